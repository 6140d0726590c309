"""The number of ticks at which a proposition was true, false and unknown, and of its changes."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from compiler.files.records import Count, Record, about
from monitors.kernel import Column


class PropositionTally(Record, frozen=True):
    """The ticks of one proposition; unknown ticks between two values are no change."""

    true: Annotated[Count, about("the number of ticks")]
    false: Count
    unknown: Count
    changes: Annotated[Count, about("the number of changes from one known value to another")]

    def __add__(self, other: PropositionTally) -> PropositionTally:
        """The sum over two runs; from one run to the next nothing changes."""
        return PropositionTally(
            self.true + other.true,
            self.false + other.false,
            self.unknown + other.unknown,
            self.changes + other.changes,
        )


NOTHING = PropositionTally(0, 0, 0, 0)


def tally(column: Column, ticks: int) -> PropositionTally:
    """The tally of a column with the given number of ticks."""
    true, unknown = column.true.bit_count(), column.unknown.bit_count()
    return PropositionTally(true, ticks - true - unknown, unknown, _changes(column, ticks))


def _changes(column: Column, ticks: int) -> int:
    if not column.unknown:
        inner = (1 << max(0, ticks - 1)) - 1
        return ((column.true ^ column.true >> 1) & inner).bit_count()
    values = [
        true
        for true, unknown in zip(
            _digits(column.true, ticks), _digits(column.unknown, ticks), strict=True
        )
        if unknown == "0"
    ]
    return sum(one != other for one, other in pairwise(values))


def _digits(bits: int, ticks: int) -> str:
    return f"{bits:0{ticks}b}" if ticks else ""
