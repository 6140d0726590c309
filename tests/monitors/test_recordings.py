import hashlib
import os
import random
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import IndexType
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders

from fretish.diagnostic import Code, Diagnostic, Severity
from fretish.rendering import render
from monitors import recordings
from monitors.recordings import Recording, read
from tests.monitors.logs import (
    LZ4,
    MS,
    NONE,
    SCAN,
    ZSTD,
    S,
    Sent,
    declare,
    number,
    recorded,
    scan,
    times,
    values,
    write,
)
from tests.monitors.logs import X as X_TEXT

X = declare(X_TEXT)
TWELVE = [number(i / 100, 1000 * S + i * 100 * MS) for i in range(12)]
"""Times 1000.0 s to 1001.1 s, values 0.00 to 0.11."""

LOGS = Path(os.environ.get("FRETC_LOGS", Path(__file__).parents[2] / "../shared/logs"))
real_logs = pytest.mark.skipif(
    not LOGS.is_dir(), reason=f"no real logs at {LOGS}: set FRETC_LOGS to their folder"
)


def refused(path: Path, text: str = X_TEXT) -> Diagnostic:
    diagnostic = read(str(path), declare(text), [])
    assert isinstance(diagnostic, Diagnostic), diagnostic
    return diagnostic


def codes(recording: Recording) -> list[str]:
    return [finding.code.number for finding in recording.findings]


# What is read


@pytest.mark.parametrize("compression", [ZSTD, LZ4, NONE])
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@pytest.mark.parametrize("chunked", [True, False])
def test_each_encoding_and_compression_gives_the_same_samples(
    tmp_path: Path, compression: Any, encoding: str, chunked: bool
) -> None:
    sent = [number(0.25, 3 * S, encoding=encoding), number(-2.5, 4 * S, encoding=encoding)]
    path = write(tmp_path / "log.mcap", sent, compression=compression, chunked=chunked)
    recording = recorded(path, X)
    assert values(recording, "x") == [0.25, -2.5]
    assert times(recording, "x") == [3 * S, 4 * S]
    assert recording.findings == ()
    assert recording.intact
    assert (recording.start_ns, recording.end_ns) == (3 * S, 4 * S)


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_a_scan_of_either_ros_gives_its_least_valid_range_and_the_least_it_can_report(
    tmp_path: Path, encoding: str
) -> None:
    sent = [scan([5.0, 0.5, 0.01, float("nan")], S, encoding=encoding, range_min=0.25)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(SCAN))
    assert values(recording, "nearest") == [0.5]
    assert recording.nearest == {"nearest": 0.25}


