"""Messages that were late, and where a watch began its grid: what a log says, and what counts."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fretc.audit.one_log import examined
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.topic_clocks import late
from fretc.logs.signals.traces import trace
from fretc.logs.watch_records import clock_text, grid_record, watch_record
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code
from monitors import ticking
from tests.fretc.logs.logs import MS, S, Sent, codes, declare, number, recorded, write

START = 1000 * S
BINDINGS = """
[clock]
tick = "10 ms"
time = "{time}"
{more}
[signal.x]
path = "/x.data"
[signal.y]
path = "/y.data"
[proposition.p]
expr = "x < 5"
{unknown}
[proposition.q]
expr = "y < 5 or (x < 5 for 15 ms)"
agg = "any"
"""


def bindings(more: str = "", unknown: str = "", time: str = "publish_time") -> Declarations:
    return declare(BINDINGS.format(more=more, unknown=unknown, time=time))


def sent(topic: str, value: float, at: int, delay: int) -> Sent:
    """A message of a time in milliseconds, received so much later."""
    made = number(value, START + (at + delay) * MS, topic)
    return Sent(made.topic, made.type, made.payload, made.time, START + at * MS)


Row = tuple[str, float, int, int]
rows = st.lists(
    st.tuples(
        st.sampled_from(["/x", "/y"]),
        st.sampled_from([1.0, 9.0, float("nan")]),
        st.integers(0, 90),
        st.sampled_from([0, 0, 1, 5, 6, 30]),
    ),
    min_size=1,
    max_size=25,
)


def written(path: Path, some: list[Row], metadata: Mapping[str, dict[str, str]] = {}) -> Path:
    messages = sorted((sent(*row) for row in some), key=lambda each: each.time)
    return write(path / "log.mcap", messages, metadata=list(metadata.items()))


@pytest.mark.slow
@given(some=rows, lateness=st.sampled_from([0, 5, 20]), unknown=st.sampled_from(["", "true"]))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_proposition_is_unknown_where_a_message_was_late_and_else_what_it_is(
    tmp_path: Path, some: list[Row], lateness: int, unknown: str
) -> None:
    """Compared with the definition, message by message and tick by tick."""
    path, on_unknown = written(tmp_path, some), f"on_unknown = {unknown}" if unknown else ""
    timely = bindings(unknown=on_unknown)
    waiting = bindings(f'lateness = "{lateness} ms"', on_unknown)
    plain = trace(timely, recorded(path, timely), ["p", "q"])
    found = trace(waiting, recorded(path, waiting), ["p", "q"])
    ticks = found.timeline.times.tolist()
    assert ticks == plain.timeline.times.tolist()
    for name, topics in (("p", {"/x"}), ("q", {"/x", "/y"})):
        for i, tick in enumerate(ticks):
            is_late = any(
                START + at * MS <= tick and tick + lateness * MS < START + (at + delay) * MS
                for topic, _, at, delay in some
                if topic in topics
            )
            expected = None if is_late else plain.columns[name].at(i)
            assert found.columns[name].at(i) is expected


@given(st.lists(st.tuples(st.integers(0, 50), st.integers(0, 50)), max_size=9), st.integers(0, 20))
def test_late_is_what_the_module_on_ticks_says(some: list[tuple[int, int]], lateness: int) -> None:
    arrivals = np.array([arrival for _, arrival in some], np.int64)
    times = np.array([time for time, _ in some], np.int64)
    found = late(arrivals, times, lateness)
    spans = [ticking.late(time, arrival, lateness) for time, arrival in some]
    expected = [span for span in spans if span is not None]
    pairs = [] if found is None else zip(found.firsts.tolist(), found.lasts.tolist(), strict=True)
    assert list(pairs) == expected


LATE = [("/x", 1.0, 10 * i, 0) for i in range(10)] + [("/y", 1.0, 25, 30), ("/y", 9.0, 41, 5)]


def test_late_messages_are_counted_with_the_lateness_that_would_do(tmp_path: Path) -> None:
    """That of 25 ms came 25 ms after the tick of 30 ms; that of 41 ms was there before 50 ms."""
    declarations = bindings('lateness = "2 ms"')
    recording = recorded(written(tmp_path, LATE), declarations)
    found = examined(recording, declarations, ["p", "q"]).findings
    (finding,) = [each for each in found if each.code is Code.LATE_MESSAGES]
    assert "1 of 2 messages of `/y` came more than 2 ms after the tick" in finding.message
    assert "at most 25 ms" in finding.message
    assert finding.help == 'write `lateness = "30 ms"` under `[clock]` to wait for them'
    assert not finding.is_error
    timely = bindings('lateness = "25 ms"')
    of_all = examined(recorded(written(tmp_path, LATE), timely), timely, ["p", "q"])
    assert "F429" not in codes(of_all)


def test_by_log_time_nothing_is_late(tmp_path: Path) -> None:
    declarations = bindings('lateness = "0 ms"', time="log_time")
    recording = recorded(written(tmp_path, LATE), declarations)
    assert recording.late == {}
    assert clock_text(declarations.clock) == "10 ms, by log_time"


# The grid of a watch


CLOCK = bindings('lateness = "5 ms"').clock
TIMELY: list[Row] = [("/x", 1.0, 3 + 10 * i, 1) for i in range(5)] + [("/y", 9.0, 7, 1)]


def watched(
    path: Path, metadata: Mapping[str, dict[str, str]], some: list[Row] = TIMELY
) -> Recording:
    return recorded(written(path, some, metadata), bindings('lateness = "5 ms"'))


def test_the_grid_and_the_end_of_a_watch_are_taken_over(tmp_path: Path) -> None:
    records = {
        "fretc.grid": grid_record(CLOCK, START + 4 * MS),
        "fretc.watch": watch_record(CLOCK, START + 80 * MS, ()),
    }
    recording = watched(tmp_path, records)
    ticks = trace(bindings(), recording, ["p"]).timeline.times
    assert ((ticks - START) // MS).tolist() == [4, 14, 24, 34, 44, 54, 64, 74]
    assert codes(recording) == ["F432"]
    assert "begins 1 ms after the first message, and it was watched for 0.077 s" in str(
        recording.findings[0].message
    )


@pytest.mark.parametrize(
    "record",
    [
        {"origin": str(START + 13 * MS)},
        {"origin": str(START + 2 * MS)},
        {"origin": str(START + 43 * MS)},
        {"origin": "nowhere"},
        {"origin": "-5"},
        {"origin": "9" * 19},
        {"origin": str(START + 4 * MS), "clock": "10 ms, by log_time"},
    ],
)
def test_a_grid_that_does_not_fit_the_log_does_not_count(
    tmp_path: Path, record: dict[str, str]
) -> None:
    """The first tick of the log is at 7 ms: an origin after it would cut ticks off."""
    recording = watched(tmp_path, {"fretc.grid": {**grid_record(CLOCK, 1), **record}})
    assert recording.origin is None
    assert codes(recording) == ["F433"]
    ticks = trace(bindings(), recording, ["p"]).timeline.times
    assert (ticks[0] - START) // MS == 7


def test_a_grid_is_placed_by_what_had_come_by_then(tmp_path: Path) -> None:
    """The first message by its time came when the first ticks were judged."""
    late_first: list[Row] = [*TIMELY, ("/y", 1.0, -30, 90)]
    recording = watched(tmp_path, {"fretc.grid": grid_record(CLOCK, START + 7 * MS)}, late_first)
    assert recording.origin == START + 7 * MS
    assert codes(recording) == ["F411", "F432"]


def test_what_was_missed_is_unknown_whatever_the_clock(tmp_path: Path) -> None:
    gap = (START + 15 * MS, START + 25 * MS)
    record = {"clock": "another", "missed": f"{gap[0]}-{gap[1]}"}
    recording = watched(tmp_path, {"fretc.watch": record})
    assert not recording.intact
    assert recording.gaps == ((START + 13 * MS, START + 33 * MS),)
    assert codes(recording)[0] == "F434"


def test_what_was_missed_at_an_unknown_time_is_missed(tmp_path: Path) -> None:
    recording = watched(tmp_path, {"fretc.watch": {"missed": "yesterday"}})
    assert not recording.intact
    assert "at unknown times" in recording.findings[0].message
