"""What a log is read by, and what of it is looked at; `test_projection.py` has the messages."""

import hashlib
import random
import struct
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.opcode import Opcode
from mcap.records import Chunk, DataEnd
from mcap.stream_reader import StreamReader
from mcap.writer import IndexType

from fretc.logs.reader import read
from fretc.logs.signals.integrity import Checked, Integrity
from fretc.logs.signals.samples import Recording
from tests.fretc.logs.logs import (
    MS,
    NONE,
    TWELVE,
    ZSTD,
    S,
    Sent,
    X,
    codes,
    number,
    values,
    write,
)

NOISE = random.Random(1).randbytes(400_000)
"""It cannot be compressed: its chunk has blocks of its own behind what is wanted."""


def camera(time: int) -> Sent:
    return Sent("/camera", "std_msgs/msg/String", NOISE, time)


def checked(path: Path, integrity: Integrity = Integrity.HASH) -> Recording:
    found = read(str(path), X, ["x"], integrity)
    assert isinstance(found, Recording), found
    return found


def test_chunks_that_are_unpacked_whole_have_their_crc_checked(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    assert checked(path).checked == Checked(by_index=True, chunks=3, crc_checked=3)
    full = checked(path, Integrity.FULL)
    assert full.checked == Checked(by_index=False, chunks=3, crc_checked=3)
    assert full.sha256 == checked(path).sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_chunk_with_a_large_end_that_nothing_binds_is_unpacked_in_part(tmp_path: Path) -> None:
    sent = [number(0.5, S), camera(S + MS), number(0.25, 2 * S), number(0.125, 3 * S)]
    path = write(tmp_path / "log.mcap", sent, per_chunk=2)
    found = checked(path)
    assert found.checked == Checked(by_index=True, chunks=2, crc_checked=1)
    assert found.checked.crc_unchecked == 1
    assert values(found, "x") == [0.5, 0.25, 0.125]


def test_a_byte_that_no_message_in_question_stands_on_is_only_seen_in_full(tmp_path: Path) -> None:
    sent = [number(0.5, S), camera(S + MS), number(0.25, 2 * S)]
    path = write(tmp_path / "log.mcap", sent, per_chunk=2, compression=NONE)
    sound = checked(path)
    data = bytearray(path.read_bytes())
    data[data.index(NOISE) + len(NOISE) - 1] ^= 1
    path.write_bytes(data)
    found = checked(path)
    assert (values(found, "x"), found.intact) == ([0.5, 0.25], True)
    assert found.checked.crc_unchecked == 1
    assert found.sha256 != sound.sha256
    full = checked(path, Integrity.FULL)
    assert (codes(full), full.intact, values(full, "x")) == (["F404"], False, [0.25])


def test_chunks_without_a_message_in_question_are_skipped(tmp_path: Path) -> None:
    sent = [number(0.5, S), camera(2 * S), camera(3 * S), number(0.25, 4 * S)]
    path = write(tmp_path / "log.mcap", sent, per_chunk=1)
    found = checked(path)
    assert found.checked == Checked(by_index=True, chunks=4, crc_checked=2, skipped=2)
    assert (found.topics["/camera"].count, found.topics["/camera"].first_ns) == (2, None)
    assert checked(path, Integrity.FULL).topics["/camera"].first_ns == 2 * S


def test_chunks_without_a_crc_are_told(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, crcs=False)
    assert checked(path).checked == Checked(by_index=True, chunks=3, without_crc=3)
    assert checked(path, Integrity.FULL).checked == Checked(by_index=False, chunks=3, without_crc=3)


def test_by_its_index_alone_a_log_is_known_by_its_summary_and_its_crcs(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=ZSTD)
    found, hashed = checked(path, Integrity.INDEX), checked(path)
    whole = path.read_bytes()
    with path.open("rb") as stream:
        records = list(StreamReader(stream, emit_chunks=True).records)
    crcs = b"".join(
        struct.pack("<I", record.uncompressed_crc)
        for record in records
        if isinstance(record, Chunk)
    )
    (end,) = (record for record in records if isinstance(record, DataEnd))
    at = whole.rindex(struct.pack("<BQI", Opcode.DATA_END, 4, end.data_section_crc))
    assert len(crcs) == 12
    assert found.sha256 == hashlib.sha256(crcs + whole[at:]).hexdigest()
    assert found.checked == replace(hashed.checked, hashed=False)
    assert values(found, "x") == values(hashed, "x")


def test_by_its_index_alone_a_log_of_the_same_lengths_is_another_one(tmp_path: Path) -> None:
    one, other = (
        write(tmp_path / name, [number(x, i * S) for i in range(4)], per_chunk=4, compression=NONE)
        for name, x in (("one.mcap", 1.0), ("other.mcap", 2.0))
    )
    assert one.stat().st_size == other.stat().st_size
    found = [checked(path, Integrity.INDEX) for path in (one, other)]
    assert all(each.checked.by_index and not each.checked.hashed for each in found)
    assert found[0].sha256 != found[1].sha256


@pytest.mark.parametrize("index", [IndexType.NONE, IndexType.CHUNK, IndexType.MESSAGE])
def test_a_log_whose_index_leaves_something_open_is_read_in_full(
    tmp_path: Path, index: IndexType
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, index=index)
    for integrity in Integrity:
        found = checked(path, integrity)
        assert values(found, "x") == [i / 100 for i in range(12)]
        assert not found.checked.by_index
        assert found.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_the_crc_of_the_data_is_checked_where_one_is_stated(tmp_path: Path) -> None:
    sent = [number(0.5, S), camera(2 * S), number(0.25, 4 * S)]
    path = write(tmp_path / "log.mcap", sent, per_chunk=1, data_crcs=True, compression=NONE)
    assert checked(path).checked.by_index
    data = bytearray(path.read_bytes())
    data[data.index(NOISE) + 5] ^= 1
    path.write_bytes(data)
    found = checked(path)
    assert not found.checked.by_index
    assert (codes(found), found.intact, values(found, "x")) == (["F404"], False, [0.5, 0.25])
