"""Evaluate arriving messages: the truth of propositions at each tick, and open obligations.

The results for a live robot equal those of an audit of the recording, tick by tick.
`monitors/ticking.py` defines which message counts at which tick. Times are whole nanoseconds.

The text of this module is copied into emitted nodes: it needs the standard library only.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, NamedTuple

from monitors.kernel.readings import Reading
from monitors.kernel.verdicts import Truth
from monitors.proposition_evaluator import PropositionEvaluator, PropositionSpec, Series
from monitors.samples import Policy, sample
from monitors.ticking import Ledger, Ticking, is_jump, late

MOST_TICKS = 10_000
"""More ticks than this at once mean that a clock was set forward."""


class BindingConfig(NamedTuple):
    """The configuration of a node, from the bindings."""

    policies: "tuple[Policy, ...]"
    meanings: "tuple[PropositionSpec, ...]"
    period: int
    phase: int = 0
    lateness: int = 0
    stamped: bool = False
    """Whether the time of a message is the stamp of its header."""
    reads: "tuple[tuple[str, tuple[str, ...]], ...]" = ()
    """Id of each requirement, and the topics that it reads."""
    frames: "Callable[[], Any] | None" = None
    """Function that makes the `FrameSignals` of `monitors/transforms.py`; None: there are none."""

    @property
    def topics(self) -> "tuple[str, ...]":
        """All topics that are read."""
        return tuple(dict.fromkeys(policy.topic for policy in self.policies))


class Perception:
    """Evaluates the propositions at each tick of one run."""

    def __init__(self, setting: BindingConfig) -> None:
        """Start before the first message."""
        self._setting = setting
        self._series: dict[str, Series] = {
            each.name: each.series() if each.series else Series(each.max_age)
            for each in setting.policies
        }
        self._topic = {each.name: each.topic for each in setting.policies}
        self._ticking = Ticking(setting.topics, setting.period, setting.phase)
        self._evaluators: dict[str, PropositionEvaluator] = {}
        self._late: dict[str, list[tuple[int, int]]] = {}
        self._start: int | None = None
        """The earliest time of all messages, including late ones."""
        self._stale: set[str] = set()
        """The propositions that must be evaluated again because of a late message."""

    @property
    def origin(self) -> "int | None":
        """The time at which the grid of ticks begins; None until it is fixed."""
        return self._ticking.origin

    def arrive(
        self, topic: str, time: int, arrival: int, values: "Mapping[str, Reading]"
    ) -> "tuple[int, int, tuple[str, ...]] | None":
        """Process a message, given as a sample of each signal of its topic.

        Returns:
            For a late message: the first and the last tick that it missed, and the propositions
            that are unknown there. Otherwise None.
        """
        for name, value in values.items():
            self._series[name].put(time, value)
        if self._start is None or time < self._start:
            self._start = time
            self._stale.update(self._evaluators)
        last = self._ticking.last
        judged = last is not None and time <= last
        span = late(time, arrival, self._setting.lateness)
        if span is not None:
            self._late.setdefault(topic, []).append(span)
        readers = tuple(each.name for each in self._setting.meanings if self._reads(each, topic))
        if not judged or last is None:
            self._ticking.arrive(topic, time)
            for name in self._evaluators.keys() & readers:
                self._evaluators[name].invalidate_lookahead(time)
            return None
        self._stale.update(readers)
        return time, last, readers

    def _reads(self, meaning: PropositionSpec, topic: str) -> bool:
        return any(self._topic[name] == topic for name in meaning.signals)

    def until(self, passed: int) -> "list[tuple[int, Mapping[str, Truth]]] | None":
        """Advance to `passed`: the newly evaluated ticks, as (time, row).

        Returns:
            The ticks; None if a clock was set forward.
        """
        due, first = self._ticking.due(passed), self._ticking.last is None
        if len(due) > MOST_TICKS:
            return None
        evaluators = self._live() if due else {}
        ticks = self._ticking.until(passed)
        if not ticks:
            return []
        rows = self._rows(ticks, evaluators, first)
        for series in self._series.values():
            series.forget(ticks[-1] - self._lookback - 1)
        for spans in self._late.values():
            spans[:] = [span for span in spans if span[1] > ticks[-1]]
        return rows

    def peek(self, time: int) -> "list[tuple[int, Mapping[str, Truth]]]":
        """The rows of the pending ticks and of an additional tick now, without advancing."""
        last, due = self._ticking.last, self._ticking.due(time)
        if last is None and not due:
            return []
        ticks = [*due, max(time, (-1 if last is None else last) + 1)]
        if len(ticks) > MOST_TICKS:
            return []
        if last is None:
            evaluators = {name: evaluator.copy() for name, evaluator in self._live().items()}
            return self._rows(ticks, evaluators, True)
        live = self._live()
        truths_at_ticks = [live[each.name].peek(ticks) for each in self._setting.meanings]
        return [
            (tick, self._row(tick, [truths[index] for truths in truths_at_ticks]))
            for index, tick in enumerate(ticks)
        ]

    @property
    def _lookback(self) -> int:
        return max((each.lookback for each in self._setting.meanings), default=0)

    def _live(self) -> "Mapping[str, PropositionEvaluator]":
        """The evaluators of all propositions, up to date to the last tick."""
        start, last = self._start, self._ticking.last
        assert start is not None, "a tick needs a message"
        for meaning in self._setting.meanings:
            if last is None:  # The start may have changed.
                self._evaluators[meaning.name] = PropositionEvaluator(meaning, self._series, start)
            elif meaning.name in self._stale:
                begin = max(start, last - meaning.lookback - 1)
                evaluator = self._evaluators[meaning.name] = PropositionEvaluator(
                    meaning, self._series, begin
                )
                evaluator.steps(last)
        self._stale.clear()
        return self._evaluators

    def _rows(
        self, ticks: "Sequence[int]", evaluators: "Mapping[str, PropositionEvaluator]", first: bool
    ) -> "list[tuple[int, Mapping[str, Truth]]]":
        rows: list[tuple[int, Mapping[str, Truth]]] = []
        for tick in ticks:
            begun = [self._beginning(each) if first else None for each in self._setting.meanings]
            truths_at_ticks = [
                evaluators[each.name].value_at_tick(tick, start)
                for each, start in zip(self._setting.meanings, begun)
            ]
            rows.append((tick, self._row(tick, truths_at_ticks)))
            first = False
        return rows

    def _row(self, tick: int, truths_at_ticks: "Sequence[Truth]") -> "Mapping[str, Truth]":
        return {
            each.name: None if self._is_late(each, tick) else truth
            for each, truth in zip(self._setting.meanings, truths_at_ticks)
        }

    def _beginning(self, meaning: PropositionSpec) -> "tuple[int, int | None]":
        start = self._start or 0
        series = [self._series[name].times for name in meaning.signals]
        if not all(series):
            return start, None
        return start, max((times[0] for times in series), default=start)

    def _is_late(self, meaning: PropositionSpec, tick: int) -> bool:
        topics = {self._topic[name] for name in meaning.signals}
        return any(a <= tick <= b for topic in topics for a, b in self._late.get(topic, ()))


# From rows to open obligations -----------------------------------------------------------------

KEPT = 1000
"""The number of last ticks that a late message can make unknown."""


class OnlineEvaluator:
    """A monitor that is stepped by arriving messages.

    The robot must stop unless `obligation_pending` is False.
    """

    def __init__(self, monitor: "Callable[[], Any]", setting: BindingConfig) -> None:
        """Start before the first message.

        Args:
            monitor: function that makes the monitor; the setting has all its propositions.
            setting: the configuration from the bindings.
        """
        self._make, self._setting = monitor, setting
        self._frames = None if setting.frames is None else setting.frames()
        self.resets = 0
        """The number of times that a clock was set and a new run began."""
        self.changes = 0
        """The number of steps and of other changes of the monitor's state."""
        self._begin()

    def _begin(self) -> None:
        self.perception = Perception(self._setting)
        if self._frames is not None:
            self._frames.forget()
        self.monitor = self._make()
        self.ledger = Ledger((self.monitor,), KEPT)
        self.changes += 1
        self._latest: dict[str, int] = {}
        self._received = 0
        self._ahead: tuple[list[Mapping[str, Truth]], tuple[Truth, ...]] | None = None
        """The last rows evaluated ahead of the ledger, and the open obligations after them."""

    def arrive(
        self, topic: str, time: int, arrival: int, message: Any, singles: "Collection[str]" = ()
    ) -> None:
        """Process a message.

        Args:
            topic: the topic of the message.
            time: the time of the message on the declared clock.
            arrival: the time of its reception on the clock of arrivals.
            message: the message, with its fields as attributes; None: one that cannot be read,
                so that its signals are unknown.
            singles: the signals that are read from 32-bit floats.

        Raises:
            AttributeError, TypeError: the message does not have the fields of the bindings.
        """
        is_back = is_jump(self._received, arrival)
        if not is_back:
            self.pass_to(arrival)  # Evaluate pending ticks before a new run.
        if is_back or is_jump(self._latest.get(topic), time):
            self.resets += 1
            self._begin()
            self.pass_to(arrival)
        values = {
            policy.name: None
            if message is None
            else sample(policy, message, policy.name in singles)
            for policy in self._setting.policies
            if policy.topic == topic and not policy.is_pose
        }
        if self._frames is not None and self._frames.reads(topic):
            values.update(self._frames.read(topic, message))
            if topic in self._frames.static_topics:  # They count from the next others on.
                return
        self._latest[topic] = max(time, self._latest.get(topic, time))
        found = self.perception.arrive(topic, time, self._received, values)
        if found is not None:
            self.ledger.withdraw(*found)
            self._ahead = None
            self.changes += 1

    def last(self, topic: str) -> "int | None":
        """The latest time of a message of the topic in the present run; None: there was none."""
        return self._latest.get(topic)

    def pass_to(self, now: int) -> None:
        """Advance to `now`: all messages received earlier have been processed."""
        self._received = max(self._received, now)
        rows = self.perception.until(self._received - self._setting.lateness)
        if rows is None:
            self.resets += 1
            self._begin()
            self._received = now
            return
        for time, row in rows:
            self.ledger.advance(time, row)
            self._ahead = None
            self.changes += 1

    def obligation_pending(self) -> "tuple[Truth, ...]":
        """For each requirement, whether an obligation is open now; None: unknown.

        Messages since the last tick count as if there were a tick now.
        """
        now = max(self._received - self._setting.lateness, *self._latest.values(), 0)
        rows = [row for _, row in self.perception.peek(now)]
        if not rows:
            return (None,) * len(self.monitor.REQUIREMENTS)
        if self._ahead is None or self._ahead[0] != rows:  # Most messages change nothing.
            self._ahead = rows, self.monitor.obligation_pending_after(rows)
        return self._ahead[1]
