"""Results as tables of results, violations and runs, and results from these tables.

Values without a column of their own are nested, by the types of evidence. A result that a column
cannot hold exactly (`fretc.audit.store.columns`) is also in `exact`, as JSON.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from typing import Any, Final, Literal, Protocol

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import UNSET, decoded, plain, replace
from compiler.files.templating import to_json
from fretc.audit.evidence.reader import VERDICTS
from fretc.audit.evidence.result_summaries import ResultSummary, RunFacts, brief, run_facts
from fretc.audit.evidence.samples import Surroundings
from fretc.audit.evidence.schema import Hashes, Health, Result, Violation
from fretc.audit.evidence.writer import unjudged_result
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.store.columns import (
    ArrowColumn,
    Field,
    InexactError,
    Text,
    Whole,
    fields_of,
    objects,
)

RESULTS: Final = "results"
EVENTS: Final = "events"
VIOLATIONS: Final = "violations"
SAMPLES: Final = "samples"
RUNS: Final = "runs"
TableName = Literal["results", "events", "violations", "samples", "runs"]
EXACT = "exact"
Tables = Mapping[TableName, pa.Table]


class TableRows(Protocol):
    """The interface of a table that is read: in Arrow's form, or still encoded."""

    @property
    def num_rows(self) -> int:
        """The number of rows."""

    def __getitem__(self, column: str) -> Any:
        """One column of all rows."""

    def take(self, rows: pa.Array) -> pa.Table:
        """Some rows, in rising order."""


Source = Mapping[TableName, TableRows]


# Rows --------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Row:
    """A result with its row numbers."""

    result: Result
    brief: ResultSummary
    run_row: int
    fretc: str
    exact: str | None = None

    @property
    def gaps(self) -> int:
        """The number of gaps."""
        return len(self.result.health.gaps)

    @property
    def findings(self) -> int:
        """The number of diagnostics."""
        return len(self.result.health.findings)


@dataclass(frozen=True, slots=True)
class _Part:
    """A violation of a result, or the samples around a violation."""

    row: int
    """The row of the result, or of the violation."""
    result: Result
    part: Violation | Surroundings


@dataclass(frozen=True, slots=True)
class _Run:
    """The results of one log."""

    first: Result
    results: int
    facts: RunFacts
    exact: str | None = None


# Columns -----------------------------------------------------------------------------------------


def _of(names: str, column: ArrowColumn) -> Iterator[Field]:
    for name in names.split():
        yield Field(name, name, column)


def _below(path: str, fields: Iterable[Field]) -> Iterator[Field]:
    return (field.below(path) for field in fields)


_SHARED = ("health", "labels")
"""Fields that all results of a run share."""
_COURSE = "course"
"""Fields of the first result of a run."""
_FLAT = "run requirement verdict finite reason clock ticks start_ns end_ns trials".split()
_ELSEWHERE = ("violations", "hashes", *_SHARED, _COURSE, *_FLAT)
_MAIN = tuple(field for field in fields_of(Result) if field.name in _FLAT)
_NESTED = tuple(field for field in fields_of(Result) if field.name not in _ELSEWHERE)
_OF_RUN = tuple(field for field in fields_of(Result) if field.name in (*_SHARED[1:], _COURSE))
_COUNTS = tuple(e for e in fields_of(ResultSummary) if e.name not in (*_FLAT, "fingerprints"))
_FACTS = tuple(e for e in fields_of(RunFacts) if e.name not in _SHARED)
_HASHES = fields_of(Hashes)
_HASH = "_sha256"
_HEALTH = fields_of(Health)
_VIOLATION = tuple(field for field in fields_of(Violation) if field.name != "window")
_WINDOW = fields_of(Surroundings)
_NAMES = (*_of("run requirement", Text()),)

