"""The definition of every temporal operator, written plainly: slow, for tests.

There is one for finite and one for endless traces. The product uses them only to check short
example traces; tests compare the fast evaluation with the first, and the second with Spot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from compiler.logic import formula as f
from fretish.classes.frozen import dataclass

Valuation = Mapping[str, bool]


def holds(formula: f.Formula, trace: Sequence[Valuation], at: int = 0) -> bool:
    """Whether the formula holds at a tick of a finite trace.

    Past operators look back to tick 0. Future operators see the ticks `at..len(trace)-1`: a
    future tick that does not exist satisfies nothing, so `X` and `F` are strong and `G` ranges
    over the ticks that exist. `LAST` marks the last one.

    Args:
        formula: any formula.
        trace: one valuation per tick, at least one.
        at: the tick, `0..len(trace)-1`.

    Raises:
        ValueError: the formula speaks of probabilities.
    """
    match formula:
        case f.Const(value):
            return value
        case f.Atom(name):
            return trace[at][name]
        case f.Last():
            return at == len(trace) - 1
        case f.Not(arg):
            return not holds(arg, trace, at)
        case f.And(args):
            return all(holds(arg, trace, at) for arg in args)
        case f.Or(args):
            return any(holds(arg, trace, at) for arg in args)
        case f.Xor(left, right):
            return holds(left, trace, at) is not holds(right, trace, at)
        case f.Implies(left, right):
            return not holds(left, trace, at) or holds(right, trace, at)
        case f.Iff(left, right):
            return holds(left, trace, at) is holds(right, trace, at)
        case f.ProbabilityBound():
            raise ValueError("one trace does not show a probability")
        case f.Next() | f.Eventually() | f.Globally() | f.Until() | f.Release():
            return _future(formula, trace, at)
        case _:
            return _past(formula, trace, at)


def _past(
    formula: f.Previous | f.WeakPrevious | f.Once | f.Historically | f.Since,
    trace: Sequence[Valuation],
    at: int,
) -> bool:
    match formula:
        case f.Previous(arg):
            return at > 0 and holds(arg, trace, at - 1)
        case f.WeakPrevious(arg):
            return at == 0 or holds(arg, trace, at - 1)
        case f.Once(arg, ago):
            return any(holds(arg, trace, j) for j in _ago(ago, at))
        case f.Historically(arg, ago):
            return all(holds(arg, trace, j) for j in _ago(ago, at))
        case f.Since(left, right, ago):
            return any(
                holds(right, trace, j) and all(holds(left, trace, k) for k in range(j + 1, at + 1))
                for j in _ago(ago, at)
            )
        case _:
            assert_never(formula)


def _future(
    formula: f.Next | f.Eventually | f.Globally | f.Until | f.Release,
    trace: Sequence[Valuation],
    at: int,
) -> bool:
    ahead = range(at, len(trace))
    match formula:
        case f.Next(arg):
            return at + 1 < len(trace) and holds(arg, trace, at + 1)
        case f.Eventually(arg, within):
            return any(holds(arg, trace, j) for j in ahead if _inside(within, j - at))
        case f.Globally(arg, within):
            return all(holds(arg, trace, j) for j in ahead if _inside(within, j - at))
        case f.Until(left, right):
            return any(
                holds(right, trace, j) and all(holds(left, trace, k) for k in range(at, j))
                for j in ahead
            )
        case f.Release(left, right):
            return all(
                holds(right, trace, j) or any(holds(left, trace, k) for k in range(at, j))
                for j in ahead
            )
        case _:
            assert_never(formula)


def _inside(interval: f.Interval, distance: int) -> bool:
    return interval.lo <= distance and (interval.hi is None or distance <= interval.hi)


def _ago(ago: f.Interval, at: int) -> range:
    """The ticks `lo..hi` before `at` that exist."""
    first = 0 if ago.hi is None else max(0, at - ago.hi)
    return range(first, at - ago.lo + 1)


def holds_on_lasso(
    formula: f.Formula, prefix: Sequence[Valuation], loop: Sequence[Valuation]
) -> bool:
    """Whether an endless trace satisfies a future-time formula.

    Args:
        formula: without past operators, `LAST` and probabilities.
        prefix: one valuation for each of the first ticks.
        loop: the ticks that repeat for ever, at least one.

    Raises:
        ValueError: the formula has another operator.

    Source: Pnueli, The temporal logic of programs, FOCS 1977 (the operators); Markey and
    Schnoebelen, Model checking a path, CONCUR 2003 (paths that repeat themselves).
    """
    return _Lasso((*prefix, *loop), len(prefix)).values(formula)[0]


@dataclass(frozen=True, slots=True)
class _Lasso:
    """The ticks `0..len(ticks)-1`, of which those from `start` on repeat."""

    ticks: Sequence[Valuation]
    start: int

    def place(self, tick: int) -> int:
        """The place of any tick among the given ones."""
        if tick < len(self.ticks):
            return tick
        return self.start + (tick - self.start) % (len(self.ticks) - self.start)

    def values(self, formula: f.Formula) -> list[bool]:
        """The value of the formula at each place."""
        places = range(len(self.ticks))
        parts = [self.values(part) for part in f.children(formula)]
        match formula:
            case f.Const(value):
                return [value] * len(places)
            case f.Atom(name):
                return [valuation[name] for valuation in self.ticks]
            case f.Not():
                return [not value for value in parts[0]]
            case f.And():
                return [all(part[i] for part in parts) for i in places]
            case f.Or():
                return [any(part[i] for part in parts) for i in places]
            case f.Xor():
                return [parts[0][i] is not parts[1][i] for i in places]
            case f.Implies():
                return [not parts[0][i] or parts[1][i] for i in places]
            case f.Iff():
                return [parts[0][i] is parts[1][i] for i in places]
            case f.Next():
                return [parts[0][self.place(i + 1)] for i in places]
            case f.Eventually(_, within):
                return [any(parts[0][j] for j in self._window(i, within)) for i in places]
            case f.Globally(_, within):
                return [all(parts[0][j] for j in self._window(i, within)) for i in places]
            case f.Until():
                return [self._until(parts[0], parts[1], i) for i in places]
            case f.Release():  # the dual of `until`
                left, right = ([not value for value in part] for part in parts)
                return [not self._until(left, right, i) for i in places]
            case _:
                raise ValueError(f"no formula about endless traces: {formula}")

    def _window(self, tick: int, within: f.Interval) -> list[int]:
        """The places of the ticks in a window; those of the loop need no second round."""
        last = within.lo + len(self.ticks) - 1
        if within.hi is not None:
            last = min(last, within.hi)
        return [self.place(tick + distance) for distance in range(within.lo, last + 1)]

    def _until(self, left: Sequence[bool], right: Sequence[bool], tick: int) -> bool:
        """Whether `right` becomes true, and `left` is true at all ticks before."""
        for place in self._window(tick, f.EVER):
            if right[place] or not left[place]:
                return right[place]
        return False
