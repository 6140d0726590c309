"""Logs that ask for more than there is: memory, bytes, and chunks where there are none."""

import struct
import tracemalloc
import zlib
from collections.abc import Callable
from itertools import product
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, DataEnd, Footer, Header, Statistics

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Diagnostic
from tests.effort import some
from tests.fretc.logs.broken import FLOAT, LITTLE, TOPIC, ended, message, raw, sound
from tests.fretc.logs.conformance import MAGIC, framed
from tests.fretc.logs.logs import MS, TWELVE, S, X, codes, times, values

MIB = 2**20
BOMB = 64 * MIB
"""Bytes that some 10 to 300 kB unpack to."""


def measured(path: Path, data: bytes) -> tuple[Recording, int]:
    """What is read, and the most bytes that were held at one time."""
    path.write_bytes(data)
    tracemalloc.start()
    found = read(str(path), X, ["x"])
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert isinstance(found, Recording), found
    return found, peak


def chunk(content: bytes, first: int, last: int) -> bytes:
    return framed(Chunk("", content, last, first, zlib.crc32(content), len(content)))


START = MAGIC + framed(Header("ros2", ""))
FIRST = chunk(framed(FLOAT) + framed(TOPIC) + framed(message(S, 0.5)), S, S)
LAST = chunk(framed(message(3 * S, 1.5)), 3 * S, 3 * S)

PACKED: dict[str, Callable[[bytes], bytes]] = {
    "zstd": lambda data: zstandard.ZstdCompressor().compress(data),
    "zstd without size": lambda data: zstandard.ZstdCompressor(write_content_size=False).compress(
        data
    ),
    "lz4": lz4.frame.compress,
    "lz4 without size": lambda data: lz4.frame.compress(data, store_size=False),
}
STATED = (0, 100, BOMB - 1, BOMB + 1, 2**40, 2**63, 2**64 - 1)


@pytest.mark.slow
@pytest.mark.parametrize(("packing", "stated"), some(product(PACKED, STATED), 4, 2))
def test_a_chunk_that_unpacks_to_more_than_it_states_is_a_gap_and_costs_no_memory(
    tmp_path: Path, packing: str, stated: int
) -> None:
    content = framed(raw(2 * S, bytes(BOMB - 31)))
    assert len(content) == BOMB
    packed = PACKED[packing](content)
    bomb = framed(Chunk(packing.split()[0], packed, 2 * S, 2 * S, 0, stated))
    found, peak = measured(tmp_path / "log.mcap", ended(START + FIRST + bomb + LAST))
    assert (times(found, "x"), values(found, "x")) == ([S, 3 * S], [0.5, 1.5])
    assert (codes(found), found.gaps, found.intact) == (["F404"], ((2 * S, 2 * S),), False)
    believed = stated if BOMB // 2 < stated < 2 * BOMB else 0
    assert peak < 16 * MIB + 2 * believed


@pytest.mark.slow
@pytest.mark.parametrize("packing", some(PACKED, 3))
def test_a_large_chunk_that_is_what_it_states_is_read(tmp_path: Path, packing: str) -> None:
    content = framed(raw(2 * S, LITTLE + struct.pack("<d", 0.25) + bytes(BOMB - 31 - 12)))
    packed = PACKED[packing](content)
    large = framed(Chunk(packing.split()[0], packed, 2 * S, 2 * S, zlib.crc32(content), BOMB))
    found, peak = measured(tmp_path / "log.mcap", ended(START + FIRST + large + LAST))
    assert values(found, "x") == [0.5, 0.25, 1.5]
    assert (codes(found), found.gaps, found.intact) == ([], (), True)
    assert peak < 6 * BOMB


def test_a_chunk_of_zeros_is_damaged_whatever_its_crc(tmp_path: Path) -> None:
    zeros = bytes(9 * 1000)
    found, _ = measured(
        tmp_path / "log.mcap", ended(START + FIRST + chunk(zeros, 2 * S, 2 * S) + LAST)
    )
    assert (codes(found), found.gaps) == (["F404"], ((2 * S, 2 * S),))


