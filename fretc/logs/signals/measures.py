"""Numbers of expressions: constants as exact fractions, samples as recorded.

A constant is a fraction until it is combined with samples; there it becomes the nearest number of
their unit and number type. So `x < 35 cm` and `x < 0.35 m` are equal for every sample, whatever its
unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from functools import lru_cache, reduce
from math import ceil, floor, isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import EXACT, WHOLE, Numbers, Values, scaled
from fretish import expressions as e
from fretish.bindings.constants import called, computed, quantity, whole_exponent
from fretish.classes.frozen import dataclass
from fretish.expressions import MIRRORED
from fretish.units import ONE, Unit
from monitors.rounded_functions import ROUNDED_FUNCTIONS

COMPARE: dict[str, Callable[..., NDArray[np.bool_]]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "=": np.equal,
    "!=": np.not_equal,
}
"""The operators of comparisons; NaN is equal to nothing."""


class ExpressionError(ValueError):
    """The expression cannot be evaluated; the text gives the reason."""


@dataclass(frozen=True, slots=True)
class NameValues:
    """The values of an expression's names, at `length` points.

    `numbers` have shape (length,), or one element for all points; NaN is unknown. Times their
    `scales` (1 where none is given) they are in base units. Quantities are read in `unit` or its
    powers. `persistences` are the states of each `... for 200 ms`, from
    `fretc.logs.signals.propositions`. `words` are the values of enumerated signals. Where the
    points are ticks, `earlier` has them one tick before; None: they are the first tick.
    """

    length: int
    numbers: Mapping[str, Values]
    unit: Unit = ONE
    scales: Mapping[str, Fraction] = field(default_factory=dict)
    persistences: Mapping[e.Persistence, NDArray[np.int8]] = field(default_factory=dict)
    earlier: NameValues | None = None
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Measure:
    """A number at each point, shape (length,) or (1,): `values * scale` is in base units."""

    values: Values
    scale: Fraction = Fraction(1)

    @property
    def base(self) -> Numbers:
        """The values in base units, as 64-bit floats."""
        return scaled(self.values.astype(np.float64), self.scale)

    @property
    def plain(self) -> Values:
        """The values as 64-bit floats, for arithmetic."""
        return self.values.astype(np.float64, copy=False)


Term = Measure | Fraction
"""A measured number or a constant."""
_UNKNOWN = Measure(np.array([np.nan]))


def number(expression: e.Expression, scope: NameValues) -> Numbers:
    """The number at each point in base units, shape (scope.length,) or (1,); NaN is unknown.

    Raises:
        ExpressionError: the expression is a truth value, or names what the scope does not hold.
    """
    return _measure(term(expression, scope)).base


def term(expression: e.Expression, scope: NameValues) -> Term:
    """The number at each point; a fraction where it is the same constant at all of them.

    What divides by zero is unknown. Infinity is a number: `1 / inf` is 0, `inf - inf` unknown.
    Constants are computed exactly, everything else in 64-bit floats; what has not been computed
    (`x`, `-x`, `abs(x)`, `min(x, y)`) stays as it was recorded. `x mod y` has the sign of `y`. The
    functions of computed signals have arguments and results in base units.

    Raises:
        ExpressionError: the expression is a truth value, or names what the scope does not hold.
        ValueError: the exponent of a power is not small and whole.
    """
    match expression:
        case e.Number(digits):
            return _constant(digits)
        case e.Quantity(digits, name, _):
            return quantity(digits, name, scope.unit)
        case e.Name(id):
            if id not in scope.numbers:
                raise ExpressionError(f"there is no `{id}`")
            return Measure(scope.numbers[id], scope.scales.get(id, Fraction(1)))
        case e.Negation(arg):
            value = term(arg, scope)
            return -value if isinstance(value, Fraction) else Measure(-value.values, value.scale)
        case e.Arithmetic(op, left, right):
            return _arithmetic(op, term(left, scope), term(right, scope))
        case e.Call("pre", (initial, arg), _):
            return _before(initial, arg, scope)
        case e.Call(name, args) if name in ROUNDED_FUNCTIONS:
            return _rounded(name, [term(arg, scope) for arg in args])
        case e.Calculation(_, value, is_rounded):
            number = term(value, scope)
            return Measure(_measure(number).base) if is_rounded else number
        case e.Call(name, args, _):
            return _call(name, [term(arg, scope) for arg in args])
        case e.Word(text):
            raise ExpressionError(f"a number is needed, and `{text}` is a word")
        case _:
            raise ExpressionError("a number is needed, and this is a truth value")


_constant = lru_cache(1024)(Fraction)


def _measure(value: Term) -> Measure:
    return Measure(_nearest(value, np.dtype(np.float64))) if isinstance(value, Fraction) else value


def together(left: Term, right: Term, op: str = "") -> tuple[Values, Values, Fraction]:
    """Both sides in one unit, with its scale: that of the samples, if they have the same one.

    A constant becomes the nearest number of the type of the other side: of 32-bit floats, of 64-bit
    floats, or, if whole numbers beyond these are compared, a whole number for which `op` has the
    same result.
    """
    if isinstance(left, Fraction):
        if isinstance(right, Fraction):
            return _measure(left).values, _measure(right).values, Fraction(1)
        return _substitute(left, right, MIRRORED.get(op, op)), right.values, right.scale
    if isinstance(right, Fraction):
        return left.values, _substitute(right, left, op), left.scale
    if left.scale == right.scale:
        return left.values, right.values, left.scale
    return left.base, right.base, Fraction(1)


def compared(op: str, left: Term, right: Term) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The truth of a comparison at each point, and where it is unknown; shape (length,) or (1,)."""
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        signs = np.array([(left > right) - (left < right)])
        return COMPARE[op](signs, 0), np.zeros(1, bool)
    x, y, _ = together(left, right, op)
    return COMPARE[op](x, y), np.isnan(x) | np.isnan(y)