def test_the_identity_of_the_file_is_the_hash_of_its_bytes(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    recording = recorded(path, X)
    assert recording.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert recording.size == path.stat().st_size
    assert recording.name == str(path)


def test_every_topic_of_the_log_has_its_health(tmp_path: Path) -> None:
    sent = [
        number(1.0, 10 * MS),
        number(1.0, 30 * MS),
        number(1.0, 20 * MS),
        number(1.0, 20 * MS),
        number(1.0, 90 * MS),
        number(1.0, 50 * MS, topic="/other"),
    ]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert recording.topics["/x"] == recordings.Topic(
        name="/x",
        type="std_msgs/msg/Float64",
        encoding="cdr",
        count=5,
        first_ns=10 * MS,
        last_ns=90 * MS,
        longest_gap_ns=60 * MS,
        out_of_order=2,
        equal_stamps=1,
    )
    assert recording.topics["/other"].count == 1
    assert recording.topics["/other"].longest_gap_ns == 0


def test_messages_out_of_order_are_sorted_and_counted(tmp_path: Path) -> None:
    sent = [number(1.0, 10 * MS), number(3.0, 30 * MS), number(2.0, 20 * MS)]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert values(recording, "x") == [1.0, 2.0, 3.0]
    (finding,) = recording.findings
    assert finding.code is Code.OUT_OF_ORDER
    assert finding.severity is Severity.WARNING
    assert finding.message == (
        "1 of 3 messages of `/x` are earlier than one before them: they are sorted by time"
    )
    assert recording.intact


def test_equal_times_keep_the_order_of_the_file(tmp_path: Path) -> None:
    sent = [number(1.0, 30 * MS), number(3.0, 20 * MS), number(2.0, 20 * MS)]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert values(recording, "x") == [3.0, 2.0, 1.0]
    assert codes(recording) == ["F411"]


def test_many_equal_times_keep_the_order_of_the_file(tmp_path: Path) -> None:
    sent = [number(float(i), (i % 3) * S) for i in range(90)]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    assert values(recording, "x") == [float(i) for first in range(3) for i in range(first, 90, 3)]


def test_the_time_of_the_run_does_not_depend_on_what_is_asked_for(tmp_path: Path) -> None:
    text = X_TEXT + '\n[signal.y]\npath = "/y.data"\n'
    sent = [number(1.0, S), number(2.0, 2 * S), number(9.0, 5 * S, topic="/y")]
    path = write(tmp_path / "log.mcap", [*sent, number(0.0, 9 * S, topic="/not_bound")])
    recording = read(str(path), declare(text), ["x"])
    assert isinstance(recording, Recording)
    assert (recording.start_ns, recording.end_ns) == (S, 5 * S)
    assert list(recording.samples) == ["x"]


# Time


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


def test_clocks_that_are_mixed_and_far_apart_are_a_warning(tmp_path: Path) -> None:
    text = SCAN.replace("log_time", "header.stamp") + '[signal.x]\npath = "/x.data"\n'
    sent = [scan([1.0], 9 * S, stamp=3 * S), number(1.0, 9 * S)]
    (finding,) = recorded(write(tmp_path / "log.mcap", sent), declare(text)).findings
    assert finding.severity is Severity.WARNING
    assert finding.message == (
        "the messages of `/x` have no header.stamp: their log_time is used, and that is 6.000 s "
        "away from the stamps of the other topics"
    )


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


def test_a_time_of_another_clock_is_refused_and_not_turned_into_a_million_years_of_ticks(
    tmp_path: Path,
) -> None:
    path = write(tmp_path / "log.mcap", [number(0.0, 0), number(0.0, 1_700_000_000 * S)])
    diagnostic = refused(path)
    assert diagnostic.code is Code.UNREADABLE_LOG
    assert diagnostic.message == (
        "the log lasts 1700000000.000 s, which is 17000000000 ticks: a message has a wrong time "
        "(log_time)"
    )


# Topics that cannot be read


def test_a_missing_topic_points_at_the_path_and_names_the_nearest(tmp_path: Path) -> None:
    recording = recorded(write(tmp_path / "log.mcap", [number(0.0, 5, topic="/xx")]), X)
    (finding,) = recording.findings
    assert render(finding) == (
        "F405 the topic `/x` is not in the log\n"
        "  --> bindings.toml:7:8\n"
        '   | path = "/x.data"\n'
        "   |        ^^^^^^^^^\n"
        "help: did you mean `/xx`?"
    )
    assert values(recording, "x") == []
    assert recording.intact


def test_a_missing_topic_with_no_near_one_lists_the_topics(tmp_path: Path) -> None:
    sent = [number(0.0, 5, topic="/wheel"), number(0.0, 5, topic="/battery")]
    (finding,) = recorded(write(tmp_path / "log.mcap", sent), X).findings
    assert finding.help == "it holds /battery, /wheel"


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


def test_the_types_of_both_ros_are_the_same_type(tmp_path: Path) -> None:
    for name in ("std_msgs/Float64", "std_msgs/msg/Float64"):
        text = X_TEXT.replace('path = "/x.data"', f'path = "/x.data"\ntype = "{name}"')
        for encoding in ("cdr", "ros1"):
            path = write(tmp_path / "log.mcap", [number(1.0, 5, encoding=encoding)])
            assert values(recorded(path, declare(text)), "x") == [1.0]


def test_an_encoding_that_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    sent = [Sent("/x", "X", b'{"data": 1}', 5, encoding="json")]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    (finding,) = recording.findings
    assert finding.code is Code.UNKNOWN_ENCODING
    assert finding.message == (
        "`/x` cannot be read: its messages are encoded as `json`, defined in `jsonschema`"
    )


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


def test_a_message_definition_is_never_run_as_a_program(tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    evil = f"float64 data\nint32 A;open({str(mark)!r},'w');B=5\n".encode()
    sent = [number(1.5, 5, encoding="ros1")]
    path = write(tmp_path / "log.mcap", sent, definitions={"std_msgs/Float64": evil})
    recording = recorded(path, X)
    assert not mark.exists()
    assert values(recording, "x") == [1.5]  # the constant is left out


def test_a_definition_that_is_no_definition_is_an_error_and_prints_nothing(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for encoding in ("cdr", "ros1"):
        message = number(1.5, 5, encoding=encoding)
        path = write(tmp_path / "log.mcap", [message], definitions={message.type: b"?! data"})
        (finding,) = recorded(path, X).findings
        assert finding.code is Code.UNKNOWN_ENCODING
    assert capfd.readouterr() == ("", "")


# Files that cannot be read


def test_what_is_no_file_is_told_apart(tmp_path: Path) -> None:
    text = tmp_path / "text.mcap"
    text.write_text("hello, this is text\n")
    bag = tmp_path / "run.bag"
    bag.write_bytes(b"#ROSBAG V2.0\n" + b"\0" * 100)
    empty = tmp_path / "empty.mcap"
    empty.write_bytes(b"")
    assert refused(tmp_path / "absent.mcap").code is Code.NO_SUCH_FILE
    assert refused(tmp_path).code is Code.IS_A_DIRECTORY
    assert refused(Path("/dev/null")).code is Code.UNREADABLE
    assert refused(text).code is Code.NOT_A_LOG
    assert refused(bag).message == "it is a ROS 1 bag, not an MCAP file"
    assert refused(empty).code is Code.EMPTY_LOG
    assert refused(write(tmp_path / "log.mcap", [])).code is Code.EMPTY_LOG


def test_a_truncated_log_says_how_far_whole_messages_go(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    data = path.read_bytes()
    third = chunk_starts(path)[2]
    path.write_bytes(data[: third + 20])
    assert render(refused(path)) == (
        f"F403 the log breaks off after byte {third}: whole messages go 0.700 s far\n"
        f"  --> {path}\n"
        "help: keep what is whole with `mcap recover IN -o OUT`, and audit that"
    )


@pytest.mark.parametrize("chunked", [True, False])
def test_a_log_cut_anywhere_is_refused(tmp_path: Path, chunked: bool) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, chunked=chunked)
    data = path.read_bytes()
    for length in range(1, len(data)):
        path.write_bytes(data[:length])
        code = refused(path).code
        assert code is (Code.NOT_A_LOG if length < 8 else Code.TRUNCATED_LOG), length


# Damage


def chunk_starts(path: Path) -> list[int]:
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return [index.chunk_start_offset for index in summary.chunk_indexes]


def damaged(path: Path, at: int, value: int | None = None) -> None:
    data = bytearray(path.read_bytes())
    data[at] = data[at] ^ 0xFF if value is None else value
    path.write_bytes(data)


@pytest.mark.parametrize("compression", [ZSTD, LZ4, NONE])
@pytest.mark.parametrize("chunk", [0, 1, 2])
def test_a_damaged_chunk_is_a_gap_and_the_others_are_read(
    tmp_path: Path, compression: Any, chunk: int
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=compression)
    damaged(path, chunk_starts(path)[chunk] + 9 + 28 + 4 + 4 + 8 + 30)
    recording = recorded(path, X)
    start = 1000 * S + chunk * 400 * MS
    assert recording.gaps == ((start, start + 300 * MS),)
    assert len(values(recording, "x")) == 8
    assert not recording.intact
    assert codes(recording) == ["F404"]
    assert recording.findings[0].severity is Severity.WARNING
    assert (recording.start_ns, recording.end_ns) == (1000 * S, 1001 * S + 100 * MS)


def test_damage_is_told_with_its_place_and_time(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE)
    second = chunk_starts(path)[1]
    damaged(path, second + 9 + 28 + 4 + 8 + 40)
    assert render(recorded(path, X).findings[0]) == (
        f"F404 warning: the log is damaged near byte {second}: a chunk has another CRC than it "
        "states; what was recorded from 0.400 s to 0.700 s counts as unknown\n"
        f"  --> {path}\n"
        "help: copy the log again from where it was recorded; nothing counts as shown by a "
        "damaged log"
    )


def test_a_chunk_that_looks_like_another_record_is_missed(tmp_path: Path) -> None:
    for opcode in (0x00, 0x01, 0x03, 0x05, 0x07, 0x09, 0x0C, 0x0F, 0x46, 0x86):
        path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
        damaged(path, chunk_starts(path)[1], opcode)
        recording = recorded(path, X)
        assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),), opcode
        assert not recording.intact
        assert len(values(recording, "x")) == 8


@pytest.mark.parametrize("byte", [7, 15])  # the highest of the first and of the last time
def test_a_chunk_with_an_absurd_time_is_a_gap_between_its_neighbours(
    tmp_path: Path, byte: int
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE, index=IndexType.NONE)
    at = path.read_bytes().index(struct.pack("<QQ", 1000 * S + 400 * MS, 1000 * S + 700 * MS))
    damaged(path, at + byte, 0x3F)
    damaged(path, at + 80)
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S + 300 * MS, 1000 * S + 800 * MS),)
    assert recording.end_ns == 1001 * S + 100 * MS


