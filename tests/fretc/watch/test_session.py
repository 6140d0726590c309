"""What is said live is what an audit says of the recording: rows, verdicts, and what was late."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.audit.one_log import audit, examined
from fretc.audit.plan import Plan, monitored_requirements
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.traces import trace
from fretc.watch.recording import RunRecorder
from fretc.watch.session import EndedRun, Jump, Session
from fretish.diagnostics.diagnostic import Code, Diagnostic
from monitors.kernel.verdicts import Truth
from tests.effort import examples
from tests.fretc.watch.sent import MEMORIES, MS, START, Sent, Setting, plan_of, settings_

messages = st.lists(
    st.builds(
        Sent,
        topic=st.sampled_from(["/x", "/x", "/y", "/clock"]),
        value=st.sampled_from([1.0, 9.0, None]),
        at=st.integers(0, 90),
        delay=st.sampled_from([0, 0, 1, 5, 6, 21, 60]),
        stamped=st.sampled_from([True, True, True, False]),
    ),
    min_size=1,
    max_size=25,
)


def recorded(
    plan: Plan, some: Sequence[Sent], idle: int, missed: Sequence[int] = ()
) -> tuple[Session, EndedRun, Recording]:
    """A watch of the messages, with what its recording holds; `idle` milliseconds come last."""
    session = Session(plan)
    arrivals = sorted((each.arrival for each in some), key=lambda each: each.log_time)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        recorder = RunRecorder(path, plan.declarations.clock)
        for i, arrival in enumerate(arrivals):
            if i in missed:
                before = arrivals[i - 1].log_time if i else arrival.log_time
                session.miss(before, arrival.log_time)
                continue
            recorder.message(arrival)
            assert session.arrive(arrival) is None
            recorder.grid(session.origin)
        session.idle(arrivals[-1].log_time + idle * MS)
        ended = session.end()
        assert isinstance(ended, EndedRun)
        recorder.grid(session.origin)
        recorder.close(ended.until, session.missed)
        recording = read(str(path), plan.declarations, list(plan.declarations.signals))
    assert isinstance(recording, Recording)
    return session, ended, recording


def live_rows(session: Session) -> list[tuple[int, dict[str, Truth]]]:
    ledger = session.ledger
    return [(ledger.time(i) or 0, dict(ledger.row(i))) for i in range(len(ledger))]


def audited_rows(plan: Plan, recording: Recording) -> list[tuple[int, dict[str, Truth]]]:
    names = sorted(plan.declarations.propositions)
    found = trace(plan.declarations, recording, names)
    return [
        (time, {name: found.columns[name].at(i) for name in names})
        for i, time in enumerate(found.timeline.times.tolist())
    ]


def bound(some: Sequence[Sent], setting: Setting) -> bool:
    """Whether a message of a topic that is read has a time."""
    topics = {"/x", "/y", *(["/clock"] if "clock" in setting.tick else [])}
    return any(each.topic in topics for each in some)


LATE_FIRST = [
    Sent("/y", 9.0, 44),
    Sent("/x", 1.0, 68, delay=5),
    Sent("/x", 1.0, 68, delay=5),
    Sent("/x", 1.0, 23, delay=60),
]
"""The last of them is the first by its time, and later ticks look back to it."""


@pytest.mark.slow
@example(Setting(time="publish_time", slow="z < 5 for 25 ms", lateness=20), LATE_FIRST, 40)
@example(Setting(slow="v < 9.1 for 12 ms"), [Sent("/x", 1.0, 0), Sent("/y", 9.0, 5)], 40)
@example(Setting(slow="v - pre(9, v) < 2"), [Sent("/x", 1.0, 0), Sent("/y", 9.0, 5)], 40)
@given(settings_, messages, st.sampled_from([0, 3, 40]))
@examples(6)
def test_rows_and_verdicts_are_those_of_the_audit(
    setting: Setting, some: list[Sent], idle: int
) -> None:
    if not bound(some, setting):
        return
    plan = plan_of(setting)
    session, ended, recording = recorded(plan, some, idle)
    assert live_rows(session) == audited_rows(plan, recording)
    found = audit(recording, plan.declarations, monitored_requirements(plan))
    assert ended.verdicts == {each.requirement: each.verdict for each in found}
    assert Code.FOREIGN_GRID not in {each.code for each in recording.findings}
    late = examined(recording, plan.declarations, sorted(plan.declarations.propositions)).findings
    said = sum(int(each.message.split()[0]) for each in late if each.code is Code.LATE_MESSAGES)
    counted = sum(session.late.values())  # a late tick of a message may lie in an earlier span
    assert said == counted if plan.declarations.clock.period is not None else said >= counted


BY_STAMP = Setting(slow="y < 5")


@pytest.mark.slow
@given(messages, st.sets(st.integers(0, 24), min_size=1))
@examples(10)
def test_what_was_missed_satisfies_nothing_live_and_audited(
    some: list[Sent], missed: set[int]
) -> None:
    """Some messages are dropped. What is said differs at most by what each knows of when."""
    plan = plan_of(BY_STAMP)
    ordered = sorted(some, key=lambda each: each.arrival.log_time)
    dropped = [i for i in range(len(ordered)) if i in missed]
    kept = [each for i, each in enumerate(ordered) if i not in missed]
    if not dropped or not bound(kept, BY_STAMP):
        return
    _, ended, recording = recorded(plan, ordered, 0, dropped)
    found = audit(recording, plan.declarations, monitored_requirements(plan))
    assert not recording.intact
    assert not {"satisfied", "vacuous"} & {*ended.verdicts.values()}
    assert not {"satisfied", "vacuous"} & {each.verdict for each in found}


@pytest.mark.slow
@given(messages, st.data())
@examples(6)
def test_nothing_is_judged_while_the_source_is_gone(some: list[Sent], data: st.DataObject) -> None:
    """By arrival both know when it was, so the audit says the same; some messages still came."""
    slow = data.draw(st.sampled_from(["y < 5", *MEMORIES]))
    setting = Setting(time="log_time", slow=slow)
    if not bound(some, setting):
        return
    plan = plan_of(setting)
    arrivals = sorted((each.arrival for each in some), key=lambda each: each.log_time)
    first = data.draw(st.integers(1, len(arrivals)))
    last = data.draw(st.integers(first, len(arrivals)))
    since = arrivals[first - 1].log_time + 1
    session = Session(plan)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        recorder = RunRecorder(path, plan.declarations.clock)
        for i, arrival in enumerate(arrivals):
            if i == first:
                session.interrupt()
                ticks = session.ticks
            if first <= i < last:
                assert session.ticks == ticks
                assert {state.obligation_pending for state in session.states()} == {None}
                session.idle(arrival.log_time)
            if i == last:
                session.miss(since, max(since, arrival.log_time - 1))
            recorder.message(arrival)
            assert session.arrive(arrival) is None
            recorder.grid(session.origin)
        if last == len(arrivals):
            session.interrupt()
            session.idle(arrivals[-1].log_time + 30 * MS)
            session.miss(since, session.received)
        ended = session.end()
        assert isinstance(ended, EndedRun)
        recorder.grid(session.origin)
        recorder.close(ended.until, session.missed)
        recording = read(str(path), plan.declarations, list(plan.declarations.signals))
    assert isinstance(recording, Recording)
    assert live_rows(session) == audited_rows(plan, recording)
    found = audit(recording, plan.declarations, monitored_requirements(plan))
    assert ended.verdicts == {each.requirement: each.verdict for each in found}


def test_what_is_pending_does_not_wait_for_the_tick() -> None:
    plan = plan_of(Setting(slow="y < 5", lateness=20))
    session = Session(plan)
    far, near = Sent("/x", 9.0, 0), Sent("/x", 1.0, 34)
    still = [Sent("/y", 9.0, 0), Sent("/y", 9.0, 30)]
    for each in (far, *still):
        assert session.arrive(each.arrival) is None
    assert session.ticks == 1
    assert {state.requirement: state.obligation_pending for state in session.states()}[
        "R0"
    ] is False
    session.arrive(near.arrival)
    assert session.ticks == 2
    states = {state.requirement: state for state in session.states()}
    assert states["R0"].obligation_pending is True
    assert states["R0"].verdict == "vacuous"
    judged = {state.requirement: state.obligation_pending for state in session.states(ahead=False)}
    assert judged["R0"] is False


def test_a_clock_that_was_set_back_is_another_run() -> None:
    session = Session(plan_of(BY_STAMP))
    assert session.arrive(Sent("/x", 9.0, 5000).arrival) is None
    assert session.arrive(Sent("/x", 9.0, 4500, delay=501).arrival) is None
    found = session.arrive(Sent("/x", 9.0, 3000, delay=2100).arrival)
    assert found == Jump("/x", 2000 * MS)
    assert session.topics["/x"].count == 2


def test_a_clock_that_leaps_ahead_by_a_million_ticks_is_told_of() -> None:
    session = Session(plan_of(BY_STAMP))
    assert session.arrive(Sent("/x", 9.0, 0).arrival) is None
    assert session.arrive(Sent("/y", 9.0, 0).arrival) is None
    assert session.arrive(Sent("/x", 9.0, 30).arrival) is None
    found = session.arrive(Sent("/x", 9.0, 11_000_000).arrival)
    assert isinstance(found, Diagnostic)
    assert found.code is Code.TOO_LARGE


def test_a_loss_that_is_known_late_makes_unknown_what_came_since() -> None:
    """A message of `/x` is lost; it is noticed after `/y` has gone on for long."""
    session = Session(plan_of(BY_STAMP))
    for at in range(0, 1000, 10):
        session.arrive(Sent("/y", 9.0, at).arrival)
        if at in (0, 300):
            session.arrive(Sent("/x", 1.0, at).arrival)
    session.miss(START + 301 * MS, START + 995 * MS)
    session.arrive(Sent("/x", 1.0, 1000).arrival)
    session.end()
    near = {time: row["near"] for time, row in live_rows(session)}
    assert near[START + 150 * MS] is True
    after = {near[time] for time in near if START + 300 * MS < time < START + 1000 * MS}
    assert after == {None}
