"""Lists that are read off columns when somebody asks for them."""

import typing
from collections.abc import Callable, Iterator
from functools import total_ordering
from typing import Any, overload

from monitors.kernel.columns import runs_of, starts_of, ticks_of
from monitors.kernel.verdicts import T


def _bits_of_text(column: int) -> int:
    return bin(column).count("1")


_count_bits: "Callable[[int], int]" = getattr(int, "bit_count", _bits_of_text)
"""How many bits are set; Python 3.8 and 3.9 have no `int.bit_count`."""


@total_ordering
class Listing(typing.Sequence[T]):
    """A tuple that is made when one of its places is asked for; until then it is its columns.

    Whatever is done with it gives what the tuple gives, and a copy of it is the tuple.
    """

    def __init__(self, marks: "Callable[[], int]", items: "Callable[[], Iterator[T]]") -> None:
        """`marks` gives a column with one bit for each of the items."""
        self._marks, self._items = marks, items
        self._tuple: tuple[T, ...] | None = None

    def __len__(self) -> int:
        return _count_bits(self._marks())

    def __iter__(self) -> "Iterator[T]":
        return self._items() if self._tuple is None else iter(self._tuple)

    @overload
    def __getitem__(self, index: int) -> T: ...

    @overload
    def __getitem__(self, index: slice) -> "tuple[T, ...]": ...

    def __getitem__(self, index: "int | slice") -> "T | tuple[T, ...]":
        if self._tuple is None:
            self._tuple = tuple(self._items())
        return self._tuple[index]

    def __eq__(self, other: object) -> bool:
        return tuple(self).__eq__(_as_tuple(other))

    def __lt__(self, other: Any) -> bool:
        return tuple(self).__lt__(_as_tuple(other))

    def __add__(self, other: Any) -> "tuple[Any, ...]":
        return tuple(self).__add__(_as_tuple(other))

    def __radd__(self, other: "tuple[Any, ...]") -> "tuple[Any, ...]":
        return other + tuple(self)

    def __mul__(self, count: int) -> "tuple[T, ...]":
        return tuple(self) * count

    __rmul__ = __mul__

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return repr(tuple(self))

    def __reduce__(self) -> "tuple[Any, ...]":
        return tuple, (tuple(self),)


def _as_tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, Listing) else value


def tick_list(column: int) -> "Listing[int]":
    """The ticks at which a column is true."""
    return Listing(lambda: column, lambda: ticks_of(column))


def run_list(column: int) -> "Listing[tuple[int, int]]":
    """Its maximal runs of true ticks, each as (first, last)."""
    return Listing(lambda: starts_of(column), lambda: runs_of(column))
