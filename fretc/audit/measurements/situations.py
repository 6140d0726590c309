"""Which situations of a requirement a run came by, over the columns that its monitor judges.

A situation is a formula of the past (`compiler.situations`): a run has come by it at a tick where
the formula is true whatever the unknown values were. Where it may only have been true, nothing is
shown: that is another word than seen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate_unknown_all
from compiler.situations.situations import Situation
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class Encounter:
    """The first ticks at which a situation has certainly been there, and may have been."""

    key: str
    """Of the situation."""
    seen: int | None
    perhaps: int | None
    """None, too, where it has been seen: nothing is left open then."""


def encounters(
    situations: Sequence[Situation], columns: Mapping[str, Column], ticks: int
) -> Iterator[Encounter]:
    """What one run shows of each situation, in their order.

    Args:
        situations: of one requirement.
        columns: of its propositions; one without a column is unknown throughout.
        ticks: the length of the run.
    """
    unknown = Column(0, (1 << ticks) - 1)
    formulas = [each.formula for each in situations]
    names = dict.fromkeys(name for formula in formulas for name in f.atoms(formula))
    known = {name: columns.get(name, unknown) for name in names}
    found = evaluate_unknown_all(formulas, known, ticks)
    last = 1 << ticks - 1 if ticks else 0
    for situation, column in zip(situations, found, strict=True):
        counted = last if situation.at_end else -1
        seen, perhaps = _first(column.true & counted), _first(column.unknown & counted)
        yield Encounter(situation.key, seen, perhaps if seen is None else None)


def _first(column: int) -> int | None:
    """The first tick at which it is true."""
    return (column & -column).bit_length() - 1 if column else None
