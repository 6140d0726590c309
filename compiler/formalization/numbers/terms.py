"""Comparisons and propositions over signals as formulas of z3: linear, exact, whole or real.

A variable has the unit of its signal. If several units meet, everything is converted to base units.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import z3

from compiler.formalization.formalized import FormalizedRequirement
from fretish import expressions as e
from fretish import units
from fretish.bindings import constants
from fretish.bindings.declarations import Signal
from fretish.bindings.types import Kind, kind
from fretish.checking import LOOK_AHEAD, LOOK_BACK, NUMBERS_BACK
from fretish.classes.frozen import dataclass
from fretish.printer import expression as printed
from fretish.reading.recursion import with_recursion_limit

Term = Any
"""A number or a truth value of z3, which has no type stubs."""


class NoTermError(Exception):
    """The expression has no formula here; the message says why."""


@dataclass(frozen=True, slots=True)
class PreviousValue:
    """The value of a variable at the tick before."""

    of: str
    first: Term
    """The value at the first tick."""


class RequirementTerms:
    """The variables of some requirements, and formulas over them."""

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        *,
        is_linear: bool = True,
        may_be_free: Callable[[frozenset[str]], bool] = lambda names: False,
    ) -> None:
        """Start without variables.

        Args:
            requirements: the requirements with the comparisons.
            is_linear: whether products of variables are refused, and unitless signals that meet a
                signal with a unit. Otherwise such a signal gets a separate variable in base units.
            may_be_free: whether a term over these variables that is not linear becomes a variable
                with any value; not for signals.
        """
        self._may_be_free = may_be_free
        self._is_linear = is_linear
        self._signals = {
            name: signal
            for requirement in requirements
            for name, signal in (
                requirement.declarations.measured if requirement.declarations else {}
            ).items()
        }
        self._types = {
            name: declared.type
            for requirement in requirements
            for name, declared in requirement.glossary.items()
        }
        self._words: dict[str, int] = {}
        self.variables: dict[str, Term] = {}
        """z3 constants of all variables."""
        self.before: dict[str, PreviousValue] = {}
        """The variables that stand for values at the tick before."""
        self.free: set[str] = set()
        """The variables that stand for terms with any value: equal terms have equal values."""

    @with_recursion_limit
    def holds(self, part: e.Expression, value: bool, all_known: Callable[[Term], Term]) -> Term:
        """The formula for a part being certainly true, or certainly false, in Kleene's logic.

        Args:
            part: a Boolean expression.
            value: the truth value.
            all_known: the formula for all variables of a comparison being known.

        Raises:
            NoTermError: the part is not linear, or not a comparison of numbers.
        """
        return self._holds(part, value, all_known, is_base=self._meets_units(part))

    def domain(self, name: str) -> Term:
        """The formula for the domain of a variable."""
        if name in self.before:
            before = self.before[name]
            of, domain = self.variables[before.of], self.domain(before.of)
            begins = z3.simplify(z3.substitute(domain, (of, before.first)))
            then = z3.substitute(domain, (of, self.variables[name]))
            return then if z3.is_true(begins) else z3.BoolVal(True)
        variable, signal = self.variables[name], self._signals.get(name)
        if signal is not None and signal.values:
            return z3.Or([variable == self._place(word) for word in signal.values])
        if (bounds := self._range(name)) is not None:
            return z3.And(variable >= bounds[0], variable <= bounds[1])
        if self._kind(name) is Kind.NATURAL:
            return variable >= 0
        return z3.BoolVal(True)

    def shown(self, name: str, value: Fraction) -> int | float | str:
        """A value of a variable as displayed."""
        signal = self._signals.get(name)
        if signal is not None and signal.values:
            return next(word for word, place in self._words.items() if place == value)
        return value.numerator if value.denominator == 1 else float(value)

    def _place(self, word: str) -> int:
        return self._words.setdefault(word, len(self._words))

    def _kind(self, name: str) -> Kind | None:
        declared = self._types.get(name)
        return kind(declared) if declared else None

    def _range(self, name: str) -> tuple[int, int] | None:
        """The range of a message type that is one integer."""
        signal = self._signals.get(name)
        if not isinstance(signal, Signal) or signal.type is None:
            return None
        if str(signal.path) != f"{signal.path.topic}.data":
            return None
        return _RANGES.get(signal.type.replace("/msg/", "/"))

    def _meets_units(self, part: e.Expression) -> bool:
        scales = {self._scale(name.id) for name in e.names(part)}
        return len(scales) > 1 or e.has_unit(part)

    def _scale(self, name: str) -> Fraction | None:
        signal = self._signals.get(name)
        return signal.scale if signal is not None else None

    # Truth values

    def _holds(
        self, part: e.Expression, value: bool, all_known: Callable[[Term], Term], *, is_base: bool
    ) -> Term:
        def read(operand: e.Expression, is_so: bool) -> Term:
            return self._holds(operand, is_so, all_known, is_base=is_base)

        match part:
            case e.Truth(is_true):
                return z3.BoolVal(is_true is value)
            case e.Not(arg):
                return read(arg, not value)
            case e.And(args):
                return (z3.And if value else z3.Or)([read(operand, value) for operand in args])
            case e.Or(args):
                return (z3.Or if value else z3.And)([read(operand, value) for operand in args])
            case e.Comparison(op, left, right):
                a, b = (self._number(side, is_base=is_base) for side in (left, right))
                compared = e.COMPARE[op](a, b)
                return z3.And(compared if value else z3.Not(compared), all_known(compared))
            case _:
                raise NoTermError("is not a comparison of numbers")

    # Numbers

    def _number(self, part: e.Expression, *, is_base: bool) -> Term:
        if not any(e.names(part)) and not isinstance(part, e.Word | e.Call):
            return _constant(part)

        def read(operand: e.Expression) -> Term:
            return self._number(operand, is_base=is_base)

        match part:
            case e.Word(text):
                return z3.IntVal(self._place(text))
            case e.Calculation(_, value):
                return read(value)
            case e.Name(id):
                return self._variable(id, is_base=is_base)
            case e.Negation(arg):
                return -read(arg)
            case e.Arithmetic(op, left, right):
                sides = [read(left), read(right)]
                try:
                    return _computed(op, *sides, is_linear=self._is_linear)
                except NoTermError as error:
                    return self._with_any_value(part, sides, error)
            case e.Call("preInt" | "preReal", (first, e.Name(id))) if not is_base:
                return self._before(printed(part), read(first), id)
            case e.Call(name, args):
                operands = [read(operand) for operand in args]
                try:
                    return _called(name, operands)
                except NoTermError as error:
                    return self._with_any_value(part, operands, error)
            case _:
                raise NoTermError("is not a comparison of numbers")

    def _with_any_value(
        self, part: e.Expression, operands: Sequence[Term], why: NoTermError
    ) -> Term:
        """The variable for a term that is not linear."""
        names = frozenset[str]().union(*map(read_by, operands))
        temporal = isinstance(part, e.Call) and part.name in LOOK_BACK | LOOK_AHEAD | NUMBERS_BACK
        if self._signals or temporal or not self._may_be_free(names):
            raise why
        name = printed(part)
        self.free.add(name)
        return self.variables.setdefault(name, z3.Real(name))

    def _before(self, name: str, first: Term, of: str) -> Term:
        """The variable for the value at the tick before."""
        now = self._variable(of, is_base=False)
        if now.is_int() and first.is_real():
            raise NoTermError("begins with a number that is not whole")
        first = z3.ToReal(first) if now.is_real() and first.is_int() else first
        constant = z3.Int(name) if now.is_int() else z3.Real(name)
        self.before[name] = PreviousValue(of, first)
        return self.variables.setdefault(name, constant)

    def _variable(self, name: str, *, is_base: bool) -> Term:
        signal, kind = self._signals.get(name), self._kind(name)
        is_word = signal is not None and bool(signal.values)
        if kind is Kind.TRUTH:
            raise NoTermError("compares a truth value with a number")
        whole = is_word or kind in (Kind.WHOLE, Kind.NATURAL) or self._range(name) is not None
        constant = z3.Int(name) if whole else z3.Real(name)
        variable = self.variables.setdefault(name, constant)
        if not is_base or is_word:
            return variable
        scale = self._scale(name)
        if scale is None and not self._is_linear:
            base = f"{name} in base units"
            return self.variables.setdefault(base, z3.Real(base))
        if scale is None:
            raise NoTermError(f"needs the unit of `{name}`, which has none")
        return variable if scale == 1 else _exact(scale) * variable


_RANGES: Mapping[str, tuple[int, int]] = {
    "std_msgs/Bool": (0, 1),
    **{f"std_msgs/Int{n}": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in (8, 16, 32, 64)},
    **{f"std_msgs/UInt{n}": (0, 2**n - 1) for n in (8, 16, 32, 64)},
}
"""The range of the field `data` of each type."""


def read_by(formula: Term) -> frozenset[str]:
    """The names of the variables in a formula."""
    names: set[str] = set()
    waiting, seen = [formula], set()
    while waiting:
        term = waiting.pop()
        if (id := term.get_id()) not in seen:
            seen.add(id)
            parts = term.children()
            waiting.extend(parts)
            if not parts and term.decl().kind() == z3.Z3_OP_UNINTERPRETED:
                names.add(term.decl().name())
    return frozenset(names)


def _exact(value: Fraction) -> Term:
    return z3.IntVal(value.numerator) if value.denominator == 1 else z3.RealVal(str(value))


def _constant(part: e.Expression) -> Term:
    try:
        for node in e.parts(part):
            if isinstance(node, e.Number | e.Quantity):
                units.number(node.digits)  # it has no more digits than can be computed with
        value = constants.number(part)
    except ValueError:
        value = None
    if value is None:
        raise NoTermError("computes with a number that does not exist, or is too long")
    return _exact(value)


def _computed(op: e.ArithmeticOperator, left: Term, right: Term, *, is_linear: bool) -> Term:
    match op:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*" if not is_linear or _is_number(left) or _is_number(right):
            return left * right
        case "/" if _is_number(right) and not z3.simplify(right == 0).eq(z3.BoolVal(True)):
            return (z3.ToReal(left) if left.is_int() else left) / right
        case _:
            raise NoTermError("is not linear")


def _is_number(term: Term) -> bool:
    simple = z3.simplify(term)
    return bool(z3.is_rational_value(simple) or z3.is_int_value(simple))


def _called(name: str, args: Sequence[Term]) -> Term:
    match name.lower(), args:
        case (("abs" | "absreal" | "absint"), [arg]):
            return z3.If(arg >= 0, arg, -arg)
        case (("min" | "minreal" | "minint"), [left, right]):
            return z3.If(left <= right, left, right)
        case (("max" | "maxreal" | "maxint"), [left, right]):
            return z3.If(left >= right, left, right)
        case _:
            raise NoTermError(f"calls `{name}`")
