"""Formalization of one requirement: parsing, checks, and the formulas."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

from compiler.formalization import predicates
from compiler.formalization.anticipation import anticipated
from compiler.formalization.binding_agreement import check_binding_consistency, first_use
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.future import future, probabilistic
from compiler.formalization.obligation import Uninterpreted, boolean, obligation
from compiler.formalization.past import (
    MonitorSpec,
    monitor_spec,
    monitor_spec_of_formula,
    past,
    past_of_formula,
)
from compiler.formalization.resolution import in_own_units, with_signal_atoms
from compiler.logic.formula import Formula, endless
from compiler.logic.prefixes import finite
from compiler.logic.printing import identifier
from fretish.ambiguities import ambiguity_warnings
from fretish.bindings.comparisons import is_measured
from fretish.bindings.declarations import Declarations, Modality, Variable
from fretish.bindings.definitions import Definitions, expanded, used_definitions
from fretish.bindings.types import type_errors, value_type_errors
from fretish.checking import (
    check_response_kinds,
    conditions,
    is_formula,
    temporal_predicates,
    too_deep,
)
from fretish.classes.frozen import dataclass
from fretish.clock import Clock, assumed_ticks, counts_in_ticks, in_ticks
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry
from fretish.expressions import Comparison, Expression, Truth, with_comparisons
from fretish.formulas.sentences import find_errors, parse
from fretish.reading.limits import with_budget
from fretish.reading.memory import remembered, remembered_by_value
from fretish.reading.recursion import with_recursion_limit
from fretish.syntax import Sentence, with_expressions


@with_recursion_limit
def formalize(
    requirement: RequirementEntry, declarations: Declarations | None
) -> tuple[FormalizedRequirement | None, tuple[Diagnostic, ...]]:
    """Parse, check and formalize one requirement.

    Returns:
        The formalized requirement, or None if there is an error; and all diagnostics.
    """
    wording = requirement.wording
    reading = partial(_formalized, requirement, declarations)
    result = with_budget(wording.end - wording.start, wording, reading)
    return (None, (result,)) if isinstance(result, Diagnostic) else result


def _formalized(
    entry: RequirementEntry, declarations: Declarations | None
) -> tuple[FormalizedRequirement | None, tuple[Diagnostic, ...]]:
    if entry.is_free_text:
        return None, (diagnostic("free_text", entry.wording, requirement=entry.id),)
    written = parse(entry.wording)
    if isinstance(written, Diagnostic):
        return None, find_errors(entry.wording)
    declarations = declarations.for_component(written.component) if declarations else None
    definitions = used_definitions(written, declarations.definitions) if declarations else {}
    wrong = _misuses(written, definitions, declarations, entry.wording)
    if wrong:
        return None, wrong
    sentence = _judged(written, definitions, declarations, entry.wording)
    if isinstance(sentence, Diagnostic):
        return None, (sentence,)
    ticks = in_ticks(sentence, _clock(declarations))
    if isinstance(ticks, Diagnostic):
        return None, (ticks,)
    try:
        requirement = _rule(entry, written, sentence, ticks, declarations, definitions)
    except (
        RecursionError
    ):  # some versions of Python bound it below what `with_recursion_limit` asks for
        return None, (too_deep(sentence),)
    wrong = (
        *name_collisions([requirement]),
        *(check_binding_consistency(requirement, declarations) if declarations else ()),
    )
    if wrong:
        return None, wrong
    bound = with_signal_atoms(requirement, declarations) if declarations else requirement
    if isinstance(bound, Diagnostic):
        return None, (bound,)
    return bound, tuple(_remarks(sentence, declarations))


def _misuses(
    written: Sentence, definitions: Definitions, declarations: Declarations | None, span: Span
) -> tuple[Diagnostic, ...]:
    """F344 in the sentence, and in the definitions of its names."""
    if declarations is None:
        return ()
    variables = declarations.variables
    inside = [type_errors(expression, variables, span) for expression in conditions(written)]
    values = [value_type_errors(variables[name], variables) for name in definitions]
    return tuple(dict.fromkeys(chain(*inside, *values)))


def _judged(
    written: Sentence, definitions: Definitions, declarations: Declarations | None, span: Span
) -> Sentence | Diagnostic:
    """The sentence to formalize: names expanded, numbers in the signals' units."""
    sentence = expanded(written, definitions)
    if not isinstance(sentence, Diagnostic):
        sentence = counts_in_ticks(sentence, _clock(declarations))
    if isinstance(sentence, Diagnostic) or declarations is None:
        return sentence
    wrong = next(check_response_kinds(sentence), None)
    return wrong or in_own_units(sentence, declarations, span)


@with_recursion_limit
def unreadable_sentence(requirement: RequirementEntry) -> tuple[Diagnostic, ...]:
    """The errors of the sentence of a requirement whose header has errors, too.

    The result is empty if the header does not end, or the file cannot be read: then the sentence is
    unknown.
    """
    wording = requirement.wording
    codes = {mistake.code for mistake in requirement.mistakes}
    if not codes or codes & _WITHOUT_SENTENCE or requirement.is_free_text:
        return ()
    diagnostics = with_budget(wording.end - wording.start, wording, partial(find_errors, wording))
    return (diagnostics,) if isinstance(diagnostics, Diagnostic) else diagnostics


_WITHOUT_SENTENCE = {
    Code.UNCLOSED_HEADER,
    Code.NO_SUCH_FILE,
    Code.IS_A_DIRECTORY,
    Code.UNREADABLE,
    Code.NOT_TEXT,
}


