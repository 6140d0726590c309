"""Impossible combinations of statements about one value, found by the cells of its range.

`x < 2` and `x > 3` divide the line into five cells, and no cell has both. There are far fewer cells
than valuations: n thresholds make 2n + 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

Exclusion = tuple[tuple[int, bool], ...]
"""Indices of statements with their truth values, in ascending order."""


def exclusions(cells: Iterable[str], steps: int) -> tuple[Exclusion, ...]:
    """Minimal sets of literals that no cell satisfies; every other valuation is possible.

    Args:
        cells: for each cell a text with `1` or `0` for each statement, whether it is true there.
        steps: the step limit; combinations that were not tried count as possible.

    Returns:
        The exclusions that a search finds which adds one statement after the other, false first,
        and reduces each impossible valuation to its last needed literals.
    """
    leaves = sorted({*cells})
    ordered = sorted(_Levels(leaves, steps).found()) if leaves else []
    return tuple(exclusion for _, exclusion in ordered)


_Place = tuple[int, int, int]
"""The position of an exclusion in the order of the search."""


class _Levels:
    """The search through valuations, statement by statement.

    Bit i of a set is the i-th cell. Cells are sorted, so cells with equal first values are
    adjacent: such a class is a possible valuation of the first statements.
    """

    def __init__(self, leaves: list[str], steps: int) -> None:
        self._all = (1 << len(leaves)) - 1
        self._true = [int("".join(row)[::-1], 2) for row in zip(*leaves, strict=True)]
        self._first_differences = [0] * len(self._true)
        numbers = [int(leaf, 2) for leaf in leaves]
        for i, (number, next_) in enumerate(pairwise(numbers), start=1):
            self._first_differences[len(self._true) - (number ^ next_).bit_length()] |= 1 << i
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
        """A minimal set of literals that excludes every cell with this one; and the cells left."""
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
    """All cells of the classes that contain a marked cell."""
    surrounding = 0
    while marks:
        mark = marks & -marks
        first = (starts & (mark - 1)).bit_length() - 1
        after = _next(starts, mark)
        surrounding |= (1 << after) - (1 << first)
        marks &= ~surrounding
    return surrounding


def _next(starts: int, mark: int) -> int:
    """The first cell of the next class."""
    beyond = starts & -(mark << 1)
    return (beyond & -beyond).bit_length() - 1


def _place(at: int, value: bool, first: int, starts: int) -> _Place:
    """The position of an exclusion: false comes before the cells of its class, true after them."""
    return (_next(starts, 1 << first), 0, -at) if value else (first, 1, at)
