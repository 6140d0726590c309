"""Assign arriving messages to ticks, live and in a log alike.

A message has a *time*, on the clock that the bindings declare, and an *arrival*: the time at which
the watch or the recorder received it. Both are whole nanoseconds. If the declared clock is that of
arrivals, both are equal, and no message is late.

**Grid.** Ticks lie at `origin + phase + k * period`, k = 0, 1, ... The origin is the time of the
first message; or of the first message of the last topic to begin, if that is less than a period
later, so that all topics are known at the first tick (`origin`). It depends on the times of
messages, never on a timer. A watch fixes it once and writes it into the recording; an audit of the
recording reads it from there. If the clock ticks by message, each message of its topic is a tick,
and there is no grid.

**Evaluation.** Tick T sees every message with a time up to T. It is evaluated when all messages
with an arrival up to T + lateness have been received: as soon as a later message arrives, or, if
none arrives, by a timer (`Ticking.until` with the present time minus the lateness).

**Late.** A message is late for the ticks at or after its time that were evaluated before it
arrived: `time <= T < arrival - lateness` (`late`). Propositions that read its topic become unknown
at these ticks; later ticks see the message as if it had been in time. An evaluated tick changes in
no other way: it may become unknown (`Ledger.withdraw`), but never takes the opposite value. A late
message of the clock's topic makes all propositions unknown there, and is itself a tick
(`Ledger.insert`).

**Order.** Messages are processed in order of time; messages of one topic with equal times in order
of arrival. For several topics, the first messages of that time are processed together, then the
second ones, so the order of topics has no effect. Ages and durations are differences of times, to
the nanosecond: a timer decides when a tick is evaluated, but not what it sees.

**Jumps.** If the time of a message is more than `JUMP` before the latest one of its topic, it is
not late: its clock was set back (`is_jump`). A new run begins, with a new grid and new monitors. A
watch reports and counts this.

**Stop requests** do not wait for the next tick: a copy of the monitor is stepped as if there were a
tick now, and the robot stops unless certainly no obligation is open.

The text of this module is copied into emitted nodes: it needs the standard library only.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, Protocol

JUMP = 10**9
"""Nanoseconds; if a time goes back by more than this, a clock was set."""


def origin(start: int, firsts: "Iterable[int]", period: int) -> int:
    """The time at which the grid begins at phase 0.

    Args:
        start: the first time of the log.
        firsts: the first time of each topic that has a message.
        period: the length of a tick.
    """
    last = max(firsts, default=start)
    return last if 0 <= last - start < period else start


def late(time: int, arrival: int, lateness: int) -> "tuple[int, int] | None":
    """The first and last time of ticks that miss a late message; None if it is in time."""
    last = arrival - lateness - 1
    return (time, last) if time <= last else None


def is_jump(latest: "int | None", time: int) -> bool:
    """Whether a topic's clock was set back, given its latest time so far."""
    return latest is not None and time < latest - JUMP