TABLES: Mapping[TableName, tuple[Field, ...]] = {
    RESULTS: (
        *_below("result", _MAIN),
        *_below("brief", _COUNTS),
        *_below("result.health", _of("size", Whole())),
        *_of("gaps findings", Whole()),
        *(Field(f"{e.name}{_HASH}", f"result.fingerprints.{e.attribute}", Text()) for e in _HASHES),
        *_of("fretc", Text()),
        *_of("run_row", Whole()),
        *_of(EXACT, Text()),
    ),
    EVENTS: (*_below("result", _NAMES), *_below("result", _NESTED)),
    VIOLATIONS: (
        Field("result_row", "row", Whole()),
        *_below("result", _NAMES),
        *_below("part", _VIOLATION),
    ),
    SAMPLES: (
        Field("violation_row", "row", Whole()),
        *_below("result", _NAMES),
        *_below("part", _WINDOW),
    ),
    RUNS: (
        *_below("facts", _FACTS),
        *_of("results", Whole()),
        *_below("facts.health", _HEALTH),
        *_below("first", _OF_RUN),
        *_of(EXACT, Text()),
    ),
}
"""Table → its columns."""


@cache
def schema(table: TableName) -> pa.Schema:
    """The types of a table."""
    return pa.schema([pa.field(each.name, each.column.type) for each in TABLES[table]])


# To tables ---------------------------------------------------------------------------------------


def to_tables(results: Sequence[Result], fretc: str) -> Tables:
    """The tables of some results, in order.

    Args:
        results: the results of whole runs.
        fretc: the version of fretc that wrote the results.
    """
    try:
        return _tabled(results, fretc, {})
    except InexactError:
        texts = {n: to_json(plain(each)) for n, each in enumerate(results) if not _is_held(each)}
        return _tabled(results, fretc, texts)


def _is_held(result: Result) -> bool:
    """Whether columns hold the result exactly."""
    try:
        _tabled([result], "", {})
    except InexactError:
        return False
    return True


def _tabled(results: Sequence[Result], fretc: str, texts: Mapping[int, str]) -> Tables:
    groups = runs_of(results)
    run_rows = [row for row, run in enumerate(groups) for _ in run]
    rows = [
        _Row(result, brief(result), run_row, fretc, texts.get(n))
        for n, (result, run_row) in enumerate(zip(results, run_rows, strict=True))
    ]
    inexact = {run_rows[n] for n in texts}
    runs = [_run(of_run, exact=row not in inexact) for row, of_run in enumerate(groups)]
    broken = [_Part(n, r, violation) for n, r in enumerate(results) for violation in r.violations]
    windows = [
        _Part(n, each.result, each.part.surroundings)
        for n, each in enumerate(broken)
        if isinstance(each.part, Violation) and each.part.surroundings is not None
    ]
    found: dict[TableName, Sequence[Any]] = {
        RESULTS: rows,
        EVENTS: rows,
        VIOLATIONS: broken,
        SAMPLES: windows,
        RUNS: runs,
    }
    return {name: _table(TABLES[name], some, exact=not texts) for name, some in found.items()}


def _run(results: Sequence[Result], *, exact: bool) -> _Run:
    facts = run_facts(results)
    return _Run(results[0], len(results), facts, None if exact else to_json(plain(facts)))


def _table(fields: Sequence[Field], rows: Sequence[Any], *, exact: bool) -> pa.Table:
    arrays = [field.array(rows, exact=exact) for field in fields]
    return pa.Table.from_arrays(arrays, names=[field.name for field in fields])


def runs_of(results: Iterable[Result]) -> list[list[Result]]:
    """The results of each run: adjoining results that share the facts of a run.

    A result with plot data is the first of its run.
    """
    runs: list[list[Result]] = []
    ids: set[str] = set()
    for result in results:
        is_first = not runs or result.requirement in ids or result.course is not UNSET
        if is_first or _shared(result) != _shared(runs[-1][0]):
            runs.append([])
            ids = set()
        runs[-1].append(result)
        ids.add(result.requirement)
    return runs


