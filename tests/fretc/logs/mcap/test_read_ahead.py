import threading
import time
from collections.abc import Callable, Sequence
from contextlib import closing

import pytest

from fretc.logs.mcap.arena import ChunkBytes
from fretc.logs.mcap.read_ahead import in_turn

COUNTS = pytest.mark.parametrize("count", [1, 2, 3])


def arenas(count: int) -> list[ChunkBytes]:
    return [ChunkBytes(0) for _ in range(count)]


def numbered(last: int) -> Callable[[ChunkBytes], Sequence[int]]:
    """Fills an empty arena with one number after the other, in as many bytes as the number."""
    left = iter(range(1, last + 1))

    def fill(arena: ChunkBytes) -> list[int]:
        assert arena.used == 0
        for number in left:
            arena.target(number)[:] = bytes([number]) * number
            arena.used = number
            return [number]
        return []

    return fill


@COUNTS
def test_what_an_arena_holds_stays_until_the_next_one_is_asked_for(count: int) -> None:
    seen = []
    with closing(in_turn(numbered(7), arenas(count))) as filled:
        for arena, (number,) in filled:
            time.sleep(0.002)  # a thread that did not wait would write over it now
            assert bytes(arena.data[: arena.used]) == bytes([number]) * number
            seen.append(number)
    assert seen == [1, 2, 3, 4, 5, 6, 7]


@COUNTS
def test_an_error_comes_after_what_was_filled_before_it(count: int) -> None:
    fill = numbered(2)
    seen: list[int] = []

    def broken(arena: ChunkBytes) -> Sequence[int]:
        if not (things := fill(arena)):
            raise OSError(5, "the disk")
        return things

    with closing(in_turn(broken, arenas(count))) as filled:
        seen += next(filled)[1]
        seen += next(filled)[1]
        with pytest.raises(OSError, match="disk"):
            next(filled)
    assert seen == [1, 2]


@COUNTS
def test_no_thread_is_left_where_the_caller_ends_before_all_is_read(count: int) -> None:
    before = threading.active_count()
    with closing(in_turn(numbered(50), arenas(count))) as filled:
        next(filled)
        assert threading.active_count() == before + (count > 1)
    assert threading.active_count() == before
