"""Temporal formulas with metric operators, past and future, and how to build them.

Classes are for matching, lower-case functions for building: a constructor folds what is local
and free. Bounds stay symbolic: `F[0,1000] p` is one node.

Time is counted in ticks. Past operators look from the present back to tick 0; future operators
look forward on an infinite trace. A formula about finite traces uses `LAST`, true exactly at the
last tick, and then does not depend on what follows it.

Sources: Pnueli, The temporal logic of programs, FOCS 1977; Lichtenstein, Pnueli, Zuck, The glory
of the past, 1985; Koymans, Specifying real-time properties with metric temporal logic, 1990.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from typing import assert_never

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Interval:
    """Ticks `lo..hi`, both ends included; `hi` None: for ever."""

    lo: int
    hi: int | None

    def __post_init__(self) -> None:
        assert self.lo >= 0
        assert self.hi is None or self.hi >= self.lo


EVER = Interval(0, None)


@dataclass(frozen=True, slots=True)
class Const:
    """True or false at every tick."""

    value: bool


@dataclass(frozen=True, slots=True)
class Atom:
    """A proposition: a variable's name, or a comparison or call as canonical text."""

    name: str


@dataclass(frozen=True, slots=True)
class Last:
    """True exactly at the last tick of a finite trace, nowhere on an infinite one."""


@dataclass(frozen=True, slots=True)
class Not:
    """`! arg`."""

    arg: Formula