LENGTHS = [2**31, 2**32 - 1, 2**60, 2**63, 2**64 - 1]


@pytest.mark.parametrize("length", LENGTHS)
def test_a_record_in_a_chunk_that_states_more_than_there_is_breaks_its_chunk(
    tmp_path: Path, length: int
) -> None:
    content = struct.pack("<BQHIQQ", 5, length, 1, 0, 2 * S, 2 * S)
    data = ended(START + FIRST + chunk(content, 2 * S, 2 * S) + LAST)
    found, peak = measured(tmp_path / "log.mcap", data)
    assert values(found, "x") == [0.5, 1.5]
    assert (codes(found), found.gaps) == (["F404"], ((2 * S, 2 * S),))
    assert peak < MIB


@pytest.mark.parametrize("length", LENGTHS)
def test_a_record_beside_chunks_that_states_more_than_there_is_breaks_the_rest(
    tmp_path: Path, length: int
) -> None:
    record = struct.pack("<BQ", Opcode.ATTACHMENT, length)
    data = ended(START + FIRST + record + LAST)
    found, peak = measured(tmp_path / "log.mcap", data)
    # Nothing says where the next record is: what is after it cannot be told from its content.
    assert values(found, "x") == [0.5]
    assert (codes(found), found.gaps, found.intact) == (["F404"], ((S, S),), False)
    assert peak < MIB


@pytest.mark.parametrize(
    "record",
    [
        struct.pack("<BQHI", Opcode.SCHEMA, 6, 7, 2**32 - 1),
        struct.pack("<BQHHI", Opcode.CHANNEL, 8, 7, 1, 2**32 - 1),
        struct.pack("<BQI", Opcode.METADATA, 4, 2**32 - 1),
        struct.pack("<BQQQIIQ", Opcode.ATTACHMENT, 32, 1, 1, 0, 0, 2**63),
        struct.pack("<BQQQQIIQ", Opcode.CHUNK, 40, S, S, 100, 0, 0, 2**63),
        struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6, 1, 2**32 - 1),
    ],
    ids=["schema", "channel", "metadata", "attachment", "chunk", "message index"],
)
def test_a_length_in_a_record_is_held_against_the_record(tmp_path: Path, record: bytes) -> None:
    found, peak = measured(tmp_path / "log.mcap", ended(START + FIRST + record + LAST))
    assert values(found, "x") == [0.5, 1.5]
    assert codes(found) == ["F404"]
    assert not found.intact
    assert peak < MIB


def indexed(data: bytes, *indexes: ChunkIndex, count: int = 2, chunks: int = 2) -> bytes:
    """The data section with a summary of these indexes, and statistics."""
    data += framed(DataEnd(0))
    tail = framed(FLOAT) + framed(TOPIC)
    tail += framed(Statistics(0, 1, {1: count}, chunks, count, 3 * S, S, 0, 1))
    tail += b"".join(map(framed, indexes))
    footer = framed(Footer(len(data), 0, 0))[:-4]
    return data + tail + footer + zlib.crc32(tail + footer).to_bytes(4, "little") + MAGIC


def index(at: int, record: bytes, first: int, last: int) -> ChunkIndex:
    size = len(record) - 49
    return ChunkIndex(len(record), at, "", size, last, 0, {}, first, size)


def right() -> tuple[bytes, ChunkIndex, ChunkIndex]:
    """A data section of two chunks, and their indexes."""
    at = len(START)
    return (
        START + FIRST + LAST,
        index(at, FIRST, S, S),
        index(at + len(FIRST), LAST, 3 * S, 3 * S),
    )


def test_a_log_with_the_right_indexes_is_whole(tmp_path: Path) -> None:
    for order in (lambda a, b: (a, b), lambda a, b: (b, a), lambda a, b: (a, b, a)):
        data, first, last = right()
        found, _ = measured(tmp_path / "log.mcap", indexed(data, *order(first, last)))
        assert values(found, "x") == [0.5, 1.5]
        assert (codes(found), found.gaps, found.intact) == ([], (), True)


INTO_THE_FIRST = len(START) + 20
INTO_THE_LAST = len(START + FIRST) + 60


