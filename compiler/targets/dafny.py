"""`--emit dafny`: monitor step, interceptor and closed loop with their proofs, for Dafny.

Each file has up to three parts. The monitor: a counter stepped tick by tick, with a lemma that it
is exact against the definition of the timing over the whole sequence; the bound is a number that is
compared, so its size costs nothing. The interceptor: a step and a class with contracts. The closed
loop: for every bound and every delay, the requirement is never violated.

The text keeps to what Dafny 2.3 and Dafny 4 both read. Used, and why both accept it:
- `function` and `predicate` without `method` or `ghost`: ghost in 2.3, compiled in 4. So methods
  write their expressions out and name functions in `ensures` only, and every quantifier in a
  predicate is over integers between bounds, which 4 can compile.
- `const` of modules, `datatype` with named fields and `d.(field := value)`, `match` without braces:
  the same in both.
- `constructor ()` that only assigns fields: needs no `new;` in either.
- `lemma {:induction false}`, `decreases`, `forall v | range ensures ...` and `var v :| ...` in
  lemmas: the same; lemmas are ghost in both.
- No semicolon after a declaration or clause, no `function method`, no `assume`, no `seq` slices.

Sources: the Safe-ROS paper, its Dafny listing of `cmd_vel_interceptor`, for the class and its three
obligations; for the counters see `compiler.formalization.reference`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of, temporal_predicate
from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.logic import formula as f
from compiler.logic.identifiers import legal_names, underlined
from compiler.logic.spelling.reserved_words import DAFNY
from compiler.targets.comparison_names import comparison_names, in_words
from compiler.targets.dafny_claims import CHANNELS, ResponseDelay, delay, no_loop_reason
from compiler.targets.interceptor_options import options as core
from compiler.targets.target import LOOP, Target, file_of_each, not_expressible, stem
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit
from fretish.syntax import ConditionKind, ScopeKind

_ELSEWHERE = "check its monitor with `fretc verify`"


@with_recursion_limit
def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for the first part of the requirement about which nothing can be proved."""
    sentence = requirement.sentence
    if requirement.pctl is not None:
        return not_expressible(
            "Dafny", requirement, "the probability", "leave it out, or use a probabilistic tool"
        )
    if sentence.scope is not None:
        scope = _SCOPES[sentence.scope.kind]
        return not_expressible("Dafny", requirement, f"the scope `{scope}`", _ELSEWHERE)
    predicate = temporal_predicate(sentence)
    if predicate is not None:
        part = f"the predicate `{predicate}`, which refers to other ticks,"
        return not_expressible("Dafny", requirement, part, _ELSEWHERE)
    return None


_SCOPES: Mapping[ScopeKind, str] = {
    ScopeKind.IN: "in",
    ScopeKind.NOT_IN: "unless in",
    ScopeKind.BEFORE: "before",
    ScopeKind.AFTER: "after",
    ScopeKind.ONLY_IN: "only in",
    ScopeKind.ONLY_BEFORE: "only before",
    ScopeKind.ONLY_AFTER: "only after",
}


def text(requirement: FormalizedRequirement, declarations: Declarations | None) -> str:
    """The text of the file; equal for equal requirement and declarations.

    Args:
        requirement: a requirement that is not refused.
        declarations: None without bindings: then the interceptor is the plain one.
    """
    return render(
        "dafny/requirement.dfy.j2",
        id=requirement.id,
        title=requirement.entry.title,
        sentence=" ".join(requirement.entry.wording.text.split()),
        file=f"{stem(requirement)}.dfy",
        monitor=_monitor(requirement).rstrip() + "\n",
        interceptor=_interceptor(declarations).rstrip() + "\n",
        loop=_loop(requirement, declarations).rstrip(),
    )


# Monitor --------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Trigger:
    """The Dafny expressions for the begin of a demand."""

    at: str
    """The trigger at tick t of a sequence w."""
    now: str
    """The trigger at tick x, for a monitor m."""
    memory: str
    """The value that the monitor remembers of tick x."""
    remembered: str
    """The remembered value, of a sequence w after k ticks."""
    memory_means: str
    in_loop: str
    loop_memory: str
    always_before: str
    """The value that the loop remembers after ticks on which the condition holds."""


_TRIGGERS: Mapping[ConditionKind | None, Trigger] = {
    None: Trigger(
        at="t == 0",
        now="!m.before",
        memory="true",
        remembered="k > 0",
        memory_means="before: there was a tick.",
        in_loop="!l.before",
        loop_memory="true",
        always_before="true",
    ),
    ConditionKind.HOLDING: Trigger(
        at="Condition(w[t])",
        now="Condition(x)",
        memory="false",
        remembered="false",
        memory_means="before: nothing has to be remembered of the condition.",
        in_loop="condition",
        loop_memory="false",
        always_before="false",
    ),
    ConditionKind.TRIGGER: Trigger(
        at="Condition(w[t]) && (t == 0 || !Condition(w[t - 1]))",
        now="Condition(x) && !m.before",
        memory="Condition(x)",
        remembered="k > 0 && Condition(w[k - 1])",
        memory_means="before: the condition held at the tick before.",
        in_loop="condition && !l.before",
        loop_memory="condition",
        always_before="true",
    ),
}


