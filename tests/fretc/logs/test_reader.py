import hashlib
from pathlib import Path
from typing import Any

import pytest

from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording, Topic
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.fretc.logs.logs import (
    LZ4,
    MS,
    NONE,
    TWELVE,
    X_TEXT,
    ZSTD,
    S,
    X,
    chunk_starts,
    codes,
    damaged,
    declare,
    number,
    recorded,
    refused,
    times,
    values,
    write,
)


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
    assert codes(recording) == ([] if chunked else ["F415"])
    assert recording.intact
    assert (recording.start_ns, recording.end_ns) == (3 * S, 4 * S)


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
    assert recording.topics["/x"] == Topic(
        name="/x",
        type="std_msgs/msg/Float64",
        encoding="cdr",
        count=5,
        first_ns=10 * MS,
        last_ns=90 * MS,
        longest_gap_ns=60 * MS,
        out_of_order=2,
        equal_stamps=1,
        median_period_ns=10 * MS,
        unstamped=0,
        zero_stamps=0,
        clock_jumps=0,
    )
    assert recording.topics["/other"].count == 1
    assert recording.topics["/other"].longest_gap_ns is None  # it was not read
    whole = read(str(tmp_path / "log.mcap"), X, ["x"], Integrity.FULL)
    assert not isinstance(whole, Diagnostic)
    assert whole.topics["/x"] == recording.topics["/x"]
    assert whole.topics["/other"].longest_gap_ns == 0


def test_the_time_of_the_run_does_not_depend_on_what_is_asked_for(tmp_path: Path) -> None:
    text = X_TEXT + '\n[signal.y]\npath = "/y.data"\n'
    sent = [number(1.0, S), number(2.0, 2 * S), number(9.0, 5 * S, topic="/y")]
    path = write(tmp_path / "log.mcap", [*sent, number(0.0, 9 * S, topic="/not_bound")])
    recording = read(str(path), declare(text), ["x"])
    assert isinstance(recording, Recording)
    assert (recording.start_ns, recording.end_ns) == (S, 5 * S)
    assert list(recording.samples) == ["x"]


def test_a_time_of_another_clock_is_refused_and_not_turned_into_a_million_years_of_ticks(
    tmp_path: Path,
) -> None:
    path = write(tmp_path / "log.mcap", [number(0.0, 5), number(0.0, 1_700_000_000 * S + 5)])
    diagnostic = refused(path)
    assert diagnostic.code is Code.UNREADABLE_LOG
    assert diagnostic.message == (
        "the log lasts 1700000000 s, which is 17000000000 ticks: a message has a wrong time "
        "(log_time)"
    )


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
    assert refused(bag).code is Code.UNREADABLE_LOG
    assert refused(empty).code is Code.EMPTY_LOG
    assert refused(write(tmp_path / "log.mcap", [])).code is Code.EMPTY_LOG


def test_a_log_of_which_nothing_is_whole_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, compression=NONE)
    damaged(path, chunk_starts(path)[0] + 200)
    assert refused(path).message == (
        "no message of the log can be read: the CRC of a chunk does not match its data"
    )
