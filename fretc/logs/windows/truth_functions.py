"""Expressions as functions in Python of lists of numbers, which are faster than arrays if short.

A function has the states of `fretc.logs.signals.propositions.truth`. Its constants are made by the
functions of `fretc.logs.signals.measures`. A 32-bit float is a float of Python with the same value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import numpy as np

from fretc.logs.signals.measures import Measure, NameValues, term, together
from fretc.logs.signals.propositions import FALSE, TRUE, UNKNOWN
from fretc.logs.signals.samples import scaled
from fretish import expressions as e
from fretish.bindings.constants import whole_exponent
from fretish.classes.frozen import dataclass
from fretish.expressions import COMPARE, MIRRORED
from monitors.loading import executed
from monitors.rounded_functions import ROUNDED_FUNCTIONS

Kind = np.dtype[Any]
"""A type of 32-bit or 64-bit floats."""
TruthFunction = Callable[..., list[int]]
"""The states at some points. Arguments: the points, shape (n,); the numbers of each name; the
states of each `... for 200 ms`."""

_SINGLE, _DOUBLE = np.dtype(np.float32), np.dtype(np.float64)
_PREFIX = "rounded_"
"""The names of the functions of computed signals begin with it."""
_OPERATORS = {"=": "=="}
"""The operators that Python writes differently."""


class NoFunctionError(ValueError):
    """The expression has no such function."""


@dataclass(frozen=True, slots=True)
class NumberType:
    """The numbers of one name: times `scale` they are in base units."""

    kind: Kind
    scale: Fraction = Fraction(1)
    words: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Measured:
    """The text of a measured number; `text * scale` is in base units."""

    text: str
    kind: Kind
    scale: Fraction = Fraction(1)


_Number = _Measured | Fraction


def truth_function(
    expression: e.Expression,
    names: Mapping[str, NumberType],
    persistences: Sequence[e.Persistence] = (),
) -> TruthFunction:
    """The function of an expression.

    Args:
        expression: the expression, which is true or false.
        names: the names, in the order of the arguments.
        persistences: the outermost `... for 200 ms` of the expression, in the order of the
            arguments.

    Raises:
        NoFunctionError: the expression looks back by ticks, uses `mod`, or compares with a whole
            number that no 64-bit float holds.
        ExpressionError, ValueError: `truth` raises it, too.
    """
    writer = _Writer(names, persistences)
    try:
        return _function(writer, writer.truth(expression))
    except (MemoryError, RecursionError, SyntaxError):
        raise NoFunctionError("the expression is nested too deeply for Python") from None


def _function(writer: _Writer, state: str) -> TruthFunction:
    elements = ", ".join(["_", *writer.arguments])
    columns = ", ".join(["points", *(f"{name}s" for name in writer.arguments)])
    text = _TEXT.format(columns=columns, elements=elements, state=state)
    module = executed(text, "truth_function")
    vars(module).update(writer.constants, nan=float("nan"), least=_least, greatest=_greatest)
    vars(module).update({_PREFIX + name: each for name, each in ROUNDED_FUNCTIONS.items()})
    function: TruthFunction = module.states
    return function


_TEXT = """\
def states({columns}):
    found = []
    for {elements} in zip({columns}):
        found.append({state})
    return found
