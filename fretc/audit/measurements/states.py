"""The state of one requirement over a run: the ticks at which it changes."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Iterator

from monitors.kernel import Outcome

IDLE, OPEN, VIOLATED, UNKNOWN = "idle", "open", "violated", "unknown"
"""No open demand; a response is awaited; a demand is broken; it is unknown whether one is."""
_VIOLATED, _UNKNOWN, _OPEN = 1, 2, 4
_STATES = (IDLE, VIOLATED, UNKNOWN, VIOLATED, OPEN, VIOLATED, UNKNOWN, VIOLATED)
"""The state for a sum of these flags: if there are several at one tick, the first one counts."""


def states(outcome: Outcome) -> tuple[tuple[int, str], ...]:
    """Each tick at which the state changes, with the new state; the first one is tick 0."""
    edges: defaultdict[int, int] = defaultdict(int)
    edges[0] = 0
    for state, runs in (
        (_VIOLATED, outcome.violations),
        (_UNKNOWN, outcome.unknown),
        (_OPEN, _waits(outcome)),
    ):
        for first, last in _union(runs):
            edges[first] ^= state
            edges[last + 1] ^= state
    changes: list[tuple[int, str]] = []
    now = 0
    for tick in sorted(tick for tick in edges if tick < outcome.ticks):
        now ^= edges[tick]
        if not changes or changes[-1][1] != _STATES[now]:
            changes.append((tick, _STATES[now]))
    return tuple(changes)


def _waits(outcome: Outcome) -> Iterator[tuple[int, int]]:
    """The ticks at which the answer to a trigger is awaited, trigger by trigger."""
    end_of = dict(outcome.answers) | {trigger: outcome.ticks for trigger, _ in outcome.open}
    violations = [first for first, _ in outcome.violations]
    for trigger in outcome.triggers:
        end = end_of.get(trigger)
        if end is None:
            index = bisect_left(violations, trigger)
            end = violations[index] if index < len(violations) else trigger
        if end > trigger:
            yield trigger, end - 1


def _union(runs: Iterable[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """The union of intervals, in order and without overlaps."""
    first, last = 0, -1
    for begin, end in runs:
        if begin <= last:
            last = max(last, end)
            continue
        if first <= last:
            yield first, last
        first, last = begin, end
    if first <= last:
        yield first, last
