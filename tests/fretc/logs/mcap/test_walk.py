import random
import struct
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import IndexType

from fretc.logs.reader import look, read
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import some
from tests.fretc.logs.logs import (
    LZ4,
    MS,
    NONE,
    TWELVE,
    ZSTD,
    S,
    X,
    chunk_starts,
    codes,
    damaged,
    recorded,
    times,
    values,
    write,
)


@pytest.mark.slow
@pytest.mark.parametrize("chunked", [True, False])
def test_of_a_log_cut_anywhere_the_whole_messages_are_read(tmp_path: Path, chunked: bool) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, chunked=chunked)
    data, whole = path.read_bytes(), values(recorded(path, X), "x")
    counts: list[int] = []
    for length in [*range(1, 9), *some(range(9, len(data)), 14)]:
        path.write_bytes(data[:length])
        found = read(str(path), X, list(X.signals))
        if isinstance(found, Diagnostic):
            assert not counts, length
            assert found.code is (Code.NOT_A_LOG if length < 8 else Code.TRUNCATED_LOG), length
            continue
        seen = values(found, "x")
        counts.append(len(seen))
        assert seen == whole[: len(seen)], length
        assert not found.intact, length
        unprotected = [] if chunked else ["F415"]
        assert codes(found) == ["F403", *unprotected], length
        assert found.gaps == ((found.end_ns, found.end_ns),), length
    assert counts == sorted(counts)
    assert counts[-1] == len(whole)


def test_a_chunk_that_looks_like_another_record_is_missed(tmp_path: Path) -> None:
    for opcode in (0x00, 0x01, 0x03, 0x05, 0x07, 0x09, 0x0C, 0x0F, 0x46, 0x86):
        path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
        damaged(path, chunk_starts(path)[1], opcode)
        recording = recorded(path, X)
        assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),), opcode
        assert not recording.intact
        assert len(values(recording, "x")) == 8


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


def test_a_broken_length_loses_one_chunk_and_not_the_rest(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    damaged(path, chunk_starts(path)[1] + 8, 0x60)  # the length is now some 2**62
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),)
    assert len(values(recording, "x")) == 8


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
        (b"float64 data", b"float64 date", "it defines `std_msgs/msg/Float64` twice, differently"),
        (b"/x", b"/y", "it declares the topic `/y` twice, differently"),
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


def test_a_data_section_without_end_is_damaged(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    at = path.read_bytes().index(b"\x0f" + struct.pack("<QI", 4, 0))
    damaged(path, at, 0x85)
    recording = recorded(path, X)
    assert "the end of its data is damaged" in recording.findings[0].message
    assert not recording.intact
    assert recording.gaps == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "options"),
    [
        (0, {"compression": ZSTD, "per_chunk": 4}),
        (2, {"compression": LZ4, "per_chunk": 4}),
        (4, {"compression": NONE, "per_chunk": 4, "statistics": False}),
        (6, {"compression": ZSTD, "per_chunk": 4, "statistics": False, "index": IndexType.NONE}),
        (8, {"chunked": False, "data_crcs": True}),
    ],
)
def test_no_flipped_byte_changes_the_samples_unseen(
    tmp_path: Path, first: int, options: dict[str, Any]
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, **options)
    data = path.read_bytes()
    sound = recorded(path, X)
    assert sound.intact
    generator = random.Random(1)
    found = 0
    tried = some(range(len(data)), 27, first)
    for at in tried:
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
    assert found > len(tried) / 2


def message_starts(path: Path) -> list[int]:
    """Where the messages of /x begin in a log whose chunks are not compressed."""
    data = path.read_bytes()
    return [data.index(struct.pack("<BQHIQ", 5, 34, 1, 0, sent.time)) for sent in TWELVE]


@pytest.mark.parametrize("crcs", [False, True])
@pytest.mark.parametrize(
    ("offset", "byte", "kept", "what"),
    [
        (0, 0x85, 7, "a chunk contains a record that is not allowed in chunks"),
        (0, 0, 7, "a record has the opcode 0"),
        (1, 8, 7, "a message is cut off"),
        (3, 255, 7, "a record is cut off"),
        (1, 50, 8, "a record is cut off"),  # told by what then stands where the next should begin
    ],
)
def test_whole_messages_before_a_broken_record_of_a_chunk_without_crc_are_kept(
    tmp_path: Path, crcs: bool, offset: int, byte: int, kept: int, what: str
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, compression=NONE, crcs=crcs)
    damaged(path, message_starts(path)[8] + offset, byte)
    if crcs:  # nothing in it is to be trusted
        assert isinstance(read(str(path), X, ["x"]), Diagnostic)
        return
    recording = recorded(path, X)
    # The last one before is not trusted: its length may be what is wrong.
    assert times(recording, "x") == [sent.time for sent in TWELVE[:kept]]
    assert recording.gaps == ((TWELVE[kept - 1].time, TWELVE[11].time),)
    assert what in recording.findings[0].message
    assert not recording.intact


def test_of_a_chunk_out_of_order_all_of_its_time_is_lost_with_one_record(tmp_path: Path) -> None:
    sent = [*TWELVE[:3], TWELVE[5], TWELVE[4], *TWELVE[6:]]
    path = write(tmp_path / "log.mcap", sent, compression=NONE, crcs=False)
    at = path.read_bytes().index(struct.pack("<BQHIQ", 5, 34, 1, 0, TWELVE[8].time))
    damaged(path, at, 0)
    assert recorded(path, X).gaps == ((TWELVE[0].time, TWELVE[11].time),)


@pytest.mark.parametrize("crcs", [False, True])
def test_a_damaged_message_index_is_told_and_costs_nothing_where_a_crc_shows_the_messages(
    tmp_path: Path, crcs: bool
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE, crcs=crcs)
    data = path.read_bytes()
    entry = data.rindex(struct.pack("<Q", TWELVE[5].time))
    damaged(path, entry, data[entry] ^ 1)
    overview = look(str(path))
    assert not isinstance(overview, Diagnostic)
    recording = overview.recording
    assert "F404" in codes(recording)
    assert "the index of a chunk does not match its messages" in (recording.findings[0].message)
    assert not recording.intact
    assert recording.gaps == (() if crcs else ((TWELVE[4].time, TWELVE[7].time),))
