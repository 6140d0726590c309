"""Sessions, recordings and events from a source; each run has a session and a recording."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fretc.audit.plan import Plan
from fretc.watch.events import DiagnosticEvent, LateMessages, RunEnded, StateChange, WatchEvent
from fretc.watch.recording import RunRecorder
from fretc.watch.session import EndedRun, Jump, Session
from fretc.watch.sources.source import (
    Arrival,
    ConnectionLost,
    Event,
    Idle,
    Missed,
    Opened,
    Problem,
    Reconnected,
)
from fretish.bindings.amounts import duration
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.stop_supervisor import State

MOST_RUNS = 100
"""The number of runs after which a clock that is set back repeatedly is taken for two clocks."""
LOOK = 50 * 10**6
"""Nanoseconds of receive time after which the open obligations are updated, even if no tick was
judged: an update costs as much as a tick."""
SILENCE = 5 * 10**9
"""Nanoseconds after which a topic without messages is reported."""


class Watch:
    """A watch of one run or, if a clock is set back, of several."""

    def __init__(self, plan: Plan, record: Path | None = None, log: str | None = None) -> None:
        """A watch without messages yet.

        Args:
            plan: the plan; its clock has a lateness, if it needs one.
            record: the file to write; for a second run, with `-2` before its suffix.
            log: the log that is watched; None: the source is not a log.

        Raises:
            OSError: the file exists already, or cannot be written.
        """
        self._plan, self._record, self._log = plan, record, log
        self.session = Session(plan)
        self.runs: list[RunEnded] = []
        self.failed = False
        """Whether an error leaves a run, or its recording, unfinished."""
        self.ended = False
        """Whether nothing more can be watched."""
        self._states: dict[str, State] = {}
        self._seen: tuple[State, ...] = ()
        """The states that were compared last."""
        self._late = 0
        self._began: int | None = None
        self._looked = 0
        """The receive time of the last update of open obligations."""
        self._judged = 0, 0
        """The number of ticks evaluated until then, and of those that had become unknown."""
        self._silent: set[str] = set()
        self._lost_since: int | None = None
        self._has_begun = False
        """Whether the source was ever connected."""
        self._recorder = self._new_recorder()

    @property
    def topics(self) -> list[str]:
        """All topics that are read."""
        return sorted(self.session.topics)

    @property
    def recordings(self) -> list[str]:
        """The files of the runs that have ended."""
        return [run.recording for run in self.runs if run.recording is not None]

    def _new_recorder(self) -> RunRecorder | None:
        if self._record is None:
            return None
        path = self._record
        if self.runs:
            path = path.with_name(f"{path.stem}-{len(self.runs) + 1}{path.suffix}")
        return RunRecorder(path, self._plan.declarations.clock)

    # Arrivals

    def take(self, item: Arrival | Event | Idle) -> Iterator[WatchEvent]:
        """Process one message or event of a source, and return the events to report."""
        match item:
            case Arrival():
                yield from self._arrive(item)
            case Idle(now):
                if now is not None and self._has_begun:
                    yield from self._passed(self.session.idle(now))
                    yield from self._silences(now)
            case Missed(since, until):
                self.session.miss(since, until)
                yield item
            case Reconnected(since, until):
                self.session.miss(min(since, self._lost_since or since), until)
                self._lost_since = None
                yield item
            case ConnectionLost(since):
                self._lost_since = since
                self.session.interrupt()
                yield item
                yield from self._changes()
            case Opened():
                self._has_begun = True
                yield item
            case Problem(diagnostic):
                self.failed |= diagnostic.is_error
                yield DiagnosticEvent(diagnostic)

    def _arrive(self, arrival: Arrival) -> Iterator[WatchEvent]:
        self._began = self._began or arrival.log_time
        self._has_begun = True
        found = self.session.arrive(arrival)
        if isinstance(found, Jump):
            yield from self._begin_anew(found, arrival)
            if self.ended:
                return
            found = self.session.arrive(arrival)
            assert not isinstance(found, Jump), "the first message of a run has none before it"
        if self._recorder is not None:
            yield from self._recorded(arrival)
        if found is not None or self._is_due(arrival.log_time):
            yield from self._passed(found)
        if self.session.problems:
            yield from map(DiagnosticEvent, self.session.problems)
            self.session.problems.clear()
        if arrival.log_time - self._began > SILENCE:
            yield from self._silences(arrival.log_time)

    def _is_due(self, now: int) -> bool:
        """Whether there can be new events: after one more tick, or after some time."""
        judged = self.session.ticks, self.session.late_ticks
        if judged == self._judged and now - self._looked < LOOK:
            return False
        self._looked, self._judged = now, judged
        return True

    def _passed(self, wrong: Diagnostic | None) -> Iterator[WatchEvent]:
        if wrong is not None:
            self.failed = self.ended = True
            yield DiagnosticEvent(wrong)
        yield from self._changes()

    def _changes(self, *, ahead: bool = True) -> Iterator[WatchEvent]:
        if self.session.late_ticks > self._late:
            self._late = self.session.late_ticks
            yield LateMessages(self._late, dict(self.session.late))
        states = self.session.states(ahead=ahead)
        if states is self._seen:
            return
        self._seen = states
        for state in states:
            before = self._states.get(state.requirement)
            if state != before:
                self._states[state.requirement] = state
                yield StateChange(state, before, self.session.now)

    def _silences(self, now: int) -> Iterator[WatchEvent]:
        self._began = self._began or now
        if now - self._began < SILENCE:
            return
        for name, topic in self.session.topics.items():
            if not topic.count and name not in self._silent | self.session.static_topics:
                self._silent.add(name)
                yield DiagnosticEvent(_silent(name))

    def _begin_anew(self, jump: Jump, arrival: Arrival) -> Iterator[WatchEvent]:
        """End this run and begin another one, because a clock was set back."""
        yield DiagnosticEvent(_set_back(jump))
        yield from self.finish(begins_anew=True)
        if len(self.runs) >= MOST_RUNS:
            self.failed = self.ended = True
            yield DiagnosticEvent(_two_clocks(jump))
            return
        self.session = Session(self._plan)
        if self._lost_since is not None:
            self.session.interrupt()
        self._states, self._late, self._began = {}, 0, arrival.log_time
        self._looked, self._judged = 0, (0, 0)
        self._silent = set()
        try:
            self._recorder = self._new_recorder()
        except OSError as error:
            yield from self._not_recorded(error)

    # The recording

    def _recorded(self, arrival: Arrival) -> Iterator[WatchEvent]:
        if self._recorder is None or arrival.channel.topic not in self.session.topics:
            return
        try:
            self._recorder.grid(self.session.origin)
            self._recorder.message(arrival)
        except OSError as error:
            yield from self._not_recorded(error)

    def _not_recorded(self, error: OSError) -> Iterator[WatchEvent]:
        self.failed = True
        path = self._record
        if self._recorder is not None:
            path = self._recorder.path
            self._recorder.abandon()
        self._recorder = None
        yield DiagnosticEvent(_not_recorded(str(path), error.strerror or str(error)))

    def finish(self, *, begins_anew: bool = False) -> Iterator[WatchEvent]:
        """End the present run: its verdicts are those of an audit of its recording.

        If the source was never connected, there is neither a run nor a recording.

        Args:
            begins_anew: whether another run of the same source follows.
        """
        if not self._has_begun:
            if self._recorder is not None:
                self._recorder.discard()
            return
        if self._lost_since is not None:
            self.session.miss(self._lost_since, max(self._lost_since, self.session.received))
        ended = self.session.end()
        if not isinstance(ended, EndedRun):
            self.failed = True
            yield DiagnosticEvent(ended)
            ended = EndedRun(dict.fromkeys(self._states, "no data"), self.session.now)
        path, session = None, self.session
        if self._recorder is not None:
            path = str(self._recorder.path)
            try:
                self._recorder.grid(None if session.disordered else session.origin)
                self._recorder.close(ended.until, session.missed, session.disordered)
            except OSError as error:
                yield from self._not_recorded(error)
            self._recorder = None
        verdicts = ended.verdicts
        if session.disordered:
            log = path or (self._log if not self.runs and not begins_anew else None)
            judged = diagnostic("run_not_recorded") if log is None else session.judge_again(log)
            yield DiagnosticEvent(_disordered(session.disordered, log, judged))
            verdicts = verdicts if isinstance(judged, Diagnostic) else judged
        yield from self._changes(ahead=False)
        run = RunEnded(len(self.runs) + 1, verdicts, path, session.ticks)
        self.runs.append(run)
        yield run


def _silent(topic: str) -> Diagnostic:
    return diagnostic("silent_topic", topic=topic, length=duration(SILENCE / 1e9))


def _set_back(jump: Jump) -> Diagnostic:
    return diagnostic("clock_set_back", topic=jump.topic, length=duration(jump.by / 1e9))


def _two_clocks(jump: Jump) -> Diagnostic:
    return diagnostic("clock_set_back_too_often", topic=jump.topic, most=MOST_RUNS)


def _disordered(count: int, log: str | None, judged: object) -> Diagnostic:
    messages = f"{count} message{'s' * (count > 1)} of the log came after later ones"
    if not isinstance(judged, Diagnostic):
        return diagnostic("run_judged_again", messages=messages, log=log)
    return diagnostic("unknown_after_disorder", messages=messages, message=judged.message)


def _not_recorded(path: str, why: str) -> Diagnostic:
    return diagnostic("recording_stopped", path=path, why=why)