"""


def _least(x: float, y: float) -> float:
    """The smaller number; NaN if one is NaN."""
    return x if x != x or x < y else y


def _greatest(x: float, y: float) -> float:
    """The larger number; NaN if one is NaN."""
    return x if x != x or x > y else y


class _Writer:
    """A writer of the text of one function."""

    def __init__(
        self, names: Mapping[str, NumberType], persistences: Sequence[e.Persistence]
    ) -> None:
        self._names = {
            name: _Measured(f"v{i}", each.kind, each.scale)
            for i, (name, each) in enumerate(names.items())
        }
        self._words = {name: each.words for name, each in names.items()}
        self._persistences = {part: f"p{i}" for i, part in enumerate(persistences)}
        self.arguments = [
            *(each.text for each in self._names.values()),
            *(f"p{i}" for i in range(len(persistences))),
        ]
        self.constants: dict[str, float] = {}
        self._stored = 0

    def truth(self, expression: e.Expression) -> str:
        """The text of the state of an expression."""
        match expression:
            case e.Truth(value):
                return str(TRUE if value else FALSE)
            case e.Name(id):
                text = self._named(id).text
                return f"({TRUE} if {text} == 1 else {FALSE} if {text} == 0 else {UNKNOWN})"
            case e.Comparison(op, e.Name(id), e.Word(text)) | e.Comparison(
                op, e.Word(text), e.Name(id)
            ):
                return self._compared(op, self._named(id), Fraction(self._words[id].index(text)))
            case e.Comparison(op, left, right):
                return self._compared(op, self._number(left), self._number(right))
            case e.Not(arg):
                return f"({TRUE} - {self.truth(arg)})"
            case e.And(args):
                return f"min({', '.join(map(self.truth, args))})"
            case e.Or(args):
                return f"max({', '.join(map(self.truth, args))})"
            case e.Implies(left, right):
                return f"max({TRUE} - {self.truth(left)}, {self.truth(right)})"
            case e.Iff(left, right):
                return self._same(left, right)
            case e.Xor(left, right):
                return f"({TRUE} - {self._same(left, right)})"
            case e.Persistence() if expression in self._persistences:
                return self._persistences[expression]
            case _:
                raise NoFunctionError("the expression is not a truth value of single points")

    def _same(self, left: e.Expression, right: e.Expression) -> str:
        """Kleene's equivalence."""
        one, one_text = self._store(self.truth(left))
        other, other_text = self._store(self.truth(right))
        some = f"({one_text}, {other_text})"
        return f"({UNKNOWN} if {UNKNOWN} in {some} else {TRUE} if {one} == {other} else {FALSE})"

    def _store(self, text: str) -> tuple[str, str]:
        """A variable, and the text that assigns it where it is read first."""
        if text.isalnum():
            return text, text
        self._stored += 1
        return f"t{self._stored}", f"(t{self._stored} := {text})"

    # Numbers

    def _named(self, id: str) -> _Measured:
        if id not in self._names:
            raise NoFunctionError(f"there is no `{id}`")
        return self._names[id]

    def _compared(self, op: e.ComparisonOperator, left: _Number, right: _Number) -> str:
        if isinstance(left, Fraction) and isinstance(right, Fraction):
            return str(TRUE if COMPARE[op](left, right) else FALSE)
        x, y, _, _ = self._together(left, right, op)
        measured = [not isinstance(each, Fraction) for each in (left, right)]
        variables, texts = zip(*map(self._store, (x, y)), strict=True)
        pairs = zip(variables, measured, strict=True)
        known = " and ".join(f"{name} == {name}" for name, is_measured in pairs if is_measured)
        sign = _OPERATORS.get(op, op)
        if op != "!=":  # a comparison with NaN is false
            return (
                f"({TRUE} if {texts[0]} {sign} {texts[1]} else {FALSE} if {known} else {UNKNOWN})"
            )
        different = f"{texts[0]} != {texts[1]}"
        return f"({FALSE} if not {different} else {TRUE} if {known} else {UNKNOWN})"

    def _number(self, expression: e.Expression) -> _Number:
        """The number of an expression, as in `term`."""
        if not any(True for _ in e.names(expression)):
            constant = term(expression, NameValues(0, {}))
            if not isinstance(constant, Fraction):
                raise NoFunctionError("the constant is unknown")
            return constant
        match expression:
            case e.Name(id):
                return self._named(id)
            case e.Negation(arg):
                return self._negated(self._number(arg))
            case e.Arithmetic(op, left, right):
                return self._arithmetic(op, self._number(left), self._number(right))
            case e.Call("abs", (arg,), _):
                number = self._number(arg)
                assert isinstance(number, _Measured), "it has a name"
                return _Measured(f"abs({number.text})", number.kind, number.scale)
            case e.Call("min" | "max" as name, args, _):
                function = "least" if name == "min" else "greatest"
                return reduce(lambda x, y: self._end(function, x, y), map(self._number, args))
            case e.Call(name, args, _) if name in ROUNDED_FUNCTIONS:
                texts = ", ".join(self._base(self._measured(self._number(arg))) for arg in args)
                return _Measured(f"{_PREFIX}{name}({texts})", _DOUBLE)
            case e.Calculation(_, value, is_rounded):
                number = self._number(value)
                if not is_rounded:
                    return number
                return _Measured(self._base(self._measured(number)), _DOUBLE)
            case _:
                raise NoFunctionError("the expression is not a number of single points")

    def _negated(self, number: _Number) -> _Number:
        assert isinstance(number, _Measured), "it has a name"
        return _Measured(f"(-{number.text})", number.kind, number.scale)

    def _end(self, function: str, left: _Number, right: _Number) -> _Number:
        if isinstance(left, Fraction) and isinstance(right, Fraction):
            return min(left, right) if function == "least" else max(left, right)
        x, y, kind, scale = self._together(left, right)
        return _Measured(f"{function}({x}, {y})", kind, scale)

    def _arithmetic(self, op: e.ArithmeticOperator, left: _Number, right: _Number) -> _Number:
        left, right = _double(left), _double(right)
        if op in ("+", "-"):
            x, y, _, scale = self._together(left, right)
            return _Measured(f"({x} {op} {y})", _DOUBLE, scale)
        if op == "^" and isinstance(right, Fraction) and isinstance(left, _Measured):
            base, text = self._store(left.text)
            count = whole_exponent(right)
            factors = " * ".join([text, *[base] * (count - 1)])
            if count < 1:
                raise NoFunctionError("there is no factor")
            return _Measured(f"({factors})", _DOUBLE, left.scale**count)
        if op not in ("*", "/"):
            raise NoFunctionError(f"`{op}` is left to arrays")
        one, other = self._measured(left), self._measured(right)
        if op == "*":
            return _Measured(f"({one.text} * {other.text})", _DOUBLE, one.scale * other.scale)
        divisor, text = self._store(other.text)
        quotient = f"(nan if {text} == 0 else {one.text} / {divisor})"
        return _Measured(quotient, _DOUBLE, one.scale / other.scale)

    def _measured(self, number: _Number) -> _Measured:
        """A constant as the nearest 64-bit float."""
        if isinstance(number, _Measured):
            return number
        nearest, _, _ = together(number, Fraction(0))
        return _Measured(self._constant(nearest[0]), _DOUBLE)

    def _together(
        self, left: _Number, right: _Number, op: str = ""
    ) -> tuple[str, str, Kind, Fraction]:
        """Both texts in one unit, as in `together`, with their type and scale."""
        if isinstance(left, Fraction):
            assert isinstance(right, _Measured), "one side is measured"
            y, x, kind, scale = self._together(right, left, MIRRORED.get(op, op))
            return x, y, kind, scale
        if isinstance(right, Fraction):
            _, constant, _ = together(Measure(np.zeros(1, left.kind), left.scale), right, op)
            kind = np.promote_types(left.kind, constant.dtype)
            return left.text, self._constant(constant[0]), kind, left.scale
        if left.scale == right.scale:
            kind = np.promote_types(left.kind, right.kind)
            return left.text, right.text, kind, left.scale
        return self._base(left), self._base(right), _DOUBLE, Fraction(1)

    def _base(self, number: _Measured) -> str:
        """The text of a number in base units, as in `scaled`."""
        parts = (number.scale.numerator, number.scale.denominator)
        top, bottom = (self._constant(scaled(1.0, Fraction(part))) for part in parts)
        if parts[0] == 1:
            return f"({number.text} / {bottom})"
        return f"({number.text} * {top} / {bottom})"

    def _constant(self, value: Any) -> str:
        """A name for a constant."""
        if float(value) != value:
            raise NoFunctionError("no 64-bit float holds the constant")
        name = f"c{len(self.constants)}"
        self.constants[name] = float(value)
        return name


def _double(number: _Number) -> _Number:
    if isinstance(number, Fraction):
        return number
    return _Measured(number.text, _DOUBLE, number.scale)
