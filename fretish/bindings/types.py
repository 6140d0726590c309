"""Check that variables are used as their declared type allows: `boolean`, `integer`, `double`, ...

Only certain errors are reported, such as a truth value that is compared with a number, or an
integer that is compared with 2.5. Types that are not FRET's are ignored.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from enum import Enum, auto
from fractions import Fraction

from fretish import expressions as e
from fretish.bindings.declarations import Variable
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.printer import expression as printed
from fretish.units import number

Variables = Mapping[str, Variable]


class Kind(Enum):
    """The kind of value of a variable or of a part of an expression."""

    TRUTH = auto()
    NUMBER = auto()
    WHOLE = auto()
    """A whole number."""
    NATURAL = auto()
    """A whole number of at least 0."""

    @property
    def is_number(self) -> bool:
        """Whether it is a number of any kind."""
        return self is not Kind.TRUTH


_KINDS = (
    (r"bool(ean)?", Kind.TRUTH),
    (r"unsigned( integer| int)?|uint\d*", Kind.NATURAL),
    (r"int(eger)?\d*", Kind.WHOLE),
    (r"single|double|real|float\d*", Kind.NUMBER),
)


def kind(type_name: str) -> Kind | None:
    """The kind of a FRET data type; None for any other type."""
    name = " ".join(type_name.lower().split())
    return next((value_kind for pattern, value_kind in _KINDS if re.fullmatch(pattern, name)), None)


def type_errors(expression: e.Expression, variables: Variables, span: Span) -> Iterator[Diagnostic]:
    """F344 for each use of a variable in a Boolean expression that its type does not allow.

    Args:
        expression: a Boolean expression.
        variables: the declared variables.
        span: the span of a diagnostic about a part without a span.
    """
    yield from _Check(variables, span).truth(expression)


def value_type_errors(variable: Variable, variables: Variables) -> Iterator[Diagnostic]:
    """F344 if the value of a variable does not have its type, and for each misuse in the value."""
    value, span = variable.value, variable.span
    assert value is not None
    assert span is not None
    check = _Check(variables, span)
    declared, actual = kind(variable.type), check.kind(value)
    if declared is not None and actual is not None and declared.is_number != actual.is_number:
        yield _type_error(
            f"is declared {variable.type}, and its value is a {_kind_name(actual)}",
            variable.name,
            span,
        )
    elif declared is not None:
        yield from check.fits(variable.name, declared, value)
    yield from check.number(value) if actual is not Kind.TRUTH else check.truth(value)


_TRUTHS = frozenset({"preBool", "prevOcc", "nextOcc"})
_LAST_TRUTH = frozenset({"persisted", "occurred", "persists", "occurs"})
_NUMBERS = frozenset("preInt preReal absReal absInt maxReal maxInt minReal minInt".split())


class _Check:
    """Checks an expression with the kind that each part must have."""

    def __init__(self, variables: Variables, span: Span) -> None:
        self._variables = variables
        self._place = span

    def truth(self, tree: e.Expression) -> Iterator[Diagnostic]:
        """The errors of a part that must be a truth value."""
        match tree:
            case e.Name(id, span):
                if (declared := self._declared(id)) is not None and declared.is_number:
                    yield self._wrong_kind("truth value", id, span)
            case e.Comparison():
                yield from self._comparison(tree)
            case e.Call(name, args):
                yield from self._arguments(name, args)
            case _:
                for part in e.children(tree):
                    yield from self.truth(part)

    def number(self, tree: e.Expression) -> Iterator[Diagnostic]:
        """The errors of a part that must be a number."""
        match tree:
            case e.Name(id, span):
                if self._declared(id) is Kind.TRUTH:
                    yield self._wrong_kind("number", id, span)
            case e.Call(name, args):
                yield from self._arguments(name, args)
            case _:
                for part in e.children(tree):
                    yield from self.number(part)

    def kind(self, tree: e.Expression) -> Kind | None:
        """The kind of a part; None if it is not certain."""
        match tree:
            case e.Name(id):
                return self._declared(id)
            case e.Call(name):
                return Kind.NUMBER if name in _NUMBERS else Kind.TRUTH if name in _TRUTHS else None
            case e.Number() | e.Quantity() | e.Negation() | e.Arithmetic():
                return Kind.NUMBER
            case _:
                return Kind.TRUTH

    def fits(self, id: str, declared: Kind, value: e.Expression) -> Iterator[Diagnostic]:
        """F344 if a constant that an integer variable is compared with is not in its range."""
        exact = self._constant(value)
        if exact is None or declared not in (Kind.WHOLE, Kind.NATURAL):
            return
        if exact.denominator != 1:
            why = "not a whole number"
        elif exact < 0 and declared is Kind.NATURAL:
            why = "below 0"
        else:
            return
        span = getattr(value, "span", None) or self._place
        yield _type_error(f"is declared {self._type(id)}, and {printed(value)} is {why}", id, span)

    def _comparison(self, tree: e.Comparison) -> Iterator[Diagnostic]:
        """Truth values can be compared by `=` and `!=`; every other comparison needs numbers."""
        kinds = [self.kind(side) for side in (tree.left, tree.right)]
        if tree.op not in ("=", "!=") or any(k is not None and k.is_number for k in kinds):
            yield from self.number(tree.left)
            yield from self.number(tree.right)
        if tree.op in ("=", "!="):
            for name, other in ((tree.left, tree.right), (tree.right, tree.left)):
                if isinstance(name, e.Name) and (declared := self._declared(name.id)) is not None:
                    yield from self.fits(name.id, declared, other)

    def _arguments(self, name: str, args: tuple[e.Expression, ...]) -> Iterator[Diagnostic]:
        """Check the arguments of a call; a function that is not FRETish's accepts any kind."""
        for i, arg in enumerate(args):
            last = i == len(args) - 1
            if name in _TRUTHS or (name in _LAST_TRUTH and last):
                yield from self.truth(arg)
            elif name in _NUMBERS:
                yield from self.number(arg)
            elif not isinstance(arg, e.Name):
                yield from self.truth(arg) if self.kind(arg) is Kind.TRUTH else self.number(arg)

    def _declared(self, id: str) -> Kind | None:
        return kind(self._type(id))

    def _type(self, id: str) -> str:
        return self._variables[id].type if id in self._variables else ""

    def _constant(self, tree: e.Expression) -> Fraction | None:
        """The value of a literal, or of a variable whose value is one; else None."""
        match tree:
            case e.Number(digits):
                try:
                    return number(digits)
                except ValueError:
                    return None
            case e.Negation(arg):
                exact = self._constant(arg)
                return None if exact is None else -exact
            case e.Name(id) if id in self._variables:
                value = self._variables[id].value
                return None if value is None or isinstance(value, e.Name) else self._constant(value)
            case _:
                return None

    def _wrong_kind(self, what: str, id: str, span: Span | None) -> Diagnostic:
        why = f"is declared {self._type(id)}, and a {what} is needed here"
        return _type_error(why, id, span or self._place)


def _kind_name(kind: Kind) -> str:
    return "truth value" if kind is Kind.TRUTH else "number"


def _type_error(why: str, id: str, span: Span) -> Diagnostic:
    return diagnostic("variable_type", span, id=id, why=why)
