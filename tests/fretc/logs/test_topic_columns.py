from pathlib import Path

import numpy as np
import pytest

from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Severity
from tests.fretc.logs.logs import (
    MS,
    NONE,
    SCAN,
    TWELVE,
    X_TEXT,
    S,
    Sent,
    X,
    chunk_starts,
    codes,
    damaged,
    declare,
    number,
    recorded,
    scan,
    times,
    values,
    write,
)


def test_messages_out_of_order_are_sorted_and_counted(tmp_path: Path) -> None:
    sent = [number(1.0, 10 * MS), number(3.0, 30 * MS), number(2.0, 20 * MS)]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert values(recording, "x") == [1.0, 2.0, 3.0]
    (finding,) = recording.findings
    assert finding.code is Code.OUT_OF_ORDER
    assert finding.severity is Severity.WARNING
    assert finding.message == ("1 of 3 messages of `/x` are out of order: they are sorted by time")
    assert recording.intact


def test_equal_times_keep_the_order_of_the_file(tmp_path: Path) -> None:
    sent = [number(1.0, 30 * MS), number(3.0, 20 * MS), number(2.0, 20 * MS)]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert values(recording, "x") == [3.0, 2.0, 1.0]
    assert codes(recording) == ["F411"]


def test_many_equal_times_keep_the_order_of_the_file(tmp_path: Path) -> None:
    sent = [number(float(i), (i % 3 + 1) * S) for i in range(90)]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert values(recording, "x") == [float(i) for first in range(3) for i in range(first, 90, 3)]


def test_publish_time_is_used_where_the_clock_says_so(tmp_path: Path) -> None:
    sent = [Sent(m.topic, m.type, m.payload, m.time, m.time - 7) for m in TWELVE[:2]]
    text = X_TEXT.replace("log_time", "publish_time")
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert times(recording, "x") == [1000 * S - 7, 1000 * S + 100 * MS - 7]


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_header_stamps_are_used_where_the_clock_says_so(tmp_path: Path, encoding: str) -> None:
    sent = [scan([1.0], 9 * S, stamp=3 * S + 5, encoding=encoding)]
    text = SCAN.replace("log_time", "header.stamp")
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert times(recording, "nearest") == [3 * S + 5]
    assert (recording.start_ns, recording.end_ns) == (3 * S + 5, 3 * S + 5)
    assert recording.findings == ()


def test_a_topic_without_header_falls_back_to_log_time_and_a_note_says_so(tmp_path: Path) -> None:
    text = X_TEXT.replace("log_time", "header.stamp")
    recording = recorded(write(tmp_path / "log.mcap", TWELVE[:2]), declare(text))
    assert times(recording, "x") == [1000 * S, 1000 * S + 100 * MS]
    (finding,) = recording.findings
    assert finding.severity is Severity.NOTE
    assert finding.message == "the messages of `/x` have no header.stamp: their log_time is used"


def test_a_message_without_a_readable_stamp_is_unknown_from_the_one_before(
    tmp_path: Path,
) -> None:
    broken = Sent("/scan", "sensor_msgs/msg/LaserScan", b"\0\1\0\0", 9 * S)
    sent = [scan([1.0], 8 * S, stamp=3 * S), broken, scan([2.0], 10 * S, stamp=5 * S)]
    text = SCAN.replace("log_time", "header.stamp")
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert times(recording, "nearest") == [3 * S, 3 * S, 5 * S]
    assert np.isnan(recording.samples["nearest"].values).tolist() == [False, True, False]


def test_a_gap_is_told_on_the_declared_clock(tmp_path: Path) -> None:
    sent = [scan([1.0], (10 + i) * S, stamp=(3 + i) * S) for i in range(6)]
    path = write(tmp_path / "log.mcap", sent, per_chunk=2, compression=NONE)
    damaged(path, chunk_starts(path)[1] + 200)
    recording = recorded(path, declare(SCAN.replace("log_time", "header.stamp")))
    # Lost are the stamps of 5 and 6 s; no more is known than the stamps around them.
    assert recording.gaps == ((4 * S, 7 * S),)


def test_an_absurd_time_loses_its_message_and_not_the_log(tmp_path: Path) -> None:
    sent = [TWELVE[0], number(1.0, 2**63 + 5), TWELVE[2]]
    recording = recorded(write(tmp_path / "log.mcap", sent, chunked=False), X)
    assert len(values(recording, "x")) == 2
    assert not recording.intact
    assert recording.gaps == ((TWELVE[0].time, TWELVE[2].time),)
    sent[1] = Sent("/x", sent[1].type, sent[1].payload, TWELVE[1].time, 2**63 + 5)
    text = X_TEXT.replace("log_time", "publish_time")
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert len(values(recording, "x")) == 2
    assert codes(recording) == ["F412"]


def test_a_clock_by_message_has_the_times_of_its_topic(tmp_path: Path) -> None:
    text = X_TEXT.replace('"100 ms"', '"/beat"')
    sent = [number(0.0, 5, topic="/beat"), number(1.0, 7), number(0.0, 5, topic="/beat")]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert recording.ticks.tolist() == [5, 5]


