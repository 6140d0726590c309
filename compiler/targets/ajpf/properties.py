"""`--emit ajpf`: a property file for the AJPF model checker of MCAPL.

AJPF's language is LTL without next, past and time. So the next-free form of the sentence is emitted
(`compiler/targets/ajpf/without_next.py`), and other sentences are refused. Each property has
controls, which are expected to be violated: if a control holds, the property holds vacuously.
Source: Dennis et al., Model checking agent programming languages, ASE 19 (2012); the property
parser of MCAPL. Controls: Kupferman and Vardi, Vacuity detection in temporal model checking, STTT 4
(2003).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from typing import Literal, assert_never

from compiler.agents.psl_printing import property_text
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Uninterpreted, boolean, obligation
from compiler.formalization.resolution import candidates
from compiler.logic import formula as f
from compiler.targets.ajpf import names
from compiler.targets.ajpf import without_next as nextfree
from compiler.targets.comparison_names import comparison_names
from compiler.targets.target import (
    DEFAULT,
    Target,
    TargetOptions,
    file_of_each,
    not_expressible,
    too_long,
)
from fretish import syntax as s
from fretish.bindings.comparisons import FUNCTIONS
from fretish.bindings.declarations import Modality
from fretish.checking import LOOK_AHEAD, LOOK_BACK, NUMBERS_BACK, calls, conditions
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.expressions import Comparison
from fretish.expressions import names as names_of
from fretish.printer import timing as printing_of
from fretish.reading.recursion import with_recursion_limit

HOLDS: Literal["HOLDS"] = "HOLDS"
VIOLATED: Literal["VIOLATED"] = "VIOLATED"
_WEAKEN = TargetOptions(weaken=True)
_MOST_LEVELS = 500
_MONITOR = "check it with `--emit monitor`"


_TRIGGERED = "a trigger comes; if it never does, {} demands nothing"
_COMES = "the mode comes; if it never does, {} demands nothing"
_ENDS = "the mode comes; if it never does, the scope of {} never ends"
_LACKS = "the mode is not on all the time; if it is, {} demands nothing"
_ENTERED = {
    s.ScopeKind.IN: _COMES,
    s.ScopeKind.ONLY_BEFORE: _COMES,
    s.ScopeKind.NOT_IN: _LACKS,
    s.ScopeKind.ONLY_IN: _LACKS,
    s.ScopeKind.AFTER: "the mode comes and goes; if it never does, {} demands nothing",
    s.ScopeKind.BEFORE: _ENDS,
    s.ScopeKind.ONLY_AFTER: _ENDS,
}


@dataclass(frozen=True, slots=True)
class ExpectedProperty:
    """One property of a file: `key: text`, the expected answer of AJPF, and why."""

    key: str
    text: str
    expected: Literal["HOLDS", "VIOLATED"]
    why: str


@with_recursion_limit
def properties(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT
) -> tuple[ExpectedProperty, ...]:
    """The property of the requirement, and the controls that give its verdict a meaning.

    Args:
        requirement: one that `refusal` does not refuse, with the same options.
        options: `weaken` counts.
    """
    formula = _formula(requirement, options)
    assert formula is not None, f"{requirement.id} was to be refused"
    key = _key(requirement.id)
    loss = weakened(requirement, options) is not None
    why = "weaker than the requirement" if loss else "the requirement"
    return (
        ExpectedProperty(key, _text(formula, requirement), HOLDS, why),
        *(
            ExpectedProperty(f"{key}_{name}", _text(control, requirement), VIOLATED, reason)
            for name, control, reason in _controls(requirement, key)
            if not isinstance(control, f.Const)
        ),
    )


def weakened(requirement: FormalizedRequirement, options: TargetOptions = DEFAULT) -> str | None:
    """The loss in words if the property is weaker than the requirement; None: no loss."""
    if not options.weaken or not _can_be_weakened(requirement):
        return None
    loss = (
        f"`{printing_of(requirement.sentence.timing)}` has lost its bound: a response that comes "
        "later, however late, satisfies it"
    )
    scope = requirement.sentence.scope
    if scope is None or scope.kind is s.ScopeKind.AFTER:
        return loss
    return f"{loss}, and so does a stretch of the scope that ends without one, however long"


def _can_be_weakened(requirement: FormalizedRequirement) -> bool:
    """Whether the requirement has a useful form without its bound, which only `within` has.

    It has none in the `only` scopes, which demand that the response is missed for that long.
    """
    scope = requirement.sentence.scope
    negates = scope is not None and scope.kind.negates
    return s.deadline(requirement.sentence.timing) is not None and not negates


# Refusals ---------------------------------------------------------------------------------------


@with_recursion_limit
def refusal(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT
) -> Diagnostic | None:
    """F601 for the first part of the requirement that AJPF's language cannot express; F604."""
    return (
        _refused_timing(requirement, options)
        or _refused_name(requirement)
        or _refused_form(requirement, _formula(requirement, options))
    )


