"""The clocks of topics: counted, told, and never silently believed."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fretish.diagnostic import Severity
from monitors.integrity import Integrity
from monitors.recordings import read
from monitors.samples import Recording
from monitors.stamps import Stamps, stamps
from tests.monitors.logs import (
    MS,
    SCAN,
    X_TEXT,
    S,
    Sent,
    codes,
    declare,
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
    assert stamps(logs, logs + 5) == Stamps(0, 0, 5)
    late = np.array([0, 0, -S, -S, 0, 0])
    assert stamps(logs, logs + late) == Stamps(0, 0, 0)
    jumped = np.array([0, 0, -S - 1, -S - 1, 2 * S, 2 * S])
    assert stamps(logs, logs + jumped) == Stamps(2, 3 * S + 1, 0)
    assert stamps(logs[:1], logs[:1]) == Stamps(0, 0, 0)
    assert stamps(logs[:0], logs[:0]) is None


def test_a_clock_that_is_set_back_is_counted_and_told(tmp_path: Path) -> None:
    back = [1000 * S + i * 100 * MS - 7 * S for i in range(3, 6)]
    recording = scans(tmp_path, [None, None, None, *back])
    assert recording.topics["/scan"].clock_jumps == 1
    assert codes(recording) == ["F411", "F417"]
    finding = recording.findings[1]
    assert finding.severity is Severity.WARNING
    assert finding.message == "the clock of `/scan` jumps against log_time once by 7.000 s"


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
        "3 of 5 messages of `/scan` have a zero for a time: their samples are unknown"
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
    ("shift", "words"), [(5 * S, "5.000 s ahead of"), (-2 * S, "2.000 s behind"), (S // 2, "")]
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
    assert finding.message.startswith("the stamps of `/scan` are 5.000 s behind those of `/back`")


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
