import struct
import zlib
from io import BufferedReader, BytesIO
from pathlib import Path

import pytest
from mcap.records import Chunk, Schema

from fretc.logs.mcap.container import BrokenError, frames, parse, summary, unpacked
from tests.fretc.logs.logs import (
    MS,
    TWELVE,
    S,
    X,
    chunk_starts,
    codes,
    damaged,
    recorded,
    write,
)


def test_an_absurd_size_is_refused_before_memory_is_asked_for(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    at = chunk_starts(path)[1] + 9 + 16
    data = bytearray(path.read_bytes())
    data[at : at + 8] = struct.pack("<Q", 2**40)
    path.write_bytes(data)
    recording = recorded(path, X)
    assert "impossible size" in recording.findings[0].message
    assert recording.gaps == ((1000 * S + 400 * MS, 1000 * S + 700 * MS),)


def test_a_damaged_summary_and_bytes_after_the_end_are_found(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE)
    data = path.read_bytes()
    damaged(path, len(data) - 8 - 29 - 1)
    recording = recorded(path, X)
    assert (codes(recording), recording.gaps, recording.intact) == (["F404"], (), False)
    assert "its summary is damaged" in recording.findings[0].message
    path.write_bytes(data + b"more")
    recording = recorded(path, X)
    assert "it contains data after its end" in recording.findings[0].message
    assert not recording.intact


def record(opcode: int, content: bytes) -> bytes:
    return struct.pack("<BQ", opcode, len(content)) + content


def chunk(data: bytes, size: int, *, crc: int = 0, compression: str = "") -> Chunk:
    return Chunk(compression, data, 0, 0, crc, size)


def test_records_are_told_by_where_their_content_is() -> None:
    data = record(5, b"abc") + record(0x80, b"")
    assert list(frames(data)) == [(5, 9, 12), (0x80, 21, 21)]


@pytest.mark.parametrize("length", [1, 8, 9, 11])
def test_a_record_that_is_cut_off_is_broken(length: int) -> None:
    with pytest.raises(BrokenError, match="a record is cut off"):
        list(frames(record(5, b"abc")[:length]))


def test_a_record_never_reads_the_bytes_of_the_next_one() -> None:
    content = struct.pack("<HI1sI3sI", 1, 1, b"A", 3, b"ros", 2) + b"de"
    assert parse(Schema.read, content) == Schema(1, b"de", "ros", "A")
    with pytest.raises(BrokenError, match="a record cannot be read"):
        parse(Schema.read, content[:-1])


@pytest.mark.parametrize(
    ("found", "why"),
    [
        (chunk(b"abc", 2), "the size of a chunk differs from the size that it states"),
        (chunk(b"abc", 4), "the size of a chunk differs from the size that it states"),
        (chunk(b"abc", 3, crc=1), "the CRC of a chunk does not match its data"),
        (chunk(b"abc", 3, compression="zstd"), "a chunk does not decompress"),
        (chunk(b"no lz4 frame", 3, compression="lz4"), "a chunk does not decompress"),
        (chunk(b"abc", 3, compression="zip"), "a chunk is compressed with the unknown codec `zip`"),
        (chunk(b"abc", 200_001), "a chunk states an impossible size of 200001 bytes"),
    ],
)
def test_a_chunk_that_is_not_as_it_states_is_broken(found: Chunk, why: str) -> None:
    with pytest.raises(BrokenError, match=f"^{why}$"):
        unpacked(found)


def test_a_chunk_with_its_crc_is_what_is_in_it() -> None:
    assert unpacked(chunk(b"abc", 3, crc=zlib.crc32(b"abc"))) == b"abc"


def test_what_has_no_end_has_no_summary() -> None:
    data = b"\x89MCAP0\r\n" + record(5, b"abc")
    assert summary(BufferedReader(BytesIO(data)), len(data)) is None
