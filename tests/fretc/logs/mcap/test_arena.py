import random

import lz4.frame
import pytest
import zstandard

from fretc.logs.mcap.arena import SIZE, SPARE, ChunkBytes
from fretc.logs.mcap.container import BrokenError

DATA = random.Random(1).randbytes(1000) * 300
PACK = {"zstd": zstandard.compress, "lz4": lz4.frame.compress}
BOTH = pytest.mark.parametrize("compression", PACK)


def unpack(arena: ChunkBytes, compression: str, packed: bytes, size: int, *, whole: bool) -> bool:
    return arena.unpack(compression, memoryview(packed), size, whole=whole)


@BOTH
@pytest.mark.parametrize("size", [1, 5000, 131072, len(DATA)])
def test_the_beginning_of_a_chunk_is_unpacked_behind_what_is_in_use(
    compression: str, size: int
) -> None:
    arena, packed = ChunkBytes(len(DATA)), PACK[compression](DATA)
    arena.used = 77
    assert unpack(arena, compression, packed, size, whole=False)
    assert bytes(arena.data[77 : 77 + size]) == DATA[:size]
    assert arena.used == 77
    assert len(arena.data) >= 77 + size + SPARE


@BOTH
def test_data_that_is_too_short_is_told(compression: str) -> None:
    arena, packed = ChunkBytes(0), PACK[compression](DATA)
    assert not unpack(arena, compression, packed[: len(packed) // 2], len(DATA), whole=False)
    assert not unpack(arena, compression, packed, len(DATA) + 1, whole=True)


@BOTH
def test_a_chunk_that_goes_on_beyond_its_size_is_broken(compression: str) -> None:
    with pytest.raises(BrokenError, match="size of a chunk differs"):
        unpack(ChunkBytes(0), compression, PACK[compression](DATA), len(DATA) - 1, whole=True)


@BOTH
def test_what_is_no_such_data_is_broken(compression: str) -> None:
    with pytest.raises(BrokenError, match="does not decompress"):
        unpack(ChunkBytes(0), compression, b"no such data at all", 10, whole=True)


def test_room_is_made_and_what_is_in_use_is_kept() -> None:
    arena = ChunkBytes(0)
    arena.target(3)[:] = b"abc"
    arena.used = 3
    assert len(arena.target(2 * SIZE)) == 2 * SIZE
    assert bytes(arena.data[:3]) == b"abc"
    arena.clear()
    assert arena.used == 0