def _shared(result: Result) -> tuple[object, ...]:
    return (result.run, *(getattr(result, name) for name in _SHARED))


# From tables -------------------------------------------------------------------------------------


def results(tables: Source, rows: Sequence[int] | None = None) -> list[Result]:
    """The results in some rows, or in all.

    Args:
        tables: tables from `tabled`, or encoded ones.
        rows: row numbers in rising order.

    Raises:
        SchemaError: the tables do not fit together, or have invalid values.
    """
    try:
        return _results(tables, rows)
    except InexactError as error:
        raise SchemaError(f"{error}") from None


def _results(tables: Source, rows: Sequence[int] | None) -> list[Result]:
    main = tables[RESULTS]
    if main.num_rows != tables[EVENTS].num_rows:
        raise SchemaError("`events` does not have the rows of `results`")
    rows = range(main.num_rows) if rows is None else rows
    texts = _taken(main[EXACT], rows).to_pylist()
    exact = {n: text for n, text in zip(rows, texts, strict=True) if text is not None}
    held = [n for n in rows if n not in exact]
    found = dict(zip(held, _held(tables, held), strict=True))
    found |= {n: decoded(parsed(text), Result) for n, text in exact.items()}
    return [found[n] for n in rows]


def _held(tables: Source, rows: Sequence[int]) -> list[Result]:
    """The results in some rows that columns hold exactly."""
    main, events = (_taken(tables[name], rows) for name in (RESULTS, EVENTS))
    run_rows = main["run_row"].to_pylist()
    firsts = _firsts(tables[RESULTS]["run_row"], rows)
    begun = {run for run, is_first in zip(run_rows, firsts, strict=True) if is_first}
    shared = _of_runs(tables[RUNS], run_rows, begun)
    parts = zip(
        _objects(main, _MAIN),
        _objects(events, _NESTED),
        _objects(main, _HASHES, _HASH),
        _violations(tables, rows),
        strict=True,
    )
    records = [
        {**flat, **nested, "hashes": hashes, "violations": violations, "health": _NO_HEALTH}
        for flat, nested, hashes, violations in parts
    ]
    results = decoded(records, list[Result])
    bare = {row: {**of_run, _COURSE: UNSET} for row, of_run in shared.items()}
    return [
        replace(each, **(shared if is_first else bare)[n])
        for each, n, is_first in zip(results, run_rows, firsts, strict=True)
    ]


def _firsts(runs: pa.ChunkedArray, rows: Sequence[int]) -> list[bool]:
    """Whether each of these rows is the first one of its run.

    Args:
        runs: the run of each row of the table.
        rows: some rows of the table.
    """
    taken = _taken(runs, rows).to_pylist()
    before = _taken(runs, [max(0, row - 1) for row in rows]).to_pylist()
    return [row == 0 or run != last for row, run, last in zip(rows, taken, before, strict=True)]


_NO_HEALTH = plain(Health(False, None, None, (), (), {}))
"""A placeholder for the health of the run, which is built once for all results of a run."""
_NO_HASHES = dict.fromkeys(("sentence", "bindings", "monitor"), "0" * 64)
_BLANK = plain(unjudged_result("", "none", "", _NO_HASHES, decoded(_NO_HEALTH, Health)))
"""A result of which only the facts of the run are used."""


def _objects(table: pa.Table, fields: Sequence[Field], suffix: str = "") -> list[Any]:
    if not fields:
        return [{} for _ in range(table.num_rows)]
    return objects(fields, [_whole(table, f"{field.name}{suffix}") for field in fields])


def _taken(table: Any, rows: Sequence[int]) -> Any:
    """Some rows of a table or a column."""
    return table.take(pa.array(rows, pa.int64()))


def _whole(table: pa.Table, name: str) -> pa.Array:
    column = table[name].combine_chunks()
    return column if isinstance(column, pa.Array) else pa.concat_arrays(column.chunks)