@pytest.mark.parametrize("opcode", [0x00, 0x01, 0x04, 0x05, 0x07, 0x09, 0x0C, 0x46, 0x86])
def test_without_a_summary_a_chunk_that_looks_like_another_record_is_missed(
    tmp_path: Path, opcode: int
) -> None:
    options: dict[str, Any] = {"statistics": False, "index": IndexType.NONE}
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, **options)
    at = path.read_bytes().index(struct.pack("<QQ", 1000 * S + 400 * MS, 1000 * S + 700 * MS))
    damaged(path, at - 9, opcode)
    recording = recorded(path, X)
    assert not recording.intact
    assert recording.gaps == ((1000 * S + 300 * MS, 1000 * S + 800 * MS),)


def test_without_a_summary_a_damaged_chunk_tells_its_own_time(tmp_path: Path) -> None:
    options: dict[str, Any] = {"statistics": False, "index": IndexType.NONE}
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE, **options)
    at = path.read_bytes().index(struct.pack("<QQ", 1000 * S, 1000 * S + 300 * MS))
    damaged(path, at + 80)
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S, 1000 * S + 300 * MS),)
    assert recording.start_ns == 1000 * S


def test_an_absurd_size_is_refused_before_memory_is_asked_for(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    at = chunk_starts(path)[1] + 9 + 16
    data = bytearray(path.read_bytes())
    data[at : at + 8] = struct.pack("<Q", 2**40)
    path.write_bytes(data)
    recording = recorded(path, X)
    assert "absurd size" in recording.findings[0].message
    assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),)


