"""A whole watch: its recordings, its runs, and what it tells of what goes wrong."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from fretc.audit.plan import Plan
from fretc.watch.events import DiagnosticEvent, RunEnded, StateChange, WatchEvent
from fretc.watch.json_lines import line
from fretc.watch.recording import RunRecorder
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
from fretc.watch.watch import LOOK, SILENCE, Watch
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.each import each
from tests.fretc.watch.sent import MS, START, Sent, Setting, plan_of
from tests.json_schemas import validate

SETTING = Setting(slow="y < 5")
Item = Arrival | Event | Idle


@pytest.fixture
def plan() -> Plan:
    return plan_of(SETTING)


def told(watch: Watch, items: Iterable[Item]) -> list[WatchEvent]:
    """All news of the items, and of the end; every one fits the schema."""
    news = [each for item in items for each in watch.take(item)]
    news += watch.finish()
    for one in news:
        validate("watch.schema.json", line(one))
    return news


def steady(first: int, last: int, value: float = 9.0) -> Iterator[Arrival]:
    for at in range(first, last, 10):
        yield Sent("/x", value, at).arrival
        yield Sent("/y", 9.0, at).arrival


def codes(news: Sequence[WatchEvent]) -> list[Code]:
    return [each.diagnostic.code for each in news if isinstance(each, DiagnosticEvent)]


def runs(news: Sequence[WatchEvent]) -> list[RunEnded]:
    return [each for each in news if isinstance(each, RunEnded)]


@pytest.mark.slow
def test_each_change_of_a_requirement_is_news_once(plan: Plan) -> None:
    items = [*steady(0, 100), *steady(100, 130, 1.0), *steady(130, 300)]
    news = told(Watch(plan), items)
    changes = [each for each in news if isinstance(each, StateChange)]
    states = [each.state for each in changes if each.state.requirement == "R0"]
    assert states[-1].verdict == "violated"
    assert runs(news)[0].verdicts["R0"] == "violated"
    assert all(one != other for one, other in pairwise(states))


@pytest.mark.slow
@pytest.mark.parametrize("last", ["message", "idle"])
def test_what_is_pending_is_news_before_the_tick_and_soon(last: str) -> None:
    """The grid ticks every 10 ms and waits for 200: what comes is not judged for long."""
    watch = Watch(plan_of(Setting(slow="y < 5", lateness=200)))
    for arrival in steady(0, 300):
        list(watch.take(arrival))
    ticks, near = watch.session.ticks, Sent("/x", 1.0, 291).arrival
    first = [*watch.take(near)]
    received = near.log_time + LOOK
    more: Item = Sent("/x", 1.0, 291 + LOOK // MS).arrival if last == "message" else Idle(received)
    obligation_pending = [
        each.state.obligation_pending
        for each in [*first, *watch.take(more)]
        if isinstance(each, StateChange) and each.state.requirement == "R0"
    ]
    assert obligation_pending[-1] is True
    assert ticks > 5
    judged = watch.session.states(ahead=False)
    assert {each.requirement: each.obligation_pending for each in judged}["R0"] is False


def test_a_clock_that_is_set_back_begins_a_run_with_a_recording_of_its_own(
    plan: Plan, tmp_path: Path
) -> None:
    watch = Watch(plan, tmp_path / "run.mcap")
    news = told(watch, [*steady(5000, 5100), *steady(0, 100)])
    assert codes(news) == [Code.CLOCK_SET_BACK]
    assert [Path(run.recording or "").name for run in runs(news)] == ["run.mcap", "run-2.mcap"]
    assert [run.ticks for run in runs(news)] == [10, 10]
    assert watch.recordings == [str(tmp_path / "run.mcap"), str(tmp_path / "run-2.mcap")]
    assert not watch.failed


def later(arrivals: Iterable[Arrival], by: int) -> Iterator[Arrival]:
    """The same messages, received so many milliseconds later."""
    for one in arrivals:
        yield Arrival(one.channel, one.payload, one.log_time + by * MS, one.publish_time)


@pytest.mark.slow
def test_two_clocks_that_take_turns_are_given_up(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fretc.watch.watch.MOST_RUNS", 3)
    turns = (next(later([Sent("/x", 9.0, 5000 * (i % 2)).arrival], 10_000 + i)) for i in range(100))
    watch = Watch(plan)
    news: list[WatchEvent] = []
    for item in turns:
        news += watch.take(item)
        if watch.ended:
            break
    assert watch.failed
    assert len(watch.runs) == 3
    assert codes(news)[-1] is Code.CLOCK_SET_BACK


def test_a_topic_of_which_nothing_comes_is_told_of_once(plan: Plan) -> None:
    received = START + SILENCE + 5 * MS
    items: list[Item] = [Sent("/x", 9.0, 0).arrival, Idle(received), Idle(received + 50 * MS)]
    news = told(Watch(plan), items)
    (found,) = [each for each in news if isinstance(each, DiagnosticEvent)]
    assert found.diagnostic.code is Code.NOTHING_COMES
    assert "`/y`" in found.diagnostic.message


def test_a_full_disk_ends_the_recording_and_not_the_watch(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    watch = Watch(plan, tmp_path / "run.mcap")
    first = [each for item in steady(0, 50) for each in watch.take(item)]
    monkeypatch.setattr(RunRecorder, "message", full)
    news = first + told(watch, steady(50, 100))
    assert codes(news) == [Code.NOT_RECORDED]
    assert watch.failed
    assert runs(news)[0].ticks == 10
    assert runs(news)[0].recording is None


def test_a_recording_is_not_written_over(plan: Plan, tmp_path: Path) -> None:
    (tmp_path / "run.mcap").write_bytes(b"mine")
    with pytest.raises(FileExistsError):
        Watch(plan, tmp_path / "run.mcap")
    assert (tmp_path / "run.mcap").read_bytes() == b"mine"


BROKEN = Diagnostic(Code.UNREADABLE, "the robot does not answer")


@pytest.mark.slow
def test_what_was_not_missed_may_be_vacuous(plan: Plan) -> None:
    told_of_all = runs(told(Watch(plan), [Opened("x"), *steady(0, 200)]))[0]
    assert "vacuous" in told_of_all.verdicts.values()


@pytest.mark.slow
@each(
    "events",
    [
        [Missed(START + 50 * MS, START + 60 * MS, 3)],
        [ConnectionLost(START + 50 * MS, BROKEN), Reconnected(START + 50 * MS, START + 60 * MS)],
        [ConnectionLost(START + 50 * MS, BROKEN)],
    ],
)
def test_what_was_missed_satisfies_nothing(plan: Plan, events: list[Event]) -> None:
    news = told(Watch(plan), [*steady(0, 50), *events, *steady(70, 200)])
    assert not {"satisfied", "vacuous"} & {*runs(news)[0].verdicts.values()}
    assert [each for each in news if isinstance(each, type(events[0]))] == events[:1]


def test_a_problem_of_the_source_is_told_and_the_watch_goes_on(plan: Plan) -> None:
    watch = Watch(plan)
    news = told(watch, [Problem(BROKEN), *steady(0, 100)])
    assert codes(news) == [Code.UNREADABLE]
    assert watch.failed
    assert runs(news)[0].ticks == 10


def test_a_source_that_was_never_there_leaves_nothing(plan: Plan, tmp_path: Path) -> None:
    """So the same command works once it is."""
    watch = Watch(plan, tmp_path / "run.mcap")
    news = told(watch, [Idle(START), Problem(BROKEN)])
    assert codes(news) == [Code.UNREADABLE]
    assert len(news) == 1
    assert watch.failed
    assert not [*tmp_path.iterdir()]