def _of_runs(
    table: TableRows, run_rows: Sequence[int], begun: Collection[int]
) -> dict[int, dict[str, Any]]:
    """Run → the facts that its results share, and its plot data if its first result is included.

    Plot data that its column cannot hold is in `exact`, with the first result of its run.
    """
    known_rows = sorted({row for row in run_rows if row is not None and 0 <= row < table.num_rows})
    if len(known_rows) != len({*run_rows}):
        raise SchemaError("`results` names a row that `runs` does not have")
    run_table = _taken(table, known_rows)
    parts = [*zip(_objects(run_table, _HEALTH), _objects(run_table, _OF_RUN), strict=True)]
    for row, (_, more) in zip(known_rows, parts, strict=True):
        if row not in begun:
            more.pop(_COURSE, None)
    results = decoded(
        [{**_BLANK, "health": health, **more} for health, more in parts], list[Result]
    )
    names = ("health", *(field.attribute for field in _OF_RUN))
    return {
        row: {name: getattr(one, name) for name in names}
        for row, one in zip(known_rows, results, strict=True)
    }


def _violations(tables: Source, rows: Sequence[int]) -> list[list[Any]]:
    """The violations of each of these rows of results."""
    table = tables[VIOLATIONS]
    places = _chosen(table, "result_row", rows, tables[RESULTS].num_rows)
    windows = dict(_windows(tables, places))
    chosen = _taken(table, places)
    of_row: dict[int, list[Any]] = {row: [] for row in rows}
    parts = zip(places, chosen["result_row"].to_pylist(), _objects(chosen, _VIOLATION), strict=True)
    for place, row, violation in parts:
        of_row[row].append({**violation, "window": windows.get(place)})
    return [of_row[row] for row in rows]


def _windows(tables: Source, rows: Sequence[int]) -> Iterator[tuple[int, Any]]:
    """The samples around each of these rows of violations."""
    table = tables[SAMPLES]
    places = _chosen(table, "violation_row", rows, tables[VIOLATIONS].num_rows)
    chosen = _taken(table, places)
    return zip(chosen["violation_row"].to_pylist(), _objects(chosen, _WINDOW), strict=True)


def _chosen(table: TableRows, key: str, rows: Sequence[int], count: int) -> list[int]:
    """The rows that belong to the given rows of another table."""
    column = table[key]
    if column.null_count:
        raise SchemaError(f"a `{key}` is missing")
    keys = column.to_numpy()
    if len(keys) and (keys[0] < 0 or keys[-1] >= count or (np.diff(keys) < 0).any()):
        raise SchemaError(f"`{key}` does not increase within its table")
    matching_rows: list[int] = np.flatnonzero(np.isin(keys, np.asarray(rows, np.int64))).tolist()
    return matching_rows


# Summaries ---------------------------------------------------------------------------------------


def briefs(table: pa.Table) -> list[ResultSummary]:
    """The summary of each row of `results`.

    Raises:
        SchemaError: a row is invalid.
    """
    texts = table[EXACT].to_pylist()
    held = [n for n, text in enumerate(texts) if text is None]
    readable = table if len(held) == len(texts) else _taken(table, held)
    flat = [each for each in (*_MAIN, *_COUNTS) if each.name != "clock"]
    prints = _objects(readable, _HASHES, _HASH)
    rows = zip(_objects(readable, flat), prints, strict=True)
    summaries = decoded(
        [{**row, "trials": row.get("trials"), "fingerprints": p} for row, p in rows],
        list[ResultSummary],
    )
    if not {each.verdict for each in summaries} <= {*VERDICTS}:
        raise SchemaError("`results` has an unknown verdict")
    whole = dict(zip(held, summaries, strict=True))
    return [
        whole[n] if text is None else brief(decoded(parsed(text), Result))
        for n, text in enumerate(texts)
    ]


