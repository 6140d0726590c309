"""Ticks of messages that arrive: what is seen at which tick, live and in a log alike.

A message has a *time*, on the clock that the bindings declare, and an *arrival*: when who watches,
or who records, received it. Both are whole nanoseconds. Where the clock is that of arrivals the two
are one, and nothing is ever late.

**Grid.** Ticks lie at `origin + phase + k * period`, k = 0, 1, ... The origin is the time of the
first message, or of the first one of the last topic to begin, where that is less than a period
later: no two topics are received at once, and the first tick shall know all of them (`origin`). It
comes of the times of messages and never of a timer. Who watches places it once and writes it into
the recording; who audits the recording takes it from there. Where the clock ticks by message, each
message of its topic is a tick, and there is no grid.

**Judgement.** Tick T sees every message with a time up to T. It is judged when everything has
arrived that arrives up to T + lateness: as soon as something later arrives, or, where nothing
arrives any more, by a timer (`Ticking.until` of the present less the lateness).

**Late.** A message is late for the ticks that lie at its time or after it, and that were judged
before it arrived: `time <= T < arrival - lateness` (`late`). What reads its topic is unknown at
these ticks, whatever was said of them; all later ticks see it as if it had been in time. A tick
that was judged changes in no other way: it may become unknown (`Ledger.withdraw`), and never the
opposite. A late message of the topic that the clock ticks by makes everything unknown there, and
is a tick of its own among them (`Ledger.insert`).

**Order.** Messages are taken by their times, and those of one topic and one time by arrival. Of
several topics the first ones of that time are taken together, then the second ones: no order of
topics is ever seen. Ages and durations are differences of times, to the nanosecond: a timer decides
when a tick is judged, and never what it sees.

**Jumps.** A message whose time is more than `JUMP` before the latest one of its topic is not late:
its clock was set back (`is_jump`). What comes then is another run, with another grid and with
monitors that begin anew. Who watches says so and counts it.

**Demands for a stop** do not wait for the tick: what would be seen if there were a tick now is
stepped by a copy of the monitor, and the robot stops unless nothing is owed for certain.

The text of this module is copied into emitted nodes: it needs the standard library only.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, Protocol

JUMP = 10**9
"""A step back of more than this means that a clock was set: no message is so late."""


def origin(start: int, firsts: Iterable[int], period: int) -> int:
    """Where the grid begins at phase 0.

    Args:
        start: the first time of the log.
        firsts: the first time of each topic that has any message.
        period: of the ticks.
    """
    last = max(firsts, default=start)
    return last if 0 <= last - start < period else start


def late(time: int, arrival: int, lateness: int) -> tuple[int, int] | None:
    """The first and the last time at which a tick does without a message; None: it is in time."""
    last = arrival - lateness - 1
    return (time, last) if time <= last else None


def is_jump(latest: int | None, time: int) -> bool:
    """Whether the clock of a topic was set back, whose latest time so far is given."""
    return latest is not None and time < latest - JUMP


class Ticking:
    """Places the ticks while messages come, in any order.

    The grid is placed as soon as no message can move it any more: where all topics have begun, or
    a period after the first message.
    """

    def __init__(
        self,
        topics: Collection[str],
        period: int | None,
        phase: int = 0,
        clock: str | None = None,
    ) -> None:
        """No message yet.

        Args:
            topics: those whose beginning the grid waits for.
            period: of the ticks; None: each message of `clock` is a tick.
            phase: from the origin to the first tick, less than a period.
            clock: the topic that the clock ticks by.
        """
        self._topics = frozenset(topics)
        self._period, self._phase, self._clock = period, phase, clock
        self._firsts: dict[str, int] = {}
        self._clock_times: list[int] = []
        """Messages of the clock's topic that are no ticks yet."""
        self.passed = 0
        """No message with an earlier time comes any more, but a late one."""
        self.last: int | None = None
        """The last tick that was judged."""
        self.origin: int | None = None
        """Where the grid begins, once a tick was judged."""

    def arrive(self, topic: str, time: int) -> None:
        """A message that is not late, of a topic that counts."""
        self._firsts[topic] = min(time, self._firsts.get(topic, time))
        if topic == self._clock:
            self._clock_times.insert(bisect_right(self._clock_times, time), time)

    @property
    def start(self) -> int | None:
        """The earliest time of all messages so far."""
        return min(self._firsts.values(), default=None)

    @property
    def waiting(self) -> tuple[str, ...]:
        """The topics that are yet to begin, and before which the grid cannot be placed."""
        if self._period is None or self.last is not None:
            return ()
        begun = self._begun(self.passed)
        if not begun or self._origin(self.passed, ended=False) is not None:
            return ()
        return tuple(sorted(self._topics - begun.keys()))

    def due(self, passed: int) -> Sequence[int]:
        """The ticks before `passed` that are still to be judged."""
        return self._before(max(passed, self.passed), ended=False)

    def until(self, passed: int) -> Sequence[int]:
        """Let time pass up to there; the ticks before it are judged now."""
        times = self.due(passed)
        self.passed = max(passed, self.passed)
        return self._judged(times)

    def ending(self, end: int) -> Sequence[int]:
        """The ticks that would be left if the log ended at `end`."""
        return self._before(max(end + 1, self.passed), ended=True)

    def end(self, end: int) -> Sequence[int]:
        """The ticks that are left: nothing comes any more after `end`."""
        times = self.ending(end)
        self.passed = max(end + 1, self.passed)
        return self._judged(times)

    def _judged(self, times: Sequence[int]) -> Sequence[int]:
        if not times:
            return times
        if self.last is None and self._period is not None:
            self.origin = times[0] - self._phase
        self.last = times[-1]
        del self._clock_times[: bisect_right(self._clock_times, self.last)]
        return times

    def _before(self, passed: int, *, ended: bool) -> Sequence[int]:
        if self._period is None:
            return self._clock_times[: bisect_left(self._clock_times, passed)]
        if self.last is not None:
            return range(self.last + self._period, passed, self._period)
        found = self._origin(passed, ended=ended)
        return range(0) if found is None else range(found + self._phase, passed, self._period)

    def _begun(self, passed: int) -> dict[str, int]:
        """The topics that have begun by then, each with its first time."""
        return {topic: first for topic, first in self._firsts.items() if first < passed}

    def _origin(self, passed: int, *, ended: bool) -> int | None:
        """Where the grid begins; None while messages that are still to come decide that.

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
    """What a ledger asks of a monitor."""

    def advance(self, rows: Sequence[Mapping[str, Any]]) -> object:
        """Take rows, each the truth of propositions at one tick."""

    def state(self) -> Mapping[str, Any]:
        """All that it remembers."""

    def restore(self, state: Mapping[str, Any], /) -> object:
        """Go back to a state."""


class Ledger:
    """Monitors with the ticks that they have taken, of which some may become unknown later."""

    def __init__(self, monitors: Sequence[Steppable], kept: int = 0) -> None:
        """No tick yet.

        Args:
            monitors: they are stepped by the ledger alone.
            kept: so many of the last ticks can become unknown; 0: all of them.
        """
        self._monitors, self._kept = tuple(monitors), kept
        self._times: list[int] = []
        self._rows: list[Mapping[str, bool | None]] = []
        self._states = [(0, self._state())]
        """Before which of the rows the monitors were so."""
        self._late: set[int] = set()
        """The kept ticks that have become unknown after they were judged."""
        self._dropped_late = 0
        """Such ticks that are not kept any more."""
        self.beyond = 0
        """Ticks that should have become so and were not kept: what is said of them stands."""
        self._dropped = 0
        """Ticks that are not kept any more."""
        self._before: int | None = None
        """The last of them."""

    def __len__(self) -> int:
        """How many ticks there were."""
        return self._dropped + len(self._times)

    @property
    def late(self) -> int:
        """How many ticks have become unknown after they were judged."""
        return self._dropped_late + len(self._late)

    @property
    def last(self) -> Mapping[str, bool | None] | None:
        """The row of the last tick."""
        return self._rows[-1] if self._rows else None

    def row(self, tick: int) -> Mapping[str, bool | None]:
        """What was seen at a tick that is kept."""
        return self._rows[tick - self._dropped]

    def time(self, tick: int) -> int | None:
        """When a tick was; None where it is not kept."""
        place = tick - self._dropped
        return self._times[place] if 0 <= place < len(self._times) else None

    def _state(self) -> tuple[Mapping[str, Any], ...]:
        return tuple(monitor.state() for monitor in self._monitors)

    def advance(self, time: int, row: Mapping[str, bool | None]) -> None:
        """One tick."""
        if len(self._rows) - self._states[-1][0] >= _APART:
            self._states.append((len(self._rows), self._state()))
            self._forget()
        self._times.append(time)
        self._rows.append(row)
        for monitor in self._monitors:
            monitor.advance((row,))

    def withdraw(self, first: int, last: int, propositions: Collection[str]) -> int:
        """Let propositions be unknown at the ticks from `first` to `last`, times that `late` gave.

        Returns:
            At how many ticks one of them was known before.
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

    def insert(self, time: int, propositions: Collection[str]) -> None:
        """A tick among those that were judged, or right after them: nothing is known of it.

        Args:
            time: of the tick.
            propositions: all that there are.
        """
        if self._before is not None and time < self._before:
            self.beyond += 1
            return
        place = bisect_right(self._times, time)
        self._times.insert(place, time)
        self._rows.insert(place, dict.fromkeys(propositions))
        self._late.add(time)
        self._again(place)

    def _again(self, place: int) -> None:
        """Step the rows from a place on once more."""
        while self._states[-1][0] > place:
            self._states.pop()
        begin, states = self._states[-1]
        for monitor, state in zip(self._monitors, states, strict=True):
            monitor.restore(state)
            monitor.advance(self._rows[begin:])

    def _forget(self) -> None:
        """Drop rows beyond those that are kept, up to a state of the monitors."""
        spare = len(self._rows) - self._kept if self._kept else 0
        drop = max((place for place, _ in self._states if place <= spare), default=0)
        if not drop:
            return
        self._before, self._dropped = self._times[drop - 1], self._dropped + drop
        dropped = self._late.intersection(self._times[:drop])
        self._late -= dropped
        self._dropped_late += len(dropped)
        del self._times[:drop], self._rows[:drop]
        self._states = [(place - drop, state) for place, state in self._states if place >= drop]


_APART = 64
"""Ticks from one kept state of the monitors to the next."""
