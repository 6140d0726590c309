"""Comparisons in words: "is below 20 %", "exceeds", "at least"."""

from __future__ import annotations

from fretish import expressions as e
from fretish.classes.frozen import dataclass
from fretish.english.amounts import amount_in
from fretish.english.parts import Part
from fretish.english.vocabulary import Vocabulary, content, matched, new_name
from fretish.english.words import COPULAS, Phrase, lower, places, text

_WORDINGS: dict[e.ComparisonOperator, str] = {
    "<=": "less than or equal to; smaller than or equal to; lower than or equal to; at most; "
    "no more than; not more than; no greater than; not greater than; no higher than; up to; <=; ≤",
    ">=": "greater than or equal to; more than or equal to; higher than or equal to; at least; "
    "no less than; not less than; no lower than; not lower than; >=; ≥",
    "<": "less than; lower than; smaller than; fewer than; falls below; drops below; fall below; "
    "drop below; sinks below; goes below; below; under; <",
    ">": "greater than; more than; higher than; larger than; rises above; goes above; rise above; "
    "exceeds; exceed; exceeding; above; over; beyond; >",
    "!=": "different from; not equal to; unequal to; differs from; !=; ≠",
    "=": "equal to; equals; equal; set to; exactly; =",
}
_OPERATORS = sorted(
    (tuple(wording.strip().split()), op)
    for op, wordings in _WORDINGS.items()
    for wording in wordings.split(";")
)
_RANGES = (("between", "and"), ("range", "to"), ("from", "to"))


@dataclass(frozen=True, slots=True)
class _Sides:
    op: e.ComparisonOperator
    left: Phrase
    words: Phrase
    right: Phrase


def comparison(phrase: Phrase, names: Vocabulary) -> Part | None:
    """The comparison that a phrase states; None if it states none."""
    sides = _sides(phrase)
    if sides is None:
        return _between(phrase, names) or _is_number(phrase, names)
    right, trailing = _right(sides.right, names)
    if right is None or not content(sides.left):
        return None
    left = _left(sides.left, names)
    if trailing and _is_new(left, names):
        left = _left((*sides.left, *trailing), names)
    return _compared(sides.op, left, right, sides.words)


def _is_new(left: Part, names: Vocabulary) -> bool:
    """Whether the left side is no name of the project."""
    return {*left.names}.isdisjoint((*names.propositions, *names.numbers))


def left_side(phrase: Phrase) -> Phrase:
    """The words before the operator; empty without a comparison."""
    sides = _sides(phrase)
    return sides.left if sides is not None else ()


def states_comparison(phrase: Phrase) -> bool:
    """Whether words of comparison stand in the phrase."""
    return _sides(phrase) is not None


def _compared(op: e.ComparisonOperator, left: Part, right: Part, words: Phrase) -> Part:
    expression = e.Comparison(op, left.expression, right.expression)
    used = left.used | right.used | places(words)
    return Part(expression, used, {**left.names, **right.names})


def _sides(phrase: Phrase) -> _Sides | None:
    """The first operator of the phrase, the longest at its place."""
    said = lower(phrase)
    for start in range(len(phrase)):
        fits = [
            (wording, op) for wording, op in _OPERATORS if said[start:][: len(wording)] == wording
        ]
        if fits and start + len(fits[0][0]) < len(phrase):
            wording, op = max(fits, key=lambda fit: len(fit[0]))
            end = start + len(wording)
            return _Sides(op, phrase[:start], phrase[start:end], phrase[end:])
    return None


def _between(phrase: Phrase, names: Vocabulary) -> Part | None:
    """`x >= 3 & x <= 5` of "x is between 3 and 5"."""
    said = lower(phrase)
    for first, second in _RANGES:
        if first not in said or second not in said[said.index(first) :]:
            continue
        start = said.index(first)
        middle = said.index(second, start)
        low, high = amount_in(phrase[start + 1 : middle]), amount_in(phrase[middle + 1 :])
        if low is None or high is None or not content(phrase[:start]):
            continue
        left, unit = _left(phrase[:start], names), high[0]
        bound = low[0]
        if isinstance(bound, e.Number) and isinstance(unit, e.Quantity):
            bound = e.Quantity(bound.digits, unit.unit)
        words = (phrase[start], phrase[middle])
        least = _compared(">=", left, Part(bound, low[1]), words)
        most = _compared("<=", left, Part(high[0], high[1]), words)
        both = e.both(least.expression, most.expression)
        return Part(both, least.used | most.used, left.names)
    return None


def _is_number(phrase: Phrase, names: Vocabulary) -> Part | None:
    """`x = 0` of "x is zero" and "x shall be 30 degrees"."""
    said = lower(phrase)
    at = next((i for i, word in enumerate(said) if word in COPULAS), None)
    if at is None or not content(phrase[:at]):
        return None
    value = amount_in(phrase[at + 1 :])
    if value is None or phrase[at + 1].start not in value[1]:
        return None
    return _compared("=", _left(phrase[:at], names), Part(value[0], value[1]), phrase[at : at + 1])


def _right(phrase: Phrase, names: Vocabulary) -> tuple[Part | None, Phrase]:
    """The right side, and the words after its number, which belong to the left."""
    value = amount_in(phrase)
    if value is None:
        return (_left(phrase, names) if content(phrase) else None), ()
    rest = phrase[value[2] :]
    belongs = bool(rest) and rest[0].lower in _PREPOSITIONS
    return Part(value[0], value[1]), rest if belongs else ()


_PREPOSITIONS = frozenset("from in to of on with at above below between inside outside per".split())


def _left(phrase: Phrase, names: Vocabulary) -> Part:
    """The number that a phrase names: known, or new."""
    apposition = _apposition(phrase)
    match = matched(phrase, names, names.numbers)
    if match is not None:
        name = match.name
    elif apposition:
        name = apposition
    else:
        variable = matched(phrase, names, names.propositions)
        exact = variable is not None and len(names.stems[variable.name]) > 1
        name = variable.name if variable and exact else new_name(phrase)
    said = phrase
    while said and said[-1].lower in COPULAS:
        said = said[:-1]
    return Part(e.Name(name), places(phrase), {name: text(said or phrase)})


def _apposition(phrase: Phrase) -> str:
    """The name in `the output of the network, z,`; empty: there is none."""
    last = phrase[-1].text == "," and len(phrase) > 3 and phrase[-3].text == ","
    return phrase[-2].text if last and phrase[-2].text.isidentifier() else ""
