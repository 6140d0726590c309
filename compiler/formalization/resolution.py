"""What the atoms of a sentence are in the logs: propositions that are declared, or signals.

A comparison of signals needs no proposition of its own: it is one, evaluated where it stands. So
is a signal that stands where a truth value does.
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
from fretish.bindings.declarations import Aggregate, Declarations, Part, Proposition, Signal
from fretish.bindings.definitions import expanded
from fretish.bindings.expressions import ticks_back
from fretish.bindings.words import resolve_words
from fretish.checking import conditions
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.printer import expression as printed
from fretish.syntax import Sentence


def in_own_units(
    sentence: Sentence, declarations: Declarations, place: Span
) -> Sentence | Diagnostic:
    """The sentence with the words of its signals as words, and units as those of the signals."""
    signals = declarations.signals
    mistakes: list[Diagnostic] = []

    def converted(comparison: e.Comparison) -> e.Comparison:
        if not comparisons.is_measured(comparison, signals):
            return comparison
        own = comparisons.in_own_units(comparison, signals, place)
        if isinstance(own, e.Comparison):
            return own
        mistakes.append(own)
        return comparison

    worded = _worded(sentence, declarations, place)
    if isinstance(worded, Diagnostic):
        return worded
    own = s.with_expressions(worded, lambda each: e.with_comparisons(each, converted))
    return mistakes[0] if mistakes else own


def _worded(sentence: Sentence, declarations: Declarations, place: Span) -> Sentence | Diagnostic:
    """The sentence as it is written, with the words of its signals as words."""
    signals = _without(declarations.propositions, declarations.signals)
    mistakes: list[Diagnostic] = []

    def rewritten(expression: e.Expression) -> e.Expression:
        worded = resolve_words(expression, signals, place)
        if isinstance(worded, Diagnostic):
            mistakes.append(worded)
            return expression
        return worded

    found = s.with_expressions(sentence, rewritten)
    return mistakes[0] if mistakes else found


def _without(
    propositions: Mapping[str, Proposition], signals: Mapping[str, Signal]
) -> Mapping[str, Signal]:
    """The signals, but for numbers with the name of a proposition: that is the truth value."""
    return {
        name: signal
        for name, signal in signals.items()
        if signal.values or name not in propositions
    }


def resolved(
    requirement: FormalizedRequirement, declarations: Declarations
) -> FormalizedRequirement | Diagnostic:
    """The requirement with declarations that hold each of its atoms which signals decide."""
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
        elif comparisons.is_measured(part, declarations.signals):
            bound = _bound(part, declarations, requirement.entry.wording)
            if isinstance(bound, Diagnostic):
                return bound
            span = getattr(part, "span", None) or requirement.entry.wording
            aggregate = _aggregate(bound, declarations.signals, span)
            if isinstance(aggregate, Diagnostic):
                return aggregate
            propositions[name] = Proposition(
                name, bound, printed(own), aggregate=aggregate, span=span
            )
    return replace(requirement, declarations=extended(declarations, propositions, mistakes))


def _aggregate(
    expression: e.Expression, signals: Mapping[str, Signal], place: Span
) -> Aggregate | Diagnostic:
    """How several samples in one tick combine: as the signals that are read declare it."""
    read = [signals[name.id] for name in e.names(expression) if name.id in signals]
    kinds = {signal.aggregate for signal in read} or {Aggregate.LAST}
    if len(kinds) > 1 or (ticks_back(expression) and kinds != {Aggregate.LAST}):
        names = ", ".join(dict.fromkeys(f"`{signal.name}`" for signal in read))
        return Diagnostic(
            Code.SEVERAL_AGGREGATES,
            f"nothing says which samples of a tick count for {names} together",
            place,
            help="give these signals the same `agg`, which is `last` beside an earlier tick",
        )
    return kinds.pop()


def extended(
    declarations: Declarations,
    propositions: Mapping[str, Proposition],
    mistakes: Mapping[Part, tuple[Diagnostic, ...]],
) -> Declarations:
    """The declarations with propositions that sentences state."""
    if not propositions and not mistakes:
        return declarations
    return replace(
        declarations,
        propositions={**declarations.propositions, **propositions},
        mistakes={**declarations.mistakes, **mistakes},
    )


def _as_written(requirement: FormalizedRequirement, declarations: Declarations) -> Sentence:
    """The sentence in the units in which it is written, with words, and with what names stand for.

    It has the same comparisons in the same places as the one in the signals' units.
    """
    whole = expanded(requirement.written, requirement.definitions)
    assert isinstance(whole, Sentence), "the requirement has been made of it"
    worded = _worded(whole, declarations, requirement.entry.wording)
    assert isinstance(worded, Sentence), "the requirement has been made of it"
    return worded


def candidates(sentence: Sentence) -> Iterator[tuple[str, e.Expression]]:
    """Comparisons and variables, by the names that formulas give them.

    Those of a sentence in other units come in the same order.
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
    """Those of the signals that it reads, where all that is not declared is one of them."""
    names = [name.id for name in e.names(part)]
    own = [declarations.mistakes.get(("signal", name), ()) for name in names]
    known = all(name in declarations.signals or own[i] for i, name in enumerate(names))
    return tuple(dict.fromkeys(chain.from_iterable(own))) if known else ()


def _bound(
    part: e.Expression, declarations: Declarations, place: Span
) -> e.Expression | Diagnostic:
    if not isinstance(part, e.Comparison):
        return part
    return comparisons.bound(part, declarations.signals, place)