class Ticking:
    """Computes the times of ticks while messages arrive, in any order.

    The grid is fixed as soon as no message can move it: when all topics have begun, or one period
    after the first message.
    """

    def __init__(
        self,
        topics: "Collection[str]",
        period: "int | None",
        phase: int = 0,
        clock: "str | None" = None,
    ) -> None:
        """Start before the first message.

        Args:
            topics: the topics for whose first message the grid waits.
            period: the length of a tick; None: each message of `clock` is a tick.
            phase: from the origin to the first tick, less than a period.
            clock: the topic that the clock ticks by.
        """
        self._topics = frozenset(topics)
        self._period, self._phase, self._clock = period, phase, clock
        self._firsts: dict[str, int] = {}
        self._clock_times: list[int] = []
        """Times of messages of the clock's topic that are not evaluated as ticks yet."""
        self.passed = 0
        """Only late messages can have an earlier time than this."""
        self.last: int | None = None
        """The time of the last evaluated tick."""
        self.origin: int | None = None
        """The time at which the grid begins; None before the first evaluated tick."""

    def arrive(self, topic: str, time: int) -> None:
        """Process a message of a relevant topic that is not late."""
        self._firsts[topic] = min(time, self._firsts.get(topic, time))
        if topic == self._clock:
            self._clock_times.insert(bisect_right(self._clock_times, time), time)

    @property
    def start(self) -> "int | None":
        """The earliest time of all messages so far."""
        return min(self._firsts.values(), default=None)

    @property
    def waiting(self) -> "tuple[str, ...]":
        """The topics without a message that prevent the grid from being fixed."""
        if self._period is None or self.last is not None:
            return ()
        begun = self._begun(self.passed)
        if not begun or self._origin(self.passed, ended=False) is not None:
            return ()
        return tuple(sorted(self._topics - begun.keys()))

    def due(self, passed: int) -> "Sequence[int]":
        """The times of the ticks before `passed` that are not evaluated yet."""
        return self._before(max(passed, self.passed), ended=False)

    def until(self, passed: int) -> "Sequence[int]":
        """Advance to `passed`; the times of the ticks that are evaluated now."""
        times = self.due(passed)
        self.passed = max(passed, self.passed)
        return self._judged(times)

    def ending(self, end: int) -> "Sequence[int]":
        """The remaining ticks if the log ended at `end`, without advancing."""
        return self._before(max(end + 1, self.passed), ended=True)

    def end(self, end: int) -> "Sequence[int]":
        """The remaining ticks of a log that ends at `end`."""
        times = self.ending(end)
        self.passed = max(end + 1, self.passed)
        return self._judged(times)

    def _judged(self, times: "Sequence[int]") -> "Sequence[int]":
        if not times:
            return times
        if self.last is None and self._period is not None:
            self.origin = times[0] - self._phase
        self.last = times[-1]
        del self._clock_times[: bisect_right(self._clock_times, self.last)]
        return times

    def _before(self, passed: int, *, ended: bool) -> "Sequence[int]":
        if self._period is None:
            return self._clock_times[: bisect_left(self._clock_times, passed)]
        if self.last is not None:
            return range(self.last + self._period, passed, self._period)
        found = self._origin(passed, ended=ended)
        return range(0) if found is None else range(found + self._phase, passed, self._period)

    def _begun(self, passed: int) -> "dict[str, int]":
        """Topic that began before `passed` -> the time of its first message."""
        return {topic: first for topic, first in self._firsts.items() if first < passed}

    def _origin(self, passed: int, *, ended: bool) -> "int | None":
        """The time at which the grid begins; None while later messages can change it.

        A topic that has not begun can move it back to the start of the log, and, less than a period
        after that, forward to its own first message.
        """
        begun = self._begun(passed)
        if self._period is None or not begun:
            return None
        start = min(begun.values())
        found = origin(start, (begun[each] for each in begun if each in self._topics), self._period)
        if ended or self._topics <= begun.keys():
            return found
        return start if passed >= start + self._period and found == start else None


class Steppable(Protocol):
    """The interface of a monitor that a ledger uses."""

    def advance(self, rows: "Sequence[Mapping[str, Any]]") -> object:
        """Step over rows, each with the truth of propositions at one tick."""

    def state(self) -> "Mapping[str, Any]":
        """The complete state."""

    def restore(self, state: "Mapping[str, Any]", /) -> object:
        """Restore a state."""


