"""Evaluate propositions on the samples of signals, over time and at ticks.

Times are whole nanoseconds. Steps, ages and durations are defined as in an audit
(`fretc.logs.signals.propositions`, `fretc.logs.signals.traces`). The text of this module is copied
into emitted nodes: it needs the standard library only.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from monitors.kernel.readings import Reading
from monitors.kernel.verdicts import Truth


class PropositionSpec(NamedTuple):
    """The definition of a proposition: its truth at an instant, and its aggregation at a tick."""

    name: str
    signals: "tuple[str, ...]"
    truth: "Callable[[Mapping[str, Reading], Sequence[Truth]], Truth]"
    """Function of the values of its signals and of the states of its `held` parts."""
    held: "tuple[tuple[Callable[[Mapping[str, Reading], Sequence[Truth]], Truth], int], ...]" = ()
    """Parts `... for 200 ms`: a truth function, which may use the states of earlier parts, and its
    duration in nanoseconds."""
    outer: "tuple[int, ...]" = ()
    """The indices of the `held` parts that `truth` uses."""
    lookback: int = 0
    """Nanoseconds of the past on which its truth depends."""
    aggregate: str = "last"
    """How several values within one tick combine: `any`, `all` or `last`."""
    on_unknown: Truth = None


class Series:
    """The samples of a signal in order of time; equal times are in order of arrival."""

    def __init__(self, max_age: "int | None" = None) -> None:
        self.max_age = max_age
        self.times: list[int] = []
        self.values: list[Reading] = []

    def put(self, time: int, value: Reading) -> None:
        """Add a sample."""
        index = bisect_right(self.times, time)
        self.times.insert(index, time)
        self.values.insert(index, value)

    def forget(self, start: int) -> None:
        """Drop the samples before the one that is current at `start`."""
        count = max(0, bisect_left(self.times, start) - 1)
        del self.times[:count], self.values[:count]

    def next(self, done: int) -> "int | None":
        """The next time after `done` at which the value may change; None: never."""
        index = bisect_right(self.times, done)
        following = self.times[index] if index < len(self.times) else None
        if index and self.max_age is not None:
            expiry = self.times[index - 1] + self.max_age + 1
            if expiry > done and (following is None or expiry < following):
                return expiry
        return following

    def span(self, time: int) -> "tuple[int, int]":
        """The index range of the samples at a time, end excluded."""
        return bisect_left(self.times, time), bisect_right(self.times, time)

    def at(self, index: int, time: int) -> Reading:
        """The value of a sample at a time; None if it is too old."""
        if index < 0 or (self.max_age is not None and time - self.times[index] > self.max_age):
            return None
        return self.values[index]


class _Persistence:
    """Whether a truth value has held for a duration, updated event by event."""

    __slots__ = ("current", "duration", "ends", "state")

    def __init__(self, duration: int) -> None:
        self.duration = duration
        self.ends: dict[Truth, int] = {}
        """Truth value -> the time at which it last ended."""
        self.current: Truth = None
        self.state: Truth = None

    def copy(self) -> "_Persistence":
        other = _Persistence(self.duration)
        other.ends, other.current, other.state = dict(self.ends), self.current, self.state
        return other

    def take(self, time: int, truth: Truth) -> None:
        self.ends[self.current] = time
        self.current = truth

    def next(self, done: int) -> "int | None":
        over = [self.ends[each] + self.duration for each in (False, None) if each in self.ends]
        return min((time for time in over if time > done), default=None)

    def settle(self, time: int) -> None:
        """Compute the state at a time, after all events of that time."""
        self.state = None if self._within(None, time) else True
        if self._within(False, time):
            self.state = False

    def _within(self, truth: Truth, time: int) -> bool:
        if self.current is truth:
            return True
        return truth in self.ends and time < self.ends[truth] + self.duration


class PropositionEvaluator:
    """Evaluates one proposition over time, step by step."""

    def __init__(
        self, meaning: PropositionSpec, series: "Mapping[str, Series]", start: int
    ) -> None:
        """Start before the first step, which is at `start`."""
        self._meaning = meaning
        self._series = {name: series[name] for name in meaning.signals}
        self._start, self._done = start, start - 1
        self._held = [_Persistence(duration) for _, duration in meaning.held]
        self._truth: Truth = None
        self._ahead: tuple[PropositionEvaluator, list[tuple[int, Truth]]] | None = None
        """A copy that was evaluated ahead, and its steps; None if there is none."""

    def copy(self) -> "PropositionEvaluator":
        """An independent copy in the same state."""
        other = PropositionEvaluator(self._meaning, self._series, self._start)
        other._done, other._truth = self._done, self._truth
        other._held = [each.copy() for each in self._held]
        return other

    def steps(self, until: int) -> "list[tuple[int, Truth]]":
        """Advance to `until`, which is included; the new steps as (time, truth)."""
        self._ahead = None
        steps: list[tuple[int, Truth]] = []
        while (time := self._next()) is not None and time <= until:
            steps += ((time, truth) for truth in self._at(time))
            self._done = time
        self._done = max(self._done, until)
        return steps

    def value_at_tick(self, tick: int, first: "tuple[int, int | None] | None" = None) -> Truth:
        """The truth at a tick; ticks must be given in increasing order.

        `first` is given for the first tick of the run: the start of the log, and the time from
        which all its signals have a sample (None: not yet). An unknown before that is ignored.
        """
        before = self._truth
        steps: Sequence[tuple[int, Truth]] = self.steps(tick)
        if first is not None and steps:
            told = [
                index
                for index, (time, truth) in enumerate(steps)
                if truth is not None or (first[1] is not None and time >= first[1])
            ]
            steps = steps[told[0] if told else -1 :]
        return self._seen(steps, before)

    def peek(self, ticks: "Sequence[int]") -> "list[Truth]":
        """The truth at later ticks if no more samples arrive, without advancing."""
        if self._ahead is None:
            self._ahead = self.copy(), []
        other, steps = self._ahead
        steps += other.steps(ticks[-1])
        begin, before = 0, self._truth
        truths: list[Truth] = []
        for tick in ticks:
            end = bisect_left(steps, (tick + 1,))  # Less than each step of that time.
            truths.append(self._seen(steps[begin:end], before))
            before = steps[end - 1][1] if end else before
            begin = end
        return truths

    def invalidate_lookahead(self, time: int) -> None:
        """Discard results ahead of a new sample of one of its signals."""
        if self._ahead is not None and time <= self._ahead[0]._done:
            self._ahead = None

    def _seen(self, steps: "Sequence[tuple[int, Truth]]", before: Truth) -> Truth:
        seen = self._combined([truth for _, truth in steps], before)
        return self._meaning.on_unknown if seen is None else seen

    def _combined(self, truths: "Sequence[Truth]", before: Truth) -> Truth:
        if not truths:
            return before
        if self._meaning.aggregate == "last":
            return truths[-1]
        decisive = self._meaning.aggregate == "any"
        if decisive in truths:
            return decisive
        return None if None in truths else not decisive

    def _next(self) -> "int | None":
        if self._done < self._start:
            return self._start
        sources: list[Series | _Persistence] = [*self._series.values(), *self._held]
        times = [source.next(self._done) for source in sources]
        return min((time for time in times if time is not None), default=None)

    def _at(self, time: int) -> "list[Truth]":
        """The truth values at one time: of the first samples, then of the second ones, ..."""
        spans = {name: series.span(time) for name, series in self._series.items()}
        ranks = max([1, *(end - begin for begin, end in spans.values())])
        rows = [
            {
                name: series.at(min(spans[name][0] + rank, spans[name][1] - 1), time)
                for name, series in self._series.items()
            }
            for rank in range(ranks)
        ]
        before = [each.state for each in self._held]
        states: list[Truth] = []
        for (truth, _), held in zip(self._meaning.held, self._held):
            for row in rows:
                held.take(time, truth(row, states))
            held.settle(time)
            states.append(held.state)
        changed = any(states[place] is not before[place] for place in self._meaning.outer)
        if not (changed or time == self._start or self._is_event(time, spans)):
            return []
        truths = [self._meaning.truth(row, states) for row in rows]
        self._truth = truths[-1]
        return truths

    def _is_event(self, time: int, spans: "Mapping[str, tuple[int, int]]") -> bool:
        return any(
            begin < end or series.next(time - 1) == time
            for (begin, end), series in zip(spans.values(), self._series.values())
        )
