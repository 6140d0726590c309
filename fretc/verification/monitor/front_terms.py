"""Comparisons of a monitor as terms: equal terms are equal truth values for any variables.

A name represents its assigned term, and a stored value the term at the previous tick. So two texts
with equal terms differ only in the names of their variables. If terms differ, a tick is searched at
which the truth values do.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from math import inf, nan, nextafter
from typing import Any

from fretc.verification.monitor.front_layout import declared_variables
from fretc.verification.monitor.statements import UnexpectedStatementError
from fretc.verification.monitor.text_check import own
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor
from monitors.kernel.readings import exact
from monitors.kernel.variables import Value, Variable
from monitors.kernel.verdicts import Truth

Term = tuple[object, ...]
"""Equal for equal terms."""


@dataclass(frozen=True, slots=True)
class Differing:
    """Ticks at whose last one a proposition has a wrong truth value."""

    truths: tuple[Mapping[str, Truth], ...]
    """Right truth values, at each tick."""
    fault: str
    values: str
    """Values of the variables at the last tick."""


def terms(text: str) -> Mapping[str, Term]:
    """Proposition → its term over the variables of a monitor.

    Args:
        text: text of a monitor, in the layout that fretc writes.

    Raises:
        UnexpectedCodeError: a stored value depends on all earlier ticks.
    """
    parts = _Parts.of(text)
    return {name: parts.term(ast.Name(local)) for name, local in parts.propositions.items()}


@dataclass(slots=True)
class _Parts:
    """The assignments of a text."""

    propositions: Mapping[str, str]
    given: Mapping[str, Term]
    """Parameter → variable."""
    assigned: dict[str, ast.expr] = field(default_factory=dict)
    kept: Sequence[ast.expr] = ()
    waiting: list[str] = field(default_factory=list)
    known: dict[str, Term] = field(default_factory=dict)

    @classmethod
    def of(cls, text: str) -> _Parts:
        """The assignments of a monitor."""
        (monitor,) = (
            node
            for node in own(text).body
            if isinstance(node, ast.ClassDef) and node.name.endswith("Monitor")
        )
        propositions: dict[str, str] = {}
        variables: Mapping[str, Variable] | None = None
        truths: list[ast.stmt] = []
        for part in monitor.body:
            match part:
                case ast.AnnAssign(ast.Name("PROPOSITIONS"), _, ast.expr() as value):
                    propositions = ast.literal_eval(value)
                case ast.AnnAssign(ast.Name("VARIABLES")):
                    variables = declared_variables(part)
                case ast.FunctionDef("truths"):
                    truths = part.body
        if variables is None:
            variables = {name: Variable(p, "truth") for name, p in propositions.items()}
        given: dict[str, Term] = {
            v.parameter: ("given", name, v.kind, v.words, v.infinite)
            for name, v in variables.items()
        }
        parts = cls(propositions, given)
        for statement in truths:
            match statement:
                case ast.Assign([ast.Name(name)], value) if name not in given:
                    parts.assigned[name] = value
                case ast.Assign([ast.Attribute(attr="kept")], ast.Tuple(values)):
                    parts.kept = values
        return parts

    def term(self, node: ast.expr) -> Term:
        """The term of an expression."""
        match node:
            case ast.Name(name) if name in self.given:
                return self.given[name]
            case ast.Name(name):
                return self._assigned(name)
            case ast.Constant(value):
                return ("constant", value)
            case ast.Call(ast.Name("exact"), [ast.Constant(str(text))]):
                return ("exact", Fraction(text))
            case ast.Call(ast.Name(function), args):
                return (function, *(self.term(arg) for arg in args))
            case ast.IfExp(_, before, ast.Subscript(_, ast.Constant(int(place)))):
                if place >= len(self.kept):
                    raise UnexpectedStatementError(
                        "it reads an earlier value that it does not store"
                    )
                return ("earlier", self.term(before), self.term(self.kept[place]))
            case _:
                raise AssertionError(f"not laid out as fretc writes it: {ast.unparse(node)}")

    def _assigned(self, name: str) -> Term:
        if name in self.waiting:
            raise UnexpectedStatementError("a stored value depends on all earlier ticks")
        if name not in self.known:
            self.waiting.append(name)
            self.known[name] = self.term(self.assigned[name])
            self.waiting.pop()
        return self.known[name]


# Where they differ ----------------------------------------------------------------------------

_LENGTHS = (1,) * 400 + (3,) * 400
"""Lengths of the examined traces."""


def differing(
    monitor: Monitor, reference: Monitor, texts: Sequence[str], propositions: Sequence[str]
) -> Differing | None:
    """A trace with different truth values, if one is found.

    Args:
        monitor: monitor loaded from a checked text.
        reference: monitor of the same variables.
        texts: both texts, for their constants.
        propositions: propositions to compare.
    """
    left, right = _truths_of(monitor), _truths_of(reference)
    inputs: Mapping[str, Variable] = reference.VARIABLES  # type: ignore[attr-defined]
    numbers = tuple(_numbers(texts))
    choose = random.Random(0)
    for length in _LENGTHS:
        monitor.reset()
        reference.reset()
        truths: list[Mapping[str, Truth]] = []
        for _ in range(length):
            row = {name: _drawn(choose, each, numbers) for name, each in inputs.items()}
            expected = right(row)
            truths.append(expected)
            try:
                actual = left(row)
            except Exception as error:
                return Differing(tuple(truths), f"it raises {type(error).__name__}", _given(row))
            for name in propositions:
                if actual[name] is not expected[name]:
                    right_one = _in_words(expected[name])
                    fault = (
                        f"`{name}` is {_in_words(actual[name])} in it, and should be {right_one}"
                    )
                    return Differing(tuple(truths), fault, _given(row))
    return None


def _truths_of(monitor: Any) -> Any:
    names, variables = tuple(monitor.PROPOSITIONS), monitor.VARIABLES

    def at(row: Mapping[str, Value]) -> Mapping[str, Truth]:
        made = monitor.truths(*(row[name] for name in variables))
        return dict(zip(names, made, strict=True))

    return at


def _numbers(texts: Sequence[str]) -> Iterator[float | None]:
    """Numbers around all constants, and numbers with other rounding."""
    yield from (None, nan, inf, -inf, 0.0, 1.0, -1.0, 0.5, 3.0, 2**53 + 1)
    for text in texts:
        for node in ast.walk(own(text)):
            match node:
                case ast.Call(ast.Name("exact"), [ast.Constant(str(digits))]):
                    constant = exact(digits)
                    number = constant.double
                    yield from (number, -number, nextafter(number, inf), nextafter(number, -inf))
                    yield from (number + 1, number - 1, 2 * number, number / 2)
                    if constant.exact.denominator == 1:
                        yield constant.exact.numerator


def _drawn(choose: random.Random, variable: Variable, numbers: Sequence[float | None]) -> Value:
    match variable.kind:
        case "number":
            return choose.choice(numbers)
        case "word":
            return choose.choice((None, *variable.words))
        case _:
            return choose.choice((None, False, True))


def _given(row: Mapping[str, Value]) -> str:
    return ", ".join(f"{name} = {_in_words(value)}" for name, value in row.items())


def _in_words(value: Value) -> str:
    return "unknown" if value is None else str(value).lower()
