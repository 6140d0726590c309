"""Short runs that distinguish readings, and the question that decides between most of them.

A reading allows a run if FRET's verdict on the finite run is true. No question is asked that all
remaining readings answer alike, so each answer leaves fewer readings. Of runs that divide the
readings alike, one is preferred whose end matters to no reading: each is violated before, or has no
open obligation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from compiler.files.records import replace as with_fields
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.evaluation import evaluate
from fretc.analysis.arena.budget import Budget
from fretc.testing.runs import DistinguishingRun, difference
from fretc.testing.suite import Repeat
from fretc.testing.words import RunColumns, judged
from fretish import expressions as e
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Question:
    """A run; the readings that allow it, and those that forbid it."""

    run: RunColumns
    allowed: frozenset[int]
    """Indices of the readings that allow the run; the others forbid it."""
    open: int = 0
    """The number of readings for which only the end of the run decides."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """Readings with different meanings, and the runs that distinguish them."""

    kept: tuple[int, ...]
    """Indices of one reading of each meaning."""
    same: tuple[tuple[int, int], ...]
    """(a reading that is left out, the kept reading with the same meaning)."""
    questions: tuple[Question, ...]
    """All runs found, each with the kept readings that allow it."""
    undecided: str
    """Why some readings could not be compared; empty: all were."""


def compare(readings: Sequence[FormalizedRequirement], seconds: float) -> Comparison:
    """Merge readings that agree on all finite runs, and find runs for all others.

    Args:
        readings: the readings; of several with the same meaning the first is kept.
        seconds: CPU seconds for all pairs together.
    """
    budget = Budget(seconds)
    kept: list[int] = []
    same: list[tuple[int, int]] = []
    runs: list[RunColumns] = []
    undecided = ""
    for index, reading in enumerate(readings):
        twin = None
        more: list[RunColumns] = []
        for earlier in kept:
            if any(_tells(readings[earlier], reading, run) for run in (*runs, *more)):
                continue
            apart = difference(readings[earlier], reading, budget.left, readings)
            if isinstance(apart, DistinguishingRun):
                more.append(_decisive(readings[earlier], reading, apart.word))
            elif apart.why:
                late = f"it takes more than {seconds:g} CPU seconds"
                undecided = apart.why if budget.left else late
            else:
                twin = earlier
                break
        if twin is not None:
            same.append((index, twin))
            continue
        kept.append(index)
        runs += more
    some = {index: readings[index] for index in kept}
    questions = tuple(_question(some, run) for run in _distinct([*runs, *_longer(some, runs)]))
    return Comparison(tuple(kept), tuple(same), questions, undecided)


def _question(readings: Mapping[int, FormalizedRequirement], run: RunColumns) -> Question:
    allowed = frozenset(index for index, each in readings.items() if allows(each, run))
    waiting = sum(_is_open(each, run) for each in readings.values())
    return Question(run, allowed, waiting)


def _is_open(reading: FormalizedRequirement, run: RunColumns) -> bool:
    """Whether a reading is not violated, and a longer run could still meet or violate it."""
    signals, last = judged(reading, run), run.ticks - 1
    if signals.violation:
        return False
    pending = evaluate(reading.watch.obligation_pending, run.columns, run.ticks)
    return not signals.accepted >> last & 1 or bool(pending >> last & 1)


def allows(reading: FormalizedRequirement, run: RunColumns) -> bool:
    """Whether the finite run satisfies a reading."""
    return bool(judged(reading, run).accepted >> run.ticks - 1 & 1)


def next_question(remaining: Iterable[int], questions: Sequence[Question]) -> Question | None:
    """The question that divides the readings most evenly, the shortest of these; None: no one does.

    Args:
        remaining: indices of the readings that are still possible.
        questions: those of `compare`.
    """
    some = frozenset(remaining)
    dividing = [each for each in questions if 0 < len(each.allowed & some) < len(some)]
    return min(dividing, key=lambda each: _rank(each, some), default=None)


def _rank(question: Question, remaining: frozenset[int]) -> tuple[int, int, int, int]:
    allowed = len(question.allowed & remaining)
    run = question.run
    return max(allowed, len(remaining) - allowed), question.open, run.ticks, len(run.rows)


def answered(remaining: Iterable[int], question: Question, *, may_happen: bool) -> tuple[int, ...]:
    """The readings that an answer leaves."""
    return tuple(index for index in remaining if (index in question.allowed) is may_happen)


def _tells(one: FormalizedRequirement, other: FormalizedRequirement, run: RunColumns) -> bool:
    return allows(one, run) is not allows(other, run)


def _decisive(
    one: FormalizedRequirement, other: FormalizedRequirement, run: RunColumns
) -> RunColumns:
    """The run up to the first tick at which only one of two readings allows it to end."""
    apart = judged(one, run).accepted ^ judged(other, run).accepted
    assert apart, "a run that distinguishes two sentences does so at some end"
    return shortened(run, (apart & -apart).bit_length())


def shortened(run: RunColumns, ticks: int) -> RunColumns:
    """The first ticks of a run."""
    rows: list[Repeat] = []
    left = ticks
    for row in run.rows:
        if left > 0:
            rows.append(with_fields(row, count=min(row.count, left)))
        left -= row.count
    every = (1 << ticks) - 1
    columns = {name: column & every for name, column in run.columns.items()}
    return RunColumns(tuple(rows), columns, ticks)


def _longer(
    readings: Mapping[int, FormalizedRequirement], runs: Sequence[RunColumns]
) -> Iterator[RunColumns]:
    """Runs with a tick or two more that end with fewer open obligations.

    None if a reading looks at numbers of earlier ticks, which ticks of other runs may contradict.
    """
    stated = [part for each in readings.values() for part in each.stated.values()]
    if any(isinstance(part, e.Call) and part.name not in e.COUNTING for part in stated):
        return
    ticks = {_values(run, tick): _one_tick(run, tick) for run in runs for tick in range(run.ticks)}
    for run in runs:
        for last in [*ticks.values()][:_MOST_ENDS]:
            for count in (1, 2):
                yield _followed(run, last, count)


_MOST_ENDS = 8


def _values(run: RunColumns, tick: int) -> frozenset[str]:
    """The atoms that are true at a tick."""
    return frozenset(name for name, column in run.columns.items() if column >> tick & 1)


def _one_tick(run: RunColumns, tick: int) -> RunColumns:
    """The run of one of its ticks alone."""
    left = tick
    for row in run.rows:
        if left < row.count:
            columns = {name: column >> tick & 1 for name, column in run.columns.items()}
            return RunColumns((with_fields(row, count=1),), columns, 1)
        left -= row.count
    raise IndexError(tick)


def _followed(run: RunColumns, last: RunColumns, count: int) -> RunColumns:
    """The run, and then a tick of another one so many times."""
    bits = (1 << count) - 1
    columns = {
        name: column | (bits << run.ticks if last.columns[name] else 0)
        for name, column in run.columns.items()
    }
    rows = (*run.rows, with_fields(last.rows[0], count=count))
    return RunColumns(rows, columns, run.ticks + count)


def _distinct(runs: Iterable[RunColumns]) -> list[RunColumns]:
    distinct: list[RunColumns] = []
    for run in runs:
        if all((run.ticks, run.columns) != (each.ticks, each.columns) for each in distinct):
            distinct.append(run)
    return distinct