@pytest.mark.parametrize(
    "at",
    [0, 3, len(START) - 5, INTO_THE_FIRST, INTO_THE_LAST, 10**4, 2**40, 2**63, 2**64 - 1],
)
def test_a_chunk_index_that_points_at_no_chunk_is_never_whole(tmp_path: Path, at: int) -> None:
    data, first, last = right()
    last.chunk_start_offset = at
    found, peak = measured(tmp_path / "log.mcap", indexed(data, first, last))
    assert set(codes(found)) == {"F404"}
    assert not found.intact
    assert peak < MIB
    # Whatever is read is in the log.
    in_it = {(S, 0.5), (3 * S, 1.5)}
    assert {*zip(times(found, "x"), values(found, "x"), strict=True)} <= in_it
    lost = in_it - {*zip(times(found, "x"), values(found, "x"), strict=True)}
    assert all(any(a <= time <= b for a, b in found.gaps) for time, _ in lost)


@pytest.mark.parametrize("which", ["earlier", "later", "absurd"])
def test_a_chunk_index_with_other_times_than_the_chunk_hides_no_message(
    tmp_path: Path, which: str
) -> None:
    data, first, last = right()
    span = {"earlier": (S, 2 * S), "later": (4 * S, 5 * S), "absurd": (2**63, 2**64 - 1)}[which]
    last.message_start_time, last.message_end_time = span
    found, _ = measured(tmp_path / "log.mcap", indexed(data, first, last))
    assert values(found, "x") == [0.5, 1.5] or not found.intact


def test_chunks_that_overlap_in_time_are_read_in_order_of_time(tmp_path: Path) -> None:
    wide = framed(FLOAT) + framed(TOPIC) + framed(message(S, 0.1)) + framed(message(3 * S, 0.3))
    inner = framed(message(2 * S, 0.2)) + framed(message(4 * S, 0.4))
    data = ended(START + chunk(wide, S, 3 * S) + chunk(inner, 2 * S, 4 * S))
    found, _ = measured(tmp_path / "log.mcap", data)
    assert times(found, "x") == [S, 2 * S, 3 * S, 4 * S]
    assert values(found, "x") == [0.1, 0.2, 0.3, 0.4]
    assert (codes(found), found.gaps, found.intact) == (["F411"], (), True)


def test_a_chunk_within_a_chunk_is_no_chunk(tmp_path: Path) -> None:
    """A payload that looks like a chunk, and an index that says that it is one."""
    hidden = chunk(framed(message(2 * S, 9.9)), 2 * S, 2 * S)
    payload = LITTLE + struct.pack("<d", 0.25) + hidden
    outer = chunk(framed(FLOAT) + framed(TOPIC) + framed(raw(S, payload)), S, S)
    data = START + outer + LAST
    found, _ = measured(tmp_path / "log.mcap", ended(data))
    assert values(found, "x") == [0.25, 1.5]
    assert found.intact
    within = index(data.index(hidden), hidden, 2 * S, 2 * S)
    around = index(len(START), outer, S, S)
    last = index(len(START + outer), LAST, 3 * S, 3 * S)
    for count in (2, 3):
        lie = indexed(data, around, within, last, count=count, chunks=3)
        found, _ = measured(tmp_path / "log.mcap", lie)
        assert not found.intact
        assert "F404" in codes(found)


def test_two_chunks_may_not_share_bytes(tmp_path: Path) -> None:
    """The first chunk of the sound log is as long as the first two."""
    log = sound()
    at = log.at(Opcode.CHUNK)
    longer = log.after(Opcode.CHUNK, 1) - at - 9
    path = tmp_path / "log.mcap"
    path.write_bytes(log.poked(at + 1, longer.to_bytes(8, "little")))
    found = read(str(path), X, ["x"])
    assert not isinstance(found, Diagnostic)
    assert not found.intact
    seen = times(found, "x")
    assert len(seen) == len(set(seen))
    assert set(seen) >= {sent.time for sent in TWELVE[4:]}
    assert found.gaps == ((1000 * S, 1000 * S + 300 * MS),)
