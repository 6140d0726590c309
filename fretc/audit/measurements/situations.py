"""The situations of a requirement that a run shows, over the columns that its monitor judges.

A situation is a formula of the past (`compiler.situations`): a run has come by it at a tick where
the formula is true. It is certain by a tick where every completion of the unknown values has come
by it up to there, maybe at different ticks. Where only some have, nothing is shown: that is another
word than seen. Some ask for more at that tick: that a proposition is unknown, or that a number is
at a threshold.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from compiler.logic import formula as f
from compiler.logic.completions import first_ticks
from compiler.logic.evaluation import evaluate, evaluate_unknown_all
from compiler.situations.situations import Situation
from compiler.situations.thresholds import ThresholdPosition
from fretish.classes.frozen import dataclass
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class SituationTicks:
    """The first ticks by which a situation has certainly occurred, and may have occurred."""

    key: str
    """The key of the situation."""
    seen: int | None
    perhaps: int | None
    """None also if the situation has certainly occurred."""


Near = Callable[[ThresholdPosition], Column]
"""A position of a number relative to a bound → the ticks at which the number is there."""


def nowhere_known(ticks: int) -> Near:
    """The positions of numbers when no numbers are available: always unknown."""
    return lambda _: Column(0, (1 << ticks) - 1)


def situation_ticks(
    situations: Sequence[Situation], columns: Mapping[str, Column], ticks: int, near: Near
) -> Iterator[SituationTicks]:
    """The situations in one run, in their order.

    Args:
        situations: the situations of one requirement.
        columns: the values of its propositions; one without a column is unknown throughout.
        ticks: the length of the run.
        near: the positions of numbers; it is called only if the rest of a situation may have
            occurred.
    """
    unknown = Column(0, (1 << ticks) - 1)
    formulas = [each.formula for each in situations]
    names = dict.fromkeys(name for formula in formulas for name in f.atoms(formula))
    known = {name: columns.get(name, unknown) for name in names}
    last = 1 << ticks - 1 if ticks else 0
    for situation, column in zip(
        situations, evaluate_unknown_all(formulas, known, ticks), strict=True
    ):
        counted = last if situation.at_end else unknown.unknown
        if situation.unknown is not None:
            counted &= columns.get(situation.unknown, unknown).unknown
        formula = situation.formula
        true, may = column.true & counted, (column.true | column.unknown) & counted
        if situation.place is not None and may:
            there = near(situation.place)
            known[_THERE] = there
            formula = f.And((formula, f.Atom(_THERE)))
            true, may = true & there.true, may & (there.true | there.unknown)
        seen, perhaps = _first(true), _first(may)
        if seen != perhaps:  # unknown values leave the bounds apart
            seen, perhaps = _exact(formula, known, ticks, counted, (seen, perhaps))
        yield SituationTicks(situation.key, seen, perhaps if seen is None else None)


_THERE = ""
"""The name of a position; no proposition has an empty name."""

_Ticks = tuple[int | None, int | None]
"""The ticks by which a situation has certainly occurred, and may have occurred."""


def _exact(
    formula: f.Formula, columns: Mapping[str, Column], ticks: int, counted: int, bounds: _Ticks
) -> _Ticks:
    """The ticks of a situation, if the evaluation gives only bounds of them.

    Two runs often settle it: all unknown values are false, or all are true. If the search would
    take too long, the bounds stay, and an occurrence in them is certain.
    """
    seen, perhaps = bounds
    names = [*f.atoms(formula)]
    false = {name: columns[name].true for name in names}
    true = {name: columns[name].true | columns[name].unknown for name in names}
    firsts = [_first(evaluate(formula, run, ticks) & counted) for run in (false, true)]
    certain = [tick for tick in firsts if tick is not None]
    if seen is None and None in firsts and perhaps == min(certain, default=None):
        return bounds
    if seen is not None and seen == max(certain):
        return bounds
    bounds_of_ticks = first_ticks(formula, columns, ticks, counted)
    return bounds if bounds_of_ticks is None else (bounds_of_ticks.by_all, bounds_of_ticks.by_some)


def _first(column: int) -> int | None:
    """The first tick at which the column is true."""
    return (column & -column).bit_length() - 1 if column else None
