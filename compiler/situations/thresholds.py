"""Thresholds of comparisons, and the numbers one step below and above.

A step is one unit of the last digit of a threshold as written: 0.1 m for `1.2 m`, 1 cm for
`120 cm`. The resolution of the measurement is not known.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal

from fretish import expressions as e
from fretish.classes.frozen import dataclass

_MOST_DIGITS = 25
"""Maximum number of digits; `Decimal` computes with more."""


@dataclass(frozen=True, slots=True)
class LiteralNumber:
    """A literal number, possibly with a unit and a sign."""

    unsigned: e.Number | e.Quantity
    value: Decimal
    step: Decimal

    def moved(self, by: Decimal) -> e.Expression:
        """The number increased by `by`, in the same unit."""
        value, unsigned = self.value + by, self.unsigned
        digits = f"{abs(value):f}"
        match unsigned:
            case e.Number():
                moved_number: e.Expression = e.Number(digits)
            case e.Quantity(_, unit):
                moved_number = e.Quantity(digits, unit)
        return e.Negation(moved_number) if value < 0 else moved_number


def literal_number(side: e.Expression) -> LiteralNumber | None:
    """The literal number of an expression; None for any other, or one with too many digits."""
    unsigned = side.arg if isinstance(side, e.Negation) else side
    if not isinstance(unsigned, e.Number | e.Quantity):
        return None
    exact = Decimal(unsigned.digits)
    exponent = exact.as_tuple().exponent
    size = max(abs(exponent), len(unsigned.digits)) if isinstance(exponent, int) else _MOST_DIGITS
    if size >= _MOST_DIGITS:
        return None
    step = Decimal(1).scaleb(int(exponent))
    return LiteralNumber(unsigned, -exact if isinstance(side, e.Negation) else exact, step)


@dataclass(frozen=True, slots=True)
class ThresholdPosition:
    """A number at a threshold, or one step beside it."""

    measured: e.Expression
    """The compared expression."""
    number: e.Expression
    """The number at the position."""
    least: e.Expression
    """The number half a step below."""
    limit: e.Expression
    """The number half a step above."""

    @property
    def exact(self) -> e.Comparison:
        """The comparison that the value equals the number, as a test sets it."""
        return e.Comparison("=", self.measured, self.number)

    @property
    def near(self) -> e.And:
        """The condition that the value rounded to a step equals the number, for recorded runs."""
        at_least = e.Comparison(">=", self.measured, self.least)
        return e.And((at_least, e.Comparison("<", self.measured, self.limit)))


STEPS: Mapping[str, int] = {"below": -1, "at": 0, "above": 1}


def threshold_positions(comparison: e.Comparison) -> Iterator[tuple[str, ThresholdPosition]]:
    """The positions one step below, at, and one step above the threshold of a comparison."""
    left, right = comparison.left, comparison.right
    number, measured = (
        (literal_number(left), right) if literal_number(left) else (literal_number(right), left)
    )
    if number is None or not any(e.names(measured)):
        return
    half = number.step / 2
    for name, steps in STEPS.items():
        here = steps * number.step
        yield (
            name,
            ThresholdPosition(
                measured, *(number.moved(here + by) for by in (Decimal(0), -half, half))
            ),
        )