def _refused_timing(
    requirement: FormalizedRequirement, options: TargetOptions
) -> Diagnostic | None:
    if requirement.pctl is not None:
        return _not(requirement, "the probability", "leave it out, or use a probabilistic tool")
    for expression in conditions(requirement.sentence):
        for name in (*calls(expression), *(n.id for n in names_of(expression))):
            if name in LOOK_BACK | LOOK_AHEAD:
                fix = (
                    "it has no past, and counts no steps ahead: make it a proposition, and bind it"
                )
                return _not(requirement, f"`{name}`", fix)
    timing = requirement.sentence.timing
    if not _counts_states(timing) or weakened(requirement, options):
        return None
    fix = f"AJPF has no next, no past and no time; {_MONITOR}"
    if _can_be_weakened(requirement):
        fix = (
            "AJPF has no next, no past and no time; state the requirement with `eventually`, "
            f"let the file say less with `--weaken`, or {_MONITOR}"
        )
    elif options.weaken:
        fix = f"no weaker form of it says anything of use: {_MONITOR}"
    return _not(requirement, f"the timing `{printing_of(timing)}`", fix)


def _counts_states(timing: s.Timing) -> bool:
    """Whether the timing counts ticks; a cycle of an agent has many states, so AJPF cannot."""
    extent = s.SHAPES[type(timing)].extent
    match extent:
        case s.Extent.NEXT | s.Extent.DURATION | s.Extent.BEYOND:
            return True
        case s.Extent.TRIGGER | s.Extent.LAST | s.Extent.INTERVAL | s.Extent.STOP:
            return False
        case _:
            assert_never(extent)


def _refused_name(requirement: FormalizedRequirement) -> Diagnostic | None:
    spoken = comparison_names(requirement)
    compared = {
        atom
        for atom, part in candidates(requirement.sentence)
        if isinstance(part, Comparison) and FUNCTIONS.keys() - NUMBERS_BACK >= {*calls(part)}
    }
    for atom in requirement.propositions:
        if atom in spoken and atom not in compared:
            fix = "bind it as a proposition whose name begins with a small letter, and use that"
            return _not(requirement, f"the proposition `{atom}`", fix)
    return None


def _refused_form(
    requirement: FormalizedRequirement, formula: f.Formula | None
) -> Diagnostic | None:
    if formula is None:
        return diagnostic(
            "ajpf_property_not_proved",
            requirement.entry.wording,
            requirement=requirement.id,
            monitor=_MONITOR,
        )
    if isinstance(formula, f.Const):
        return _not(requirement, "a formula that is constant", "it says nothing")
    long = too_long("AJPF", requirement, formula)
    if long is not None:
        return long
    levels = _levels(_text(formula, requirement))
    if levels > _MOST_LEVELS:
        fix = "bind parts of the expressions as propositions"
        return _not(requirement, f"{levels} parentheses within each other", fix)
    return None


def _not(requirement: FormalizedRequirement, part: str, fix: str) -> Diagnostic:
    return not_expressible("AJPF", requirement, part, fix)


def _levels(text: str) -> int:
    level = deepest = 0
    for character in text:
        level += (character == "(") - (character == ")")
        deepest = max(deepest, level)
    return deepest


# The formulas -----------------------------------------------------------------------------------


def _formula(requirement: FormalizedRequirement, options: TargetOptions) -> f.Formula | None:
    """The requirement's formula without X, or its next-free form; None if not proved equal."""
    duty = obligation(requirement.sentence, requirement.ticks or 0)
    condition = duty.condition
    if weakened(requirement, options):
        return nextfree.unbounded(duty) if nextfree.is_weaker(duty.scope, condition) else None
    if nextfree.is_next_free(requirement.ft_infinite):
        return requirement.ft_infinite
    proved = nextfree.is_proved(duty.scope, condition, duty.demand.kind)
    return nextfree.next_free(duty) if proved else None


