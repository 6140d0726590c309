"""Comparisons that cannot be true together: `x < 2` and `x > 3`, or `x < y`, `y < z` and `z < x`.

An exclusion holds for every sample, because proofs rely on it. Monitors and audits compute in
floats, where `x + 1 > x` is false for a large x. So only order is used, which rounding preserves: a
computed term (`x + y`) is a number of its own, equal wherever it is written in the same way; a
constant that is not a 32-bit float stands for any number between its nearest floats. A combination
that cannot be decided in this way counts as possible.

Source: Dechter, Meiri, Pearl, Temporal constraint networks, Artificial Intelligence 49 (1991): a
set of order constraints has a solution where no circle of them is strict.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TypeVar

from compiler.logic.ordering import ranges
from compiler.logic.ordering.relations import (
    MIRRORED,
    ZERO,
    NumberTerm,
    Point,
    Relation,
    Term,
    is_word,
    negative,
    of_magnitude,
    relation_of,
)
from fretish import expressions as e
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit

Literal = tuple[str, bool]
"""The name of a comparison, and its truth value."""
Exclusion = tuple[Literal, ...]
"""Literals that are never all true at one tick; every proper subset can be."""
MOST = 5_000
"""Limit of valuations of related comparisons; further ones count as possible."""
MOST_STEPS = 15_000_000
"""Step limit of a search through valuations, about two seconds."""
MOST_POINTS = 500
"""Limit of points in a search; comparisons of further points count as possible."""
_DENIED: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">=", "<=": ">", ">": "<=", ">=": "<", "=": "!=", "!=": "=",
}  # fmt: skip


@with_recursion_limit
def exclusions(
    comparisons: Mapping[str, e.Comparison],
    scales: Mapping[str, Fraction],
    words: Mapping[str, Sequence[str]] | None = None,
) -> tuple[Exclusion, ...]:
    """The minimal sets of literals that no numbers make true; each other valuation may occur.

    Args:
        comparisons: by their names; a number without a unit has the unit of the term beside it.
        scales: factors from the signals' units to base units; a name without one has no unit.
        words: the values of each enumerated signal.
    """
    read = {name: relation_of(comparison, scales) for name, comparison in comparisons.items()}
    excluded: list[Exclusion] = []
    for names in _groups(read):
        share = Fraction(len(names), len(read))
        excluded += _of_group({name: read[name] for name in names}, words or {}, share)
    return tuple(excluded)


Values = TypeVar("Values", bound="tuple[bool | None, ...]")


def only_possible(
    valuations: Sequence[Values], atoms: Sequence[str], excluded: Sequence[Exclusion]
) -> tuple[Values, ...]:
    """The valuations of atoms that are not excluded, in their order; all, if none were left."""
    places = {name: index for index, name in enumerate(atoms)}
    relevant = [
        [(places[name], value) for name, value in exclusion]
        for exclusion in excluded
        if all(name in places for name, _ in exclusion)
    ]
    left = tuple(
        values
        for values in valuations
        if not any(all(values[i] is value for i, value in exclusion) for exclusion in relevant)
    )
    return left or tuple(valuations)


# Groups ---------------------------------------------------------------------------------------


def _groups(relations: Mapping[str, Relation]) -> Sequence[Sequence[str]]:
    """Groups of related comparisons: those that share terms, directly or through others."""
    heads: dict[Term, Term] = {}

    def head(term: Term) -> Term:
        while heads.setdefault(term, term) != term:
            heads[term] = heads[heads[term]]
            term = heads[term]
        return term

    for relation in relations.values():
        terms = tuple(relation.terms)
        for term in terms:
            heads[head(term)] = head(terms[0])
    groups: dict[Term | str, list[str]] = {}
    for name, relation in relations.items():
        first = next(relation.terms, None)
        groups.setdefault(name if first is None else head(first), []).append(name)
    places = {name: index for index, name in enumerate(relations)}
    return sorted(groups.values(), key=lambda names: places[names[-1]])


def _of_group(
    relations: Mapping[str, Relation], words: Mapping[str, Sequence[str]], share: Fraction
) -> Sequence[Exclusion]:
    """The exclusions of related comparisons, found with a share of the step limit."""
    if ranges.is_of_one_term(relations):
        return ranges.exclusions(relations, words, share)
    search = _ValuationSearch(relations, words, int(MOST_STEPS * share))
    minimal = search.run()
    if not search.is_cut:
        return minimal
    literal_sets = {frozenset(exclusion) for exclusion in minimal}
    more = (
        exclusion
        for of_term in _by_term(relations)
        for exclusion in ranges.exclusions(
            of_term, words, share * Fraction(len(of_term), len(relations))
        )
    )
    return [
        *minimal,
        *(exclusion for exclusion in more if frozenset(exclusion) not in literal_sets),
    ]


def _by_term(relations: Mapping[str, Relation]) -> Iterator[Mapping[str, Relation]]:
    """The comparisons of each term with constants or enumeration values, decided alone."""
    groups: dict[Point, dict[str, Relation]] = {}
    for name, relation in relations.items():
        if isinstance(relation.right, NumberTerm) or is_word(relation.right):
            groups.setdefault(relation.left, {})[name] = relation
    return (group for group in groups.values() if ranges.is_of_one_term(group))


# Order ----------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Order:
    """Known order relations of points, closed under consequences.

    Bit j of entry i is a relation of the points i and j.
    """

    at_most: list[int]
    """Bit j of entry i: point i is at most point j."""
    less: list[int]
    apart: list[int]
    """Bit j of entry i: the points differ; symmetric."""
    choices: Sequence[tuple[int, int]] = ()
    """Points that are equal to one of several others."""
    has_circle: bool = False
    """Whether a point is less than itself."""

    def copy(self) -> _Order:
        """An independent copy."""
        return replace(self, at_most=[*self.at_most], less=[*self.less], apart=[*self.apart])

    def add(self, i: int, j: int, *, strict: bool) -> None:
        """Add that point i is at most point j, or less if `strict`."""
        if (self.less if strict else self.at_most)[i] >> j & 1:
            return
        beyond, far = self.at_most[j], self.less[j]
        for k, reached in enumerate(self.at_most):
            if reached >> i & 1:
                self.at_most[k] |= beyond
                self.less[k] |= beyond if strict or self.less[k] >> i & 1 else far
                self.has_circle |= bool(self.less[k] >> k & 1)

    def separate(self, i: int, j: int) -> None:
        """Add that the points differ."""
        self.apart[i] |= 1 << j
        self.apart[j] |= 1 << i

    @property
    def is_impossible(self) -> bool:
        """Whether a point is less than itself, two are equal and apart, or no choice is left."""
        return (
            self.has_circle
            or any(
                self.at_most[j] >> i & 1
                for i, apart in enumerate(self.apart)
                if apart
                for j in _places(apart & self.at_most[i])
            )
            or any(not candidates & ~self.apart[i] for i, candidates in self.choices)
        )


def _places(bits: int) -> Iterator[int]:
    while bits:
        yield (bits & -bits).bit_length() - 1
        bits &= bits - 1


class _ValuationSearch:
    """The search through possible valuations of a group, one comparison after the other."""

    def __init__(
        self, relations: Mapping[str, Relation], words: Mapping[str, Sequence[str]], steps: int
    ) -> None:
        names = tuple(relations)
        while (
            len(points := dict.fromkeys(_points(map(relations.__getitem__, names)))) > MOST_POINTS
        ):
            names = names[: len(names) // 2]
        self._relations, self._names, self._words = relations, names, words
        self._found: list[Exclusion] = []
        self._by_last: dict[Literal, list[int]] = {}
        self._places = {point: index for index, point in enumerate(points)}
        self._known = self._order()
        self._left, self._steps = MOST, steps

    @property
    def is_cut(self) -> bool:
        """Whether some valuations were not tried, and count as possible."""
        return self._left <= 0 or self._steps <= 0 or len(self._names) < len(self._relations)

    def run(self) -> Sequence[Exclusion]:
        """The exclusions of the group."""
        self._go((), 0, self._known)
        return self._found

    def _go(self, chosen: tuple[Literal, ...], bits: int, order: _Order) -> None:
        """Try the next comparison; bit 2i + 1 says that the i-th one is true, bit 2i false."""
        if len(chosen) == len(self._names):
            self._left -= 1
            return
        name = self._names[len(chosen)]
        for value in (False, True):
            if self._left <= 0 or self._steps <= 0:
                return
            literal = (name, value)
            if any(not exclusion_bits & ~bits for exclusion_bits in self._by_last.get(literal, ())):
                continue
            after = order.copy()
            self._add(after, literal)
            self._steps -= len(self._places)
            if after.is_impossible:
                self._exclude(chosen, literal)
            else:
                self._go((*chosen, literal), bits | 1 << 2 * len(chosen) + value, after)

    def _exclude(self, chosen: tuple[Literal, ...], last: Literal) -> None:
        """Add the minimal exclusion of the literal and some of those chosen before it."""
        needed: list[int] = []
        fixed = self._known.copy()
        self._add(fixed, last)
        while not fixed.is_impossible:
            order, index = fixed.copy(), len(chosen)
            while not order.is_impossible:
                if self._steps <= 0:
                    return
                index -= 1
                self._steps -= len(self._places)
                self._add(order, chosen[index])
            needed.append(index)
            self._add(fixed, chosen[index])
        self._found.append((*(chosen[index] for index in sorted(needed)), last))
        bits = sum(1 << 2 * index + chosen[index][1] for index in needed)
        self._by_last.setdefault(last, []).append(bits)

    def _add(self, order: _Order, literal: Literal) -> None:
        name, value = literal
        relation = self._relations[name]
        op = relation.op if value else _DENIED[relation.op]
        for left, sign, right in _consequences(relation.left, op, relation.right):
            self._steps -= len(self._places)
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
                    order.separate(i, j)

    def _order(self) -> _Order:
        """The order of the points that holds for all measurements."""
        single = [1 << index for index in range(len(self._places))]
        order = _Order([*single], [0] * len(single), [0] * len(single))
        self._add_constants(order)
        for point, index in self._places.items():
            arg = of_magnitude(point) if isinstance(point, Term) else None
            parts: tuple[Point, ...] = () if arg is None else (ZERO, arg, negative(arg))
            for part in parts:
                order.add(self._places[part], index, strict=False)
        spoken = sum(1 << index for point, index in self._places.items() if is_word(point))
        for index in _places(spoken):
            order.apart[index] = spoken & ~(1 << index)
        order.choices = tuple(self._choices())
        return order

    def _add_constants(self, order: _Order) -> None:
        """Add the order of the constants, from the last one down, with its consequences."""
        row = [point for point in self._places if isinstance(point, NumberTerm)]
        row.sort(key=lambda constant: constant.value, reverse=True)
        above: list[tuple[NumberTerm, Fraction, int]] = []
        for less in row:
            i, (_, end) = self._places[less], less.ends
            for more, start, j in above:
                if end < start:
                    order.at_most[i] |= order.at_most[j]
                    order.less[i] |= order.at_most[j]
                elif less.beside == more.beside or None in (less.beside, more.beside):
                    order.at_most[i] |= order.at_most[j]  # as rounded
                    order.less[i] |= order.less[j]
            above.append((less, less.ends[0], i))

    def _choices(self) -> Iterator[tuple[int, int]]:
        """Enumerated signals whose values all appear as points."""
        for point, index in self._places.items():
            match point:
                case Term(e.Name(id)) if id in self._words:
                    words = [Term(e.Word(word), is_base=False) for word in self._words[id]]
                    if all(word in self._places for word in words):
                        yield index, sum(1 << self._places[word] for word in words)


def _points(relations: Iterable[Relation]) -> Iterator[Point]:
    for relation in relations:
        for op in ("<", ">"):
            for left, _, right in _consequences(relation.left, op, relation.right):
                yield from (left, right)
        for term in relation.terms:
            arg = of_magnitude(term)
            if arg is not None:
                yield from (ZERO, arg, negative(arg))


def _consequences(
    left: Point, op: e.ComparisonOperator, right: Point
) -> Iterator[tuple[Point, e.ComparisonOperator, Point]]:
    """The relation and its consequences, such as `-x > -2` for `x < 2`."""
    yield left, op, right
    if isinstance(left, Term) and isinstance(right, NumberTerm):
        yield negative(left), MIRRORED[op], NumberTerm(-right.value, right.beside)
