"""A test as a table for the emitted monitor of its requirement."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python.input_adapter import input_adapter
from fretc.analysis.arena.alphabet import Value
from fretc.testing.suite import Test
from fretish.classes.frozen import dataclass

Cell = Value | None
Row = tuple[int, tuple[Cell, ...]]
"""Number of ticks, and the value of each column."""


@dataclass(frozen=True, slots=True)
class TestTable:
    """A test in the columns of a monitor."""

    names: tuple[str, ...]
    rows: tuple[Row, ...]
    of_truths: bool
    """Whether the columns are propositions although the monitor expects variables, because no
    numbers satisfy the test's comparisons. The monitor reads it with `--propositions`."""


def table(requirement: FormalizedRequirement, test: Test) -> TestTable:
    """The columns of a test that the monitor of its requirement reads."""
    variables = input_adapter((requirement,), requirement.watched)
    names = requirement.watched if variables is None else tuple(variables.inputs)
    known = all(row.values.keys() >= {*names} for row in test.rows)
    if not known:
        names = requirement.watched
    return TestTable(names, columns(test, names), of_truths=not known)


def truths(requirement: FormalizedRequirement, test: Test) -> TestTable:
    """Truth values of the propositions of a test, for the monitor in C."""
    return TestTable(requirement.watched, columns(test, requirement.watched), of_truths=True)


def columns(test: Test, names: Sequence[str]) -> tuple[Row, ...]:
    """Some columns of a test; equal adjacent ticks are one row."""
    rows = ((row.count, tuple(row.values[name] for name in names)) for row in test.rows)
    # 0, 0.0 and False are equal, but different values.
    grouped = groupby(rows, key=lambda row: [(type(cell), cell) for cell in row[1]])
    runs = ([*group] for _, group in grouped)
    return tuple((sum(count for count, _ in run), run[0][1]) for run in runs)


def csv_text(names: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """CSV with a header."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(rows)
    return text.getvalue()


def ticks(rows: Iterable[Row]) -> Iterator[tuple[str, ...]]:
    """A row of text for each tick."""
    for count, values in rows:
        yield from [tuple(map(cell_text, values))] * count


def cell_text(value: Cell) -> str:
    """Text of a value for monitors; empty if it is unknown."""
    if value is None:
        return ""
    return str(value).lower() if isinstance(value, bool) else str(value)
