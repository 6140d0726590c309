"""Expressions of bindings as numbers and truth values of one instant.

Units are resolved here: each constant is converted into the unit of the signals that it meets, and
signals in different units are converted where they meet. `fretc.logs.signals.measures` does the
same for whole columns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from typing import Literal

from compiler.signals import numbers as n
from fretish import expressions as e
from fretish.bindings.constants import called, computed, quantity, whole_exponent
from fretish.bindings.functions import ROUNDED
from fretish.classes.frozen import dataclass
from fretish.units import ONE, Unit


@dataclass(frozen=True, slots=True)
class _ScaledNumber:
    """A number that is not constant, with its scale to base units. None: always unknown."""

    number: n.Number | None
    scale: Fraction = Fraction(1)


_Term = _ScaledNumber | Fraction
_UNKNOWN = _ScaledNumber(None)
_FUNCTIONS: Mapping[str, Literal["plus", "minus", "times", "over", "modulo"]] = {
    "+": "plus",
    "-": "minus",
    "*": "times",
    "/": "over",
    "mod": "modulo",
}
_SIGNS: Mapping[e.ComparisonOperator, e.ComparisonOperator] = {
    "<": ">",
    "<=": ">=",
    ">": "<",
    ">=": "<=",
    "=": "=",
    "!=": "!=",
}


@dataclass(slots=True)
class Lowering:
    """The lowering of the expressions of one proposition, or of one `valid`."""

    scales: Mapping[str, Fraction] = field(default_factory=dict)
    """Factors to base units by name; the default is 1."""
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """The values of each enumerated signal; its number is the index of the value."""
    unit: Unit = ONE
    """The unit in which quantities are read."""
    gives_rounded: bool = False
    """Whether the caller gives the numbers of computed signals that call a rounded function."""
    held: list[tuple[n.Truth, int]] = field(default_factory=list)
    """Conditions that must have held, with nanoseconds, in the order of `HeldFor.place`."""

    def truth(self, tree: e.Expression) -> n.Truth:
        """The truth value of an expression that the reader of bindings accepts, without `pre`."""
        match tree:
            case e.Truth(value):
                return n.Known(value)
            case e.Name(id):
                return n.BooleanSignal(id)
            case e.Comparison(op, e.Name(id), e.Word(text)):
                return n.Comparison(op, n.SignalValue(id), self._place(id, text))
            case e.Comparison(op, e.Word(text), e.Name(id)):
                return n.Comparison(_SIGNS[op], n.SignalValue(id), self._place(id, text))
            case e.Comparison(op, left, right):
                return self._compared(op, self._term(left), self._term(right))
            case e.Not(arg):
                return n.Not(self.truth(arg))
            case e.And(args):
                return n.All(tuple(map(self.truth, args)))
            case e.Or(args):
                return n.Some(tuple(map(self.truth, args)))
            case e.Implies(left, right):
                return n.Some((n.Not(self.truth(left)), self.truth(right)))
            case e.Iff(left, right):
                return n.Iff(self.truth(left), self.truth(right))
            case e.Xor(left, right):
                return n.Not(n.Iff(self.truth(left), self.truth(right)))
            case e.Persistence(arg, duration):
                self.held.append((self.truth(arg), duration))
                return n.HeldFor(len(self.held) - 1)
            case _:
                raise AssertionError("the reader of bindings refuses a number as a truth value")

    def _place(self, id: str, text: str) -> n.Constant:
        return n.Constant(Fraction(self.words[id].index(text)))

    def _compared(self, op: e.ComparisonOperator, left: _Term, right: _Term) -> n.Truth:
        if isinstance(left, Fraction):
            if isinstance(right, Fraction):
                return n.Known(e.COMPARE[op](left, right))
            left, right, op = right, left, _SIGNS[op]
        x, y, _ = _together(left, right)
        return n.Known(None) if x is None or y is None else n.Comparison(op, x, y)

    # Numbers

    def _term(self, tree: e.Expression) -> _Term:
        match tree:
            case e.Number(digits):
                return Fraction(digits)
            case e.Quantity(digits, name):
                return quantity(digits, name, self.unit)
            case e.Name(id):
                return _ScaledNumber(n.SignalValue(id), self.scales.get(id, Fraction(1)))
            case e.Negation(arg):
                term = self._term(arg)
                return -term if isinstance(term, Fraction) else _applied("negative", term)
            case e.Arithmetic("^", base, exponent):
                return _power(self._term(base), self._term(exponent))
            case e.Arithmetic(op, left, right):
                return _arithmetic(op, self._term(left), self._term(right))
            case e.Call("abs", (arg,)):
                term = self._term(arg)
                return abs(term) if isinstance(term, Fraction) else _applied("absolute", term)
            case e.Call("min" | "max" as name, args):
                return _end(name, [self._term(arg) for arg in args])
            case e.Call(name, args) if name in ROUNDED:
                return _rounded(name, [self._term(arg) for arg in args])
            case e.Calculation():
                return self._calculation(tree)
            case _:
                raise AssertionError("the reader of bindings refuses it as a number")

    def _calculation(self, tree: e.Calculation) -> _Term:
        """The number of a computed signal: its expression, or the caller's number."""
        if not tree.is_rounded:
            return self._term(tree.value)
        if self.gives_rounded:
            return _ScaledNumber(n.SignalValue(tree.name))
        term = _factor(self._term(tree.value))
        is_base = isinstance(term.number, n.RoundedCall)
        return term if is_base else _ScaledNumber(_in_base(term))