@dataclass(frozen=True, slots=True)
class And:
    """`a & b & ...`, at least two."""

    args: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """`a | b | ...`, at least two."""

    args: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Xor:
    """`left xor right`."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Implies:
    """`left -> right`."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Iff:
    """`left <-> right`."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Previous:
    """`Y arg`: arg held at the tick before; false at tick 0."""

    arg: Formula


@dataclass(frozen=True, slots=True)
class WeakPrevious:
    """`Z arg`: as `Y arg`, but true at tick 0."""

    arg: Formula


@dataclass(frozen=True, slots=True)
class Once:
    """`O[lo,hi] arg`: arg held at some tick `lo..hi` ago; there is none before tick 0."""

    arg: Formula
    ago: Interval


@dataclass(frozen=True, slots=True)
class Historically:
    """`H[lo,hi] arg`: arg held at every tick `lo..hi` ago that there is."""

    arg: Formula
    ago: Interval


@dataclass(frozen=True, slots=True)
class Since:
    """`left S[lo,hi] right`: right held at some tick `lo..hi` ago, and left ever since (after it).

    Plain `S` has the interval `EVER`.
    """

    left: Formula
    right: Formula
    ago: Interval


@dataclass(frozen=True, slots=True)
class Next:
    """`X arg`: arg holds at the next tick."""

    arg: Formula


@dataclass(frozen=True, slots=True)
class Eventually:
    """`F[lo,hi] arg`: arg holds at some tick `lo..hi` ahead."""

    arg: Formula
    ahead: Interval


@dataclass(frozen=True, slots=True)
class Globally:
    """`G[lo,hi] arg`: arg holds at every tick `lo..hi` ahead."""

    arg: Formula
    ahead: Interval


@dataclass(frozen=True, slots=True)
class Until:
    """`left U right`: right holds at some tick from now on, and left at all ticks before it."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Release:
    """`left R right`: right holds up to and including the first tick at which left holds."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class ProbabilityBound:
    """`P op bound [ arg ]`: over all runs from here, arg has such a probability (PCTL*)."""

    op: str
    bound: str
    arg: Formula


Formula = (
    Const
    | Atom
    | Last
    | Not
    | And
    | Or
    | Xor
    | Implies
    | Iff
    | Previous
    | WeakPrevious
    | Once
    | Historically
    | Since
    | Next
    | Eventually
    | Globally
    | Until
    | Release
    | ProbabilityBound
)

TRUE, FALSE, LAST = Const(True), Const(False), Last()
FIRST = WeakPrevious(FALSE)
"""True exactly at tick 0."""


def not_(arg: Formula) -> Formula:
    """`! arg`."""
    match arg:
        case Const(value):
            return Const(not value)
        case Not(inner):
            return inner
        case _:
            return Not(arg)


def and_(*args: Formula) -> Formula:
    """Conjunction, flat, without repetitions; TRUE for none."""
    flat = _flat(And, args)
    if FALSE in flat:
        return FALSE
    # F a is weaker than F[0,n] a, so beside it in a conjunction it says nothing.
    bounded = {g.arg for g in flat if isinstance(g, Eventually) and g.ahead.hi is not None}
    rest = tuple(
        arg
        for arg in flat
        if arg != TRUE
        and not (isinstance(arg, Eventually) and arg.ahead == EVER and arg.arg in bounded)
    )
    return And(rest) if len(rest) > 1 else rest[0] if rest else TRUE


def or_(*args: Formula) -> Formula:
    """Disjunction, flat, without repetitions; FALSE for none."""
    flat = _flat(Or, args)
    if TRUE in flat:
        return TRUE
    # G a is stronger than G[0,n] a, so beside it in a disjunction it says nothing.
    bounded = {g.arg for g in flat if isinstance(g, Globally) and g.ahead.hi is not None}
    rest = tuple(
        arg
        for arg in flat
        if arg != FALSE
        and not (isinstance(arg, Globally) and arg.ahead == EVER and arg.arg in bounded)
    )
    return Or(rest) if len(rest) > 1 else rest[0] if rest else FALSE


def _flat(kind: type[And] | type[Or], args: tuple[Formula, ...]) -> list[Formula]:
    """The arguments in their order, each once; compared, not hashed: unequal trees differ early."""
    parts = [part for arg in args for part in (arg.args if isinstance(arg, kind) else (arg,))]
    levels = _GLANCE if len(parts) > _FEW else 0
    flat: list[Formula] = []
    alike: dict[Hashable, list[Formula]] = {}
    for part in parts:
        others = alike.setdefault(_glance(part, levels), [])
        if part not in others:
            flat.append(part)
            others.append(part)
    return flat


_FEW, _GLANCE = 8, 3
"""Above `_FEW` formulas, only those with equal operators down to `_GLANCE` levels are compared."""


def _glance(f: Formula, levels: int) -> Hashable:
    """A key that equal formulas share, at a cost independent of their size.

    The key has the first operands of an operator, some levels deep.
    """
    if isinstance(f, Atom):
        return f.name
    if levels == 0:
        return type(f).__name__
    return type(f).__name__, *(_glance(part, levels - 1) for part in children(f)[:2])


def xor(left: Formula, right: Formula) -> Formula:
    """`left xor right`."""
    if isinstance(left, Const):
        return not_(right) if left.value else right
    if isinstance(right, Const):
        return not_(left) if right.value else left
    return Xor(left, right)


def implies(left: Formula, right: Formula) -> Formula:
    """`left -> right`."""
    if left == TRUE:
        return right
    if right == FALSE:
        return not_(left)
    if left == FALSE or right == TRUE:
        return TRUE
    return Implies(left, right)


def iff(left: Formula, right: Formula) -> Formula:
    """`left <-> right`."""
    if isinstance(left, Const):
        return right if left.value else not_(right)
    if isinstance(right, Const):
        return left if right.value else not_(left)
    return Iff(left, right)


def previous(arg: Formula) -> Formula:
    """`Y arg`; `Y TRUE` is not TRUE: at tick 0 there is no tick before."""
    return FALSE if arg == FALSE else Previous(arg)


def weak_previous(arg: Formula) -> Formula:
    """`Z arg`; `Z FALSE` is not FALSE: it marks tick 0."""
    return TRUE if arg == TRUE else WeakPrevious(arg)


def once(arg: Formula, ago: Interval = EVER) -> Formula:
    """`O[ago] arg`."""
    if arg == FALSE or ago == Interval(0, 0):
        return arg
    if arg == TRUE and ago.lo == 0:  # O[2,3] TRUE is false at tick 0: no tick is 2 ago.
        return TRUE
    if arg == FIRST and ago == EVER:
        return TRUE
    return Once(arg, ago)


def historically(arg: Formula, ago: Interval = EVER) -> Formula:
    """`H[ago] arg`."""
    if arg == TRUE or ago == Interval(0, 0):
        return arg
    if arg == FALSE and ago.lo == 0:  # H[2,3] FALSE is true at tick 0: no tick is 2 ago.
        return FALSE
    return Historically(arg, ago)


def since(left: Formula, right: Formula, ago: Interval = EVER) -> Formula:
    """`left S[ago] right`."""
    if right == FALSE or (left == FALSE and ago.lo > 0):
        return FALSE
    if left == TRUE:
        return once(right, ago)
    if ago.lo == 0 and (left == FALSE or right == TRUE):
        return right
    return Since(left, right, ago)


def next_(arg: Formula) -> Formula:
    """`X arg`."""
    return arg if isinstance(arg, Const) else Next(arg)


def eventually(arg: Formula, ahead: Interval = EVER) -> Formula:
    """`F[ahead] arg`; `F[n,n] F[lo,hi] arg` is `F[n+lo,n+hi] arg`."""
    if isinstance(arg, Eventually) and ahead.lo == ahead.hi and arg.ahead.hi is not None:
        return eventually(arg.arg, Interval(ahead.lo + arg.ahead.lo, ahead.lo + arg.ahead.hi))
    return arg if isinstance(arg, Const) or ahead == Interval(0, 0) else Eventually(arg, ahead)


def globally(arg: Formula, ahead: Interval = EVER) -> Formula:
    """`G[ahead] arg`."""
    return arg if isinstance(arg, Const) or ahead == Interval(0, 0) else Globally(arg, ahead)


def until(left: Formula, right: Formula) -> Formula:
    """`left U right`."""
    if left == FALSE or isinstance(right, Const):
        return right
    return eventually(right) if left == TRUE else Until(left, right)


def release(left: Formula, right: Formula) -> Formula:
    """`left R right`."""
    if left == TRUE or isinstance(right, Const):
        return right
    return globally(right) if left == FALSE else Release(left, right)


def children(f: Formula) -> tuple[Formula, ...]:
    """The direct sub-formulas, left to right."""
    match f:
        case Const() | Atom() | Last():
            return ()
        case And(args) | Or(args):
            return args
        case Not(arg) | Previous(arg) | WeakPrevious(arg) | Next(arg) | ProbabilityBound(_, _, arg):
            return (arg,)
        case Once(arg, _) | Historically(arg, _) | Eventually(arg, _) | Globally(arg, _):
            return (arg,)
        case Xor(left, right) | Implies(left, right) | Iff(left, right):
            return (left, right)
        case Since(left, right, _) | Until(left, right) | Release(left, right):
            return (left, right)
        case _:
            assert_never(f)


def rebuild(f: Formula, change: Callable[[Formula], Formula]) -> Formula:
    """The same operator over changed sub-formulas, built anew and so folded anew."""
    match f:
        case Const() | Atom() | Last():
            return f
        case And(args):
            return and_(*map(change, args))
        case Or(args):
            return or_(*map(change, args))
        case Xor(left, right):
            return xor(change(left), change(right))
        case Implies(left, right):
            return implies(change(left), change(right))
        case Iff(left, right):
            return iff(change(left), change(right))
        case Since(left, right, ago):
            return since(change(left), change(right), ago)
        case Until(left, right):
            return until(change(left), change(right))
        case Release(left, right):
            return release(change(left), change(right))
        case ProbabilityBound(op, bound, arg):
            return ProbabilityBound(op, bound, change(arg))
        case _:
            return _rebuild_unary(f, change)


def _rebuild_unary(
    f: Not | Previous | WeakPrevious | Once | Historically | Next | Eventually | Globally,
    change: Callable[[Formula], Formula],
) -> Formula:
    match f:
        case Not(arg):
            return not_(change(arg))
        case Previous(arg):
            return previous(change(arg))
        case WeakPrevious(arg):
            return weak_previous(change(arg))
        case Once(arg, ago):
            return once(change(arg), ago)
        case Historically(arg, ago):
            return historically(change(arg), ago)
        case Next(arg):
            return next_(change(arg))
        case Eventually(arg, ahead):
            return eventually(change(arg), ahead)
        case Globally(arg, ahead):
            return globally(change(arg), ahead)
        case _:
            assert_never(f)


def endless(f: Formula) -> Formula:
    """The formula on infinite traces: there is no last tick."""
    return FALSE if f == LAST else rebuild(f, endless)


def atoms(f: Formula) -> Iterator[str]:
    """The names of all atoms, in the order of their first appearance, without repetitions."""
    names: dict[str, None] = {}
    waiting = [f]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Atom):
            names[part.name] = None
        waiting.extend(reversed(children(part)))
    return iter(names)


def longest_bound(f: Formula) -> int:
    """The largest number of ticks that an operator of the formula counts; 0 for none."""
    longest = 0
    waiting = [f]
    while waiting:
        part = waiting.pop()
        match part:
            case Once(_, interval) | Historically(_, interval) | Since(_, _, interval):
                longest = max(longest, interval.lo, interval.hi or 0)
            case Eventually(_, interval) | Globally(_, interval):
                longest = max(longest, interval.lo, interval.hi or 0)
            case _:
                pass
        waiting.extend(children(part))
    return longest
