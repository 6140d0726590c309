from dataclasses import replace
from pathlib import Path

import pytest

from fretc.logs.signals.rates import slow_topics
from tests.fretc.logs.logs import MS, X_TEXT, S, declare, number, recorded, write

AGE = 'max_age = "250 ms"\n'
UNAGED = X_TEXT.replace(AGE, "")


def warnings_of(path: Path, period: int, text: str = X_TEXT, jitter: int = 0) -> list[str]:
    sent = [number(1.0, 1000 * S + i * period + i % 2 * jitter) for i in range(12)]
    declarations = declare(text)
    recording = recorded(write(path / "log.mcap", sent), declarations)
    return [
        f"{finding.code.number} {finding.message}"
        for finding in slow_topics(declarations, recording, ["x"])
    ]


@pytest.mark.parametrize("period", [10 * MS, 100 * MS, 109 * MS])
def test_a_topic_that_comes_with_each_tick_is_fast_enough(tmp_path: Path, period: int) -> None:
    assert warnings_of(tmp_path, period) == []
    assert warnings_of(tmp_path, period, jitter=MS) == []


def test_one_slower_than_the_tick_is_told(tmp_path: Path) -> None:
    assert warnings_of(tmp_path, 200 * MS, UNAGED) == [
        "F315 `/x` comes every 200 ms, and the clock ticks every 100 ms: most ticks use the "
        "sample of an earlier tick"
    ]


def test_one_slower_than_the_tick_is_meant_where_max_age_is_stated(tmp_path: Path) -> None:
    assert warnings_of(tmp_path, 200 * MS) == []
    assert warnings_of(tmp_path, 250 * MS) == []


def test_one_slower_than_max_age_is_told_as_that(tmp_path: Path) -> None:
    assert warnings_of(tmp_path, 500 * MS) == [
        "F318 `/x` comes every 500 ms, and a sample of `x` counts for 250 ms: in between it is "
        "unknown"
    ]
    aged = X_TEXT.replace('"100 ms"', '"1 s"').replace("250 ms", "499 ms")
    assert len(warnings_of(tmp_path, 500 * MS, aged)) == 1


def test_a_clock_that_ticks_by_message_is_as_fast_as_its_topic(tmp_path: Path) -> None:
    declarations = declare(X_TEXT.replace('"100 ms"', '"/y"').replace(AGE, ""))
    sent = [number(1.0, 1000 * S + i * 200 * MS) for i in range(12)]
    sent += [number(1.0, 1000 * S + i * 50 * MS, topic="/y") for i in range(33)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declarations)
    (finding,) = slow_topics(declarations, recording, ["x"])
    assert finding.message.startswith(
        "`/x` comes every 200 ms, and the clock ticks every 50 ms (each message of `/y`)"
    )


def test_what_came_once_or_never_has_no_rate(tmp_path: Path) -> None:
    declarations = declare(X_TEXT)
    recording = recorded(write(tmp_path / "log.mcap", [number(1.0, S)]), declarations)
    assert list(slow_topics(declarations, recording, ["x"])) == []
    nothing = replace(recording, topics={})
    assert list(slow_topics(declarations, nothing, ["x"])) == []


def test_events_have_no_rate_where_a_sample_counts_until_the_next(tmp_path: Path) -> None:
    sent = [number(1.0, time * S) for time in (1000, 1001, 1002, 1030, 1031)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(X_TEXT))
    assert len(list(slow_topics(declare(X_TEXT), recording, ["x"]))) == 1
    events = declare(UNAGED)
    assert list(slow_topics(events, recording, ["x"])) == []
    few = [number(1.0, time * S) for time in range(1000, 1009)]
    assert (
        list(slow_topics(events, recorded(write(tmp_path / "few.mcap", few), events), ["x"])) == []
    )
    regular = [number(1.0, time * S) for time in range(1000, 1010)]
    steady = recorded(write(tmp_path / "steady.mcap", regular), events)
    assert len(list(slow_topics(events, steady, ["x"]))) == 1
