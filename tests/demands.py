"""Demands of a trace, tick by tick, from the definition: triggers, answers, open, violations.

As `tests/meaning.py`, it shares nothing with the formalizer: it treats every demand by itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tests import meaning
from tests.strategies import Template

Column = Sequence[bool]

_OPPOSITE = {
    "null": ("never", False),
    "eventually": ("never", False),
    "never": ("eventually", False),
    "always": ("eventually", True),
    "within": ("for", True),
    "for": ("within", True),
    "until": ("before", True),
    "before": ("until", True),
    "immediately": ("immediately", True),
    "next": ("next", True),
    "finally": ("finally", True),
    "after": ("not after", False),
}
"""What an `only` scope demands in place of a timing, and whether of the opposite response."""

_ENDLESS = ("null", "after", "onlyBefore")
"""Scopes whose interval lasts for ever once it has begun."""


@dataclass(frozen=True)
class Demands:
    """The fields of an outcome about single demands."""

    triggers: tuple[int, ...]
    answers: tuple[tuple[int, int], ...]
    violations: tuple[tuple[int, int], ...]
    open: tuple[tuple[int, int | None], ...] | None
    """None where a demand has been broken: nothing is promised of those that follow."""


def demands_of(template: Template, columns: Mapping[str, Column]) -> Demands:
    """The demands of one template on one trace."""
    m, p, q, s = (columns.get(name, columns["q"]) for name in "mpqs")
    timing, negated = template.timing, False
    if template.scope.startswith("only"):
        timing, negated = _OPPOSITE[timing]
    q = [value is not negated for value in q]
    last = len(q) - 1
    demands = [
        _Demand(timing, template.n, t, right, last, q, s)
        for left, right in meaning.intervals(template.scope, m)
        for t in meaning.triggers(template.condition, p, left, right)
    ]
    broken = {k for demand in demands for k in range(last + 1) if demand.broken(k)}
    if timing == "after" and template.scope in _ENDLESS:
        broken |= {b.t for a in demands for b in demands if a.t < b.t and not any(q[a.t : b.t])}
    return Demands(
        tuple(demand.t for demand in demands),
        tuple(pair for demand in demands for pair in demand.answers()),
        tuple(_runs(sorted(broken))),
        None if broken else tuple(d.as_open() for d in demands if d.is_open()),
    )


def _runs(ticks: Sequence[int]) -> Iterator[tuple[int, int]]:
    first = before = None
    for tick in ticks:
        if first is None or before is None:
            first = tick
        elif tick != before + 1:
            yield first, before
            first = tick
        before = tick
    if first is not None and before is not None:
        yield first, before


@dataclass(frozen=True)
class _Demand:
    """One demand, of a trigger at `t` in an interval that ends at `right`."""

    timing: str
    n: int
    t: int
    right: int
    last: int
    q: Column
    s: Column

    def broken(self, k: int) -> bool:
        """Whether it is broken at tick k, or overdue there and not answered."""
        t, n, q = self.t, self.n, self.q
        inside, left = t <= k <= self.right, k == self.right + 1
        silent, stopped = not any(q[t : k + 1]), any(self.s[t:k])
        match self.timing:
            case "immediately":
                return k == t and not q[k]
            case "next":
                return inside and k == t + 1 and not q[k]
            case "finally":
                return left and not q[k - 1]
            case "null" | "eventually":
                return left and not any(q[t:k])
            case "always":
                return inside and not q[k]
            case "never":
                return inside and q[k]
            case "within":
                return inside and k >= t + n and silent
            case "for":
                return inside and k <= t + n and not q[k]
            case "after":
                return inside and (q[k] if k <= t + n else silent)
            case "not after":
                return inside and k == t + n + 1 and q[k] and not any(q[t:k])
            case "until":
                return inside and not stopped and not self.s[k] and not q[k]
            case _:
                return inside and self.s[k] and not any(q[t:k])  # at each stop

    @property
    def deadline_ticks(self) -> int | None:
        """Ticks up to the last one that decides it."""
        counted = {"immediately": 0, "next": 1, "within": self.n, "for": self.n}
        return counted.get(self.timing, self.n + 1 if "after" in self.timing else None)

    def answers(self) -> Iterator[tuple[int, int]]:
        """The first response, where it waits for one, up to the deadline."""
        if self.timing not in ("null", "eventually", "within", "after"):
            return
        end = (
            self.right
            if self.deadline_ticks is None
            else min(self.right, self.t + self.deadline_ticks)
        )
        first = next((k for k in range(self.t, end + 1) if self.q[k]), None)
        if first is not None:
            yield self.t, first

    def is_open(self) -> bool:
        """Whether what follows the trace decides it."""
        if self.right != self.last:
            return False
        silent = not any(self.q[self.t :])
        waited = self.last - self.t
        match self.timing:
            case "next" | "for":
                return self.deadline_ticks is not None and waited < self.deadline_ticks
            case "finally":
                return True
            case "null" | "eventually":
                return silent
            case "within" | "after" | "not after":
                return silent and self.deadline_ticks is not None and waited < self.deadline_ticks
            case _:
                return False

    def as_open(self) -> tuple[int, int | None]:
        return self.t, None if self.deadline_ticks is None else self.t + self.deadline_ticks