def _controls(requirement: FormalizedRequirement, key: str) -> Iterator[tuple[str, f.Formula, str]]:
    """Name, formula and reason of each control; the formula may be constant."""
    duty = obligation(requirement.sentence, requirement.ticks or 0)
    response = boolean(requirement.sentence.response, Uninterpreted().alone())
    never = nextfree.never_begins(duty)
    if never is not None:
        entered = _TRIGGERED if duty.scope is None else _ENTERED[duty.scope]
        why = entered if duty.condition is None else _TRIGGERED
        yield "reach", never, why.format(key)
    timing = requirement.sentence.timing
    negates = duty.scope is not None and duty.scope.negates
    # What `never` forbids, an `only` scope demands outside of its mode, and the other way round: a
    # prohibition is kept by not responding, and nothing is wrong with that.
    if negates is (s.SHAPES[type(timing)].quantifier is s.Quantifier.NONE):
        reason = f"the response comes; if it never does, {key} holds without it"
        yield "resp", f.globally(f.not_(response)), reason
    if s.stop(timing) and s.SHAPES[type(timing)].quantifier is s.Quantifier.SOME and not negates:
        reason = f"the stop condition comes; if it never does, {key} demands nothing"
        yield "stop", f.globally(f.not_(duty.demand.stop)), reason


def _text(formula: f.Formula, requirement: FormalizedRequirement) -> str:
    agent, functors = names.agent(requirement), names.spelt(requirement)

    def spell(name: str) -> str:
        declared = requirement.glossary.get(name)
        modality = declared.modality if declared else Modality.BELIEF
        return f"{modality}({agent},{functors[name]})"

    return property_text(formula, spell)


def _key(id: str) -> str:
    """The id as a key: characters that `target.args` cannot carry become `_`."""
    return re.sub(r"[^A-Za-z0-9_.-]", "_", id)


# What a user should know ------------------------------------------------------------------------


def remark(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT
) -> Diagnostic | None:
    """F605, F606, F607: limits of AJPF's verdict on the property."""
    span = requirement.sentence.timing_span or requirement.entry.wording
    loss = weakened(requirement, options)
    if loss is not None:
        return diagnostic("weakened_property", span, requirement=requirement.id, loss=loss)
    sentence = requirement.sentence
    scope = sentence.scope.kind if sentence.scope else None
    if not _begins_at_once(sentence.timing) or (scope is not None and scope.negates):
        return None
    if sentence.condition is None and scope in (None, s.ScopeKind.NOT_IN, s.ScopeKind.BEFORE):
        return diagnostic("state_zero", span, requirement=requirement.id)
    return diagnostic("no_time_to_react", span, requirement=requirement.id)


def text(requirement: FormalizedRequirement, options: TargetOptions = DEFAULT) -> str:
    """The property file of one requirement."""
    return render(
        "ajpf/properties.psl.j2",
        id=requirement.id,
        sentence=" ".join(requirement.entry.wording.text.split()),
        loss=weakened(requirement, options),
        definitions=names.definitions(requirement),
        properties=properties(requirement, options),
    )


_EMIT = file_of_each("psl", text)
_SUMMARY = "a property file for the AJPF model checker"
TARGET = Target(
    "ajpf",
    _SUMMARY,
    _EMIT,
    refusal,
    remark,
    names=names.everything,
    weak=Target(
        "ajpf", _SUMMARY, _EMIT, partial(refusal, options=_WEAKEN), partial(remark, options=_WEAKEN)
    ),
)


def _begins_at_once(timing: s.Timing) -> bool:
    """Whether the response has to be true in the state of the trigger."""
    shape = s.SHAPES[type(timing)]
    match shape.extent:
        case s.Extent.TRIGGER | s.Extent.INTERVAL | s.Extent.STOP:
            return shape.quantifier is s.Quantifier.ALL
        case s.Extent.NEXT | s.Extent.LAST | s.Extent.DURATION | s.Extent.BEYOND:
            return False
        case _:
            assert_never(shape.extent)
