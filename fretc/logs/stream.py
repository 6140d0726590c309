"""The truth values of propositions at each tick of the clock, from a stream of samples.

The values at a tick are computed by the functions that judge recorded logs (`signals.propositions`,
`signals.traces`), over a window of samples. The window begins before the last tick, by the longest
time that a proposition looks back (`lookback`), and one nanosecond: from there on its steps are
those of the whole log.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np

from fretc.logs import log_diagnostics
from fretc.logs.mcap.damage import LATEST
from fretc.logs.messages.python_messages import PythonMessage, Value, sampled
from fretc.logs.signals.propositions import truth_values
from fretc.logs.signals.samples import Gap
from fretc.logs.signals.signals import FieldError
from fretc.logs.signals.traces import proposition_states
from fretc.logs.windows.sample_queue import SampleQueue
from fretc.logs.windows.window_recording import window_recording
from fretc.logs.windows.window_truth import Window, WindowTruth
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Signal
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.kernel.verdicts import Truth
from monitors.ticking import Ticking, late

MOST_TICKS = 1_000_000
"""The most ticks that may pass at once: more are probably a mistake in the unit of time."""
_FEW = 64
"""The most ticks that are faster to evaluate in lists than in arrays."""


@dataclass(frozen=True, slots=True)
class ClockTick:
    """One tick of the clock, with the truth value of each proposition."""

    time: int
    truth: Mapping[str, Truth]


@dataclass(frozen=True, slots=True)
class StreamEnd:
    """The last ticks, and the tick that the end of the stream cuts short (None: there is none)."""

    ticks: tuple[ClockTick, ...]
    cut: Mapping[str, Truth] | None
    until: int = 0
    """The end of the log, on the declared clock."""


@dataclass(frozen=True, slots=True)
class Withdrawn:
    """Judged ticks at which propositions became unknown, because a message was late."""

    first: int
    last: int
    propositions: tuple[str, ...]
    tick: int | None = None
    """A tick to insert, because the message was one of the clock's topic."""


@dataclass(slots=True)
class _Span:
    """The ticks for which a message is late, by their times."""

    first: int
    last: int
    counted: bool
    """Whether the message was late for a judged tick."""

    def holds(self, ticks: Sequence[int]) -> bool:
        """Whether the span contains one of the ticks, which are in order."""
        index = bisect_left(ticks, self.first)
        return index < len(ticks) and ticks[index] <= self.last