class Ledger:
    """Steps monitors, and steps them again if earlier ticks become unknown."""

    def __init__(self, monitors: "Sequence[Steppable]", kept: int = 0) -> None:
        """Start before the first tick.

        Args:
            monitors: the monitors; only the ledger may step them.
            kept: the number of last ticks that can become unknown; 0: all.
        """
        self._monitors, self._kept = tuple(monitors), kept
        self._times: list[int] = []
        self._rows: list[Mapping[str, bool | None]] = []
        self._states = [(0, self._state())]
        """Indices of rows, with the states of the monitors before them."""
        self._late: set[int] = set()
        """The times of kept ticks that became unknown after their evaluation."""
        self._dropped_late = 0
        """The number of such ticks that were dropped."""
        self.beyond = 0
        """The number of late messages for dropped ticks, whose results stay unchanged."""
        self._dropped = 0
        """The number of dropped ticks."""
        self._before: int | None = None
        """The time of the last dropped tick."""

    def __len__(self) -> int:
        """The number of ticks."""
        return self._dropped + len(self._times)

    @property
    def late(self) -> int:
        """The number of ticks that became unknown after their evaluation."""
        return self._dropped_late + len(self._late)

    @property
    def last(self) -> "Mapping[str, bool | None] | None":
        """The row of the last tick."""
        return self._rows[-1] if self._rows else None

    def row(self, tick: int) -> "Mapping[str, bool | None]":
        """The row of a kept tick."""
        return self._rows[tick - self._dropped]

    def time(self, tick: int) -> "int | None":
        """The time of a tick; None if it was dropped."""
        index = tick - self._dropped
        return self._times[index] if 0 <= index < len(self._times) else None

    def _state(self) -> "tuple[Mapping[str, Any], ...]":
        return tuple(monitor.state() for monitor in self._monitors)

    def advance(self, time: int, row: "Mapping[str, bool | None]") -> None:
        """Step all monitors by one tick."""
        if len(self._rows) - self._states[-1][0] >= _APART:
            self._states.append((len(self._rows), self._state()))
            self._forget()
        self._times.append(time)
        self._rows.append(row)
        for monitor in self._monitors:
            monitor.advance((row,))

    def withdraw(self, first: int, last: int, propositions: "Collection[str]") -> int:
        """Make propositions unknown at the ticks from `first` to `last`, as given by `late`.

        Returns:
            The number of ticks at which one of them was known before.
        """
        if self._before is not None and first <= self._before:
            self.beyond += 1
        start, stop = bisect_left(self._times, first), bisect_right(self._times, last)
        changed = [
            i
            for i in range(start, stop)
            if any(self._rows[i].get(name) is not None for name in propositions)
        ]
        for i in changed:
            self._rows[i] = {**self._rows[i], **dict.fromkeys(propositions)}
        if changed:
            self._again(changed[0])
        self._late.update(self._times[i] for i in changed)
        return len(changed)

    def insert(self, time: int, propositions: "Collection[str]") -> None:
        """Insert a tick among the evaluated ones, or after them, with all propositions unknown.

        Args:
            time: the time of the tick.
            propositions: the names of all propositions.
        """
        if self._before is not None and time < self._before:
            self.beyond += 1
            return
        index = bisect_right(self._times, time)
        self._times.insert(index, time)
        self._rows.insert(index, dict.fromkeys(propositions))
        self._late.add(time)
        self._again(index)

    def _again(self, index: int) -> None:
        """Step the monitors again over the rows from an index on."""
        while self._states[-1][0] > index:
            self._states.pop()
        begin, states = self._states[-1]
        for monitor, state in zip(self._monitors, states):
            monitor.restore(state)
            monitor.advance(self._rows[begin:])

    def _forget(self) -> None:
        """Drop rows that need not be kept, up to a stored state of the monitors."""
        spare = len(self._rows) - self._kept if self._kept else 0
        drop = max((index for index, _ in self._states if index <= spare), default=0)
        if not drop:
            return
        self._before, self._dropped = self._times[drop - 1], self._dropped + drop
        dropped = self._late.intersection(self._times[:drop])
        self._late -= dropped
        self._dropped_late += len(dropped)
        del self._times[:drop], self._rows[:drop]
        self._states = [(index - drop, state) for index, state in self._states if index >= drop]


_APART = 64
"""The number of ticks between two stored states of the monitors."""
