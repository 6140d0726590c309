"""Comparisons as relations of two points, each a term or a constant.

Terms are measured, or computed in floating-point numbers. A constant that is not a 32-bit float
stands for any number between its nearest floats.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from fractions import Fraction

from fretish import expressions as e
from fretish.bindings import constants
from fretish.classes.frozen import dataclass
from fretish.units import number

MIRRORED: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!=",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Term:
    """A measured number, or an expression over measured numbers."""

    text: e.Expression
    is_base: bool
    """Whether the term is in base units: signals of several units meet there, and conversion
    rounds."""


@dataclass(frozen=True, slots=True)
class NumberTerm:
    """A number; if it is not a 32-bit float, it may differ from term to term."""

    value: Fraction
    beside: Term | None = None

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """The bounds of the number that is compared instead of the constant."""
        if self.beside is None:
            return self.value, self.value
        error = abs(self.value) / 2**23 + Fraction(1, 2**149)
        return self.value - error, self.value + error


Point = Term | NumberTerm


@dataclass(frozen=True, slots=True)
class Relation:
    """`left op right`."""

    left: Point
    op: e.ComparisonOperator
    right: Point

    @property
    def terms(self) -> Iterator[Term]:
        """The terms among its points, and the terms of which they are magnitudes."""
        for point in (self.left, self.right):
            if isinstance(point, Term) and not is_word(point):
                yield point
                yield from (
                    magnitude for magnitude in (of_magnitude(point),) if magnitude is not None
                )


def relation_of(comparison: e.Comparison, scales: Mapping[str, Fraction]) -> Relation:
    """The comparison as a relation, with a constant on the right side."""
    factors = {scales.get(name.id) for name in e.names(comparison)}
    is_base = len(factors) > 1 or e.has_unit(comparison)
    left, right = _exact(comparison.left), _exact(comparison.right)
    if left is not None and right is not None:
        return Relation(NumberTerm(left), comparison.op, NumberTerm(right))
    if left is not None:
        mirrored = MIRRORED[comparison.op]
        return _measured(comparison.right, mirrored, left, is_base)
    if right is not None:
        return _measured(comparison.left, comparison.op, right, is_base)
    sides = [
        Term(side, is_base and not isinstance(side, e.Word))
        for side in (comparison.left, comparison.right)
    ]
    return Relation(sides[0], comparison.op, sides[1])


def _measured(
    side: e.Expression, op: e.ComparisonOperator, limit: Fraction, is_base: bool
) -> Relation:
    """`side op limit`; `-x < 2` is `x > -2`."""
    while isinstance(side, e.Negation):
        side, op, limit = side.arg, MIRRORED[op], -limit
    term = Term(side, is_base)
    return Relation(term, op, _beside(limit, term))


def _beside(value: Fraction, term: Term) -> NumberTerm:
    """The constant for a number beside a term; a term and its magnitude have the same one."""
    return NumberTerm(value) if _is_single(value) else NumberTerm(value, of_magnitude(term) or term)


def of_magnitude(term: Term) -> Term | None:
    """The x of `abs(x)`."""
    match term.text:
        case e.Call("abs" | "absReal" | "absInt", (arg,)):
            return Term(arg, term.is_base)
        case _:
            return None


def _is_single(value: Fraction) -> bool:
    """Whether a 32-bit float has exactly this value."""
    try:
        (nearest,) = struct.unpack("<f", struct.pack("<f", float(value)))
    except OverflowError:
        return False
    return value == Fraction(nearest)


def _exact(expression: e.Expression) -> Fraction | None:
    """The value of an expression without names, in base units if it has a unit; else None."""
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
"""From about this value on, 32-bit floats are infinite."""


def is_word(point: Point) -> bool:
    """Whether the point is an enumeration value."""
    return isinstance(point, Term) and isinstance(point.text, e.Word)


ZERO = NumberTerm(Fraction(0))


def negative(term: Term) -> Term:
    """The term `-x`."""
    return Term(e.Negation(term.text), term.is_base)