def test_a_clock_whose_topic_is_missing_is_an_error(tmp_path: Path) -> None:
    text = X_TEXT.replace('"100 ms"', '"/beet"')
    sent = [*TWELVE, number(0.0, 5, topic="/beat")]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    (finding,) = recording.findings
    assert finding.code is Code.NO_TOPIC
    assert finding.help == "did you mean `/beat`?"
    assert finding.span is not None
    assert finding.span.text == '"/beet"'


def test_a_missing_field_names_the_nearest(tmp_path: Path) -> None:
    text = X_TEXT.replace("/x.data", "/x.date")
    recording = recorded(write(tmp_path / "log.mcap", TWELVE), declare(text))
    (finding,) = recording.findings
    assert finding.code is Code.NO_FIELD
    assert finding.message == "in `/x` the message has no field `date`"
    assert finding.help == "did you mean `data`?"
    assert values(recording, "x") == []


def test_another_type_than_declared_is_an_error(tmp_path: Path) -> None:
    text = X_TEXT.replace('path = "/x.data"', 'path = "/x.data"\ntype = "std_msgs/Float32"')
    recording = recorded(write(tmp_path / "log.mcap", TWELVE), declare(text))
    (finding,) = recording.findings
    assert finding.code is Code.WRONG_TYPE
    assert finding.message == (
        "`/x` is of type `std_msgs/Float64` in the log, not `std_msgs/Float32`"
    )
    assert values(recording, "x") == []


def both(first: str, second: str) -> list[Sent]:
    """Messages of two types on one topic, by turns."""
    types = {
        "std_msgs/msg/Float64": b"\0\1\0\0" + b"\0" * 8,
        "std_msgs/msg/Int64": b"\0\1\0\0" + b"\0" * 8,
    }
    return [
        Sent("/x", type_, types[type_], i * S) for i, type_ in enumerate([first, second] * 3, 1)
    ]


@pytest.mark.parametrize("integrity", list(Integrity))
def test_messages_of_two_types_on_one_topic_are_told_with_both(
    tmp_path: Path, integrity: Integrity
) -> None:
    path = write(tmp_path / "log.mcap", both("std_msgs/msg/Float64", "std_msgs/msg/Int64"))
    recording = read(str(path), X, ["x"], integrity)
    assert isinstance(recording, Recording)
    (finding,) = recording.findings
    assert (finding.code, finding.severity) == (Code.SEVERAL_TYPES, Severity.WARNING)
    assert finding.message == (
        "`/x` has messages of `std_msgs/Float64` and `std_msgs/Int64`: `x` is read from all of them"
    )
    assert values(recording, "x") == [0.0] * 6


def test_two_types_are_refused_where_the_binding_names_one(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", both("std_msgs/msg/Float64", "std_msgs/msg/Int64"))
    text = X_TEXT.replace('path = "/x.data"', 'path = "/x.data"\ntype = "std_msgs/Float64"')
    recording = recorded(path, declare(text))
    assert codes(recording) == ["F409"]
    assert values(recording, "x") == []


def test_one_type_on_two_channels_is_nothing_to_tell(tmp_path: Path) -> None:
    sent = [number(1.0, i * S, encoding=encoding) for i, encoding in ((1, "cdr"), (2, "ros1"))]
    assert codes(recorded(write(tmp_path / "log.mcap", sent), X)) == []


def test_a_clock_may_tick_with_a_topic_without_a_leading_slash(tmp_path: Path) -> None:
    text = X_TEXT.replace('"100 ms"', '"beat"')
    sent = [number(0.0, 5, topic="beat"), number(1.0, 7), number(0.0, 9, topic="beat")]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(text))
    assert (recording.ticks.tolist(), codes(recording)) == ([5, 9], [])


def test_the_types_of_both_ros_are_the_same_type(tmp_path: Path) -> None:
    for name in ("std_msgs/Float64", "std_msgs/msg/Float64"):
        text = X_TEXT.replace('path = "/x.data"', f'path = "/x.data"\ntype = "{name}"')
        for encoding in ("cdr", "ros1"):
            path = write(tmp_path / "log.mcap", [number(1.0, 5, encoding=encoding)])
            assert values(recorded(path, declare(text)), "x") == [1.0]


@pytest.mark.parametrize(
    "payload", [b"", b"\x00\x01\x00\x00\x01\x02", b"\x00\x07\x00\x00" + b"\0" * 8]
)
def test_a_message_that_cannot_be_decoded_is_unknown_and_counted(
    tmp_path: Path, payload: bytes
) -> None:
    sent = [TWELVE[1], Sent("/x", "std_msgs/msg/Float64", payload, 1001 * S), TWELVE[11]]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert np.isnan(recording.samples["x"].values).tolist() == [False, True, False]
    (finding,) = recording.findings
    assert finding.code is Code.BAD_MESSAGE
    assert finding.message == (
        "1 of 3 messages of `/x` cannot be decoded: their samples are unknown"
    )
