"""Numbers and truth values as text: calls of a language's functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import reduce
from math import ceil, floor, nan
from typing import NamedTuple, assert_never

from compiler.signals import numbers as n
from fretish.classes.frozen import dataclass
from monitors.kernel.readings import DOUBLES_END, Single, exact

_HALVES_END = 2**52
"""From this value on, 64-bit floats are integers."""
_WHOLE_END = 2**64
"""Recorded integers are below this value."""


class ConstantEncodings(NamedTuple):
    """A constant as a number of each kind that it may meet; NaN: no number equals it."""

    single: float
    is_single: bool
    """Whether the number compared with 32-bit floats is one itself; it may be too large."""
    double: float
    exact: float
    magnitude: int
    """The magnitude of the exact number if it is an integer from 2^53 on; else 0."""


def encode_constant(value: Fraction, sign: str = "") -> ConstantEncodings:
    """The numbers for which `x sign number` equals the exact comparison for each `x` of their kind.

    An audit compares samples with them; without a sign they are the nearest numbers.
    """
    constant = exact(str(value))
    double, wide, magnitude = constant.double, constant.double, 0
    if sign and _HALVES_END <= abs(value) < _WHOLE_END:
        if value.denominator != 1 and sign in ("=", "!="):
            wide = nan
        else:
            whole = (ceil if sign in ("<", ">=") else floor)(value)
            wide = float(whole)
            magnitude = abs(whole) if DOUBLES_END <= abs(whole) < _WHOLE_END else 0
        double = wide if abs(value) < DOUBLES_END else double
    is_single = isinstance(constant.single, Single)
    return ConstantEncodings(float(constant.single), is_single, double, wide, magnitude)


class NumberSyntax(NamedTuple):
    """A language's syntax of numbers and truth values."""

    prefix: str
    """The prefix of each function."""
    truths: Mapping[bool | None, str]
    signs: Mapping[str, str]
    held: str
    """The format of an input for a condition that has held."""
    scale: Callable[[Fraction], str]
    """Writes a factor to base units, as one or two arguments."""
    fixed: Callable[[Fraction], str]
    """Writes a constant in arithmetic."""
    chosen: Callable[[str, str, Fraction], str]
    """Writes the less or the greater of a number and a constant, by function."""
    compared: Callable[[str, str, Fraction], str]
    """Writes a comparison of a number with a constant, by sign."""


@dataclass(frozen=True, slots=True)
class Printer:
    """Prints expressions over given names of signals and durations."""

    language: NumberSyntax
    given: Mapping[str, str]
    held: tuple[str, ...] = ()

    def truth(self, tree: n.Truth) -> str:
        """The text of a truth."""
        match tree:
            case n.Known(value):
                return self.language.truths[value]
            case n.BooleanSignal(name):
                return self._call("flag", self.given[name])
            case n.Comparison(sign, left, n.Constant(value)):
                return self.language.compared(self.number(left), sign, value)
            case n.Comparison(sign, left, right):
                return self._call(
                    "compared", self.number(left), self.language.signs[sign], self.number(right)
                )
            case n.HeldFor(place):
                return self.held[place]
            case n.Not(arg):
                return self._call("negated", self.truth(arg))
            case n.All(args):
                return reduce(lambda x, y: self._call("both", x, y), map(self.truth, args))
            case n.Some(args):
                return reduce(lambda x, y: self._call("either", x, y), map(self.truth, args))
            case n.Iff(left, right):
                return self._call("same", self.truth(left), self.truth(right))
            case _:
                assert_never(tree)

    def number(self, tree: n.Number) -> str:
        """The text of a number."""
        match tree:
            case n.SignalValue(name):
                return self.given[name]
            case n.Constant(value):
                return self.language.fixed(value)
            case n.UnaryCall(function, arg):
                return self._call(function, self.number(arg))
            case n.MinMax(function, left, n.Constant(value)):
                return self.language.chosen(function, self.number(left), value)
            case n.Computed(function, left, right) | n.MinMax(function, left, right):
                return self._call(function, self.number(left), self.number(right))
            case n.Power(base, times):
                return self._call("power", self.number(base), str(times))
            case n.ToBaseUnit(arg, scale):
                return self._call("in_base", self.number(arg), self.language.scale(scale))
            case n.RoundedCall(function):
                raise AssertionError(f"the caller gives the number of {function}")
            case _:
                assert_never(tree)

    def _call(self, function: str, *args: str) -> str:
        return f"{self.language.prefix}{function}({', '.join(args)})"


def parts(value: Fraction) -> tuple[float, float]:
    """Numerator and denominator of a factor as the nearest 64-bit floats."""
    top, bottom = (exact(str(part)).double for part in value.as_integer_ratio())
    return top, bottom


def letters(word: str, escape: str) -> str:
    """The bytes of a word for a literal: letters and digits unchanged, others by `escape`."""
    return "".join(
        chr(byte) if chr(byte).isascii() and chr(byte).isalnum() else escape.format(byte)
        for byte in word.encode()
    )
