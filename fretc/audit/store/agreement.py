"""A quick check that the tables of a part agree on verdicts and violations.

A reader needs this before it counts the verdicts of many runs. The check of every column needs all
tables (`fretc.audit.store.reader.Store.check_tables`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import decoded
from fretc.audit.evidence.result_summaries import brief, judgement_of
from fretc.audit.evidence.schema import Result
from fretc.audit.store.tables import (
    EVENTS,
    EXACT,
    RESULTS,
    RUNS,
    SAMPLES,
    VIOLATIONS,
    TableName,
    TableRows,
    Tables,
)

Ticks = Sequence[int]
_KEY = ("run", "requirement")
_JUDGED = ("verdict", "finite", "triggers")
COLUMNS: Mapping[TableName, Sequence[str]] = {
    RESULTS: (*_KEY, *_JUDGED, "violations", "judgement", "run_row", EXACT),
    EVENTS: (*_KEY, "open"),
    VIOLATIONS: ("result_row", *_KEY, "first_tick", "last_tick"),
    SAMPLES: ("violation_row",),
    RUNS: ("run", "results"),
}
"""The columns of each table that `check` reads."""


def check(tables: Tables) -> None:
    """Check verdict, run, requirement and violations of each result against the other tables.

    Args:
        tables: the tables of a part, with at least `COLUMNS`.

    Raises:
        SchemaError: the tables contradict each other.
    """
    main, broken = tables[RESULTS], tables[VIOLATIONS]
    _check_names(main, tables[EVENTS], "events")
    rows = _rows(broken["result_row"], main.num_rows)
    _check_names(main.take(rows), broken, "violations")
    runs = tables[RUNS]
    run_rows = _rows(main["run_row"], runs.num_rows)
    results = np.bincount(run_rows, minlength=runs.num_rows)
    if results.tolist() != runs["results"].to_pylist():
        raise SchemaError("`results` does not have the rows that `runs` states")
    if not _same(main["run"], runs["run"].take(run_rows)):
        raise SchemaError("the runs in `results` and in `runs` differ")
    counts = np.bincount(rows, minlength=main.num_rows).tolist()
    known = zip(*_lists(main, "verdict", "judgement", "violations"), counts, strict=True)
    if [*known] != [*_expected(main, broken, tables[EVENTS], counts)]:
        raise SchemaError("the counts in `results` differ from the other tables")


def _check_names(main: TableRows, other: TableRows, name: str) -> None:
    for column in _KEY:
        if not _same(main[column], other[column]):
            raise SchemaError(f"`{column}` of `{name}` is not that of `results`")


def _same(column: Any, other: Any) -> bool:
    is_same: bool = column.equals(other)  # independent of chunks
    return is_same


def _rows(column: Any, count: int) -> Any:
    """The row numbers of a table with so many rows."""
    rows = column.to_numpy()
    if column.null_count or (len(rows) and not 0 <= rows[0] <= rows[-1] < count):
        raise SchemaError("a table names a row that another one does not have")
    if (np.diff(rows) < 0).any():
        raise SchemaError("the rows of a table are in another order than those of `results`")
    return rows


def _expected(
    main: TableRows, broken: TableRows, events: TableRows, counts: Sequence[int]
) -> Iterator[tuple[str, str, int, int]]:
    """Verdict, fingerprint and number of violations of each result, and its number of rows."""
    spans = [[*ticks] for ticks in zip(*_lists(broken, "first_tick", "last_tick"), strict=True)]
    open_at = (_ticks(moments or ()) for moments in events["open"].to_pylist())
    rows = zip(*_lists(main, *_JUDGED, EXACT), _cut(spans, counts), open_at, strict=True)
    for verdict, finite, triggers, text, violations, open_ticks in rows:
        if text is None:
            judgement = judgement_of(verdict, finite, triggers, violations, open_ticks)
            yield verdict, judgement, len(violations), len(violations)
        else:
            whole = brief(decoded(parsed(text), Result))
            yield whole.verdict, whole.judgement, whole.violations, whole.violations


def _ticks(moments: Sequence[Mapping[str, int] | None]) -> list[int | None]:
    """The ticks of moments; a missing moment has none."""
    return [None if moment is None else moment["tick"] for moment in moments]


def _lists(table: TableRows, *columns: str) -> Iterator[list[Any]]:
    return (table[name].to_pylist() for name in columns)


def _cut(items: Sequence[Ticks], counts: Sequence[int]) -> Iterator[Sequence[Ticks]]:
    """The items in lists of these lengths."""
    for start, end in pairwise(accumulate(counts, initial=0)):
        yield items[start:end]
