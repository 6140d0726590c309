"""The definition of every temporal operator, written plainly: slow, for tests.

The product uses it only to check short example traces; tests compare the fast evaluation with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from compiler.logic import formula as f

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
