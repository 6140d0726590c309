"""The state of one requirement over a run: when it changes, and to what."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator

from monitors.kernel import Outcome

IDLE, OPEN, VIOLATED, UNKNOWN = "idle", "open", "violated", "unknown"
"""Nothing is demanded that could fail now; an answer is awaited; a demand is broken; it cannot be
known whether one is."""
_FIRST = (VIOLATED, UNKNOWN, OPEN)
"""Of several at one tick the first one counts."""


def states(outcome: Outcome) -> tuple[tuple[int, str], ...]:
    """Each tick at which the state changes, with the new state; the first one is tick 0."""
    changes: dict[int, Counter[str]] = {0: Counter()}
    for state, first, last in _stretches(outcome):
        changes.setdefault(first, Counter())[state] += 1
        changes.setdefault(last + 1, Counter())[state] -= 1
    now: Counter[str] = Counter()
    changes_of_state: list[tuple[int, str]] = []
    for tick in sorted(tick for tick in changes if tick < outcome.ticks):
        now.update(changes[tick])
        state = next((state for state in _FIRST if now[state] > 0), IDLE)
        if not changes_of_state or changes_of_state[-1][1] != state:
            changes_of_state.append((tick, state))
    return tuple(changes_of_state)


def _stretches(outcome: Outcome) -> Iterator[tuple[str, int, int]]:
    """Each state with the ticks of it, both ends included."""
    yield from ((VIOLATED, first, last) for first, last in outcome.violations)
    yield from ((UNKNOWN, first, last) for first, last in outcome.unknown)
    answered = dict(outcome.answers)
    waiting = {trigger for trigger, _ in outcome.open}
    broken = [first for first, _ in outcome.violations]
    for trigger in outcome.triggers:
        if trigger in answered:
            until = answered[trigger]
        elif trigger in waiting:
            until = outcome.ticks
        else:
            place = bisect_left(broken, trigger)
            until = broken[place] if place < len(broken) else trigger
        if until > trigger:
            yield OPEN, trigger, until - 1
