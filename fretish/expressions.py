"""Boolean and arithmetic expressions: the same tree in sentences and in bindings.

A sentence never holds a `Quantity` or a `Persistence`; a binding never holds a temporal predicate.
Spans are not compared: two expressions are equal if they have the same structure.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Any, Literal, assert_never

from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Span

ComparisonOperator = Literal["<", "<=", ">", ">=", "=", "!="]
Order = Literal["<", "<=", ">", ">="]
MIRRORED: Mapping[str, Order] = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
"""Comparison operator → the equivalent operator for exchanged sides."""
COMPARE: Mapping[ComparisonOperator, Callable[[Any, Any], Any]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
"""Comparison operator → its function."""
ArithmeticOperator = Literal["+", "-", "*", "/", "mod", "^"]
MOST_EXPONENT = 16
"""The largest exponent of a power."""


@dataclass(frozen=True, slots=True)
class Truth:
    """`true` or `false`."""

    value: bool


@dataclass(frozen=True, slots=True)
class Name:
    """A variable, as the user spells it (without the quotes of a quoted identifier)."""

    id: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Number:
    """A number without a unit, digits as written; never signed."""

    digits: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit: `5 cm`, `0.01 m/s`."""

    digits: str
    unit: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Word:
    """A value of an enumerated signal, as the bindings spell it: `docking`."""

    text: str
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Negation:
    """Arithmetic minus: `-x`."""

    arg: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """`left op right`, both numbers."""

    op: ArithmeticOperator
    left: Expression
    right: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Comparison:
    """`left op right`, both numbers, or both words; the whole is Boolean."""

    op: ComparisonOperator
    left: Expression
    right: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Not:
    """`! arg`."""

    arg: Expression


@dataclass(frozen=True, slots=True)
class And:
    """`a & b & ...`, at least two."""

    args: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """`a | b | ...`, at least two."""

    args: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Xor:
    """`left xor right`."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Implies:
    """`left -> right`, also written `left => right` and `if left then right`."""

    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Iff:
    """`left <-> right`, also written `left <=> right`."""

    left: Expression
    right: Expression


COUNTING = frozenset({"persisted", "occurred", "persists", "occurs"})
"""The predicates whose last argument is a truth value, and whose others count ticks."""


@dataclass(frozen=True, slots=True)
class Call:
    """`name(arg, ...)`: a function, or one of FRETish's temporal predicates."""

    name: str
    args: tuple[Expression, ...]
    span: Span | None = field(default=None, compare=False, repr=False)


TemporalOperator = Literal["X", "F", "G", "U", "R", "W"]


@dataclass(frozen=True, slots=True)
class Temporal:
    """`G arg`, `F[2,5] arg`, `left U right`: a truth value of later ticks, in a formula only."""

    operator: TemporalOperator
    args: tuple[Expression, ...]
    bounds: tuple[int, int] | None = None
    """The ticks ahead of `F` and `G`, both ends included; None: for ever."""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Calculation:
    """A computed signal in an expression of bindings: its value stands for its name."""

    name: str
    value: Expression
    """Over recorded signals, and other computed ones."""
    is_rounded: bool = False
    """Whether the bindings compute it by one of `fretish.bindings.functions.ROUNDED`; then its
    number is in base units."""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Persistence:
    """`arg for 200 ms`: arg has been true, without a break, for that long (nanoseconds)."""

    arg: Expression
    duration: int


Expression = (
    Truth
    | Name
    | Number
    | Quantity
    | Word
    | Negation
    | Arithmetic
    | Comparison
    | Not
    | And
    | Or
    | Xor
    | Implies
    | Iff
    | Call
    | Temporal
    | Calculation
    | Persistence
)


def both(left: Expression, right: Expression) -> And:
    """`left & right`, flat."""
    return And((*_flat(And, left), *_flat(And, right)))


def either(left: Expression, right: Expression) -> Or:
    """`left | right`, flat."""
    return Or((*_flat(Or, left), *_flat(Or, right)))


def _flat(kind: type[And] | type[Or], arg: Expression) -> tuple[Expression, ...]:
    return arg.args if isinstance(arg, kind) else (arg,)


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct parts, left to right."""
    match expression:
        case Truth() | Name() | Number() | Quantity() | Word():
            return ()
        case Not(arg) | Negation(arg) | Persistence(arg):
            return (arg,)
        case And(args) | Or(args):
            return args
        case Call(_, args) | Temporal(_, args):
            return args
        case Calculation(_, value):
            return (value,)
        case (
            Xor(left, right)
            | Implies(left, right)
            | Iff(left, right)
            | Arithmetic(_, left, right)
            | Comparison(_, left, right)
        ):
            return (left, right)


def with_children(expression: Expression, parts: Sequence[Expression]) -> Expression:
    """The expression with its direct parts replaced by as many others; `&` and `|` stay flat."""
    match expression:
        case Truth() | Name() | Number() | Quantity() | Word():
            return expression
        case Not() | Negation() | Persistence():
            return replace(expression, arg=parts[0])
        case And():
            return And(tuple(arg for part in parts for arg in _flat(And, part)))
        case Or():
            return Or(tuple(arg for part in parts for arg in _flat(Or, part)))
        case Call() | Temporal():
            return replace(expression, args=tuple(parts))
        case Calculation():
            return replace(expression, value=parts[0])
        case Xor() | Implies() | Iff() | Arithmetic() | Comparison():
            return replace(expression, left=parts[0], right=parts[1])
        case _:
            assert_never(expression)


def with_comparisons(
    expression: Expression, rewrite: Callable[[Comparison], Expression]
) -> Expression:
    """The expression with each comparison replaced, also inside calls."""
    match expression:
        case Comparison():
            return rewrite(expression)
        case Not(arg) | Persistence(arg):
            return replace(expression, arg=with_comparisons(arg, rewrite))
        case And(args) | Or(args) | Call(_, args) | Temporal(_, args):
            return replace(expression, args=tuple(with_comparisons(arg, rewrite) for arg in args))
        case Xor(left, right) | Implies(left, right) | Iff(left, right):
            sides = with_comparisons(left, rewrite), with_comparisons(right, rewrite)
            return replace(expression, left=sides[0], right=sides[1])
        case Truth() | Name() | Number() | Quantity() | Word() | Negation() | Arithmetic():
            return expression
        case Calculation():
            return expression
        case _:
            assert_never(expression)


def parts(expression: Expression) -> Iterator[Expression]:
    """The expression and all its parts, in preorder."""
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        yield part
        waiting.extend(reversed(children(part)))


def truths(expression: Expression) -> Iterator[Name]:
    """Every `Name` that is a truth value, except in calls."""
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Name):
            yield part
        elif not isinstance(part, Comparison | Arithmetic | Negation | Call | Calculation):
            waiting.extend(reversed(children(part)))


def names(expression: Expression) -> Iterator[Name]:
    """Every `Name`, left to right, with repetitions."""
    return (part for part in parts(expression) if isinstance(part, Name))


def has_unit(expression: Expression) -> bool:
    """Whether a number in the expression has a unit."""
    return any(isinstance(part, Quantity) for part in parts(expression))


def depth(expression: Expression) -> int:
    """The nesting depth of the expression, computed without recursion."""
    deepest = 0
    waiting = [(expression, 1)]
    while waiting:
        part, level = waiting.pop()
        deepest = max(deepest, level)
        waiting.extend((child, level + 1) for child in children(part))
    return deepest