def name_collisions(requirements: Sequence[FormalizedRequirement]) -> Iterator[Diagnostic]:
    """F116 for two names with the same spelling in formulas, such as `a.b` and `a_DOT_b`."""
    spelt: dict[str, str] = {}
    for requirement in requirements:
        for name in requirement.variables:
            first = spelt.setdefault(identifier(name), name)
            if first != name:
                yield diagnostic(
                    "same_name_in_formulas",
                    first_use(requirement, name),
                    first=first,
                    name=name,
                    identifier=identifier(name),
                )


def _rule(
    requirement: RequirementEntry,
    written: Sentence,
    sentence: Sentence,
    ticks: int | None,
    declarations: Declarations | None,
    definitions: Definitions,
) -> FormalizedRequirement:
    formulas = _formulas(sentence, ticks)
    return FormalizedRequirement(
        entry=requirement,
        written=written,
        sentence=sentence,
        ticks=ticks,
        clock=_clock(declarations),
        ft_infinite=formulas.ft_infinite,
        ft_finite=formulas.ft_finite,
        pt=formulas.pt,
        watch=formulas.watch,
        pctl=formulas.pctl,
        glossary=_glossary(declarations),
        declarations=declarations,
        definitions=definitions,
    )


@dataclass(frozen=True, slots=True)
class _Formulas:
    """The formulas of a `FormalizedRequirement`."""

    ft_infinite: Formula
    ft_finite: Formula
    pt: Formula
    watch: MonitorSpec
    pctl: Formula | None


@remembered_by_value
def _formulas(sentence: Sentence, ticks: int | None) -> _Formulas:
    """The formulas and the monitor specification, all from one obligation or one formula."""
    if is_formula(sentence):
        return _of_formula(boolean(sentence.response, Uninterpreted().alone()))
    ahead = obligation(sentence, ticks or 0, predicates.Future())
    back = obligation(sentence, ticks or 0, predicates.Past())
    ft_finite = future(ahead)
    odds = sentence.probability
    return _Formulas(
        ft_infinite=endless(ft_finite),
        ft_finite=ft_finite,
        pt=past(back),
        watch=anticipated(sentence, back, monitor_spec(back)),
        pctl=probabilistic(ahead, odds.op, odds.digits) if odds else None,
    )


def _of_formula(formula: Formula) -> _Formulas:
    watch = monitor_spec_of_formula(formula)
    return _Formulas(formula, finite(formula), past_of_formula(formula, watch), watch, pctl=None)


@remembered
def _glossary(declarations: Declarations | None) -> Mapping[str, Variable]:
    """The declaration of each variable; a bound proposition has its binding's role and text.

    A modality other than belief has priority wherever it is declared.
    """
    if declarations is None:
        return {}
    bound = {
        name: Variable(
            name,
            type="boolean",
            role=str(p.role),
            text=p.text,
            modality=p.modality,
            action=p.action,
        )
        for name, p in declarations.propositions.items()
    }
    bound |= {
        name: Variable(name, role=str(signal.role))
        for name, signal in declarations.measured.items()
        if signal.role is not None and name not in bound
    }
    named = {
        name: _with_bound(variable, bound[name]) if name in bound else variable
        for name, variable in declarations.variables.items()
    }
    return {**bound, **named}


def _with_bound(variable: Variable, bound: Variable) -> Variable:
    """The variable of FRET's glossary, completed by its binding."""
    modality = bound.modality if variable.modality is Modality.BELIEF else variable.modality
    action, role = variable.action or bound.action, variable.role or bound.role
    return replace(variable, modality=modality, action=action, role=role)


def _clock(declarations: Declarations | None) -> Clock | None:
    return declarations.clock if declarations and declarations.clock.declared else None


def _remarks(sentence: Sentence, declarations: Declarations | None) -> Iterator[Diagnostic]:
    clock = _clock(declarations)
    assumed = assumed_ticks(sentence, clock)
    if assumed is not None:
        yield assumed
    yield from ambiguity_warnings(sentence)
    yield from temporal_predicates(_without_signals(sentence, declarations))


def _without_signals(sentence: Sentence, declarations: Declarations | None) -> Sentence:
    """The sentence without the comparisons that are evaluated directly over signals."""
    signals = declarations.measured if declarations else {}

    def answered(comparison: Comparison) -> Expression:
        return Truth(True) if is_measured(comparison, signals) else comparison

    return with_expressions(sentence, partial(with_comparisons, rewrite=answered))


def duplicate_ids(
    requirements: Sequence[RequirementEntry],
) -> Mapping[RequirementEntry, Diagnostic]:
    """F201 for every repeated id; case, `-`, `_` and `.` do not distinguish ids.

    Returns:
        The diagnostic of each requirement with a repeated id, the first one included.
    """
    first: dict[str, RequirementEntry] = {}
    diagnostics: dict[RequirementEntry, Diagnostic] = {}
    for requirement in requirements:
        earlier = first.setdefault(re.sub(r"[-.]", "_", requirement.id.lower()), requirement)
        if earlier is not requirement:
            span = earlier.place("id")
            diagnostics[requirement] = diagnostic(
                "duplicate_id",
                requirement.place("id"),
                requirement=requirement.id,
                source=span.source.name,
                line=span.line,
                related=(span,),
            )
            diagnostics.setdefault(earlier, diagnostics[requirement])
    return diagnostics