# Constants

_HALVES = WHOLE // 2
"""From here on every 64-bit float is a whole number; below its double every whole number is a
float."""
_BEYOND = 2**64
"""From here on nothing was recorded as a whole number."""


def _substitute(constant: Fraction, measure: Measure, op: str) -> Values:
    """The value to compare in `measure op constant`, in the number type of the measure."""
    return _in_unit(constant, measure.scale, measure.values.dtype, op)


@lru_cache(1024)
def _in_unit(constant: Fraction, scale: Fraction, kind: np.dtype[Any], op: str) -> Values:
    exact = constant / scale
    is_between = _HALVES <= abs(exact) < (_BEYOND if kind == EXACT else WHOLE)
    if not op or not is_between or kind == np.float32:
        return _nearest(exact, kind)
    if exact.denominator != 1 and op in ("=", "!="):
        return np.nextafter(np.zeros(1, EXACT), 1)  # no recorded number is equal to it
    return np.array([ceil(exact) if op in ("<", ">=") else floor(exact)], EXACT)


@lru_cache(1024)
def _nearest(exact: Fraction, kind: np.dtype[Any]) -> Values:
    """The number of a type that is nearest to a fraction; infinite if the fraction is too large."""
    try:
        double = float(exact)
    except OverflowError:
        double = float("inf") if exact > 0 else float("-inf")
    with np.errstate(over="ignore"):
        narrow = np.float32(double)
    if kind != np.float32 or not isfinite(narrow):
        return np.array([double], kind if kind == EXACT else np.float64)
    around = (narrow, *(np.nextafter(narrow, np.float32(end)) for end in (-np.inf, np.inf)))
    finite = [number for number in around if isfinite(number)]
    return np.array([min(finite, key=lambda each: abs(Fraction(float(each)) - exact))], np.float32)


# Computation


def _before(initial: e.Expression, arg: e.Expression, scope: NameValues) -> Measure:
    """The value of `arg` one tick before; at the first tick, the value of `initial`.

    It is a measured number: a constant is the nearest 64-bit float in the unit of the other side.
    Both are in one unit: that of the signals if they share it, else the base unit.
    """
    at = scope if scope.earlier is None else scope.earlier
    chosen, other = term(initial, at), term(arg, at)
    if scope.earlier is not None:
        chosen, other = other, chosen
    if isinstance(chosen, Fraction):
        scale = Fraction(1) if isinstance(other, Fraction) else other.scale
        return Measure(_measured(chosen / scale), scale)
    if isinstance(other, Fraction) or other.scale == chosen.scale:
        return chosen
    return Measure(chosen.base)


