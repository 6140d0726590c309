"""Numbers and truth values of one instant, with the same result in every language.

A number is a 32-bit float, a 64-bit float, or exact: an integer of 64 bits from 2^53 on, or the
least or greatest of such an integer and another number. A number may be unknown, and so is every
number computed from it. `monitors.kernel.readings` has a function for each of these nodes except
`SignalValue` and `RoundedCall`; a constant becomes the nearest number of the kind that it meets.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class SignalValue:
    """The number of a signal, or of a field of its message."""

    name: str


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant in the unit of the number that it is combined with, which is not constant."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class UnaryCall:
    """A function of one number; the result is of the same kind."""

    function: Literal["negative", "absolute"]
    arg: Number


@dataclass(frozen=True, slots=True)
class Computed:
    """Arithmetic in 64-bit floats, rounded once; a division by zero is unknown.

    `modulo` has the sign of the right side.
    """

    function: Literal["plus", "minus", "times", "over", "modulo"]
    left: Number
    right: Number


@dataclass(frozen=True, slots=True)
class MinMax:
    """The less or the greater of two numbers, of the kind that holds both.

    If the right side is a constant, integers become 64-bit floats first.
    """

    function: Literal["lesser", "greater"]
    left: Number
    right: Number


@dataclass(frozen=True, slots=True)
class Power:
    """The 64-bit float multiplied with itself, `times` factors from left to right."""

    base: Number
    times: int


@dataclass(frozen=True, slots=True)
class ToBaseUnit:
    """`arg * numerator / denominator` in 64-bit floats, the factor's parts as the nearest ones."""

    arg: Number
    scale: Fraction


@dataclass(frozen=True, slots=True)
class RoundedCall:
    """A function of `monitors/rounded_functions.py`, of 64-bit floats in base units."""

    function: str
    args: tuple[Number, ...]


Number = SignalValue | Constant | UnaryCall | Computed | MinMax | Power | ToBaseUnit | RoundedCall


@dataclass(frozen=True, slots=True)
class Known:
    """A constant truth value; None: unknown."""

    value: bool | None


@dataclass(frozen=True, slots=True)
class BooleanSignal:
    """A signal as a truth value: 1 is true, 0 is false, any other number is unknown."""

    name: str


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left sign right`; only the right side may be a constant. Unknown if a side is."""

    sign: str
    left: Number
    right: Number


@dataclass(frozen=True, slots=True)
class HeldFor:
    """Whether a condition has held for a duration: the `place`-th such input of its proposition."""

    place: int


@dataclass(frozen=True, slots=True)
class Not:
    """Kleene's negation."""

    arg: Truth


@dataclass(frozen=True, slots=True)
class All:
    """Kleene's conjunction."""

    args: tuple[Truth, ...]


@dataclass(frozen=True, slots=True)
class Some:
    """Kleene's disjunction."""

    args: tuple[Truth, ...]


@dataclass(frozen=True, slots=True)
class Iff:
    """Kleene's equivalence: unknown if a side is."""

    left: Truth
    right: Truth


Truth = Known | BooleanSignal | Comparison | HeldFor | Not | All | Some | Iff