def test_a_broken_length_loses_one_chunk_and_not_the_rest(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    damaged(path, chunk_starts(path)[1] + 8, 0x60)  # the length is now some 2**62
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),)
    assert len(values(recording, "x")) == 8


def test_other_counts_than_the_statistics_state_make_the_whole_log_a_gap(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, chunked=False, crcs=False)
    data = path.read_bytes()
    message = data.index(b"\x05" + struct.pack("<QHIQ", 34, 1, 0, TWELVE[5].time))
    damaged(path, message, 0x85)
    recording = recorded(path, X)
    # A record of an unknown kind tells where: the gap is between its neighbours.
    assert recording.gaps == ((TWELVE[4].time, TWELVE[6].time),)
    statistics = struct.pack("<QHI", 12, 1, 1)
    data = data.replace(statistics, struct.pack("<QHI", 13, 1, 1))
    path.write_bytes(data)
    recording = recorded(path, X)
    assert codes(recording) == ["F410"]
    assert "it states 13 messages and holds 12" in recording.findings[0].message
    assert recording.gaps == ((1000 * S, 1001 * S + 100 * MS),)
    assert not recording.intact


def test_a_chunk_without_crc_is_held_against_its_index(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE, crcs=False)
    data = path.read_bytes()
    at = data.index(struct.pack("<HIQ", 1, 0, TWELVE[5].time)) + 6
    damaged(path, at, data[at] ^ 1)  # one nanosecond: no count and no span tells
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),)
    assert not recording.intact


