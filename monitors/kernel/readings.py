"""Arithmetic of one tick: variables as given, constants as written.

A constant is a fraction until it meets a number that was given; there it becomes the nearest number
of its kind: of 32-bit floats or of 64-bit floats. Beside whole numbers from 2^53 on it stays what
it is. What is computed of given numbers is computed in 64-bit floats. None is unknown, and what is
computed of it is unknown; so is what divides by zero. `fretc audit` computes the same of samples.
"""

import operator
import struct
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache
from math import ceil, floor, inf, isfinite, isnan
from numbers import Integral, Real
from typing import Any, NamedTuple, Optional, Union

from monitors.kernel.verdicts import Truth, boolean

Number = Optional[float]
"""A number, or None: unknown. NaN is unknown, too."""

Reading = Optional[float]
"""A number as it is computed with, never NaN. An `int` has 2^53 or more, with or without a sign."""

DOUBLES_END = 2**53
"""The least number from which 64-bit floats do not represent every whole number."""
_HALVES_END = 2**52
"""The least number from which 64-bit floats are whole numbers."""
_WHOLE_END = 2**64
"""The least whole number that is not recorded."""


class Single(float):
    """A 32-bit float."""

    __slots__ = ()


class Wide(float):
    """A float chosen by `min` or `max` beside an `int`; constants treat both alike."""

    __slots__ = ()


class Constant(NamedTuple):
    """A number that is written in a sentence."""

    exact: Fraction
    double: float
    """The nearest 64-bit float; infinite where it is too large for one."""
    single: float
    """The nearest 32-bit float; the 64-bit float where it is too large for one."""

    def beside(self, given: object) -> float:
        """The nearest number of the kind of a given one."""
        return self.single if isinstance(given, Single) else self.double


Term = Union[float, Constant, None]
"""A given number, or what is computed of some; or a constant."""


@lru_cache(maxsize=None)
def exact(text: str) -> Constant:
    """The constant that is written so: `20`, `0.35`, `25/18`."""
    fraction = Fraction(text)
    double = _double(fraction)
    return Constant(fraction, double, _single(fraction, double))


def _double(number: "Fraction | int") -> float:
    try:
        return float(number)
    except OverflowError:
        return inf if number > 0 else -inf


def _single(fraction: Fraction, double: float) -> float:
    try:
        (bits,) = struct.unpack("<i", struct.pack("<f", double))
    except OverflowError:
        return double
    if not isfinite(double):
        return double
    index = bits if bits >= 0 else -(bits & (1 << 31) - 1)
    around = [value for at in (index, index - 1, index + 1) if isfinite(value := _float32(at))]
    return Single(min(around, key=lambda value: abs(Fraction(value) - fraction)))


def _float32(index: int) -> float:
    """The 32-bit float at an index in their order; zero is at 0."""
    bits = index if index >= 0 else -index | 1 << 31
    (value,) = struct.unpack("<f", struct.pack("<I", bits))
    return float(value)


# What is given --------------------------------------------------------------------------------


def number(value: object, name: str) -> Reading:
    """A number as it is computed with; NumPy's numbers, too.

    Raises:
        TypeError: it is none.
    """
    if type(value) is float:
        return _known(value)
    if value is None:
        return None
    if type(value) is int:
        return _whole(value)
    if not isinstance(value, Real) or isinstance(value, bool):
        raise TypeError(f"`{name}` is a number, or None or NaN (unknown), not {value!r}")
    if isinstance(value, Integral):
        return _whole(int(value))
    if type(value).__name__ == "float32":
        return None if isnan(value) else Single(value)
    return _real(value)


def measurement(value: object, name: str, *infinite: str) -> Reading:
    """A number that a step is given; an infinite one is unknown, unless it means something.

    Args:
        value: what is given.
        name: of the variable.
        infinite: `+inf`, `-inf`: those that mean something, as the bindings say of the signal.

    Raises:
        TypeError: it is no number.
    """
    if type(value) is float and -inf < value < inf:
        return value
    reading = number(value, name)
    if isinstance(reading, int):
        double = _double(reading)
        reading = reading if isfinite(double) else double
    if reading is None or -inf < reading < inf:
        return reading
    return reading if ("+inf" if reading > 0 else "-inf") in infinite else None


def _real(value: Any) -> Reading:
    """A number of another kind: of 80-bit floats, for example, which hold more whole numbers."""
    try:
        double = float(value)
    except OverflowError:
        double = inf if value > 0 else -inf
    if isfinite(double) and abs(double) >= DOUBLES_END and value != double:
        return _whole(round(value))
    return _known(double)


def _whole(value: int) -> Reading:
    return float(value) if -DOUBLES_END < value < DOUBLES_END else value


def _known(value: float) -> "float | None":
    return None if isnan(value) else value


def truth_value(value: object, name: str) -> Truth:
    """A truth value; NumPy's, too.

    Raises:
        TypeError: it is none.
    """
    return value if value is None or value is True or value is False else boolean(value, name)


