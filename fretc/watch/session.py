"""The session of one run: arrivals in, ticks, states and diagnostics out.

The session never waits, prints, or reads a clock: the caller passes arrivals, and the receive time
up to which they are complete. Times are nanoseconds, with the meaning in `monitors/ticking.py`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import field
from functools import cached_property

from fretc.audit.one_log import signals_of
from fretc.audit.plan import Plan
from fretc.logs.reader import read
from fretc.logs.signals.samples import Gap
from fretc.logs.signals.traces import trace
from fretc.logs.stream import ClockTick, SampleStream, StreamEnd, Withdrawn
from fretc.watch.checkpoints import Checkpoints
from fretc.watch.decoding import Decoder, Timed
from fretc.watch.requirement_monitors import RequirementMonitors
from fretc.watch.sources.source import Arrival
from fretish.classes.frozen import dataclass
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.kernel.columns import rows_of
from monitors.kernel.stepping import RequirementStatus
from monitors.kernel.verdicts import Truth
from monitors.stop_supervisor import State
from monitors.ticking import Ledger, is_jump


@dataclass(frozen=True, slots=True)
class Jump:
    """The clock of a topic was set back: a new run begins."""

    topic: str
    by: int


@dataclass(frozen=True, slots=True)
class EndedRun:
    """A run that has ended, with the verdicts of an audit of its recording."""

    verdicts: Mapping[str, str]
    until: int
    """The end of the watch, on the declared clock."""


_RECENT = 20


@dataclass(slots=True)
class ArrivedMessages:
    """The messages of a topic that have arrived."""

    count: int = 0
    first: int | None = None
    last: int | None = None
    """Receive times."""
    recent: deque[int] = field(default_factory=lambda: deque(maxlen=_RECENT))
    """The last receive times, for the rate."""

    @property
    def rate(self) -> float | None:
        """Messages per second, from the last ones."""
        if len(self.recent) < 2 or self.recent[-1] == self.recent[0]:
            return None
        return (len(self.recent) - 1) * 1e9 / (self.recent[-1] - self.recent[0])


class Session:
    """A session of one run of a robot, with all requirements of a plan."""

    def __init__(self, plan: Plan) -> None:
        """An empty session; the clock of the plan declares a lateness, if it needs one."""
        self._plan = plan
        self._clock = plan.declarations.clock
        patience = self._clock.effective_lateness
        assert patience is not None, "a clock by stamps has a lateness"
        self._patience = patience
        self._monitors = RequirementMonitors(plan)
        self._stream = SampleStream(plan.declarations, self._monitors.propositions)
        self._decoder = Decoder(plan.declarations)
        self._latest: dict[str, int] = {}
        self.now = 0
        """The latest time of all messages on the declared clock; 0 before the first."""
        self.received = 0
        """The receive time up to which arrivals are complete; 0 before the first."""
        self.disordered = 0
        """Messages that arrived after later ones whose ticks had been judged, in a log that is
        followed."""
        self._checkpoints = Checkpoints()
        self._last_arrival = 0
        self._missed: list[Gap] = []
        self._gap_from: int | None = None
        """The latest time before messages were missed, until another one arrives."""
        self.interrupted = False
        """Whether the source is not connected."""
        self._ahead: tuple[Truth, ...] | None = None
        self._states: tuple[State, ...] = ()
        self._basis: tuple[object, ...] | None = None
        """What `_states` was made of, besides the ticks of the statuses."""
        self._final: Mapping[str, str] = {}
        """The verdicts of a run that has ended."""
        self.topics = {name: ArrivedMessages() for name in sorted(self._decoder.topics)}
        self.problems: list[Diagnostic] = []
        """Diagnostics of the messages of topics, each once."""

    @cached_property
    def reads(self) -> Mapping[str, tuple[str, ...]]:
        """For each requirement, the topics on which it depends."""
        of, reads = self._plan.declarations, {}
        for monitor in self._monitors.monitors:
            names = {n for name in monitor.PROPOSITIONS for n in of.propositions[name].signals}
            topics = {of.signals[name].path.topic for name in names}
            reads[monitor.REQUIREMENTS[0].id] = tuple(sorted(topics))
        return reads

    @property
    def static_topics(self) -> frozenset[str]:
        """The topics of static transforms, which are published once."""
        return self._decoder.static_topics

    @property
    def missed(self) -> tuple[Gap, ...]:
        """The intervals of missed messages, by receive time."""
        return tuple(self._missed)

    @property
    def origin(self) -> int | None:
        """The start of the grid of ticks, once it is placed; None also if there is no grid."""
        return self._stream.origin

    @property
    def first_tick(self) -> int | None:
        """The time of the first tick."""
        return self._monitors.ledger.time(0)

    @property
    def ticks(self) -> int:
        """The number of judged ticks."""
        return self._monitors.count

    @property
    def ledger(self) -> Ledger:
        """The judged ticks."""
        return self._monitors.ledger

    @property
    def late(self) -> Mapping[str, int]:
        """For each topic, the number of late messages."""
        return self._stream.late

    @property
    def late_ticks(self) -> int:
        """The number of ticks that became unknown because a message was late."""
        return self._monitors.ledger.late

    @property
    def waiting(self) -> tuple[str, ...]:
        """The topics without a message yet, before which the first tick cannot be placed."""
        return self._stream.waiting

    # Arrivals

    def arrive(self, arrival: Arrival) -> Jump | Diagnostic | None:
        """Add one message.

        Returns:
            A jump, and nothing was taken: the message belongs to another run. Or what keeps time
            from passing: a jump forward by a million ticks.
        """
        is_behind = arrival.log_time < self.received
        self.received = max(self.received, arrival.log_time)
        wrong = self._pass(self._time_passed)
        if wrong is not None:
            return wrong
        messages, problems = self._decoder.read(arrival)
        self.problems += problems
        for message in messages:
            latest = self._latest.get(message.topic)
            if is_jump(latest, message.time):
                return Jump(message.topic, (latest or 0) - message.time)
        topic = self.topics.get(arrival.channel.topic)
        if topic is not None:
            topic.count += 1
            topic.first = topic.first or arrival.log_time
            topic.last = arrival.log_time
            topic.recent.append(arrival.log_time)
        for message in messages:
            was_judged = self._take(message)
            self.disordered += is_behind and was_judged
        self._last_arrival = max(self._last_arrival, arrival.log_time)
        if self.now:
            self._checkpoints.add(self._last_arrival, self.now)
        return None

    def _take(self, message: Timed) -> bool:
        """Add a message; whether a tick that it affects was already judged."""
        self._latest[message.topic] = max(message.time, self._latest.get(message.topic, 0))
        self.now = max(self.now, message.time)
        if self._gap_from is not None and not self.interrupted:
            before, self._gap_from = self._gap_from, None
            self._withdraw(self._stream.miss(min(before, message.time), max(before, message.time)))
        late = self._stream.arrive(message.topic, message.time, message.arrival, message.values)
        self._withdraw(late)
        self._ahead = None
        return late is not None

    def _withdraw(self, late: Withdrawn | None) -> None:
        if late is not None:
            self._monitors.withdraw(late)

    def interrupt(self) -> None:
        """Record that the connection is lost: no tick is judged until `miss` is called."""
        self.interrupted = True
        self._gap_from = self._gap_from or self.now or None

    def miss(self, since: int, until: int) -> None:
        """Record that messages received from `since` to `until` were lost.

        With stamps, the neighbouring messages determine the lost times. If others have arrived
        since, the time from `since` on is unknown.
        """
        self.interrupted, self._ahead = False, None
        self._decoder.lose()
        if self._missed and since <= self._missed[-1][1]:
            before = self._missed.pop()
            since, until = min(since, before[0]), max(until, before[1])
        self._missed.append((since, until))
        if self._clock.time is TimeSource.LOG_TIME:
            self._gap_from = None
            self._withdraw(self._stream.miss(since, until))
        else:
            known = [self._gap_from, self._latest_at(since)]
            self._gap_from = min((time for time in known if time is not None), default=None)

    def _latest_at(self, arrival: int) -> int | None:
        """The latest time of the messages until this arrival; None: there is no message at all."""
        if not self.now or arrival >= self._last_arrival:
            return self.now or None
        latest = self._checkpoints.latest(arrival)
        return self._checkpoints.first if latest is None else latest

    def idle(self, now: int) -> Diagnostic | None:
        """Record that all messages received before `now` have been added."""
        self.received = max(self.received, now)
        return self._pass(self._time_passed) if self.now else None

    def _pass(self, time: int) -> Diagnostic | None:
        if self.interrupted:
            return None
        ticks = self._stream.until(max(time, 0))
        if isinstance(ticks, Diagnostic):
            return ticks
        for tick in ticks:
            self._monitors.step(tick)
        if ticks:
            self._ahead = None
        return None

    # The state

    def states(self, *, ahead: bool = True) -> tuple[State, ...]:
        """The present state of each requirement; the same tuple until one of them may have changed.

        Args:
            ahead: whether messages since the last tick count for `obligation_pending`.
        """
        monitors = self._monitors
        if ahead and self._ahead is None:
            rows = [tick.truth for tick in self._stream.peek(max(self.now, self._time_passed))]
            self._ahead = monitors.obligation_pending(rows)
        pending = (
            self._ahead if ahead and self._ahead is not None else monitors.obligation_pending()
        )
        pending = (None,) * len(pending) if self.interrupted else pending
        statuses = monitors.statuses()
        basis = statuses, pending, self._final, bool(self._missed)
        if self._basis is None or statuses is not self._basis[0] or basis != self._basis:
            self._basis = basis
            self._states = self._states_of(statuses, pending)
        return self._states

    def _states_of(
        self, statuses: tuple[RequirementStatus, ...], pending: tuple[Truth, ...]
    ) -> tuple[State, ...]:
        monitors = self._monitors
        read = zip(statuses, pending, monitors.last_triggers(), strict=True)
        return tuple(
            State(
                status.requirement,
                self._verdict(status),
                is_pending,
                trigger,
                self._tick_time(status.open),
                self._tick_time(status.deadline),
                None
                if status.requirement in monitors.counted
                else self._tick_time(status.first_violation),
            )
            for status, is_pending, trigger in read
        )

    @property
    def _time_passed(self) -> int:
        return self.received - self._patience

    def _verdict(self, status: RequirementStatus) -> str:
        """The verdict of a run that has ended; a run with missed messages satisfies nothing."""
        if status.requirement in self._final:
            return self._final[status.requirement]
        verdict = self._monitors.audit_verdict(status.requirement, str(status.verdict))
        return "no data" if self._missed and verdict in ("satisfied", "vacuous") else verdict

    def _tick_time(self, tick: int | None) -> int | None:
        """The time of a tick, also of a future one."""
        if tick is None:
            return None
        judged_time = self._monitors.ledger.time(tick)
        origin, period = self.origin, self._clock.period
        if judged_time is not None or origin is None or period is None:
            return judged_time
        return origin + self._clock.phase + tick * period

    def end(self) -> EndedRun | Diagnostic:
        """End the run."""
        if self._gap_from is not None:
            self._withdraw(self._stream.miss(self._gap_from, self.now))
        stream_end = self._stream.end()
        if not isinstance(stream_end, StreamEnd):
            return stream_end
        for tick in stream_end.ticks:
            self._monitors.step(tick)
        self._final = self._monitors.verdicts(stream_end.cut, intact=not self._missed)
        return EndedRun(self._final, stream_end.until)

    def judge_again(self, log: str) -> Mapping[str, str] | Diagnostic:
        """Judge the ended run by a log of it, as an audit does: in the order of times.

        Returns:
            The verdicts, which `states` has, too; or why the log cannot be read.
        """
        declarations, names = self._plan.declarations, self._monitors.propositions
        signals = signals_of(declarations, names)
        recording = read(log, declarations, signals, self._plan.integrity)
        if isinstance(recording, Diagnostic):
            return recording
        columns = trace(declarations, recording, names)
        times = columns.timeline.times.tolist()
        self._monitors, self._ahead = RequirementMonitors(self._plan), None
        rows = rows_of([columns.columns[name] for name in names], len(times))
        for time, row in zip(times, rows, strict=True):
            self._monitors.step(ClockTick(time, dict(zip(names, row, strict=True))))
        self._final = self._monitors.verdicts(columns.cut, intact=recording.intact)
        return self._final
