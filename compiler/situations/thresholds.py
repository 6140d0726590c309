"""Numbers that comparisons are made with, and the places beside them.

A step is one unit of the last digit of a threshold as it is written: 0.1 m of `1.2 m`, 1 cm of
`120 cm`. No more than that is known of how finely a signal is measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal

from fretish import expressions as e

_MOST_DIGITS = 25
"""Fewer than what `Decimal` computes with."""


@dataclass(frozen=True, slots=True)
class Written:
    """A number, perhaps with a unit and a sign."""

    unsigned: e.Number | e.Quantity
    value: Decimal
    step: Decimal

    def moved(self, by: Decimal) -> e.Expression:
        """The number so much more, in the same unit."""
        value, unsigned = self.value + by, self.unsigned
        digits = f"{abs(value):f}"
        match unsigned:
            case e.Number():
                found: e.Expression = e.Number(digits)
            case e.Quantity(_, unit):
                found = e.Quantity(digits, unit)
        return e.Negation(found) if value < 0 else found


def written(side: e.Expression) -> Written | None:
    """The number that stands there; None where something else does, or a very long one."""
    unsigned = side.arg if isinstance(side, e.Negation) else side
    if not isinstance(unsigned, e.Number | e.Quantity):
        return None
    exact = Decimal(unsigned.digits)
    exponent = exact.as_tuple().exponent
    size = max(abs(exponent), len(unsigned.digits)) if isinstance(exponent, int) else _MOST_DIGITS
    if size >= _MOST_DIGITS:
        return None
    step = Decimal(1).scaleb(int(exponent))
    return Written(unsigned, -exact if isinstance(side, e.Negation) else exact, step)


@dataclass(frozen=True, slots=True)
class Place:
    """A number at a threshold, or one step beside it."""

    measured: e.Expression
    """What is compared."""
    number: e.Expression
    """Where it is."""
    least: e.Expression
    """Half a step below."""
    limit: e.Expression
    """Half a step above."""

    @property
    def exact(self) -> e.Comparison:
        """It is this number: so a test sets it."""
        return e.Comparison("=", self.measured, self.number)

    @property
    def near(self) -> e.And:
        """Rounded to a step, it is: so a recorded run may have it."""
        at_least = e.Comparison(">=", self.measured, self.least)
        return e.And((at_least, e.Comparison("<", self.measured, self.limit)))


STEPS: Mapping[str, int] = {"below": -1, "at": 0, "above": 1}


def places(comparison: e.Comparison) -> Iterator[tuple[str, Place]]:
    """Just below, at, and just above the number that something else is compared with."""
    left, right = comparison.left, comparison.right
    number, measured = (written(left), right) if written(left) else (written(right), left)
    if number is None or not any(e.names(measured)):
        return
    half = number.step / 2
    for name, steps in STEPS.items():
        here = steps * number.step
        yield name, Place(measured, *(number.moved(here + by) for by in (Decimal(0), -half, half)))