def _measured(exact: Fraction) -> Values:
    """A constant as a measured number."""
    if exact.denominator == 1 and abs(exact) >= WHOLE:
        return np.array([exact.numerator], EXACT)
    return _nearest(exact, np.dtype(np.float64))


def _arithmetic(op: e.ArithmeticOperator, left: Term, right: Term) -> Term:
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        exact = computed(op, left, right)
        return _UNKNOWN if exact is None else exact
    with np.errstate(all="ignore"):
        if op in ("+", "-"):
            x, y, scale = together(_double(left), _double(right))
            return Measure(x + y if op == "+" else x - y, scale)
        a, b = _measure(left), _measure(right)
        match op:
            case "*":
                return Measure(a.plain * b.plain, a.scale * b.scale)
            case "/":
                quotient = np.where(b.plain == 0, np.nan, a.plain / b.plain)
                return Measure(quotient, a.scale / b.scale)
            case "mod":
                x, y, scale = together(_double(left), _double(right))
                return Measure(np.where(y == 0, np.nan, np.mod(x, y)), scale)
            case _:  # `^`; sums are above
                return _power(a, right)


def _power(base: Measure, exponent: Term) -> Measure:
    """The product of a number with itself, from left to right."""
    if not isinstance(exponent, Fraction):
        raise ExpressionError("an exponent is a constant")
    factors = [base.plain] * whole_exponent(exponent)
    return Measure(reduce(np.multiply, factors), base.scale ** len(factors))


def _double(value: Term) -> Term:
    return value if isinstance(value, Fraction) else Measure(value.plain, value.scale)


def _without_exact(value: Term) -> Term:
    """The term in 64-bit floats: the minimum of whole numbers and a constant need not be whole."""
    exact = isinstance(value, Measure) and value.values.dtype == EXACT
    return _double(value) if exact else value


def _call(name: str, args: Sequence[Term]) -> Term:
    match name, len(args):
        case "abs", 1:
            value = args[0]
            if isinstance(value, Fraction):
                return called("abs", [value])
            return Measure(np.abs(value.values), value.scale)
        case "min", _:
            return reduce(lambda x, y: _end(np.minimum, x, y), args)
        case "max", _:
            return reduce(lambda x, y: _end(np.maximum, x, y), args)
        case _:
            raise ExpressionError(f"bindings have no `{name}` of {len(args)} numbers")


def _rounded(name: str, args: Sequence[Term]) -> Measure:
    """A function of `monitors/rounded_functions.py`, with its very results."""
    columns = np.broadcast_arrays(*(_measure(arg).base for arg in args))
    if name in _OF_ARRAYS:
        with np.errstate(all="ignore"):
            return Measure(np.asarray(_OF_ARRAYS[name](*columns), np.float64))
    function = ROUNDED_FUNCTIONS[name]
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return Measure(np.array([function(*row) for row in rows], np.float64))


def _norm(*columns: Numbers) -> Numbers:
    return np.asarray(np.sqrt(reduce(np.add, (column * column for column in columns))))


_OF_ARRAYS: Mapping[str, Callable[..., NDArray[Any]]] = {
    "sqrt": np.sqrt,
    "hypot": _norm,
    "norm": _norm,
    "sign": np.sign,
    "floor": np.floor,
    "ceil": np.ceil,
}
"""The functions whose result IEEE 754 defines to the last bit; the others are left to Python."""


def _end(function: np.ufunc, left: Term, right: Term) -> Term:
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        return called("min" if function is np.minimum else "max", [left, right])
    if isinstance(left, Fraction) or isinstance(right, Fraction):
        left, right = _without_exact(left), _without_exact(right)
    x, y, scale = together(left, right)
    return Measure(function(x, y), scale)