def _monitor(requirement: FormalizedRequirement) -> str:
    sentence, timing = requirement.sentence, requirement.sentence.timing
    fields = _names(requirement)
    stop, shape = s.stop(timing), s.SHAPES[type(timing)]
    return render(
        f"dafny/{_COUNTERS[type(timing)]}.dfy.j2",
        fields=fields,
        meanings=in_words(requirement),
        condition=_dafny(sentence.condition.expression, fields) if sentence.condition else None,
        response=_dafny(sentence.response, fields),
        stop=_dafny(stop, fields) if stop else None,
        trigger=_trigger(requirement),
        clash=_COUNTERS[type(timing)] == "after",
        sign="!" if shape.quantifier is s.Quantifier.NONE else "",
        **_bound(requirement),
    )


def _trigger(requirement: FormalizedRequirement) -> Trigger:
    condition = requirement.sentence.condition
    return _TRIGGERS[condition.kind if condition else None]


_COUNTERS: Mapping[type[s.Timing], str] = {
    s.Immediately: "immediately",
    s.Next: "next",
    s.Finally: "finally",
    s.Eventually: "eventually",
    s.Always: "always",
    s.Never: "always",  # not
    s.Within: "within",
    s.For: "for",
    s.After: "after",
    s.Until: "until",
    s.Before: "before",
}
"""The template of each timing."""


def _bound(requirement: FormalizedRequirement) -> Mapping[str, object]:
    """The bound in the templates: a parameter and an argument, if there is one."""
    bounded = s.duration(requirement.sentence.timing) is not None
    return {
        "bounded": bounded,
        "bound": requirement.ticks,
        "n": "n: nat, " if bounded else "",
        "with_n": "n, " if bounded else "",
    }


def _fields(atoms: Sequence[str], comparisons: Mapping[str, str]) -> Mapping[str, str]:
    """A unique Dafny name for each atom; a tick without propositions gets an unused field.

    A name begins with a letter, and ends neither with `?` nor with digits like those of an array
    type.
    """
    wanted = {atom: _field(comparisons.get(atom, atom)) for atom in atoms}
    names = legal_names(atoms, DAFNY, names=wanted, variants=underlined)
    return names or {"no proposition": "unused"}


def _field(name: str) -> str:
    """The name with only letters, digits and single `_`."""
    text = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "p"
    return text if text[0].isalpha() else f"p_{text}"


def _names(requirement: FormalizedRequirement) -> Mapping[str, str]:
    return _fields(atoms_of(requirement.sentence), comparison_names(requirement))


def _dafny(expression: e.Expression, fields: Mapping[str, str]) -> str:
    return _text(boolean(expression, Uninterpreted().alone()), fields)


def _text(formula: f.Formula, fields: Mapping[str, str]) -> str:
    """The text of a formula without time, about tick `x`, with every operator in parentheses."""

    def text(part: f.Formula) -> str:
        return _text(part, fields)

    match formula:
        case f.Const(value):
            return "true" if value else "false"
        case f.Atom(name):
            return f"x.{fields[name]}"
        case f.Not(arg):
            return f"!{text(arg)}"
        case f.And(args):
            return f"({' && '.join(map(text, args))})"
        case f.Or(args):
            return f"({' || '.join(map(text, args))})"
        case f.Implies(left, right):
            return f"({text(left)} ==> {text(right)})"
        case f.Iff(left, right):
            return f"({text(left)} <==> {text(right)})"
        case f.Xor(left, right):
            return f"({text(left)} != {text(right)})"
        case _:
            raise AssertionError(f"not of one tick: {formula}")


# Interceptor ----------------------------------------------------------------------------------


def _interceptor(declarations: Declarations | None) -> str:
    if declarations is None or declarations.interceptor is None:
        return render("dafny/latch.dfy.j2")
    options = core(declarations.interceptor)
    watched = [channel for channel in CHANNELS if getattr(options, f"{channel[1]}_timeout")]
    return render("dafny/interceptor.dfy.j2", options=options, watched=watched)


# Closed loop ----------------------------------------------------------------------------------


def _loop(requirement: FormalizedRequirement, declarations: Declarations | None) -> str:
    reason = no_loop_reason(requirement, declarations)
    if reason is not None:
        return render("dafny/loopless.dfy.j2", reason=reason)
    declared = delay(requirement, declarations)
    fits = (
        isinstance(declared, ResponseDelay)
        and requirement.ticks is not None
        and declared.total <= requirement.ticks
    )
    return render(
        "dafny/loop.dfy.j2",
        trigger=_trigger(requirement),
        declared=declared if fits else None,
        **_bound(requirement),
    )


TARGET = Target(
    "dafny",
    "monitor step, interceptor and closed loop with proofs, for Dafny",
    file_of_each("dfy", lambda requirement, options: text(requirement, options.declarations)),
    refuse,
    next_step="`dafny verify {}` proves it",
    reads=LOOP,
    names=_names,
)