def test_a_chunk_without_crc_and_index_is_held_against_its_own_times_and_size(
    tmp_path: Path,
) -> None:
    options: dict[str, Any] = {"crcs": False, "index": IndexType.NONE, "compression": NONE}
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, **options)
    data = path.read_bytes()
    gap = ((1000 * S + 400 * MS, 1000 * S + 700 * MS),)
    damaged(path, data.index(struct.pack("<HIQ", 1, 0, TWELVE[5].time)) + 6 + 5)
    recording = recorded(path, X)
    assert (recording.gaps, len(values(recording, "x"))) == (gap, 8)
    path.write_bytes(data)
    damaged(path, data.index(struct.pack("<QQ", *gap[0])) + 16)
    recording = recorded(path, X)
    assert (recording.gaps, len(values(recording, "x"))) == (gap, 8)


@pytest.mark.parametrize(
    ("was", "now", "message"),
    [
        (b"float64 data", b"float64 date", "it defines `std_msgs/msg/Float64` in two ways"),
        (b"/x", b"/y", "it declares the topic `/y` in two ways"),
    ],
)
def test_what_a_log_says_twice_must_be_the_same(
    tmp_path: Path, was: bytes, now: bytes, message: str
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, chunked=False)
    path.write_bytes(path.read_bytes().replace(was, now, 1))
    recording = recorded(path, X)
    assert message in recording.findings[0].message
    assert recording.gaps == ((1000 * S, 1001 * S + 100 * MS),)
    assert not recording.intact


def test_a_record_that_cannot_be_read_loses_no_more_than_itself(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, chunked=False, crcs=False)
    data = path.read_bytes()
    damaged(path, data.index(struct.pack("<QHIQ", 34, 1, 0, TWELVE[5].time)) - 1, 0x03)
    recording = recorded(path, X)
    assert len(values(recording, "x")) == 11
    assert recording.gaps == ((TWELVE[4].time, TWELVE[6].time),)


def test_a_message_that_changed_its_topic_is_missed(tmp_path: Path) -> None:
    sent = [*TWELVE, number(1.0, 1001 * S, topic="/y")]
    path = write(tmp_path / "log.mcap", sent, chunked=False, crcs=False)
    data = path.read_bytes()
    damaged(path, data.index(struct.pack("<HIQ", 1, 0, TWELVE[5].time)), 2)
    recording = recorded(path, X)
    assert codes(recording)[-1] == "F410"
    assert "its topics hold other numbers of messages" in recording.findings[-1].message
    assert not recording.intact


