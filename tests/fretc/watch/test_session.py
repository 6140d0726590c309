"""What is said live is what an audit says of the recording: rows, verdicts, and what was late."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp

from hypothesis import example, given
from hypothesis import strategies as st

from fretc.api.requirements import read_project
from fretc.audit.one_log import audit, examined
from fretc.audit.plan import Plan, monitored_requirements, planned
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.traces import trace
from fretc.watch.recording import Recorder
from fretc.watch.session import Ended, Session
from fretc.watch.sources.source import Arrival, Channel
from fretish.diagnostics.diagnostic import Code
from monitors.kernel.verdicts import Truth

MS, START = 10**6, 10**12
SENTENCES = (
    "whenever near the r shall within 2 ticks satisfy still",
    "the r shall always satisfy !near | still",
    "upon near the r shall for 2 ticks satisfy slow",
    "whenever persisted(1, near) the r shall eventually satisfy slow",
)
BINDINGS = """
[clock]
tick = {tick}
time = "{time}"
{more}
[signal.x]
path = "/x.data"
{age}
[signal.y]
path = "/y.data"
[signal.z]
path = "/x.other"
[proposition.near]
expr = "x < 5"
agg = "{aggregate}"
{unknown}
[proposition.still]
expr = "(y < 5 for 12 ms) or (x < 5 and not (z < 5))"
[proposition.slow]
expr = "{slow}"
"""


@dataclass(frozen=True)
class Setting:
    """What bindings say."""

    tick: str = '"10 ms"'
    time: str = "header.stamp"
    more: str = ""
    age: str = ""
    aggregate: str = "any"
    unknown: str = ""
    slow: str = "y - pre(9, y) < 5"
    lateness: int = 5

    @property
    def bindings(self) -> str:
        waits = f'lateness = "{self.lateness} ms"'
        more = "\n".join([waits, *([self.more] if '"/' not in self.tick else [])])
        return BINDINGS.format(**{**vars(self), "more": more})


settings_ = st.builds(
    Setting,
    tick=st.sampled_from(['"10 ms"', '"10 ms"', '"/x"', '"/clock"']),
    time=st.sampled_from(["header.stamp", "header.stamp", "publish_time", "log_time"]),
    more=st.sampled_from(["", 'phase = "3 ms"', 'end = "violated"']),
    age=st.sampled_from(["", 'max_age = "17 ms"']),
    aggregate=st.sampled_from(["any", "all", "last"]),
    unknown=st.sampled_from(["", "on_unknown = true"]),
    slow=st.sampled_from(["y - pre(9, y) < 5", "y < 5 and x < 9", "z < 5 for 25 ms"]),
    lateness=st.sampled_from([0, 5, 20]),
)


@cache
def plan_of(setting: Setting) -> Plan:
    folder = Path(mkdtemp())
    for i, sentence in enumerate(SENTENCES):
        (folder / f"R{i}.fret").write_text(sentence)
    (folder / "bindings.toml").write_text(setting.bindings)
    plan = planned(read_project(folder))
    assert isinstance(plan, Plan), plan
    assert len(plan.claims) == len(SENTENCES)
    return plan


@dataclass(frozen=True)
class Sent:
    """A message: its time, and how much later it was received, in milliseconds."""

    topic: str
    value: float | None
    at: int
    delay: int = 0
    stamped: bool = True

    @property
    def arrival(self) -> Arrival:
        stamp = START + self.at * MS
        sec, nanosec = divmod(stamp, 10**9)
        content: dict[str, object] = {"data": self.value, "other": 4}
        if self.stamped:
            content["header"] = {"stamp": {"sec": sec, "nanosec": nanosec}}
        channel = Channel(self.topic, "json", "", "", b"")
        received = stamp + self.delay * MS
        return Arrival(channel, json.dumps(content).encode(), received, stamp)


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
) -> tuple[Session, Ended, Recording]:
    """A watch of the messages, with what its recording holds; `idle` milliseconds come last."""
    session = Session(plan)
    arrivals = sorted((each.arrival for each in some), key=lambda each: each.log_time)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        recorder = Recorder(path, plan.declarations.clock)
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
        assert isinstance(ended, Ended)
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


LATE_FIRST = [Sent("/x", 1.0, 0, delay=60), Sent("/x", 1.0, 40)]
"""The first message by its time comes when ticks are judged; durations count from it, too."""


def bound(some: Sequence[Sent], setting: Setting) -> bool:
    """Whether a message of a topic that is read has a time."""
    topics = {"/x", "/y", *(["/clock"] if "clock" in setting.tick else [])}
    return any(each.topic in topics for each in some)


@given(settings_, messages, st.sampled_from([0, 3, 40]))
@example(Setting(slow="z < 5 for 25 ms", lateness=0), LATE_FIRST, 3)
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
    assert said == sum(session.late.values())
