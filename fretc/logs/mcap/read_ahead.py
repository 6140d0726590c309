"""Memory that a second thread fills while the caller reads what it has filled before.

Reading, unpacking and CRCs release the interpreter lock, and so does most of NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from queue import SimpleQueue
from threading import Event, Thread
from typing import TypeVar

from fretc.logs.mcap.arena import ChunkBytes

T = TypeVar("T")
Filled = tuple[ChunkBytes, Sequence[T]]
"""An arena, and what is in it."""


def in_turn(
    fill: Callable[[ChunkBytes], Sequence[T]], arenas: Sequence[ChunkBytes]
) -> Generator[Filled[T], None, None]:
    """Fill arenas one after the other; each is the caller's until the next one is asked for.

    The caller must close the iterator, which ends the thread.

    Args:
        fill: fills an empty arena; what it returns is empty at the end.
        arenas: one, which this thread fills; or several, which a second thread fills.

    Raises:
        Exception: what `fill` raises.
    """
    if len(arenas) > 1:
        yield from _ahead(fill, arenas)
        return
    (arena,) = arenas
    while things := fill(arena):
        yield arena, things
        arena.clear()


def _ahead(
    fill: Callable[[ChunkBytes], Sequence[T]], arenas: Sequence[ChunkBytes]
) -> Generator[Filled[T], None, None]:
    free: SimpleQueue[ChunkBytes] = SimpleQueue()
    filled: SimpleQueue[Filled[T] | BaseException] = SimpleQueue()
    ended = Event()

    def run() -> None:
        try:
            while not ended.is_set():
                arena = free.get()
                arena.clear()
                filled.put((arena, fill(arena)))
        except BaseException as error:  # the caller raises it
            filled.put(error)

    for arena in arenas:
        free.put(arena)
    thread = Thread(target=run, daemon=True)
    thread.start()
    try:
        while True:
            next_one = filled.get()
            if isinstance(next_one, BaseException):
                raise next_one
            if not next_one[1]:
                return
            yield next_one
            free.put(next_one[0])
    finally:
        ended.set()
        free.put(arenas[0])  # it may wait for one
        thread.join()
