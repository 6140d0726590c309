"""One run, watched: arrivals in, ticks, standings and findings out.

Nothing here waits, prints, or looks at a clock: who calls it says what has arrived, and up to which
receive time everything has. Times are nanoseconds; what is meant by them, `monitors/ticking.py`
says.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from fretc.audit.one_log import signals_of
from fretc.audit.plan import Plan
from fretc.logs.reader import read
from fretc.logs.signals.samples import Gap
from fretc.logs.signals.traces import trace
from fretc.logs.stream import End, Stream, Tick, Withdrawn
from fretc.watch.decoding import Decoder, Timed
from fretc.watch.judging import Judges
from fretc.watch.sources.source import Arrival
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.guard import State
from monitors.kernel.columns import rows_of
from monitors.kernel.stepping import Standing
from monitors.kernel.verdicts import Truth
from monitors.ticking import Ledger, is_jump


@dataclass(frozen=True, slots=True)
class Jump:
    """The clock of a topic was set back: a new run begins."""

    topic: str
    by: int


@dataclass(frozen=True, slots=True)
class Ended:
    """A run that has ended, as an audit of its recording judges it."""

    verdicts: Mapping[str, str]
    until: int
    """Up to when it was watched, on the declared clock."""


@dataclass(slots=True)
class Topic:
    """What has come of a topic."""

    count: int = 0
    first: int | None = None
    last: int | None = None
    """Receive times."""
    recent: list[int] = field(default_factory=list)
    """The last receive times, for its rate."""

    @property
    def rate(self) -> float | None:
        """Messages a second, of the last ones."""
        if len(self.recent) < 2 or self.recent[-1] == self.recent[0]:
            return None
        return (len(self.recent) - 1) * 1e9 / (self.recent[-1] - self.recent[0])


_RECENT = 20


class Session:
    """Watches one run of a robot by all requirements of a plan."""

    def __init__(self, plan: Plan) -> None:
        """Nothing has come yet; the clock of the plan declares a lateness, where it needs one."""
        self._plan = plan
        self._clock = plan.declarations.clock
        patience = self._clock.patience
        assert patience is not None, "a clock by stamps has a lateness"
        self._patience = patience
        self._judges = Judges(plan)
        self._stream = Stream(plan.declarations, self._judges.propositions)
        self._decoder = Decoder(plan.declarations)
        self._latest: dict[str, int] = {}
        self._now = 0
        """On the declared clock: the latest time of all messages."""
        self._received = 0
        self.disordered = 0
        """Messages behind later ones, by receive time, that came after their ticks were judged: a
        log that is followed can have some."""
        self._missed: list[Gap] = []
        self._gap_from: int | None = None
        """The latest time before messages were missed, until another one comes."""
        self.interrupted = False
        """Whether the source is not connected."""
        self._ahead: tuple[Truth, ...] | None = None
        self._final: Mapping[str, str] = {}
        """The verdicts of a run that has ended."""
        self.topics = {name: Topic() for name in sorted(self._decoder.topics)}
        self.problems: list[Diagnostic] = []
        """What is wrong with the messages of a topic, each once."""

    @cached_property
    def reads(self) -> Mapping[str, tuple[str, ...]]:
        """Of each requirement the topics on which it depends."""
        of, found = self._plan.declarations, {}
        for monitor in self._judges.monitors:
            names = {n for each in monitor.PROPOSITIONS for n in of.propositions[each].signals}
            topics = {of.signals[name].path.topic for name in names}
            found[monitor.REQUIREMENTS[0].id] = tuple(sorted(topics))
        return found

    @property
    def missed(self) -> tuple[Gap, ...]:
        """When messages were missed, by receive time."""
        return tuple(self._missed)

    @property
    def received(self) -> int:
        """The receive time up to which everything that has come was given; 0 before the first."""
        return self._received

    @property
    def origin(self) -> int | None:
        """Where the grid of ticks begins, once it is placed; None, too, where there is no grid."""
        return self._stream.origin

    @property
    def first_tick(self) -> int | None:
        """The time of the first tick."""
        return self._judges.ledger.time(0)

    @property
    def ticks(self) -> int:
        """How many were judged."""
        return self._judges.count

    @property
    def ledger(self) -> Ledger:
        """The ticks that were judged."""
        return self._judges.ledger

    @property
    def late(self) -> Mapping[str, int]:
        """Of each topic how many messages were late for a tick."""
        return self._stream.late

    @property
    def late_ticks(self) -> int:
        """How many of them became unknown because a message was late."""
        return self._judges.ledger.late

    @property
    def now(self) -> int:
        """The latest time of all messages on the declared clock; 0 before the first."""
        return self._now

    @property
    def waiting(self) -> tuple[str, ...]:
        """The topics that have to begin before the first tick can be placed."""
        return self._stream.waiting

    # What comes

    def arrive(self, arrival: Arrival) -> Jump | Diagnostic | None:
        """One message.

        Returns:
            A jump, and nothing was taken: the message belongs to another run. Or what keeps time
            from passing: a jump forward by a million ticks.
        """
        is_behind = arrival.log_time < self._received
        self._received = max(self._received, arrival.log_time)
        wrong = self._pass(self._received - self._patience)
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
            topic.recent = [*topic.recent, arrival.log_time][-_RECENT:]
        for message in messages:
            was_judged = self._take(message)
            self.disordered += is_behind and was_judged
        return None

    def _take(self, message: Timed) -> bool:
        """Whether a tick that needed it was judged already."""
        self._latest[message.topic] = max(message.time, self._latest.get(message.topic, 0))
        self._now = max(self._now, message.time)
        if self._gap_from is not None and not self.interrupted:
            before, self._gap_from = self._gap_from, None
            self._withdraw(self._stream.miss(min(before, message.time), max(before, message.time)))
        late = self._stream.arrive(message.topic, message.time, message.arrival, message.values)
        self._withdraw(late)
        self._ahead = None
        return late is not None

    def _withdraw(self, late: Withdrawn | None) -> None:
        if late is not None:
            self._judges.withdraw(late)

    def interrupt(self) -> None:
        """The source is gone: no tick is judged until `miss` says what was lost."""
        self.interrupted = True
        self._gap_from = self._gap_from or self._now or None

    def miss(self, since: int, until: int) -> None:
        """Messages received from `since` to `until` were lost.

        By stamps, the messages around them tell which times that are.
        """
        self.interrupted, self._ahead = False, None
        if self._missed and since <= self._missed[-1][1]:
            before = self._missed.pop()
            since, until = min(since, before[0]), max(until, before[1])
        self._missed.append((since, until))
        if self._clock.time is TimeSource.LOG_TIME:
            self._gap_from = None
            self._withdraw(self._stream.miss(since, until))
        else:
            self._gap_from = self._gap_from or self._now or None

    def idle(self, now: int) -> Diagnostic | None:
        """Everything that was received before `now` has been given."""
        self._received = max(self._received, now)
        return self._pass(self._received - self._patience) if self._now else None

    def _pass(self, time: int) -> Diagnostic | None:
        if self.interrupted:
            return None
        found = self._stream.until(max(time, 0))
        if isinstance(found, Diagnostic):
            return found
        for tick in found:
            self._judges.step(tick)
        if found:
            self._ahead = None
        return None

    # What is known

    def states(self, *, ahead: bool = True) -> tuple[State, ...]:
        """Of each requirement what is known now.

        Args:
            ahead: whether what has come since the last tick counts for what is owed.
        """
        judges = self._judges
        if ahead and self._ahead is None:
            rows = [tick.truth for tick in self._stream.glance(max(self._now, self._time_passed))]
            self._ahead = judges.owed(rows)
        owed = self._ahead if ahead and self._ahead is not None else judges.owed()
        owed = (None,) * len(owed) if self.interrupted else owed
        read = zip(judges.standings(), owed, judges.last_triggers(), strict=True)
        return tuple(
            State(
                standing.requirement,
                self._verdict(standing),
                owing,
                trigger,
                self._tick_time(standing.open),
                self._tick_time(standing.deadline),
                None
                if standing.requirement in judges.counted
                else self._tick_time(standing.first_violation),
            )
            for standing, owing, trigger in read
        )

    @property
    def _time_passed(self) -> int:
        return self._received - self._patience

    def _verdict(self, standing: Standing) -> str:
        """That of the run, where it has ended; one with missed messages satisfies nothing."""
        if standing.requirement in self._final:
            return self._final[standing.requirement]
        verdict = self._judges.said(standing.requirement, str(standing.verdict))
        return "no data" if self._missed and verdict in ("satisfied", "vacuous") else verdict

    def _tick_time(self, tick: int | None) -> int | None:
        """When a tick is, perhaps one to come."""
        if tick is None:
            return None
        known = self._judges.ledger.time(tick)
        origin, period = self.origin, self._clock.period
        if known is not None or origin is None or period is None:
            return known
        return origin + self._clock.phase + tick * period

    def end(self) -> Ended | Diagnostic:
        """The run ends here."""
        if self._gap_from is not None:
            self._withdraw(self._stream.miss(self._gap_from, self._now))
        found = self._stream.end()
        if not isinstance(found, End):
            return found
        for tick in found.ticks:
            self._judges.step(tick)
        self._final = self._judges.verdicts(found.cut, intact=not self._missed)
        return Ended(self._final, found.until)

    def judge_again(self, log: str) -> Mapping[str, str] | Diagnostic:
        """Judge the run that has ended by a log of it, as an audit does: in the order of times.

        Returns:
            The verdicts, which `states` has, too; or why the log cannot be read.
        """
        declarations, names = self._plan.declarations, self._judges.propositions
        signals = signals_of(declarations, names)
        recording = read(log, declarations, signals, self._plan.integrity)
        if isinstance(recording, Diagnostic):
            return recording
        found = trace(declarations, recording, names)
        times = found.timeline.times.tolist()
        self._judges, self._ahead = Judges(self._plan), None
        rows = rows_of([found.columns[name] for name in names], len(times))
        for time, row in zip(times, rows, strict=True):
            self._judges.step(Tick(time, dict(zip(names, row, strict=True))))
        self._final = self._judges.verdicts(found.cut, intact=recording.intact)
        return self._final
