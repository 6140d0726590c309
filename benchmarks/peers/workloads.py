"""What is monitored: four formulas, their meaning tick by tick, and traces of any length."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.bool_]
Columns = Mapping[str, Column]
"""Signals by name; index i is tick i. All have the same length."""

VIOLATED_AT = 0.7
"""Where in a trace the first violation comes, so that most of it is monitored undecided."""


@dataclass(frozen=True)
class Workload:
    """A formula. Its truth at a tick is that of `past`, which needs the ticks up to there alone."""

    name: str
    formula: str
    past: str
    signals: str
    holds: Callable[[Columns, int], bool]
    """The truth at a tick, from the definition: slow, and trusted."""
    random: Callable[[np.random.Generator, int], Columns]

    def truths(self, columns: Columns) -> list[bool]:
        """The truth at each tick, from the definition."""
        return [self.holds(columns, tick) for tick in range(len(columns["a"]))]

    def columns(self, ticks: int, seed: int = 0) -> Columns:
        """A trace, the same for the same seed."""
        return self.random(np.random.default_rng(seed), ticks)


def _answered(columns: Columns, tick: int) -> bool:
    a, b = columns["a"], columns["b"]
    return all(b[i : tick + 1].any() for i in range(tick + 1) if a[i])


def _answered_in_time(columns: Columns, tick: int) -> bool:
    a, b = columns["a"], columns["b"]
    return all(b[i : i + 11].any() for i in range(tick - 9) if a[i])


def _recent(columns: Columns, tick: int) -> bool:
    a, b = columns["a"], columns["b"]
    return all(b[max(0, i - 100) : i + 1].any() for i in range(tick + 1) if a[i])


def _kept_since(columns: Columns, tick: int) -> bool:
    a, b, c = (columns[name] for name in "abc")
    rises = (i for i in range(1, tick + 1) if a[i] and not a[i - 1])
    return all(any(b[j] and not c[j + 1 : i + 1].any() for j in range(i + 1)) for i in rises)


def _spaced(rng: np.random.Generator, ticks: int, mean: float, most: int) -> Column:
    """True at tick 0 and then at random ticks, never more than `most` apart."""
    steps = np.minimum(rng.geometric(1 / mean, ticks), most)
    column = np.zeros(ticks, dtype=np.bool_)
    at = np.cumsum(steps) - steps[:1]
    column[at[at < ticks]] = True
    return column


def _responses(rng: np.random.Generator, ticks: int) -> Columns:
    """Triggers at a fifth of the ticks, answered within 10 ticks but for one."""
    a, b = rng.random(ticks) < 0.2, _spaced(rng, ticks, 5, 11)
    late = int(VIOLATED_AT * ticks)
    a[late : late + 1], b[late : late + 11] = True, False
    return {"a": a, "b": b}


def _reminders(rng: np.random.Generator, ticks: int) -> Columns:
    """Triggers at a fifth of the ticks, each within 100 ticks after some b but for a few."""
    a, b = rng.random(ticks) < 0.2, _spaced(rng, ticks, 30, 101)
    late = int(VIOLATED_AT * ticks)
    a[late : late + 1], b[max(0, late - 100) : late + 1] = True, False
    return {"a": a, "b": b}


def _phases(rng: np.random.Generator, ticks: int) -> Columns:
    """Phases of a of 10 ticks on average, which begin where no c came after the last b but once."""
    a = np.logical_xor.accumulate(rng.random(ticks) < 0.1)
    b, c = rng.random(ticks) < 0.1, rng.random(ticks) < 0.05
    index = np.arange(ticks)
    last_b, last_c = (np.maximum.accumulate(np.where(column, index, -1)) for column in (b, c))
    rises = a & ~np.concatenate(([True], a[:-1]))
    b |= rises & ((last_b < 0) | (last_b < last_c))
    late = int(VIOLATED_AT * ticks)
    a[max(0, late - 1) : late], a[late : late + 1] = False, True
    b[late : late + 1], c[late : late + 1] = False, True
    return {"a": a, "b": b, "c": c}


WORKLOADS = {
    workload.name: workload
    for workload in (
        Workload("W1", "G(a -> F b)", "!(!b S (a & !b))", "ab", _answered, _responses),
        Workload(
            "W2",
            "G(a -> F[0,10] b)",
            "H(O[10,10] a -> O[0,10] b)",
            "ab",
            _answered_in_time,
            _responses,
        ),
        Workload("W3", "H(a -> O[0,100] b)", "H(a -> O[0,100] b)", "ab", _recent, _reminders),
        Workload(
            "W4",
            "H((a & Y !a) -> (!c S b))",
            "H((a & Y !a) -> (!c S b))",
            "abc",
            _kept_since,
            _phases,
        ),
    )
}
"""By name. `Y` is false at the first tick; `O[10,10]` in the first ten."""


def letters(columns: Columns) -> bytes:
    """One number a tick: a + 2 b + 4 c."""
    some = next(iter(columns.values()))
    total = np.zeros(len(some), dtype=np.uint8)
    for place, name in enumerate("abc"):
        if name in columns:
            total |= columns[name].view(np.uint8) << place
    return total.tobytes()


def rows(columns: Columns) -> list[Mapping[str, bool]]:
    """A mapping a tick, as a program has its inputs when it calls a monitor tick by tick."""
    names = list(columns)
    each = zip(*(columns[name].tolist() for name in names), strict=True)
    return [dict(zip(names, values, strict=True)) for values in each]