def facts(table: pa.Table) -> list[RunFacts]:
    """The facts of each row of `runs`.

    Raises:
        SchemaError: a row is invalid.
    """
    texts = table[EXACT].to_pylist()
    held = [n for n, text in enumerate(texts) if text is None]
    readable = _taken(table, held)
    labels = tuple(field for field in _OF_RUN if field.name == "labels")
    rows = zip(*(_objects(readable, fields) for fields in (_FACTS, _HEALTH, labels)), strict=True)
    records = [{**facts, "health": health, **labels} for facts, health, labels in rows]
    facts_of_runs = decoded(records, list[RunFacts])
    whole = dict(zip(held, facts_of_runs, strict=True))
    return [
        whole[n] if text is None else decoded(parsed(text), RunFacts)
        for n, text in enumerate(texts)
    ]


def nested(tables: Tables, name: str, requirements: Collection[str]) -> list[tuple[int, Any]]:
    """One column of `events` for each row of some requirements, with its row, as plain values.

    Args:
        tables: `results` with `requirement` and `exact`, `events` with the column.
        name: the name of the column.
        requirements: the requirements whose rows are wanted.

    Raises:
        SchemaError: a row cannot be read.
    """
    main, events = tables[RESULTS], tables[EVENTS]
    if main.num_rows != events.num_rows:
        raise SchemaError("`events` does not have the rows of `results`")
    wanted = pa.array([*requirements], pa.string())
    is_wanted = pc.is_in(main["requirement"], wanted).to_numpy(zero_copy_only=False)
    rows: list[int] = np.flatnonzero(is_wanted).tolist()
    (column,) = (field.column for field in _NESTED if field.name == name)
    values = column.values(_whole(_taken(events, rows), name))
    texts = _taken(main[EXACT], rows).to_pylist()
    whole = [
        value if text is None else plain(decoded(parsed(text), Result)).get(name)
        for value, text in zip(values, texts, strict=True)
    ]
    return [*zip(rows, whole, strict=True)]


def joined(groups: Sequence[Tables]) -> Tables:
    """The tables of several groups of runs, joined in order."""
    if len(groups) == 1:
        return groups[0]
    return {name: _joined(groups, name) for name in TABLES}


_KEYS: Mapping[TableName, tuple[str, TableName]] = {
    RESULTS: ("run_row", RUNS),
    VIOLATIONS: ("result_row", RESULTS),
    SAMPLES: ("violation_row", VIOLATIONS),
}
"""Table → its column with row numbers of another table."""


def _joined(groups: Sequence[Tables], name: TableName) -> pa.Table:
    key, other = _KEYS.get(name, ("", name))
    starts = accumulate((len(group[other]) for group in groups), initial=0)
    parts = []
    for group, start in zip(groups, starts, strict=False):
        part = group[name]
        if key:
            place = part.schema.get_field_index(key)
            part = part.set_column(place, key, pc.add(part[key], pa.scalar(start, pa.int64())))
        parts.append(part)
    return pa.concat_tables(parts)


def tallies(tables: Tables) -> list[dict[str, PropositionTally]]:
    """The tally of each proposition in each run.

    Args:
        tables: `results` with `run_row`, `events` with `propositions`, `runs`.

    Raises:
        SchemaError: the tables cannot be read.
    """
    (column,) = (field.column for field in _NESTED if field.name == "propositions")
    tallies_of_runs: list[dict[str, PropositionTally]] = [{} for _ in range(len(tables[RUNS]))]
    rows = tables[RESULTS]["run_row"].to_pylist()
    values = column.values(_whole(tables[EVENTS], "propositions"))
    tally_of_numbers: dict[tuple[int, ...], PropositionTally] = {}
    for row, propositions in zip(rows, values, strict=True):
        for name, counts in propositions.items():
            numbers = tuple(counts.values())
            if numbers not in tally_of_numbers:
                tally_of_numbers[numbers] = decoded(counts, PropositionTally)
            tallies_of_runs[row][name] = tally_of_numbers[numbers]
    return tallies_of_runs
