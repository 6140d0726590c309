"""Logs whose messages stand in any order: the watch ends with what its evidence says."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.audit.one_log import audit
from fretc.audit.plan import Plan, monitored_requirements
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.watch.events import DiagnosticEvent, LateMessages, RunEnded, WatchEvent
from fretc.watch.sources.log import Log
from fretc.watch.sources.source import Idle
from fretc.watch.watch import Watch
from fretish.diagnostics.diagnostic import Code
from tests.effort import examples
from tests.fretc.logs.logs import Sent as Written
from tests.fretc.logs.logs import write
from tests.fretc.watch.sent import Sent, Setting, plan_of, settings_
from tests.fretc.watch.test_session import audited_rows, bound, live_rows, messages

BY_ARRIVAL = Setting(time="log_time", slow="y < 5")


def written(path: Path, some: Sequence[Sent], per_chunk: int | None) -> str:
    """A log with the messages in their order."""
    arrivals = [each.arrival for each in some]
    sent = [
        Written(each.channel.topic, "", each.payload, each.log_time, each.publish_time, "json")
        for each in arrivals
    ]
    return str(write(path, sent, per_chunk=per_chunk, chunked=per_chunk is not None))


def watched(plan: Plan, log: str, record: Path | None) -> tuple[Watch, list[WatchEvent]]:
    watch = Watch(plan, record, log)
    items = (item for item in Log(log, follow=False).arrivals(watch.topics))
    news = [each for item in items if not isinstance(item, Idle) for each in watch.take(item)]
    return watch, [*news, *watch.finish()]


def audited(plan: Plan, log: str) -> tuple[Recording, dict[str, str]]:
    recording = read(log, plan.declarations, list(plan.declarations.signals))
    assert isinstance(recording, Recording)
    found = audit(recording, plan.declarations, monitored_requirements(plan))
    return recording, {each.requirement: each.verdict for each in found}


REPORTED = [Sent("/x", 1.0, 80), Sent("/y", 9.0, 44), Sent("/x", 9.0, 0), Sent("/y", 1.0, 60)]
"""Messages of one topic after another, each in a disorder of its own."""


@pytest.mark.slow
@example(BY_ARRIVAL, REPORTED, None, True)
@given(settings_, messages, st.sampled_from([None, 1, 3, 100]), st.booleans())
@examples(6)
def test_what_is_shown_at_the_end_is_what_the_evidence_says(
    setting: Setting, some: list[Sent], per_chunk: int | None, records: bool
) -> None:
    """That of the recording, where there is one; by arrival also that of the log itself.

    By stamps the recording says where the grid of the watch began, and the log does not.
    """
    if not bound(some, setting):
        return
    plan = plan_of(setting)
    with TemporaryDirectory() as folder:
        log = written(Path(folder) / "run.mcap", some, per_chunk)
        record = Path(folder) / "seen.mcap" if records else None
        watch, news = watched(plan, log, record)
        (ended,) = [each for each in news if isinstance(each, RunEnded)]
        codes = [each.diagnostic.code for each in news if isinstance(each, DiagnosticEvent)]
        assert (Code.DISORDERED in codes) is (watch.session.disordered > 0)
        for audited_log in [str(record)] * records + [log] * (setting.time == "log_time"):
            recording, verdicts = audited(plan, audited_log)
            assert live_rows(watch.session) == audited_rows(plan, recording)
            assert ended.ticks == len(live_rows(watch.session))
            assert ended.verdicts == verdicts
            assert Code.FOREIGN_GRID not in {each.code for each in recording.findings}
        states = {each.requirement: each.verdict for each in watch.session.states(ahead=False)}
        assert states == ended.verdicts


@pytest.mark.slow
@given(messages)
@examples(6)
def test_by_arrival_in_order_nothing_is_late_and_nothing_judged_again(some: list[Sent]) -> None:
    if not bound(some, BY_ARRIVAL):
        return
    with TemporaryDirectory() as folder:
        ordered = sorted(some, key=lambda each: each.arrival.log_time)
        log = written(Path(folder) / "run.mcap", ordered, 3)
        watch, news = watched(plan_of(BY_ARRIVAL), log, None)
        assert not watch.session.disordered
        assert not any(isinstance(each, LateMessages) for each in news)
