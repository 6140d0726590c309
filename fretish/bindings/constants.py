"""Exact values of constant expressions: `10 cm / 2` is 5 cm."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from fretish import expressions as e
from fretish import units
from fretish.bindings import expressions as binding
from fretish.bindings.functions import ROUNDED
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source

Exact = tuple[units.Dimension, Fraction]
"""A dimension, and a number in its base units."""


def constants(expression: e.Expression) -> set[Exact]:
    """The values of all constants in the expression.

    A constant sub-expression is one value. `-5 cm` gives two: with and without its sign.
    """
    numbers: set[Exact] = set()
    measured = _non_constant_parts(expression)
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        if isinstance(part, e.Persistence):
            numbers.add((units.SECOND.dimension, Fraction(part.duration, 10**9)))
        exact = None if id(part) in measured else _constant(part)
        if exact is not None:
            numbers.add(exact)
        if exact is None or isinstance(part, e.Negation):
            waiting.extend(e.children(part))
    return numbers


def _non_constant_parts(expression: e.Expression) -> set[int]:
    """The `id` of each part that is not constant: a word, a `pre`, or a part with a name."""
    measured: set[int] = set()
    for part in reversed([*e.parts(expression)]):  # operands before their operators
        own = isinstance(part, e.Word | e.Name) or binding.looks_back(part)
        if own or any(id(operand) in measured for operand in e.children(part)):
            measured.add(id(part))
    return measured


def _constant(expression: e.Expression) -> Exact | None:
    """The value of a constant part; None for a truth value or a division by zero."""
    dimension = binding.dimension(expression, {}, Source("", "").span())
    assert not isinstance(dimension, Diagnostic), "the reader of bindings refuses the expression"
    value = number(expression) if dimension is not None else None
    return (dimension, value) if dimension is not None and value is not None else None


@lru_cache(1024)
def quantity(digits: str, name: str, read_in: units.Unit) -> Fraction:
    """The value of a quantity in a unit or a power of it: 4 m^2 are 40 000 cm^2."""
    own_unit = units.unit(name)
    assert own_unit is not None, "the parser refuses unknown units"
    powers = (1, 0, 2, 3, -1, -2)
    same = (n for n in powers if own_unit.dimension == tuple(n * d for d in read_in.dimension))
    return Fraction(digits) * own_unit.factor / read_in.factor ** next(same, 0)


def number(expression: e.Expression) -> Fraction | None:
    """The value of a constant expression in base units.

    None: it divides by zero, or calls a function whose result is rounded.
    """
    match expression:
        case e.Number(digits):
            return Fraction(digits)
        case e.Quantity(digits, name, _):
            unit = units.unit(name)
            assert unit is not None, "the parser refuses unknown units"
            return Fraction(digits) * unit.factor
        case e.Negation(arg):
            value = number(arg)
            return None if value is None else -value
        case e.Arithmetic(op, left, right):
            first, second = number(left), number(right)
            return None if first is None or second is None else computed(op, first, second)
        case e.Call(name) if name in ROUNDED:
            return None
        case e.Call(name, args, _):
            values = [value for value in map(number, args) if value is not None]
            return called(name, values) if len(values) == len(args) else None
        case _:
            raise ValueError("a number is needed, and this is a truth value or a name")


def computed(op: e.ArithmeticOperator, left: Fraction, right: Fraction) -> Fraction | None:
    """The value of `left op right`; None for a division by zero.

    `left mod right` has the sign of `right`.

    Raises:
        ValueError: the exponent is not a whole number in range, or the power is too large.
    """
    match op:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "/":
            return left / right if right else None
        case "mod":
            return left % right if right else None
        case "^":
            exponent = whole_exponent(right)
            if max(map(int.bit_length, left.as_integer_ratio())) * exponent > _MOST_BITS:
                raise ValueError("a power is too large")
            return left**exponent


_MOST_BITS = 1 << 16


def whole_exponent(exponent: Fraction) -> int:
    """The exponent of a power as an integer.

    Raises:
        ValueError: it is not a whole number from 1 to `e.MOST_EXPONENT`.
    """
    if exponent.denominator != 1 or not 1 <= exponent <= e.MOST_EXPONENT:
        raise ValueError(f"an exponent must be a whole number from 1 to {e.MOST_EXPONENT}")
    return int(exponent)


def called(name: str, values: list[Fraction]) -> Fraction:
    """The value of `abs`, `min` or `max`."""
    match name:
        case "abs":
            return abs(values[0])
        case "min":
            return min(values)
        case "max":
            return max(values)
        case _:
            raise ValueError(f"bindings have no function `{name}`")
