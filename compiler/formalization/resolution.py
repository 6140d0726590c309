"""The atoms of a sentence in the logs: declared propositions, or expressions over signals.

A comparison of signals needs no declared proposition: it is evaluated directly. So is a signal that
is used as a truth value.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import atom, variable
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings import comparisons
from fretish.bindings.calculations import with_calculations
from fretish.bindings.declarations import Aggregate, Declarations, MeasuredSignal, Part, Proposition
from fretish.bindings.definitions import expanded
from fretish.bindings.expressions import ticks_back
from fretish.bindings.words import resolve_words
from fretish.checking import conditions
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.printer import expression as printed
from fretish.syntax import Sentence


def in_own_units(
    sentence: Sentence, declarations: Declarations, span: Span
) -> Sentence | Diagnostic:
    """The sentence with names resolved to signals' values, and with the signals' units."""
    signals = declarations.measured
    mistakes: list[Diagnostic] = []

    def converted(comparison: e.Comparison) -> e.Comparison:
        if not comparisons.is_measured(comparison, signals):
            return comparison
        own = comparisons.in_own_units(comparison, signals, span)
        if isinstance(own, e.Comparison):
            return own
        mistakes.append(own)
        return comparison

    worded = _worded(sentence, declarations, span)
    if isinstance(worded, Diagnostic):
        return worded
    own = s.with_expressions(worded, lambda expression: e.with_comparisons(expression, converted))
    return mistakes[0] if mistakes else own


def _worded(sentence: Sentence, declarations: Declarations, span: Span) -> Sentence | Diagnostic:
    """The sentence as written, with names resolved to signals' values."""
    signals = _without(declarations.propositions, declarations.measured)
    mistakes: list[Diagnostic] = []

    def rewritten(expression: e.Expression) -> e.Expression:
        worded = resolve_words(expression, signals, span)
        if isinstance(worded, Diagnostic):
            mistakes.append(worded)
            return expression
        return worded

    resolved_sentence = s.with_expressions(sentence, rewritten)
    return mistakes[0] if mistakes else resolved_sentence


def _without(
    propositions: Mapping[str, Proposition], signals: Mapping[str, MeasuredSignal]
) -> Mapping[str, MeasuredSignal]:
    """The signals without numeric signals that share their name with a proposition."""
    return {
        name: signal
        for name, signal in signals.items()
        if signal.values or name not in propositions
    }


def with_signal_atoms(
    requirement: FormalizedRequirement, declarations: Declarations
) -> FormalizedRequirement | Diagnostic:
    """The requirement with declarations extended by its atoms over signals."""
    propositions: dict[str, Proposition] = {}
    mistakes: dict[Part, tuple[Diagnostic, ...]] = {}
    atoms = {*requirement.propositions, *requirement.watched}
    written = _as_written(requirement, declarations)
    parts = zip(candidates(requirement.sentence), candidates(written), strict=True)
    for (name, own), (_, part) in parts:
        if name not in atoms or name in propositions:
            continue
        if name in declarations.propositions or ("proposition", name) in declarations.mistakes:
            continue
        broken = _mistakes(part, declarations)
        if broken:
            mistakes[("proposition", name)] = broken
        elif comparisons.is_measured(part, declarations.measured):
            bound = _bound(part, declarations, requirement.entry.wording)
            if isinstance(bound, Diagnostic):
                return bound
            span = getattr(part, "span", None) or requirement.entry.wording
            aggregate = _aggregate(bound, declarations.measured, span)
            if isinstance(aggregate, Diagnostic):
                return aggregate
            expression = with_calculations(bound, declarations.computed)
            propositions[name] = Proposition(
                name, expression, printed(own), aggregate=aggregate, span=span
            )
    return replace(
        requirement, declarations=with_propositions(declarations, propositions, mistakes)
    )


def _aggregate(
    expression: e.Expression, signals: Mapping[str, MeasuredSignal], span: Span
) -> Aggregate | Diagnostic:
    """The aggregation of several samples in one tick, as the signals declare it."""
    read = [signals[name.id] for name in e.names(expression) if name.id in signals]
    kinds = {signal.aggregate for signal in read} or {Aggregate.LAST}
    if len(kinds) > 1 or (ticks_back(expression) and kinds != {Aggregate.LAST}):
        names = ", ".join(dict.fromkeys(f"`{signal.name}`" for signal in read))
        return diagnostic("several_aggregates", span, names=names)
    return kinds.pop()


def with_propositions(
    declarations: Declarations,
    propositions: Mapping[str, Proposition],
    mistakes: Mapping[Part, tuple[Diagnostic, ...]],
) -> Declarations:
    """The declarations extended by propositions of sentences."""
    if not propositions and not mistakes:
        return declarations
    return replace(
        declarations,
        propositions={**declarations.propositions, **propositions},
        mistakes={**declarations.mistakes, **mistakes},
    )


def _as_written(requirement: FormalizedRequirement, declarations: Declarations) -> Sentence:
    """The sentence in its written units, with values of signals, and with definitions inserted.

    The comparisons are in the same places as in the sentence in the signals' units.
    """
    whole = expanded(requirement.written, requirement.definitions)
    assert isinstance(whole, Sentence), "the requirement has been made of it"
    worded = _worded(whole, declarations, requirement.entry.wording)
    assert isinstance(worded, Sentence), "the requirement has been made of it"
    return worded


def candidates(sentence: Sentence) -> Iterator[tuple[str, e.Expression]]:
    """The comparisons and variables, with their names in formulas.

    A sentence in other units has the same order.
    """
    waiting = list(conditions(sentence))
    while waiting:
        part = waiting.pop()
        if isinstance(part, e.Comparison):
            yield atom(part), part
            continue
        if isinstance(part, e.Name):
            yield variable(part.id), part
        waiting.extend(e.children(part))


def _mistakes(part: e.Expression, declarations: Declarations) -> tuple[Diagnostic, ...]:
    """Errors of the signals that the part reads; empty if it also reads an undeclared name."""
    names = [name.id for name in e.names(part)]
    own = [declarations.mistakes.get(("signal", name), ()) for name in names]
    all_declared = all(name in declarations.measured or own[i] for i, name in enumerate(names))
    return tuple(dict.fromkeys(chain.from_iterable(own))) if all_declared else ()


def _bound(part: e.Expression, declarations: Declarations, span: Span) -> e.Expression | Diagnostic:
    if not isinstance(part, e.Comparison):
        return part
    return comparisons.bound(part, declarations.measured, span)
