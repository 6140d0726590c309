"""Comparisons as relations of two points, each a term or a constant.

Terms are what is measured or computed in floating-point numbers; of a constant that is no 32-bit
float it is known only that its nearest floats lie near it.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from fretish import expressions as e
from fretish.bindings import constants
from fretish.units import number

MIRRORED: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!=",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Term:
    """What is measured, or computed of it."""

    text: e.Expression
    is_base: bool
    """Signals of several units meet in base units, and conversion rounds."""


@dataclass(frozen=True, slots=True)
class Constant:
    """A number; where it is no 32-bit float, it is another one beside each term."""

    value: Fraction
    beside: Term | None = None

    @property
    def ends(self) -> tuple[Fraction, Fraction]:
        """Between which the number lies that is compared in its place."""
        if self.beside is None:
            return self.value, self.value
        error = abs(self.value) / 2**23 + Fraction(1, 2**149)
        return self.value - error, self.value + error


Point = Term | Constant


@dataclass(frozen=True, slots=True)
class Relation:
    """`left op right`."""

    left: Point
    op: e.ComparisonOperator
    right: Point

    @property
    def terms(self) -> Iterator[Term]:
        """Those of its points that are no constants, and what they are the magnitudes of."""
        for point in (self.left, self.right):
            if isinstance(point, Term) and not is_word(point):
                yield point
                yield from (each for each in (of_magnitude(point),) if each is not None)


def relation_of(comparison: e.Comparison, scales: Mapping[str, Fraction]) -> Relation:
    """The comparison, with a constant that it has on its right side."""
    factors = {scales.get(name.id) for name in e.names(comparison)}
    is_base = len(factors) > 1 or e.has_unit(comparison)
    left, right = _exact(comparison.left), _exact(comparison.right)
    if left is not None and right is not None:
        return Relation(Constant(left), comparison.op, Constant(right))
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


def _beside(value: Fraction, term: Term) -> Constant:
    """The constant that stands for a number beside a term; its magnitude is of the same kind."""
    return Constant(value) if _is_single(value) else Constant(value, of_magnitude(term) or term)


def of_magnitude(term: Term) -> Term | None:
    """The x of `abs(x)`."""
    match term.text:
        case e.Call("abs" | "absReal" | "absInt", (arg,)):
            return Term(arg, term.is_base)
        case _:
            return None


def _is_single(value: Fraction) -> bool:
    """Whether a 32-bit float has the value: then no other number is compared in its place."""
    try:
        (nearest,) = struct.unpack("<f", struct.pack("<f", float(value)))
    except OverflowError:
        return False
    return value == Fraction(nearest)


def _exact(expression: e.Expression) -> Fraction | None:
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


def is_word(point: Point) -> bool:
    """Whether it is a value of an enumerated signal."""
    return isinstance(point, Term) and isinstance(point.text, e.Word)


ZERO = Constant(Fraction(0))


def negative(term: Term) -> Term:
    """`-x`, as it is written."""
    return Term(e.Negation(term.text), term.is_base)
