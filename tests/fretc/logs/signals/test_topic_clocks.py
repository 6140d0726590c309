"""The clocks of topics: counted, told, and never silently believed."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mcap.records import Channel, Schema

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.topic_clocks import ClockOffset, clock_offset, count_still
from fretc.logs.topic_columns import Columns
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Severity
from tests.effort import FULL
from tests.fretc.logs.logs import (
    MS,
    NONE,
    SCAN,
    X_TEXT,
    S,
    Sent,
    chunk_starts,
    codes,
    damaged,
    declare,
    definition,
    number,
    recorded,
    scan,
    times,
    values,
    write,
)

BY_STAMP = declare(SCAN.replace("log_time", "header.stamp"))
TWO = SCAN.replace("log_time", "header.stamp") + (
    '[signal.back]\npath = "/back.ranges[:]"\nreduce = "min"\n'
)
BY_PUBLISHER = declare(X_TEXT.replace("log_time", "publish_time"))


def scans(path: Path, stamped: Sequence[int | None]) -> Recording:
    """A scan every 100 ms from 1000 s on, its range the number of it; None: stamped as recorded."""
    sent = []
    for i, stamp in enumerate(stamped):
        at = 1000 * S + i * 100 * MS
        sent.append(scan([float(i + 1)], at, stamp=at if stamp is None else stamp))
    return recorded(write(path / "log.mcap", sent), BY_STAMP)


def test_a_jump_is_a_step_of_more_than_a_second_between_two_messages() -> None:
    logs = np.arange(6, dtype=np.int64) * S
    assert clock_offset(logs, logs + 5) == ClockOffset(0, 0, 5)
    late = np.array([0, 0, -S, -S, 0, 0])
    assert clock_offset(logs, logs + late) == ClockOffset(0, 0, 0)
    jumped = np.array([0, 0, -S - 1, -S - 1, 2 * S, 2 * S])
    assert clock_offset(logs, logs + jumped) == ClockOffset(2, 3 * S + 1, 0)
    assert clock_offset(logs[:1], logs[:1]) == ClockOffset(0, 0, 0)
    assert clock_offset(logs[:0], logs[:0]) is None


def test_a_clock_that_is_set_back_is_counted_and_told(tmp_path: Path) -> None:
    back = [1000 * S + i * 100 * MS - 7 * S for i in range(3, 6)]
    recording = scans(tmp_path, [None, None, None, *back])
    assert recording.topics["/scan"].clock_jumps == 1
    assert codes(recording) == ["F411", "F417"]
    finding = recording.findings[1]
    assert finding.severity is Severity.WARNING
    assert finding.message == "the clock of `/scan` jumps against log_time once by 7 s"


def test_log_times_are_one_clock_whatever_the_stamps(tmp_path: Path) -> None:
    sent = [scan([1.0], i * S, stamp=stamp) for i, stamp in enumerate([5 * S, 0, 90 * S], 10)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(SCAN))
    topic = recording.topics["/scan"]
    assert (topic.clock_jumps, topic.zero_stamps, codes(recording)) == (0, 0, [])


def test_a_message_with_a_zero_stamp_is_unknown_from_the_one_before(tmp_path: Path) -> None:
    recording = scans(tmp_path, [None, 0, None, 0, 0])
    second = 1000 * S + 200 * MS
    assert times(recording, "nearest") == [1000 * S, 1000 * S, second, second, second]
    unknown = [value != value for value in values(recording, "nearest")]
    assert unknown == [False, True, False, True, True]
    assert recording.topics["/scan"].zero_stamps == 3
    (finding,) = recording.findings
    assert (finding.code.number, finding.severity) == ("F416", Severity.WARNING)
    assert finding.message == (
        "3 of 5 messages of `/scan` have the time 0: their samples are unknown"
    )


def test_zeros_before_the_first_stamp_do_not_make_the_log_half_a_century_long(
    tmp_path: Path,
) -> None:
    recording = scans(tmp_path, [0, 0, None, None])
    assert recording.start_ns == 1000 * S + 200 * MS
    assert [value != value for value in values(recording, "nearest")] == [True, True, False, False]


def test_where_no_stamp_is_set_nothing_is_known_and_no_clock_is_judged(tmp_path: Path) -> None:
    recording = scans(tmp_path, [0, 0, 0])
    assert [value != value for value in values(recording, "nearest")] == [True] * 3
    assert recording.topics["/scan"].zero_stamps == 3
    assert codes(recording) == ["F416"]


def test_a_topic_without_a_stamp_does_not_lengthen_a_run_on_another_clock(tmp_path: Path) -> None:
    """As in real logs: a battery that never sets its stamp, on a robot whose clock is behind."""
    sent = []
    for i in range(5):
        at = 9000 * S + i * 100 * MS
        other = scan([1.0], at, stamp=0)
        sent += [scan([1.0], at, stamp=at - 8000 * S), Sent("/back", other.type, other.payload, at)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(TWO))
    assert (recording.start_ns, recording.end_ns) == (1000 * S, 1000 * S + 400 * MS)
    assert codes(recording) == ["F416"]


def test_zeros_for_a_while_are_no_jump(tmp_path: Path) -> None:
    recording = scans(tmp_path, [None, *[0] * 20, None])
    assert (recording.topics["/scan"].clock_jumps, codes(recording)) == (0, ["F416"])


def test_a_log_that_begins_at_zero_has_a_zero_stamp_that_counts(tmp_path: Path) -> None:
    sent = [scan([float(i + 1)], i * 100 * MS, stamp=i * 100 * MS) for i in range(3)]
    recording = recorded(write(tmp_path / "log.mcap", sent), BY_STAMP)
    assert values(recording, "nearest") == [1.0, 2.0, 3.0]
    assert (recording.start_ns, codes(recording)) == (0, [])


def test_a_publish_time_of_zero_is_none(tmp_path: Path) -> None:
    sent = [
        Sent(m.topic, m.type, m.payload, m.time, 0 if i == 1 else m.time)
        for i, m in enumerate(number(float(i), 1000 * S + i * 100 * MS) for i in range(3))
    ]
    recording = recorded(write(tmp_path / "log.mcap", sent), BY_PUBLISHER)
    assert [value != value for value in values(recording, "x")] == [False, True, False]
    assert codes(recording) == ["F416"]


@pytest.mark.parametrize(
    ("shift", "words"), [(5 * S, "5 s ahead of"), (-2 * S, "2 s behind"), (S // 2, "")]
)
def test_two_topics_on_two_clocks_are_told(tmp_path: Path, shift: int, words: str) -> None:
    sent = []
    for i in range(4):
        at = 1000 * S + i * 100 * MS
        one, other = scan([1.0], at, stamp=at + 3), scan([1.0], at, stamp=at + shift)
        sent += [one, Sent("/back", other.type, other.payload, at)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(TWO))
    assert codes(recording) == (["F418"] if words else [])
    for finding in recording.findings:
        assert finding.message.startswith(f"the stamps of `/back` are {words} those of `/scan`")


def test_of_three_topics_the_one_that_differs_is_told(tmp_path: Path) -> None:
    text = TWO + '[signal.front]\npath = "/front.ranges[:]"\nreduce = "min"\n'
    sent = []
    for i in range(4):
        at = 1000 * S + i * 100 * MS
        for topic, shift in (("/scan", 0), ("/back", 5 * S), ("/front", 5 * S + 7)):
            one = scan([1.0], at, stamp=at + shift)
            sent.append(Sent(topic, one.type, one.payload, at))
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    (finding,) = recording.findings
    assert finding.message.startswith("the stamps of `/scan` are 5 s behind those of `/back`")


@pytest.mark.slow
@pytest.mark.parametrize("unset", [3, 4096, 5000])
@pytest.mark.parametrize("integrity", list(Integrity))
def test_many_messages_before_the_first_stamp_are_as_that_one(
    tmp_path: Path, unset: int, integrity: Integrity
) -> None:
    # So many are read at once; by log time instead, the log would last for fifty years.
    first = 1_700_000_000 * S
    sent = [number(0.5, first + i * MS) for i in range(unset)]
    sent = [Sent(s.topic, s.type, s.payload, s.time, 0) for s in sent]
    last = number(1.5, first + unset * MS)
    sent.append(Sent(last.topic, last.type, last.payload, last.time, 7 * S))
    path = write(tmp_path / "log.mcap", sent)
    found = read(str(path), BY_PUBLISHER, ["x"], integrity)
    assert isinstance(found, Recording), found
    assert (found.start_ns, found.end_ns) == (7 * S, 7 * S)
    assert set(times(found, "x")) == {7 * S}
    assert np.isnan(values(found, "x")[:-1]).all()
    assert values(found, "x")[-1] == 1.5
    assert found.topics["/x"].zero_stamps == unset


# Times that were never set ---------------------------------------------------------------------


@pytest.mark.parametrize("zeros", [range(100), range(50, 54), [99]])
@pytest.mark.parametrize("source", ["log_time", "publish_time"])
def test_samples_with_a_zero_for_a_time_are_unknown_and_the_others_count(
    tmp_path: Path, source: str, zeros: Sequence[int]
) -> None:
    sent = []
    for i in range(100):
        at = 1000 * S + i * 100 * MS
        one, time = number(1.0, at), 0 if i in zeros else at
        log, published = (time, at) if source == "log_time" else (at, time)
        sent.append(Sent(one.topic, one.type, one.payload, log, published))
    text = X_TEXT.replace("log_time", source)
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert np.isnan(recording.samples["x"].values).sum() == len(zeros)
    assert codes(recording) == ["F416"]
    if len(zeros) < 100:
        assert recording.start_ns == 1000 * S


def test_a_damaged_log_with_zeros_is_no_longer_than_its_other_times(tmp_path: Path) -> None:
    sent = [number(float(i), (1000 + i) * S if i % 3 else 0) for i in range(12)]
    path = write(tmp_path / "log.mcap", sent, per_chunk=3, compression=NONE)
    damaged(path, chunk_starts(path)[2] + 100)
    recording = recorded(path, declare(X_TEXT))
    assert recording.gaps == ((1001 * S, 1008 * S),)
    assert (recording.start_ns, recording.end_ns) == (1001 * S, 1011 * S)


def test_a_topic_without_any_time_is_unknown_in_a_log_that_begins_at_zero(tmp_path: Path) -> None:
    sent = [number(1.0, 0) for _ in range(200)]
    sent += [number(1.0, i * MS, topic="/y") for i in range(1, 2000)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(X_TEXT))
    assert np.isnan(recording.samples["x"].values).all()
    assert (recording.start_ns, recording.end_ns) == (0, 1999 * MS)
    (finding,) = recording.findings
    assert (finding.code.number, finding.help) == (
        "F416",
        'check the clock of the recorder, or use `time = "header.stamp"` under `[clock]`',
    )


def test_a_clock_topic_that_no_signal_reads_is_looked_at_too(tmp_path: Path) -> None:
    sent = [number(1.0, 0, topic="/beat")]
    sent += [number(1.0, 1000 * S + i * MS) for i in range(3)]
    text = X_TEXT.replace('"100 ms"', '"/beat"')
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    (finding,) = recording.findings
    assert finding.message == (
        "1 of 1 messages of `/beat` have the time 0: their samples are unknown"
    )
    assert finding.span is not None
    assert finding.span.text == '"/beat"'


_TIMES = st.one_of(
    st.just(0),
    st.sampled_from([1, 2, S // 2, S - 1, S, 2 * S, 5 * S]),
)
_ROWS = st.lists(
    st.tuples(st.sampled_from(["/scan", "/back"]), _TIMES, _TIMES, st.integers(1, 12)),
    max_size=8,
)
"""Topic, log time, declared time, and how many messages are like that."""


def naive(rows: Sequence[tuple[str, int, int]], topic: str) -> list[tuple[int, bool]]:
    """Of each message of a topic its time, and whether it is unknown, one message at a time."""
    begins_at_zero = any(0 < time <= S for _, _, time in rows)
    mine = [(log, time) for name, log, time in rows if name == topic]
    zeros = sum(time == 0 for _, time in mine)
    found: list[tuple[int, bool]] = []
    for i, (log, time) in enumerate(mine):
        begins = begins_at_zero and zeros < 10 and log < S and not any(t for _, t in mine[:i])
        unknown = time == 0 and not begins
        before = [t for t, lost in found if not lost][-1:]
        found.append((before[0] if unknown and before else time, unknown))
    known = [time for time, lost in found if not lost]
    if not known:
        return [(log, True) for log, _ in mine]
    first = next(i for i, (_, lost) in enumerate(found) if not lost)
    return [(known[0], True)] * first + found[first:]


@pytest.mark.slow
@pytest.mark.parametrize("source", list(TimeSource))
@given(_ROWS)
@example([("/scan", 0, 0, 9), ("/scan", 5, 5, 1)])
@example([("/scan", 0, 0, 10), ("/scan", 5, 5, 1)])
@example([("/scan", 5 * S, 0, 1), ("/scan", 5 * S, 5, 1)])
@settings(max_examples=1000 if FULL else 12)
def test_each_zero_is_read_as_the_definition_says(
    source: TimeSource, drawn: list[tuple[str, int, int, int]]
) -> None:
    if source is TimeSource.LOG_TIME:
        drawn = [(topic, time, time, count) for topic, _, time, count in drawn]
    rows = [(topic, log, time) for topic, log, time, count in drawn for _ in range(count)]
    declarations = declare(TWO.replace("header.stamp", source))
    columns = Columns(declarations, list(declarations.signals.values()))
    streams = {}
    for id, topic in enumerate(("/scan", "/back"), 1):
        schema = Schema(
            id, definition("sensor_msgs/msg/LaserScan", "cdr"), "ros2msg", "sensor_msgs/LaserScan"
        )
        channel = Channel(id, topic, "cdr", {}, id)
        streams[topic] = ChannelDefinition(channel, schema)
        columns.declare(streams[topic])
    for topic, log, time in rows:
        message = scan([1.0], log, stamp=time)
        columns.add(streams[topic], log, time, memoryview(message.payload))
    columns.settle()
    for signal in declarations.signals.values():
        found, values_ = columns.samples(signal)
        expected = sorted(naive(rows, signal.path.topic), key=lambda row: row[0])
        assert list(zip(found.tolist(), np.isnan(values_).tolist(), strict=True)) == expected


# Clocks that stand still -----------------------------------------------------------------------


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(1, 14)), max_size=6))
def test_messages_that_stand_still_are_those_of_long_runs(runs: list[tuple[int, int]]) -> None:
    times = [time for time, count in runs for _ in range(count)]
    lengths = [len(list(group)) for _, group in groupby(times)]
    assert count_still(np.array(times, np.int64)) == sum(n for n in lengths if n >= 10)


@pytest.mark.parametrize(("count", "expected"), [(9, []), (10, ["F420"]), (60, ["F420"])])
def test_a_clock_that_stands_still_is_told(tmp_path: Path, count: int, expected: list[str]) -> None:
    stood = [1000 * S + 200 * MS] * count
    recording = scans(tmp_path, [None, None, *stood, None])
    assert [code for code in codes(recording) if code == "F420"] == expected
    for finding in recording.findings:
        if finding.code.number == "F420":
            assert finding.message == (
                f"the clock of `/scan` stands still: {count} of {count + 3} messages have the "
                "header.stamp of 9 or more neighbours"
            )
