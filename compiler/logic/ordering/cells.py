"""What statements about one value cannot be together: each is true in some cells of its range.

`x < 2` and `x > 3` cut the line into five cells, and no cell has both. Cells are few where
valuations are many: n thresholds make 2n + 1 of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

Exclusion = tuple[tuple[int, bool], ...]
"""Statements by their places, and whether they are true; in the order of places."""


def exclusions(cells: Iterable[str], steps: int) -> tuple[Exclusion, ...]:
    """Least sets of literals that no cell has, so that each other valuation of all is a cell's.

    Args:
        cells: for each cell `1` or `0` at the place of each statement, whether it is true there.
        steps: that it may take; what it has not come to then is left possible.

    Returns:
        What a search through valuations finds that tries one statement after the other, false
        first, and keeps of each that is impossible what it needs, of the last literals.
    """
    leaves = sorted({*cells})
    found = sorted(_Levels(leaves, steps).found()) if leaves else []
    return tuple(exclusion for _, exclusion in found)


_Place = tuple[int, int, int]
"""Where a search through valuations comes to it: orders as it does."""


class _Levels:
    """The search, statement by statement.

    Bit i of a set is the i-th cell. Cells are sorted, so those that begin alike lie together: such
    a class is a valuation of the first statements that is possible.
    """

    def __init__(self, leaves: list[str], steps: int) -> None:
        self._all = (1 << len(leaves)) - 1
        self._true = [int("".join(row)[::-1], 2) for row in zip(*leaves, strict=True)]
        self._first_differences = [0] * len(self._true)
        numbers = [int(leaf, 2) for leaf in leaves]
        for i, (one, next_) in enumerate(pairwise(numbers), start=1):
            self._first_differences[len(self._true) - (one ^ next_).bit_length()] |= 1 << i
        self._left = steps

    def found(self) -> Iterator[tuple[_Place, Exclusion]]:
        """The exclusions, by the last statement of each."""
        starts = 1 | 1 << self._all.bit_length()
        for at, new in enumerate(self._first_differences):
            open_ = self._all & ~_around(new, starts)
            for value in (False, True):
                rest = open_ & self._where(at, not value)
                while rest and self._left > 0:
                    first = (rest & -rest).bit_length() - 1
                    exclusion, others = self._least(at, value, first)
                    yield _place(at, value, first, starts), exclusion
                    rest &= ~others
            starts |= new

    def _where(self, at: int, value: bool) -> int:
        return self._true[at] if value else self._all ^ self._true[at]

    def _least(self, at: int, value: bool, cell: int) -> tuple[Exclusion, int]:
        """What the literal needs of those of the cell before it; and the cells that have that."""
        chosen, common, left = [(at, value)], self._all, self._where(at, value)
        while left:
            rest, place = left, at
            while rest:
                place -= 1
                true = bool(self._true[place] >> cell & 1)
                rest &= self._where(place, true)
            self._left -= at - place
            chosen.append((place, true))
            common &= self._where(place, true)
            left &= common
        return tuple(sorted(chosen)), common


def _around(marks: int, starts: int) -> int:
    """All cells of the classes in which a mark lies."""
    found = 0
    while marks:
        mark = marks & -marks
        first = (starts & (mark - 1)).bit_length() - 1
        after = _next(starts, mark)
        found |= (1 << after) - (1 << first)
        marks &= ~found
    return found


def _next(starts: int, mark: int) -> int:
    """The first cell of the next class."""
    beyond = starts & -(mark << 1)
    return (beyond & -beyond).bit_length() - 1


def _place(at: int, value: bool, first: int, starts: int) -> _Place:
    """False comes before the cells of its class, true after them."""
    return (_next(starts, 1 << first), 0, -at) if value else (first, 1, at)
