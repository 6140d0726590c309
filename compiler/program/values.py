"""Truth values at a tick: expressions over literals, variables and counters.

All values but the tests of counters are monotone in the literals, so that one program computes
both what holds for certain and what may hold.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Constant:
    """True or false at every tick."""

    truth: bool


@dataclass(frozen=True, slots=True)
class Literal:
    """A proposition or its negation, at this tick."""

    proposition: str
    positive: bool


@dataclass(frozen=True, slots=True)
class Variable:
    """A named truth value: a cell, or a value computed at this tick."""

    name: str


class Comparison(Enum):
    """The operators between a counter and a number."""

    LESS = "<"
    AT_MOST = "<="
    AT_LEAST = ">="
    MORE = ">"


@dataclass(frozen=True, slots=True)
class Age:
    """A counter, compared with a number."""

    counter: str
    comparison: Comparison
    number: int


@dataclass(frozen=True, slots=True)
class Not:
    """The negation; only in conditions of dual operators."""

    value: Value


@dataclass(frozen=True, slots=True)
class And:
    """The conjunction of two values or more."""

    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """The disjunction of two values or more."""

    values: tuple[Value, ...]


Value = Constant | Literal | Variable | Age | Not | And | Or

TRUE, FALSE = Constant(True), Constant(False)


def and_(values: Iterable[Value]) -> Value:
    """The conjunction; constants fold."""
    rest = tuple(value for value in values if value != TRUE)
    if FALSE in rest:
        return FALSE
    if len(rest) < 2:
        return rest[0] if rest else TRUE
    return And(rest)


def or_(values: Iterable[Value]) -> Value:
    """The disjunction; constants fold."""
    rest = tuple(value for value in values if value != FALSE)
    if TRUE in rest:
        return TRUE
    if len(rest) < 2:
        return rest[0] if rest else FALSE
    return Or(rest)


def not_(value: Value) -> Value:
    """The negation; constants fold."""
    return Constant(not value.truth) if isinstance(value, Constant) else Not(value)


def parts(value: Value) -> Iterator[Value]:
    """The value and all values within it."""
    yield value
    match value:
        case And(values) | Or(values):
            inner = values
        case Not(negated):
            inner = (negated,)
        case Constant() | Literal() | Variable() | Age():
            inner = ()
    for operand in inner:
        yield from parts(operand)
