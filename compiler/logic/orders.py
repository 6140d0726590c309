"""Which comparisons cannot be true together: `x < 2` and `x > 3`, or `x < y`, `y < z` and `z < x`.

What is excluded here is excluded of every sample, for proofs leave it out. Monitors and audits
compute in floating-point numbers, where `x + 1 > x` is false of a large x. So only order is used,
which rounding keeps: what is computed is a number of its own (`x + y`), the same wherever it is
written in the same way; and of a constant that is no 32-bit float it is known only that its nearest
floats lie near it. What cannot be decided so is possible.

Source: Dechter, Meiri, Pearl, Temporal constraint networks, Artificial Intelligence 49 (1991): a
set of order constraints has a solution where no circle of them is strict.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from typing import TypeVar

from fretish import expressions as e
from fretish.bindings import constants
from fretish.reading.recursion import deep
from fretish.units import number

Literal = tuple[str, bool]
"""A comparison by its name, and whether it is true."""
Exclusion = tuple[Literal, ...]
"""Literals that are never all right at one tick; without one of them, they are at some."""
MOST = 5_000
"""Valuations of comparisons that speak of one another; the further ones are left possible."""
_DENIED: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">=", "<=": ">", ">": "<=", ">=": "<", "=": "!=", "!=": "=",
}  # fmt: skip
_MIRRORED: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!=",
}  # fmt: skip


@deep
def exclusions(
    comparisons: Mapping[str, e.Comparison],
    scales: Mapping[str, Fraction],
    words: Mapping[str, Sequence[str]] | None = None,
) -> tuple[Exclusion, ...]:
    """The least sets of literals that no numbers make true; each other valuation may occur.

    Args:
        comparisons: by their names; a bare number is in the unit of what it is compared with.
        scales: of the signals, from their units to base units; a name without one is a number.
        words: what each enumerated signal may be.
    """
    read = {name: _relation(each, scales) for name, each in comparisons.items()}
    found: list[Exclusion] = []
    for group in _groups(read):
        _Search({name: read[name] for name in read if name in group}, words or {}, found).run()
    return tuple(found)


Values = TypeVar("Values", bound="tuple[bool | None, ...]")


def only_possible(
    valuations: Sequence[Values], atoms: Sequence[str], excluded: Sequence[Exclusion]
) -> tuple[Values, ...]:
    """The valuations of atoms that are not excluded, in their order; all, if none were left."""
    places = {name: place for place, name in enumerate(atoms)}
    known = [
        [(places[name], value) for name, value in each]
        for each in excluded
        if all(name in places for name, _ in each)
    ]
    left = tuple(
        values
        for values in valuations
        if not any(all(values[i] is value for i, value in each) for each in known)
    )
    return left or tuple(valuations)


# Comparisons as relations of two points -------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Term:
    """What is measured, or computed of it."""

    text: e.Expression
    is_base: bool
    """Signals of several units meet in base units, and conversion rounds."""


@dataclass(frozen=True, slots=True)
class _Constant:
    """A number; where it is no 32-bit float, it is another one beside each term."""

    value: Fraction
    beside: _Term | None = None

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """Between which the number lies that is compared in its place."""
        if self.beside is None:
            return self.value, self.value
        error = abs(self.value) / 2**23 + Fraction(1, 2**149)
        return self.value - error, self.value + error


_Point = _Term | _Constant


@dataclass(frozen=True, slots=True)
class _Relation:
    """`left op right`."""

    left: _Point
    op: e.ComparisonOperator
    right: _Point

    @property
    def terms(self) -> Iterator[_Term]:
        """Those of its points that are no constants, and what they are the magnitudes of."""
        for point in (self.left, self.right):
            if isinstance(point, _Term) and not _is_word(point):
                yield point
                yield from (each for each in (_of_magnitude(point),) if each is not None)


def _relation(comparison: e.Comparison, scales: Mapping[str, Fraction]) -> _Relation:
    factors = {scales.get(name.id) for name in e.names(comparison)}
    is_base = len(factors) > 1 or e.has_unit(comparison)
    left, right = _constant(comparison.left), _constant(comparison.right)
    if left is not None and right is not None:
        return _Relation(_Constant(left), comparison.op, _Constant(right))
    if left is not None:
        mirrored = _MIRRORED[comparison.op]
        return _measured(comparison.right, mirrored, left, is_base)
    if right is not None:
        return _measured(comparison.left, comparison.op, right, is_base)
    sides = [
        _Term(side, is_base and not isinstance(side, e.Word))
        for side in (comparison.left, comparison.right)
    ]
    return _Relation(sides[0], comparison.op, sides[1])


def _measured(
    side: e.Expression, op: e.ComparisonOperator, limit: Fraction, is_base: bool
) -> _Relation:
    """`side op limit`; `-x < 2` is `x > -2`."""
    while isinstance(side, e.Negation):
        side, op, limit = side.arg, _MIRRORED[op], -limit
    term = _Term(side, is_base)
    return _Relation(term, op, _beside(limit, term))


def _beside(value: Fraction, term: _Term) -> _Constant:
    """The constant that stands for a number beside a term; its magnitude is of the same kind."""
    return _Constant(value) if _is_single(value) else _Constant(value, _of_magnitude(term) or term)


def _of_magnitude(term: _Term) -> _Term | None:
    """The x of `abs(x)`."""
    match term.text:
        case e.Call("abs" | "absReal" | "absInt", (arg,)):
            return _Term(arg, term.is_base)
        case _:
            return None


def _is_single(value: Fraction) -> bool:
    """Whether a 32-bit float has the value: then no other number is compared in its place."""
    try:
        (nearest,) = struct.unpack("<f", struct.pack("<f", float(value)))
    except OverflowError:
        return False
    return value == Fraction(nearest)


def _constant(expression: e.Expression) -> Fraction | None:
    """A number without names, in base units where it has one; None for anything else."""
    if any(e.names(expression)):
        return None
    try:
        for part in e.parts(expression):
            if isinstance(part, e.Number | e.Quantity):
                number(part.digits)  # it has no more digits than can be computed with
        exact = constants.number(expression)
    except ValueError:
        return None
    return exact if exact is not None and abs(exact) < _LARGE else None


_LARGE = 2**127
"""From about here on 32-bit floats are infinite."""


def _groups(relations: Mapping[str, _Relation]) -> Iterator[tuple[str, ...]]:
    """Comparisons that speak of one another: of the same terms, or in a row of them."""
    groups: list[tuple[set[_Term], list[str]]] = []
    for name, relation in relations.items():
        terms, names = {*relation.terms}, [name]
        apart = []
        for group in groups:
            if group[0].isdisjoint(terms):
                apart.append(group)
            else:
                terms, names = terms | group[0], group[1] + names
        groups = [*apart, (terms, names)]
    for _, names in groups:
        yield tuple(names)


# Order ----------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Order:
    """What is known of the order of points, with all that follows.

    Bit j of an entry i says something of the points i and j.
    """

    at_most: list[int]
    """Point i is at most point j."""
    less: list[int]
    apart: list[tuple[int, int]] = field(default_factory=list)
    choices: Sequence[tuple[int, Sequence[int]]] = ()
    """Points that are equal to one of several others."""

    def copy(self) -> _Order:
        """One of its own."""
        return _Order([*self.at_most], [*self.less], [*self.apart], self.choices)

    def add(self, i: int, j: int, *, strict: bool) -> None:
        """Point i is at most point j, or less."""
        beyond, far = self.at_most[j], self.less[j]
        for k, reached in enumerate(self.at_most):
            if reached >> i & 1:
                self.at_most[k] |= beyond
                self.less[k] |= beyond if strict or self.less[k] >> i & 1 else far

    @property
    def is_impossible(self) -> bool:
        """Whether a point is less than itself, two are equal and apart, or no choice is left."""
        return (
            any(less >> i & 1 for i, less in enumerate(self.less))
            or any(self.at_most[i] >> j & 1 and self.at_most[j] >> i & 1 for i, j in self.apart)
            or any(
                all((i, j) in self.apart or (j, i) in self.apart for j in each)
                for i, each in self.choices
            )
        )


class _Search:
    """The valuations of a group, one comparison after the other, as long as they are possible."""

    def __init__(
        self,
        relations: Mapping[str, _Relation],
        words: Mapping[str, Sequence[str]],
        found: list[Exclusion],
    ) -> None:
        self._relations, self._found = relations, found
        self._words = words
        self._names = tuple(relations)
        points = dict.fromkeys(_points(relations.values()))
        self._places = {point: place for place, point in enumerate(points)}
        self._known = self._order()
        self._left = MOST

    def run(self) -> None:
        """Add the exclusions of the group to those that were found."""
        self._go((), self._known)

    def _go(self, chosen: tuple[Literal, ...], order: _Order) -> None:
        if len(chosen) == len(self._names):
            self._left -= 1
            return
        name = self._names[len(chosen)]
        for value in (False, True):
            if self._left <= 0:
                return
            literals = (*chosen, (name, value))
            if any({*each} <= {*literals} for each in self._found):
                continue
            after = order.copy()
            self._add(after, (name, value))
            if after.is_impossible:
                self._found.append(self._least(literals))
            else:
                self._go(literals, after)

    def _least(self, literals: Exclusion) -> Exclusion:
        """Without the literals that are not needed."""
        for literal in literals:
            fewer = tuple(each for each in literals if each != literal)
            order = self._known.copy()
            for each in fewer:
                self._add(order, each)
            if order.is_impossible:
                literals = fewer
        return literals

    def _add(self, order: _Order, literal: Literal) -> None:
        name, value = literal
        relation = self._relations[name]
        op = relation.op if value else _DENIED[relation.op]
        for left, sign, right in _consequences(relation.left, op, relation.right):
            i, j = self._places[left], self._places[right]
            match sign:
                case "<" | "<=":
                    order.add(i, j, strict=sign == "<")
                case ">" | ">=":
                    order.add(j, i, strict=sign == ">")
                case "=":
                    order.add(i, j, strict=False)
                    order.add(j, i, strict=False)
                case "!=":
                    order.apart.append((i, j))

    def _order(self) -> _Order:
        """What holds of the points whatever is measured."""
        single = [1 << place for place in range(len(self._places))]
        order = _Order([*single], [0] * len(single))
        fixed = [point for point in self._places if isinstance(point, _Constant)]
        for pair in combinations(fixed, 2):
            less, more = sorted(pair, key=lambda each: each.value)
            if less.ends[1] < more.ends[0]:
                order.add(self._places[less], self._places[more], strict=True)
            elif less.beside == more.beside or None in (less.beside, more.beside):
                order.add(self._places[less], self._places[more], strict=False)  # as rounded
        for point, place in self._places.items():
            arg = _of_magnitude(point) if isinstance(point, _Term) else None
            parts: tuple[_Point, ...] = () if arg is None else (_ZERO, arg, _negative(arg))
            for part in parts:
                order.add(self._places[part], place, strict=False)
        spoken = [p for point, p in self._places.items() if _is_word(point)]
        order.apart.extend(combinations(spoken, 2))
        order.choices = tuple(self._choices())
        return order

    def _choices(self) -> Iterator[tuple[int, Sequence[int]]]:
        """Enumerated signals with all their words, where all are spoken of."""
        for point, place in self._places.items():
            match point:
                case _Term(e.Name(id)) if id in self._words:
                    words = [_Term(e.Word(word), is_base=False) for word in self._words[id]]
                    if all(word in self._places for word in words):
                        yield place, [self._places[word] for word in words]


def _is_word(point: _Point) -> bool:
    return isinstance(point, _Term) and isinstance(point.text, e.Word)


_ZERO = _Constant(Fraction(0))


def _negative(term: _Term) -> _Term:
    return _Term(e.Negation(term.text), term.is_base)


def _points(relations: Iterable[_Relation]) -> Iterator[_Point]:
    for relation in relations:
        for op in ("<", ">"):
            for left, _, right in _consequences(relation.left, op, relation.right):
                yield from (left, right)
        for term in relation.terms:
            arg = _of_magnitude(term)
            if arg is not None:
                yield from (_ZERO, arg, _negative(arg))


def _consequences(
    left: _Point, op: e.ComparisonOperator, right: _Point
) -> Iterator[tuple[_Point, e.ComparisonOperator, _Point]]:
    """The relation; and `-x > -2` beside `x < 2`."""
    yield left, op, right
    if isinstance(left, _Term) and isinstance(right, _Constant):
        yield _negative(left), _MIRRORED[op], _Constant(-right.value, right.beside)