def _together(
    left: _ScaledNumber, right: _Term
) -> tuple[n.Number | None, n.Number | None, Fraction]:
    """Both numbers in one unit, and the scale of the unit."""
    if isinstance(right, Fraction):
        return left.number, n.Constant(right / left.scale), left.scale
    if left.scale == right.scale:
        return left.number, right.number, left.scale
    return _in_base(left), _in_base(right), Fraction(1)


def _in_base(term: _ScaledNumber) -> n.Number | None:
    return None if term.number is None else n.ToBaseUnit(term.number, term.scale)


def _rounded(name: str, args: Sequence[_Term]) -> _ScaledNumber:
    numbers = [term.number if term.scale == 1 else _in_base(term) for term in map(_factor, args)]
    known = tuple(number for number in numbers if number is not None)
    return _ScaledNumber(n.RoundedCall(name, known)) if len(known) == len(numbers) else _UNKNOWN


def _applied(function: Literal["negative", "absolute"], term: _ScaledNumber) -> _ScaledNumber:
    if term.number is None:
        return _UNKNOWN
    return _ScaledNumber(n.UnaryCall(function, term.number), term.scale)


def _arithmetic(op: e.ArithmeticOperator, left: _Term, right: _Term) -> _Term:
    if isinstance(left, Fraction) and isinstance(right, Fraction):
        exact = computed(op, left, right)
        return _UNKNOWN if exact is None else exact
    if op in ("*", "/"):
        a, b = _factor(left), _factor(right)
        x, y, scale = a.number, b.number, a.scale * b.scale if op == "*" else a.scale / b.scale
    elif isinstance(left, Fraction):
        assert isinstance(right, _ScaledNumber)
        y, x, scale = _together(right, left)
    else:
        x, y, scale = _together(left, right)
    if x is None or y is None:
        return _UNKNOWN
    return _ScaledNumber(n.Computed(_FUNCTIONS[op], x, y), scale)


def _factor(term: _Term) -> _ScaledNumber:
    return _ScaledNumber(n.Constant(term)) if isinstance(term, Fraction) else term


def _power(base: _Term, exponent: _Term) -> _Term:
    assert isinstance(exponent, Fraction), "the reader of bindings refuses another exponent"
    if isinstance(base, Fraction):
        exact = computed("^", base, exponent)
        return _UNKNOWN if exact is None else exact
    if base.number is None:
        return _UNKNOWN
    times = whole_exponent(exponent)
    return _ScaledNumber(n.Power(base.number, times), base.scale**times)


def _end(name: Literal["min", "max"], args: Sequence[_Term]) -> _Term:
    """The least or the greatest argument, computed pairwise from left to right."""
    extreme, *rest = args
    for term in rest:
        if isinstance(extreme, Fraction):
            if isinstance(term, Fraction):
                extreme = called(name, [extreme, term])
                continue
            extreme, term = term, extreme
        x, y, scale = _together(extreme, term)
        if x is None or y is None:
            return _UNKNOWN
        extreme = _ScaledNumber(n.MinMax("lesser" if name == "min" else "greater", x, y), scale)
    return extreme
