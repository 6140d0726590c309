"""Variables are used as their declared type allows: FRET's `boolean`, `integer`, `double`, ...

Only what is certainly wrong is a mistake: a truth value that is compared with a number, a whole
number that is to be equal to 2.5. A type that is none of these is not looked at.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from enum import Enum, auto
from fractions import Fraction

from fretish import expressions as e
from fretish.bindings.declarations import Variable
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.printer import expression as printed
from fretish.units import number

Variables = Mapping[str, Variable]


class Kind(Enum):
    """What a variable or a part of an expression is."""

    TRUTH = auto()
    NUMBER = auto()
    WHOLE = auto()
    """A whole number."""
    NATURAL = auto()
    """A whole number, and not below 0."""

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
    """What a variable of FRET's type is; None for any other type."""
    name = " ".join(type_name.lower().split())
    return next((found for form, found in _KINDS if re.fullmatch(form, name)), None)


def misuses(expression: e.Expression, variables: Variables, place: Span) -> Iterator[Diagnostic]:
    """F344 for each place of a truth value where a variable is used against its type.

    Args:
        expression: a truth value.
        variables: that are declared, each with its type.
        place: where to point when a part has no place of its own.
    """
    yield from _Check(variables, place).truth(expression)


def misuses_of_value(variable: Variable, variables: Variables) -> Iterator[Diagnostic]:
    """F344 where a variable stands for what is not of its type, and for misuses within that."""
    value, place = variable.value, variable.span
    assert value is not None
    assert place is not None
    check = _Check(variables, place)
    declared, actual = kind(variable.type), check.kind(value)
    if declared is not None and actual is not None and declared.is_number != actual.is_number:
        yield _misuse(
            f"is declared {variable.type}, and stands for a {_words(actual)}", variable.name, place
        )
    elif declared is not None:
        yield from check.fits(variable.name, declared, value)
    yield from check.number(value) if actual is not Kind.TRUTH else check.truth(value)


_TRUTHS = frozenset({"preBool", "prevOcc", "nextOcc"})
_LAST_TRUTH = frozenset({"persisted", "occurred", "persists", "occurs"})
_NUMBERS = frozenset("preInt preReal absReal absInt maxReal maxInt minReal minInt".split())


class _Check:
    """Walks over an expression with what each part has to be."""

    def __init__(self, variables: Variables, place: Span) -> None:
        self._variables = variables
        self._place = place

    def truth(self, tree: e.Expression) -> Iterator[Diagnostic]:
        """What is wrong with a part that is a truth value."""
        match tree:
            case e.Name(id, span):
                if (declared := self._declared(id)) is not None and declared.is_number:
                    yield self._wanted("truth value", id, span)
            case e.Comparison():
                yield from self._comparison(tree)
            case e.Call(name, args):
                yield from self._arguments(name, args)
            case _:
                for part in e.children(tree):
                    yield from self.truth(part)

    def number(self, tree: e.Expression) -> Iterator[Diagnostic]:
        """What is wrong with a part that is a number."""
        match tree:
            case e.Name(id, span):
                if self._declared(id) is Kind.TRUTH:
                    yield self._wanted("number", id, span)
            case e.Call(name, args):
                yield from self._arguments(name, args)
            case _:
                for part in e.children(tree):
                    yield from self.number(part)

    def kind(self, tree: e.Expression) -> Kind | None:
        """What a part is; None where that is not certain."""
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
        """F344 where a whole number would have to be a constant that is none."""
        exact = self._constant(value)
        if exact is None or declared not in (Kind.WHOLE, Kind.NATURAL):
            return
        if exact.denominator != 1:
            why = "a whole number, and never"
        elif exact < 0 and declared is Kind.NATURAL:
            why = "never below 0, and so never"
        else:
            return
        place = getattr(value, "span", None) or self._place
        yield _misuse(f"is declared {self._type(id)}: {why} {printed(value)}", id, place)

    def _comparison(self, tree: e.Comparison) -> Iterator[Diagnostic]:
        """Two truth values may be equal, but for that numbers are compared."""
        kinds = [self.kind(side) for side in (tree.left, tree.right)]
        if tree.op not in ("=", "!=") or any(k is not None and k.is_number for k in kinds):
            yield from self.number(tree.left)
            yield from self.number(tree.right)
        if tree.op in ("=", "!="):
            for name, other in ((tree.left, tree.right), (tree.right, tree.left)):
                if isinstance(name, e.Name) and (declared := self._declared(name.id)) is not None:
                    yield from self.fits(name.id, declared, other)

    def _arguments(self, name: str, args: tuple[e.Expression, ...]) -> Iterator[Diagnostic]:
        """What functions take that are not FRETish's own is theirs."""
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
        """A number that is written as such, or a name that stands for one."""
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

    def _wanted(self, what: str, id: str, span: Span | None) -> Diagnostic:
        why = f"is declared {self._type(id)}, and a {what} is needed here"
        return _misuse(why, id, span or self._place)


def _words(kind: Kind) -> str:
    return "truth value" if kind is Kind.TRUTH else "number"


def _misuse(why: str, id: str, place: Span) -> Diagnostic:
    return Diagnostic(
        Code.VARIABLE_TYPE,
        f"`{id}` {why}",
        place,
        help=f"fix the sentence or the value, or the type of `[variable.{id}]`",
    )