def word(value: object, name: str, words: "tuple[str, ...]") -> "str | None":
    """A word of an enumeration, after a check; None is unknown.

    Raises:
        TypeError: it is no text.
        ValueError: it is another word.
    """
    if value is None:
        return None
    among = f"one of {', '.join(words)}, or None (unknown)"
    if not isinstance(value, str):
        raise TypeError(f"`{name}` is {among}, not {value!r}")
    if value not in words:
        raise ValueError(f"`{name}` is {among}, not {str(value)!r}")
    return value


# What is compared -----------------------------------------------------------------------------

_COMPARE: "Mapping[str, Callable[[float, float], bool]]" = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "=": "=", "!=": "!="}
"""Comparison operator -> the equivalent operator for exchanged sides."""


def compared(left: Term, sign: str, right: Term) -> Truth:
    """`left sign right`; at most one of them is a constant."""
    if isinstance(left, Constant):
        left, sign, right = right, _MIRRORED[sign], left
    if left is None or right is None:
        return None
    assert not isinstance(left, Constant)
    if not isinstance(right, Constant):
        return _COMPARE[sign](left, right)
    end = _WHOLE_END if isinstance(left, (int, Wide)) else DOUBLES_END
    if isinstance(left, Single) or not _HALVES_END <= abs(right.exact) < end:
        return _COMPARE[sign](left, right.beside(left))
    if right.exact.denominator != 1 and sign in ("=", "!="):
        return sign == "!="
    return _COMPARE[sign](left, (ceil if sign in ("<", ">=") else floor)(right.exact))


def is_word(value: "str | None", sign: str, other: "str | None") -> Truth:
    """`value = other` or `value != other`."""
    if value is None or other is None:
        return None
    return (value == other) is (sign == "=")


# What is computed -----------------------------------------------------------------------------


def _plain(term: "float | Constant") -> float:
    """The value as a 64-bit float."""
    if isinstance(term, Constant):
        return term.double
    return _double(term) if isinstance(term, int) else float(term)


def plus(left: Term, right: Term) -> Reading:
    """`left + right`."""
    return None if left is None or right is None else _known(_plain(left) + _plain(right))


def minus(left: Term, right: Term) -> Reading:
    """`left - right`."""
    return None if left is None or right is None else _known(_plain(left) - _plain(right))


def times(left: Term, right: Term) -> Reading:
    """`left * right`."""
    return None if left is None or right is None else _known(_plain(left) * _plain(right))


def over(left: Term, right: Term) -> Reading:
    """`left / right`; unknown where that divides by zero."""
    if left is None or right is None or _plain(right) == 0:
        return None
    return _known(_plain(left) / _plain(right))


def modulo(left: Term, right: Term) -> Reading:
    """`left mod right`, with the sign of `right`; unknown where that divides by zero."""
    if left is None or right is None or _plain(right) == 0:
        return None
    return _known(_plain(left) % _plain(right))


def power(base: Reading, exponent: int) -> Reading:
    """`base * base * ...`, `exponent` times, from left to right."""
    if base is None:
        return None
    factor = result = _plain(base)
    for _ in range(exponent - 1):
        result *= factor
    return _known(result)


def negative(value: Reading) -> Reading:
    """`-value`."""
    if value is None:
        return None
    return type(value)(-value)


def absolute(value: Reading) -> Reading:
    """`value` without its sign."""
    return value if value is None or value >= 0 else negative(value)


def lesser(left: Term, right: Term) -> Term:
    """The less of two numbers."""
    return _one_of(left, right, operator.le)


def greater(left: Term, right: Term) -> Term:
    """The greater of two numbers."""
    return _one_of(left, right, operator.ge)


def _one_of(left: Term, right: Term, first: "Callable[[Any, Any], bool]") -> Term:
    """The left one where it comes first, else the right one, as a number of the kind of both."""
    if left is None or right is None:
        return None
    if isinstance(left, Constant) and isinstance(right, Constant):
        return left if first(left.exact, right.exact) else right
    x, y = _alike(left, right), _alike(right, left)
    chosen = x if first(x, y) else y
    if isinstance(x, (int, Wide)) or isinstance(y, (int, Wide)):
        return chosen if isinstance(chosen, int) else Wide(chosen)
    return chosen if isinstance(x, Single) and isinstance(y, Single) else float(chosen)


def _alike(term: "float | Constant", other: "float | Constant") -> float:
    """A number to choose: beside a constant, 64-bit floats stand for whole numbers."""
    if isinstance(term, Constant):
        return term.beside(other)
    return _plain(term) if isinstance(term, (int, Wide)) and isinstance(other, Constant) else term


def in_base(value: Reading, scale: Constant) -> Reading:
    """In the base unit: `value * scale`, rounded once where one operation does it."""
    if value is None:
        return None
    top, bottom = scale.exact.as_integer_ratio()
    return _known(_plain(value) * _double(top) / _double(bottom))


def first(term: Term) -> Reading:
    """The value before the first tick: a constant becomes the nearest number."""
    if not isinstance(term, Constant):
        return term
    is_whole = term.exact.denominator == 1
    return _whole(term.exact.numerator) if is_whole else term.double
