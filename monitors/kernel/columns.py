"""Past-time operators over whole traces: a column is an integer, bit i is its truth at tick i.

`every` is the column that is true at every tick of the trace, so its length says how long the
trace is. The cost of an operator is a few passes over the memory of a column; of one with bounds,
log2 of the bound. Sources: `since` by the carry of an addition: Reynolds, in Warren, Hacker's
Delight, 2013, section 2; windows by doubling: van Herk, Pattern Recognition Letters 13 (1992).
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from monitors.kernel.verdicts import Truth, boolean, same_length

LARGE = 1 << 19
"""Ticks from which the memory of a column is allocated differently; see `reuse_memory`."""


@lru_cache(maxsize=None)
def reuse_memory() -> None:
    """Let the C library reuse the memory of large columns.

    glibc asks the system for each block from 128 kB on, and gives it back at once, which costs more
    than to compute it. A larger block that has been freed raises this limit: see mallopt(3),
    M_MMAP_THRESHOLD. Nothing is written to it, so it takes no memory. A second one would be one of
    those that are kept, and be cleared each time: so it is done once.
    """
    bytes(31 << 20)


class Column(NamedTuple):
    """The truth of one proposition at each tick; where neither bit is set it is false."""

    true: int
    unknown: int
    """Disjoint from `true`."""

    def at(self, tick: int) -> Truth:
        """The truth value at one tick."""
        return None if self.unknown >> tick & 1 else bool(self.true >> tick & 1)

    def followed(self, value: Truth, ticks: int) -> "Column":
        """The column with one more value, after its `ticks` others."""
        return Column(self.true | (value is True) << ticks, self.unknown | (value is None) << ticks)


def column(codes: "bytes | bytearray") -> Column:
    """The column of one code a tick: 0 false, 1 true, 2 unknown."""
    if not codes:
        return Column(0, 0)
    backwards = codes[::-1]
    true = int(backwards.translate(_TRUE), 2)
    return Column(true, int(backwards.translate(_UNKNOWN), 2) if 2 in codes else 0)


_TRUE = bytes.maketrans(b"\0\1\2", b"010")
_UNKNOWN = bytes.maketrans(b"\0\1\2", b"001")


def code(value: Truth) -> int:
    """The code of a truth value; any other value is an error of the caller."""
    if value is None:
        return 2
    if value is True or value is False:
        return int(value)
    return int(boolean(value))


class Tape:
    """A column that grows: bits in whole bytes, and the codes of up to seven ticks after them."""

    __slots__ = ("rest", "true", "unknown")

    def __init__(self) -> None:
        self.true, self.unknown = bytearray(), bytearray()
        self.rest = b""

    def append(self, codes: bytes) -> None:
        """Append one code per tick."""
        codes = self.rest + codes
        size = len(codes) // 8
        true, unknown = column(codes[: 8 * size])
        if unknown:  # as long as all is known, that takes no memory
            self.unknown += bytes(len(self.true) - len(self.unknown))
            self.unknown += unknown.to_bytes(size, "little")
        self.true += true.to_bytes(size, "little")
        self.rest = codes[8 * size :]

    def column(self) -> Column:
        """The complete column."""
        ticks, last = 8 * len(self.true), column(self.rest)
        return Column(
            int.from_bytes(self.true, "little") | last.true << ticks,
            int.from_bytes(self.unknown, "little") | last.unknown << ticks,
        )


class Piece(NamedTuple):
    """Some ticks of a trace."""

    ticks: int
    codes: "Sequence[bytes]"
    """For each proposition, one code per tick."""


def pieces_of(rows: "Iterable[Sequence[Truth]]") -> "Iterator[Piece]":
    """Truth values, one row a tick, in pieces.

    Raises:
        TypeError: a value is not True, False or None.
        ValueError: a row has more or fewer values than others.
    """
    waiting = iter(rows)
    while some := list(itertools.islice(waiting, _AT_ONCE)):
        same_length(*some)
        yield Piece(len(some), [bytes(map(code, values)) for values in zip(*some)])


_AT_ONCE = 512
"""Rows of a piece: there may be thousands of values in each."""


def columns_of(pieces: "Iterable[Piece]", count: int) -> "tuple[int, tuple[Column, ...]]":
    """The length and the columns of a trace of `count` propositions.

    Raises:
        ValueError: a piece has more or fewer of them.
    """
    tapes = [Tape() for _ in range(count)]
    ticks = 0
    for piece in pieces:
        ticks += piece.ticks
        same_length(tapes, piece.codes)
        for tape, codes in zip(tapes, piece.codes):
            tape.append(codes)
    return ticks, tuple(tape.column() for tape in tapes)


def truths(column: Column, ticks: int) -> "list[Truth]":
    """The truth value at each tick."""
    true, unknown = (f"{bits:0{ticks}b}"[::-1][:ticks] for bits in column)
    if not column.unknown:
        return [bit == "1" for bit in true]
    return [None if no_bit == "1" else bit == "1" for bit, no_bit in zip(true, unknown)]


def rows_of(columns: "Sequence[Column]", ticks: int) -> "Iterator[tuple[Truth, ...]]":
    """The truth value of each column, tick by tick."""
    if not columns:
        yield from itertools.repeat((), ticks)
        return
    size = (ticks + 7) // 8
    data = [[bits.to_bytes(size, "little") for bits in column] for column in columns]
    for first in range(0, size, _STRETCH):
        parts = [
            Column(*(int.from_bytes(bits[first : first + _STRETCH], "little") for bits in column))
            for column in data
        ]
        few = min(8 * _STRETCH, ticks - 8 * first)
        yield from zip(*(truths(part, few) for part in parts))


_STRETCH = 64
"""Bytes of a column whose truth values are in memory at once."""


def ticks_of(column: int) -> "Iterator[int]":
    """The ticks at which the column is true, in order."""
    return itertools.chain.from_iterable(_tick_lists(column))


_PIECE_BYTES = 512
_BITS = tuple(tuple(bit for bit in range(8) if byte >> bit & 1) for byte in range(256))


def _tick_lists(column: int) -> "Iterator[list[int]]":
    """The ticks in lists, which is faster than a generator of single ticks."""
    data = column.to_bytes((column.bit_length() + 7) // 8, "little")
    for start in range(0, len(data), _PIECE_BYTES):
        piece = data[start : start + _PIECE_BYTES]
        if piece.strip(b"\0"):
            octets = zip(range(8 * start, 8 * (start + len(piece)), 8), piece)
            yield [first + bit for first, byte in octets if byte for bit in _BITS[byte]]


def first_of(column: int) -> "int | None":
    """The first tick at which it is true."""
    return (column & -column).bit_length() - 1 if column else None


def starts_of(column: int) -> int:
    """True at the ticks at which the column becomes true."""
    return column ^ column & column << 1


def runs_of(column: int) -> "Iterator[tuple[int, int]]":
    """Its maximal runs of true ticks, each as (first, last)."""
    edges = ticks_of(column ^ column << 1)
    return ((first, after - 1) for first, after in zip(edges, edges))


# Operators, in the order of their cost ---------------------------------------------------------


def previous(arg: int, every: int) -> int:
    """`Y arg`; false at tick 0."""
    return arg << 1 & every


def weak_previous(arg: int, every: int) -> int:
    """`Z arg`; true at tick 0."""
    return (arg << 1 | 1) & every


def since(left: int, right: int) -> int:
    """`left S right`: a bit of `right` starts a carry, and `left` passes it on."""
    passes = left | right
    return (passes ^ right ^ passes + right) >> 1


def released(left: int, right: int) -> int:
    """`!(!left S !right)`: right, from the last tick at which left held too, or from tick 0 on."""
    starts = left & right
    return (right ^ starts ^ right + starts + 1) >> 1


def once(arg: int, lo: int, hi: "int | None", every: int) -> int:
    """`O[lo,hi] arg`."""
    if lo >= every.bit_length():
        return 0  # no tick of the trace is so long ago
    arg = arg << lo & every if lo else arg
    return _from_first(arg, every) if hi is None else _smeared(arg, hi - lo, every)


def historically(arg: int, lo: int, hi: "int | None", every: int) -> int:
    """`H[lo,hi] arg`."""
    return every ^ once(every ^ arg, lo, hi, every)


def since_from(unbounded: int, left: int, right: int, lo: int, every: int) -> int:
    """`left S[lo,inf) right`, where `unbounded` is `left S right`."""
    if lo >= every.bit_length():
        return 0
    if right | left == left:  # then it began lo ticks ago or more if it has held since
        return _lasting(unbounded, lo)
    return unbounded << lo & historically(left, 0, lo - 1, every) if lo else unbounded


def since_between(left: int, right: int, lo: int, hi: "int | None", every: int) -> int:
    """`left S[lo,hi] right`."""
    result = since(left, right)
    if hi is None:
        return since_from(result, left, right, lo, every)
    if lo >= every.bit_length():
        return 0
    result &= _smeared(right, hi - lo, every)
    return result << lo & historically(left, 0, lo - 1, every) if lo else result


def released_between(left: int, right: int, lo: int, hi: "int | None", every: int) -> int:
    """`!(!left S[lo,hi] !right)`."""
    return every ^ since_between(every ^ left, every ^ right, lo, hi, every)


def until(left: int, right: int, most: int) -> int:
    """`left U[0,most] right`: right comes at most so many ticks later, and left holds before."""
    done = 0
    while left and done < most:
        step = min(done + 1, most - done)
        right |= left & right >> step
        left &= left >> done + 1
        done += step
    return right


def _from_first(arg: int, every: int) -> int:
    """True from the first tick of `arg` on."""
    return every ^ (arg ^ arg - 1) >> 1 if arg else 0


def _smeared(arg: int, more: int, every: int) -> int:
    """True at each tick of `arg` and for `more` ticks after it."""
    more, done = min(more, every.bit_length()), 0
    while done < more:
        step = min(done + 1, more - done)
        arg |= arg << step
        done += step
    return arg & every


def _lasting(arg: int, more: int) -> int:
    """True where `arg` is true and was at each of the `more` ticks before."""
    done = 0
    while done < more:
        step = min(done + 1, more - done)
        arg &= arg << step
        done += step
    return arg