def test_a_data_section_without_end_is_damaged(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    at = path.read_bytes().index(b"\x0f" + struct.pack("<QI", 4, 0))
    damaged(path, at, 0x85)
    recording = recorded(path, X)
    assert "the end of its data is damaged" in recording.findings[0].message
    assert not recording.intact
    assert recording.gaps == ()


def test_a_damaged_summary_and_bytes_after_the_end_are_found(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    data = path.read_bytes()
    damaged(path, len(data) - 8 - 29 - 1)
    recording = recorded(path, X)
    assert (codes(recording), recording.gaps, recording.intact) == (["F404"], (), False)
    assert "its summary is damaged" in recording.findings[0].message
    path.write_bytes(data + b"more")
    recording = recorded(path, X)
    assert "it goes on after its end" in recording.findings[0].message
    assert not recording.intact


def test_a_log_of_which_nothing_is_whole_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, compression=NONE)
    damaged(path, chunk_starts(path)[0] + 200)
    assert refused(path).message == (
        "no message of the log can be read: a chunk has another CRC than it states"
    )


@pytest.mark.parametrize(
    "options",
    [
        {"compression": ZSTD, "per_chunk": 4},
        {"compression": LZ4, "per_chunk": 4},
        {"compression": NONE, "per_chunk": 4, "statistics": False},
        {"compression": ZSTD, "per_chunk": 4, "statistics": False, "index": IndexType.NONE},
        {"chunked": False, "data_crcs": True},
    ],
)
def test_no_flipped_byte_changes_the_samples_unseen(
    tmp_path: Path, options: dict[str, Any]
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, **options)
    data = path.read_bytes()
    sound = recorded(path, X)
    assert sound.intact
    generator = random.Random(1)
    found = 0
    for at in range(len(data)):
        path.write_bytes(
            data[:at] + bytes([data[at] ^ generator.randrange(1, 256)]) + data[at + 1 :]
        )
        result = read(str(path), X, ["x"])
        if isinstance(result, Diagnostic) or not result.intact:
            found += 1
            assert isinstance(result, Diagnostic) or result.findings
            continue
        assert times(result, "x") == times(sound, "x"), at
        assert values(result, "x") == values(sound, "x"), at
    assert found > len(data) / 2


# Logs that others recorded


def decoded(path: Path, topic: str) -> list[tuple[int, Any]]:
    """Log times and messages, by the official reader and decoders."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[Ros1Decoders(), Ros2Decoders()])
        return [(m.log_time, d) for _, _, m, d in reader.iter_decoded_messages(topics=[topic])]


def bindings(signals: dict[str, str]) -> str:
    return '[clock]\ntick = "100 ms"\n' + "".join(
        f'[signal.{name}]\npath = "{path}"\ninvalid = {{ nan = "drop" }}\n'
        + ('reduce = "min"\n' if path.endswith("[:]") else "")
        for name, path in signals.items()
    )


@real_logs
def test_a_real_turtlebot_log_agrees_with_the_official_decoder() -> None:
    path = LOGS / "ros_amr_interop_turtlebot3_ros1.mcap"
    text = bindings({"v": "/velocity.twist.linear.x", "w": "/velocity.twist.angular.z"})
    recording = recorded(path, declare(text))
    official = decoded(path, "/velocity")
    assert len(official) == 5270
    assert values(recording, "v") == [m.twist.linear.x for _, m in official]
    assert values(recording, "w") == [m.twist.angular.z for _, m in official]
    assert times(recording, "v") == [time for time, _ in official]
    assert recording.intact
    assert recording.topics["/local_plan"].longest_gap_ns // 10**8 == 55


@real_logs
def test_a_real_laser_log_agrees_with_the_official_decoder() -> None:
    path = LOGS / "scan_tools_hokuyo_ros1.mcap"
    recording = recorded(path, declare(SCAN))
    expected = []
    for _, message in decoded(path, "/scan"):
        low, high = message.range_min, message.range_max
        expected.append(min(r for r in message.ranges if low <= r <= high))
    assert len(expected) == 360
    assert values(recording, "nearest") == expected


@real_logs
def test_a_real_rosbag2_log_agrees_with_the_official_decoder() -> None:
    path = LOGS / "cougars_auv_ros2.mcap"
    text = bindings(
        {
            "voltage": "/coug2/battery/data.voltage",
            "depth": "/coug2/depth_data.pose.pose.position.z",
            "x": "/coug2/odom.pose.pose.position.x",
            "covariance": "/coug2/depth_data.pose.covariance[14]",
        }
    )
    recording = recorded(path, declare(text))
    battery = decoded(path, "/coug2/battery/data")
    depth = decoded(path, "/coug2/depth_data")
    assert len(battery) == 334
    assert values(recording, "voltage") == [m.voltage for _, m in battery]
    assert values(recording, "depth") == [m.pose.pose.position.z for _, m in depth]
    assert values(recording, "covariance") == [m.pose.covariance[14] for _, m in depth]
    assert len(values(recording, "x")) == 3
    assert recording.intact
