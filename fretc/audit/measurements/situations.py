"""Which situations of a requirement a run came by, over the columns that its monitor judges.

A situation is a formula of the past (`compiler.situations`): a run has come by it at a tick where
the formula is true whatever the unknown values were. Where it may only have been true, nothing is
shown: that is another word than seen. Some ask for more at that tick: that a proposition is
unknown, or that a number is at a threshold.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate_unknown_all
from compiler.situations.situations import Situation
from compiler.situations.thresholds import Place
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class Encounter:
    """The first ticks at which a situation has certainly been there, and may have been."""

    key: str
    """Of the situation."""
    seen: int | None
    perhaps: int | None
    """None, too, where it has been seen: nothing is left open then."""


Near = Callable[[Place], Column]
"""A place of a number → at which ticks the number is there."""


def nowhere_known(ticks: int) -> Near:
    """Where no numbers are at hand: everywhere unknown."""
    return lambda _: Column(0, (1 << ticks) - 1)


def encounters(
    situations: Sequence[Situation], columns: Mapping[str, Column], ticks: int, near: Near
) -> Iterator[Encounter]:
    """What one run shows of each situation, in their order.

    Args:
        situations: of one requirement.
        columns: of its propositions; one without a column is unknown throughout.
        ticks: the length of the run.
        near: is asked only where the rest of a situation may have been there.
    """
    unknown = Column(0, (1 << ticks) - 1)
    formulas = [each.formula for each in situations]
    names = dict.fromkeys(name for formula in formulas for name in f.atoms(formula))
    known = {name: columns.get(name, unknown) for name in names}
    found = evaluate_unknown_all(formulas, known, ticks)
    last = 1 << ticks - 1 if ticks else 0
    for situation, column in zip(situations, found, strict=True):
        counted = last if situation.at_end else -1
        true, may = column.true & counted, (column.true | column.unknown) & counted
        if situation.unknown is not None:
            hole = columns.get(situation.unknown, unknown).unknown
            true, may = true & hole, may & hole
        if situation.place is not None and may:
            there = near(situation.place)
            true, may = true & there.true, may & (there.true | there.unknown)
        seen = _first(true)
        yield Encounter(situation.key, seen, _first(may) if seen is None else None)


def _first(column: int) -> int | None:
    """The first tick at which it is true."""
    return (column & -column).bit_length() - 1 if column else None
