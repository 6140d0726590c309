"""The meaning of FRETish written down directly: intervals, triggers, timings; no formula.

Source: FRETish semantics as published by NASA FRET (Giannakopoulou et al., IST 137, 2021,
sections 3 and 4). Traces are finite; a tick is an index; nothing here is shared with the
formalizer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache

Column = Sequence[bool]
Interval = tuple[int, int]

SCOPES = ("null", "in", "notin", "before", "after", "onlyIn", "onlyBefore", "onlyAfter")
CONDITIONS = ("null", "regular", "holding")
TIMINGS = (
    "null", "immediately", "next", "finally", "eventually", "always", "never", "within", "for",
    "after", "until", "before",
)  # fmt: skip
COUNTING = ("within", "for", "after")


def satisfied(
    scope: str, condition: str, timing: str, n: int, m: Column, p: Column, q: Column, s: Column
) -> bool:
    """Whether a finite trace satisfies the template.

    Args:
        scope, condition, timing: FRET's keys.
        n: what a counting timing counts, in ticks.
        m, p, q, s: mode, condition, response and stop condition, one value a tick.
    """
    demand = _NEGATED[timing] if scope.startswith("only") else _DEMANDS[timing]
    return all(
        demand(t, right, n, q, s)
        for left, right in _intervals(scope, tuple(m))
        for t in triggers(condition, p, left, right)
    )


def intervals(scope: str, m: Column) -> Iterator[Interval]:
    """The stretches of ticks, both ends included, on which the scope is active."""
    last = len(m) - 1
    first_mode = next((t for t in range(len(m)) if m[t]), None)
    first_end = next((t for t in range(len(m) - 1) if m[t] and not m[t + 1]), None)
    if scope == "null":
        yield 0, last
    elif scope == "in":
        yield from _runs(m)
    elif scope in ("notin", "onlyIn"):
        yield from _runs([not value for value in m])
    elif scope == "before" and first_mode != 0:
        yield 0, last if first_mode is None else first_mode - 1
    elif scope == "after" and first_end is not None:
        yield first_end + 1, last
    elif scope == "onlyBefore" and first_mode is not None:
        yield first_mode, last
    elif scope == "onlyAfter":
        yield 0, last if first_end is None else first_end


@lru_cache(2**14)
def _intervals(scope: str, m: tuple[bool, ...]) -> tuple[Interval, ...]:
    """Of all traces, many have one column of modes."""
    return tuple(intervals(scope, m))


def _runs(column: Column) -> Iterator[Interval]:
    start: int | None = None
    for t, value in enumerate(column):
        if value and start is None:
            start = t
        if not value and start is not None:
            yield start, t - 1
            start = None
    if start is not None:
        yield start, len(column) - 1


def triggers(condition: str, p: Column, left: int, right: int) -> Iterator[int]:
    """The ticks of an interval at which a demand begins."""
    for t in range(left, right + 1):
        if condition == "null":
            if t == left:
                yield t
        elif condition == "holding":
            if p[t]:
                yield t
        elif p[t] and (t == left or not p[t - 1]):
            yield t


Demand = Callable[[int, int, int, Column, Column], bool]


def _some(column: Column, first: int, last: int) -> bool:
    return any(column[first : last + 1])


def _every(column: Column, first: int, last: int) -> bool:
    return all(column[first : last + 1])


def _first_stop(s: Column, t: int, right: int) -> int | None:
    return next((k for k in range(t, right + 1) if s[k]), None)


def _until(t: int, right: int, n: int, q: Column, s: Column) -> bool:
    stop = _first_stop(s, t, right)
    return _every(q, t, right if stop is None else stop - 1)


def _before(t: int, right: int, n: int, q: Column, s: Column) -> bool:
    stop = _first_stop(s, t, right)
    return stop is None or _some(q, t, stop - 1)


def _after(t: int, right: int, n: int, q: Column, s: Column) -> bool:
    return not _some(q, t, min(t + n, right)) and (t + n + 1 > right or q[t + n + 1])


_DEMANDS: dict[str, Demand] = {
    "immediately": lambda t, right, n, q, s: q[t],
    "next": lambda t, right, n, q, s: t == right or q[t + 1],
    "finally": lambda t, right, n, q, s: q[right],
    "null": lambda t, right, n, q, s: _some(q, t, right),
    "eventually": lambda t, right, n, q, s: _some(q, t, right),
    "always": lambda t, right, n, q, s: _every(q, t, right),
    "never": lambda t, right, n, q, s: not _some(q, t, right),
    "within": lambda t, right, n, q, s: right < t + n or _some(q, t, t + n),
    "for": lambda t, right, n, q, s: _every(q, t, min(t + n, right)),
    "after": _after,
    "until": _until,
    "before": _before,
}


def _negation(q: Column) -> Column:
    return [not value for value in q]


_NEGATED: dict[str, Demand] = {
    "immediately": lambda t, right, n, q, s: not q[t],
    "next": lambda t, right, n, q, s: t == right or not q[t + 1],
    "finally": lambda t, right, n, q, s: not q[right],
    "null": lambda t, right, n, q, s: not _some(q, t, right),
    "eventually": lambda t, right, n, q, s: not _some(q, t, right),
    "always": lambda t, right, n, q, s: not _every(q, t, right),
    "never": lambda t, right, n, q, s: _some(q, t, right),
    "within": lambda t, right, n, q, s: not _some(q, t, min(t + n, right)),
    "for": lambda t, right, n, q, s: right < t + n or not _every(q, t, t + n),
    "after": lambda t, right, n, q, s: (
        right < t + n or _some(q, t, t + n) or not _some(q, t, min(t + n + 1, right))
    ),
    "until": lambda t, right, n, q, s: _before(t, right, n, _negation(q), s),
    "before": lambda t, right, n, q, s: _until(t, right, n, _negation(q), s),
}