class SampleStream:
    """A stream of samples in any order, as long as none is earlier than the time passed."""

    def __init__(self, declarations: Declarations, propositions: Collection[str]) -> None:
        self._declarations = declarations
        self._propositions = tuple(propositions)
        lookbacks = {
            name: lookback(declarations.propositions[name].expression) for name in propositions
        }
        self._lookback = max(lookbacks.values(), default=0)
        self._back = 1 + max(
            (ticks_back(declarations.propositions[name].expression) for name in propositions),
            default=0,
        )
        """The number of earlier ticks on which later ones depend."""
        flags = {
            name.id
            for proposition in propositions
            for name in e.truths(declarations.propositions[proposition].expression)
        }
        self._queues = {
            name: SampleQueue(signal, name in flags)
            for name, signal in declarations.signals.items()
        }
        self._window_truth = WindowTruth(declarations, self._queues, lookbacks)
        clock = declarations.clock
        self._ticking = Ticking(_topics(declarations), clock.period, clock.phase, clock.topic)
        self._begin, self._end = LATEST, 0
        """The first and the last message of all bound topics."""
        self._recent: list[int] = []
        """The last ticks, from that of `_back` on; all ticks of one time, if one of that time is
        included."""
        self._late: dict[str, list[_Span]] = {}
        """For each topic, the ticks that are still to be judged and for which a message is late."""
        self.late: Counter[str] = Counter()
        """For each topic, the number of messages that were late for a judged tick."""
        self._gaps: list[Gap] = []
        self._ended = False

    # Samples

    def add(self, name: str, time: int, value: object) -> Diagnostic | None:
        """Add one sample of a signal: a number, an array of numbers, or an enumeration value."""
        signal = self._declarations.signals[name]
        if signal.numbers and isinstance(value, str) and value in signal.values:
            value = signal.numbers[signal.values.index(value)]
        if self._declarations.clock.period is None:
            return _needs_messages(self._declarations)
        message = value
        for part in reversed(signal.path.fields):
            message = {part: message}
        of_sample = [
            each
            for each in self._declarations.signals.values()
            if each is signal or (each.memory is not None and each.memory.source == name)
        ]
        return self._take(signal.path.topic, time, message, of_sample)

    def message(self, topic: str, time: int, message: object) -> Diagnostic | None:
        """Add one message: a sample of each signal of the topic, and a tick of its clock."""
        signals = [s for s in self._declarations.signals.values() if s.path.topic == topic]
        if not signals and topic != self._declarations.clock.topic:
            return None
        return self._take(topic, time, message, signals)

    def _take(
        self, topic: str, time: int, message: object, signals: Sequence[Signal]
    ) -> Diagnostic | None:
        """Add all samples of a message, or none, with the reason."""
        wrong = self._over() or self._untimely(topic, time)
        if wrong is not None:
            return wrong
        read = PythonMessage(message)
        values: list[tuple[SampleQueue, Value]] = []
        for signal in signals:
            try:
                read_sample = sampled(signal, read)
            except FieldError as error:
                return log_diagnostics.no_field(signal, error)
            queue = self._queues[signal.name]
            wrong = queue.refusal(read_sample[1], self._ticking.passed)
            if wrong is not None:
                return wrong
            values.append((queue, read_sample))
        self._put(topic, time, values)
        self._ticking.arrive(topic, time)
        return None

    def _put(self, topic: str, time: int, values: Iterable[tuple[SampleQueue, Value]]) -> None:
        for queue, (value, kind, foreign) in values:
            queue.put(time, value, kind, foreign)
        self._begin, self._end = min(self._begin, time), max(self._end, time)

    # Arrivals

    def arrive(
        self, topic: str, time: int, arrival: int, values: Mapping[str, Value]
    ) -> Withdrawn | None:
        """Add one message with its time and its arrival, as defined in `monitors/ticking.py`.

        Args:
            topic: the topic of a signal, or of the clock.
            time: the time on the declared clock.
            arrival: the time at which it was received; it does not decrease from one message to the
                next.
            values: a sample of each signal that reads the topic.

        Returns:
            The judged ticks for which it was late.
        """
        self._put(topic, time, ((self._queues[name], value) for name, value in values.items()))
        judged = self._ticking.last
        among = judged is not None and time <= judged
        if not among:
            self._ticking.arrive(topic, time)
        span = late(time, arrival, self._declarations.clock.effective_lateness or 0)
        if span is not None:
            self._late.setdefault(topic, []).append(_Span(*span, counted=among))
        if not among or judged is None:
            return None
        self.late[topic] += 1
        is_tick = topic == self._declarations.clock.topic
        if is_tick:
            index = bisect_right(self._recent, time)
            self._recent = self._within_reach([*self._recent[:index], time, *self._recent[index:]])
        return Withdrawn(time, judged, self._readers(topic), time if is_tick else None)

    def _readers(self, topic: str) -> tuple[str, ...]:
        """The propositions that depend on a topic."""
        if topic == self._declarations.clock.topic:
            return self._propositions
        return tuple(
            name
            for name in self._propositions
            if any(
                self._declarations.signals[signal].path.topic == topic
                for signal in self._declarations.propositions[name].signals
            )
        )

    def miss(self, first: int, last: int) -> Withdrawn | None:
        """Mark all messages with times from `first` to `last` as possibly lost.

        Returns:
            The judged ticks at which nothing is known any more.
        """
        self._gaps.append((first, last))
        self._begin, self._end = min(self._begin, first), max(self._end, last)
        judged = self._ticking.last
        if judged is None or first > judged:
            return None
        return Withdrawn(first, judged, self._propositions)

    def peek(self, time: int) -> tuple[ClockTick, ...]:
        """The values if there were a tick now, after those that still wait for messages.

        Nothing is judged. There are no values before the first tick is placed.
        """
        last = self._ticking.last
        if self._ended or (last is None and not self._ticking.due(time)):
            return ()
        time = max(time, (last or 0) + 1)
        return self._ticks([*self._ticking.due(time), time], time)

    def _untimely(self, topic: str, time: int) -> Diagnostic | None:
        if time == 0:
            return diagnostic("stream_time_zero", topic=topic)
        if not 0 < time < LATEST:
            return diagnostic("stream_time_out_of_range", topic=topic, time=time)
        passed = self._ticking.passed
        if time < passed:
            return diagnostic("stream_message_late", topic=topic, late=passed - time, passed=passed)
        return None

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """Warnings about samples outside the values of their signal, or not a truth value."""
        return tuple(
            finding
            for queue in self._queues.values()
            if (finding := _finding(queue, self._ticking.start or 0)) is not None
        )

    # Ticks

    @property
    def origin(self) -> int | None:
        """The start of the tick grid, once a tick was judged; None: there is no grid."""
        return self._ticking.origin

    @property
    def waiting(self) -> tuple[str, ...]:
        """The topics without a message yet, before which no tick can be placed.

        The tick grid begins with the last topic that begins less than a tick after the first one,
        and with the first one if another begins later: while topics are missing, both are possible.
        """
        return self._ticking.waiting

    def until(self, time: int) -> tuple[ClockTick, ...] | Diagnostic:
        """Advance the time: no message before `time` arrives any more.

        Returns:
            The ticks before `time` that are new, as a log has them that goes on for longer.
        """
        if (over := self._over()) is not None:
            return over
        if not 0 <= time < LATEST:
            return diagnostic("stream_time_cannot_advance", time=time)
        due = self._ticking.due(time)
        if not due:
            self._ticking.passed = max(time, self._ticking.passed)
            return ()
        if (many := _too_many(due)) is not None:
            return many
        times = self._ticking.until(time)
        ticks = self._ticks(times, self._ticking.passed)
        self._remember(times)
        return ticks

    def end(self) -> StreamEnd | Diagnostic:
        """The remaining ticks if the log ends here: at the last message or the time passed."""
        if (over := self._over()) is not None:
            return over
        end = max(self._end, self._ticking.passed)
        if (many := _too_many(self._ticking.ending(end))) is not None:
            return many
        self._ended = True
        times = self._ticking.end(end)
        if self._ticking.last is None or self._ticking.last == end:
            whole = self._ticks(times, end)
            self._remember(times)
            return StreamEnd(whole, None, end)
        *ticks, cut = self._ticks([*times, end], end)
        self._remember(times)
        return StreamEnd(tuple(ticks), cut.truth, end)

    def _over(self) -> Diagnostic | None:
        if not self._ended:
            return None
        return diagnostic("stream_ended")

    def _ticks(self, times: Sequence[int], end: int) -> tuple[ClockTick, ...]:
        """The values at each of the new ticks, in a log that continues up to `end`."""
        if not times:
            return ()
        truth = self._truth_in_lists(times)
        rest = [name for name in self._propositions if name not in truth]
        if rest:
            truth |= self._truth_in_arrays(rest, times, end)
        names = self._propositions
        return tuple(
            ClockTick(time, {name: truth[name][i] for name in names})
            for i, time in enumerate(times)
        )

    def _truth_in_lists(self, times: Sequence[int]) -> dict[str, list[Truth]]:
        """The propositions that are faster to evaluate in lists; none of them in some windows."""
        if not self._recent or self._declarations.clock.period is None or len(times) > _FEW:
            return {}
        lost = max((gap[1] for gap in self._gaps), default=-1)
        if lost >= self._window() or any(self._late.values()):
            return {}
        return self._window_truth.truth(Window(self._begin, self._recent[-1], lost), times)

    def _truth_in_arrays(
        self, names: Sequence[str], times: Sequence[int], end: int
    ) -> dict[str, list[Truth]]:
        start, first = self._begin, None
        before = self._recent
        if before:
            start = max(start, self._window())
        elif self._declarations.clock.period is not None:
            first = start
        late = {
            topic: [(span.first, span.last) for span in spans]
            for topic, spans in self._late.items()
        }
        recording = window_recording((start, end), self._queues, self._gaps, late)
        ticks = np.array([*before, *times], np.int64)
        states = {
            name: proposition_states(name, self._declarations, recording, ticks, first)
            for name in names
        }
        return {name: truth_values(each[len(before) :]) for name, each in states.items()}

    def _window(self) -> int:
        """The time from which on samples affect later ticks."""
        return self._recent[0] - self._lookback - 1

    def _within_reach(self, ticks: list[int]) -> list[int]:
        """The judged ticks on which later ones depend."""
        return ticks[bisect_left(ticks, ticks[-self._back :][0]) :]

    def _remember(self, times: Sequence[int]) -> None:
        """Record these ticks as judged, and drop samples that affect no later one."""
        if not times:
            return
        self._recent = self._within_reach([*self._recent, *times])
        for topic, spans in self._late.items():
            new = [span for span in spans if not span.counted and span.holds(times)]
            self.late[topic] += len(new)
            for span in new:
                span.counted = True
            spans[:] = [span for span in spans if span.last > times[-1]]
        over = [gap for gap in self._gaps if gap[1] < self._window()]
        if over:  # the last one still hides the samples before it
            last = max(over, key=lambda gap: gap[1])
            self._gaps = [gap for gap in self._gaps if gap not in over or gap == last]
        for queue in self._queues.values():
            queue.forget(self._window())


def lookback(expression: e.Expression) -> int:
    """The duration in nanoseconds that the truth value looks back: the sum of nested durations."""
    inner = max(map(lookback, e.children(expression)), default=0)
    return inner + expression.duration if isinstance(expression, e.Persistence) else inner


def _finding(queue: SampleQueue, start: int) -> Diagnostic | None:
    """F423 or F424, if samples were unmapped; the stream began at `start`."""
    if queue.foreign is None:
        return None
    find = log_diagnostics.no_truth if queue.is_flag else log_diagnostics.foreign_value
    return find(queue.signal, queue.foreign, queue.count, queue.first_foreign - start)


def _topics(declarations: Declarations) -> frozenset[str]:
    return frozenset(signal.path.topic for signal in declarations.signals.values())


def _too_many(times: Sequence[int]) -> Diagnostic | None:
    if not isinstance(times, range) or len(times) <= MOST_TICKS:
        return None
    return diagnostic("too_many_ticks_at_once", ticks=len(times))


def _needs_messages(declarations: Declarations) -> Diagnostic:
    return diagnostic(
        "stream_needs_messages", declarations.source.span(0, 0), clock=declarations.clock
    )
