"""Evidence as tables for queries, with a row for each run and requirement."""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Container, Iterable, Iterator, Sequence
from contextlib import suppress
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from compiler.files.checked_json import LARGEST_COUNT, LEAST
from compiler.files.records import UNSET, plain
from compiler.files.text_files import open_regular, unreadable
from fretc.audit.evidence.result_summaries import (
    EvidenceSource,
    ResultSummary,
    RunFacts,
    summary_of,
)
from fretc.audit.evidence.schema import Health, Result, Violation
from fretc.audit.store.anywhere import required_source
from fretc.audit.store.container import StoreError
from fretc.audit.store.reader import Store
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import unless_installed
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source

if TYPE_CHECKING:
    from pyarrow import Schema, Table

SCHEMA, OLDER = "fretc-table-2", "fretc-table-1"
"""The versions of the table that can be read; the older one lacks the last column."""
_TYPES = {
    "run": "string",
    "requirement": "string",
    "verdict": "string",
    "finite": "bool",
    "reason": "string",
    "clock": "string",
    "ticks": "int64",
    "start_ns": "int64",
    "end_ns": "int64",
    "triggers": "int64",
    "violations": "int64",
    "violated_ticks": "int64",
    "first_violation_ns": "int64",
    "first_violation_s": "float64",
    "unknown_ticks": "int64",
    "open": "int64",
    "answers": "int64",
    "latency_median_s": "float64",
    "latency_max_s": "float64",
    "intact": "bool",
    "size": "int64",
    "gaps": "int64",
    "findings": "int64",
    "log_sha256": "string",
    "sentence_sha256": "string",
    "bindings_sha256": "string",
    "monitor_sha256": "string",
    "fretc": "string",
    "log_summary_sha256": "string",
}
"""Column → its type. The meaning of each is in `docs/audit.md`."""
_LARGE = ("start_ns", "end_ns", "first_violation_ns", "violated_ticks", "unknown_ticks")
"""The columns whose values may be beyond 64 bits."""
_OF_LOG = ("size", "gaps", "findings", "fretc")
_HASHED = ("log", "sentence", "bindings", "monitor", "log_summary")
_SHAS = tuple(f"{name}_sha256" for name in _HASHED)
_COUNTED = tuple(name for name in _TYPES if name not in (*_LARGE, *_OF_LOG, *_SHAS))
_counted, _large, _hashes = attrgetter(*_COUNTED), attrgetter(*_LARGE), attrgetter(*_HASHED)
ROW = (*_COUNTED, *_LARGE, *_OF_LOG, *_SHAS)
"""The columns of `row_of`, in its order."""
_SQL = {"string": "TEXT", "bool": "INTEGER", "int64": "INTEGER", "float64": "REAL"}
_VIOLATION = tuple(name for name in Violation.__struct_fields__ if name != "surroundings")
_RUN = tuple(name for name in RunFacts.__dataclass_fields__ if name not in ("health", "labels"))
_HEALTH = Health.__struct_fields__
TABLES = {
    "results": tuple(f'"{name}" {_SQL[kind]}' for name, kind in _TYPES.items()),
    "violations": ("run", "requirement", *(f'"{name}"' for name in _VIOLATION)),
    "runs": (*_RUN, *_HEALTH, "labels"),
}
"""Table → its columns. Lists and objects are JSON."""
READS = frozenset(
    (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ, sqlite3.SQLITE_FUNCTION, sqlite3.SQLITE_RECURSIVE)
)
"""What a query of a user may do: none of it reads or writes a file."""


def read(paths: Sequence[str], query: str | None = None) -> sqlite3.Connection | Diagnostic:
    """The tables of all the files; a row that several files contain is there once.

    Args:
        paths: stores, evidence files, and tables that `--parquet` wrote.
        query: only the tables that it reads are filled; None: only `results`.
    """
    connection = sqlite3.connect("", isolation_level=None)  # beyond some size it is on the disk
    connection.execute("PRAGMA journal_mode=OFF")
    for name, columns in TABLES.items():
        connection.execute(f"CREATE TABLE {name} ({', '.join(columns)})")
    names = {"results"} if query is None else _read_by(connection, query)
    connection.execute("CREATE TABLE given AS SELECT * FROM results")
    for path in paths:
        wrong = _add(connection, path, names)
        if wrong is not None:
            connection.close()
            return wrong
    order = ", ".join(f"{n}" for n, _ in enumerate(_TYPES, 1))
    connection.execute(f"INSERT INTO results SELECT DISTINCT * FROM given ORDER BY {order}")
    connection.execute("DROP TABLE given")
    return connection


def _read_by(connection: sqlite3.Connection, query: str) -> set[str]:
    """The tables that a query reads; none if it is wrong, which its execution will say."""
    found: set[str] = set()

    def authorize(action: int, table: str | None, *_: object) -> int:
        if action == sqlite3.SQLITE_READ and table is not None:
            found.add(table.lower())  # spelled as in the query, if no column is read
        return sqlite3.SQLITE_OK if action in READS else sqlite3.SQLITE_DENY

    connection.set_authorizer(authorize)
    with suppress(sqlite3.Error, sqlite3.Warning, ValueError):
        connection.execute(f"EXPLAIN {query}")
    connection.set_authorizer(None)
    return found


def _add(connection: sqlite3.Connection, path: str, names: Container[str]) -> Diagnostic | None:
    if not os.path.isdir(path):
        try:
            with open_regular(path) as file:
                start = file.read(64)
        except OSError as error:
            return unreadable(path, error)
        if start.startswith(b"PAR1"):
            found = _read_parquet(path)
            if isinstance(found, Diagnostic):
                return found
            _insert(connection, "given", (tuple(map(row.get, ROW)) for row in found.to_pylist()))
            return None
        if not start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{"):
            return diagnostic("neither_table_nor_evidence", Source(path, "").span(), path=path)
    source = required_source(path, by_summaries=True)
    if isinstance(source, Diagnostic):
        return source
    try:
        if "results" in names:
            _insert(connection, "given", rows(source))
        if "violations" in names:
            _insert(connection, "violations", _violations(source))
        if "runs" in names:
            _insert(connection, "runs", map(_run, source.runs()))
    except StoreError as error:
        return error.diagnostic
    return None


def _insert(connection: sqlite3.Connection, table: str, rows: Iterable[tuple[Any, ...]]) -> None:
    columns = ROW if table == "given" else TABLES[table]
    marks = ",".join("?" * len(columns))
    connection.execute("BEGIN")
    connection.executemany(f"INSERT INTO {table} ({','.join(columns)}) VALUES ({marks})", rows)
    connection.execute("COMMIT")


def rows(source: EvidenceSource) -> Iterator[tuple[Any, ...]]:
    """The row of each result in the table `results`."""
    if isinstance(source, Store):
        for run in source.run_summaries():
            health = run.facts.health
            yield from (_row(each, health, source.fretc) for each in run.results)
    else:
        for _, result in source.details([n for n, _ in source.summaries()]):
            yield row_of(result, source.fretc)


def row_of(result: Result, fretc: str) -> tuple[Any, ...]:
    """The row of a result, with the columns of `ROW`.

    Args:
        result: a record of evidence.
        fretc: the version of fretc that wrote the result.
    """
    return _row(summary_of(result), result.health, fretc)


def _row(summary: ResultSummary, health: Health, fretc: str) -> tuple[Any, ...]:
    return (
        *_counted(summary),
        *map(_held, _large(summary)),
        *(health.size, len(health.gaps), len(health.findings), fretc),
        *(each or None for each in _hashes(summary.fingerprints)),
    )


def _held(value: object) -> Any:
    """A value as a column holds it: an integer beyond 64 bits is null, what is composed is JSON."""
    if isinstance(value, int) and not LEAST <= value <= LARGEST_COUNT:
        return None
    return value if value is None or isinstance(value, int | float | str) else json.dumps(value)


def _violations(source: EvidenceSource) -> Iterator[tuple[Any, ...]]:
    found: Iterable[tuple[str, str, Sequence[Violation]]]
    if isinstance(source, Store):
        found = source.violations()
    else:
        results = (result for _, result in source.details([n for n, _ in source.summaries()]))
        found = ((each.run, each.requirement, each.violations) for each in results)
    for run, requirement, violations in found:
        for violation in violations:
            values = (getattr(violation, name) for name in _VIOLATION)
            yield run, requirement, *(_held(None if v is UNSET else plain(v)) for v in values)


def _run(facts: RunFacts) -> tuple[Any, ...]:
    own = (getattr(facts, name) for name in _RUN)
    of_log = (plain(getattr(facts.health, name)) for name in _HEALTH)
    return *map(_held, own), *map(_held, of_log), json.dumps(dict(facts.labels))


# Parquet -----------------------------------------------------------------------------------------


def no_parquet() -> Diagnostic | None:
    """F908 if the extra is not installed."""
    return unless_installed("a Parquet table needs", ["pyarrow"], "parquet")


def parquet(rows: Iterable[tuple[Any, ...]]) -> bytes:
    """The content of a Parquet file: equal rows give equal bytes."""
    import pyarrow
    from pyarrow.parquet import write_table

    schema = _schema()
    columns = dict(zip(ROW, [*zip(*rows, strict=True)] or [()] * len(ROW), strict=True))
    arrays = [pyarrow.array(columns[field.name], field.type) for field in schema]
    stream = pyarrow.BufferOutputStream()
    write_table(pyarrow.Table.from_arrays(arrays, schema=schema), stream, compression="zstd")
    return bytes(stream.getvalue())


def _read_parquet(path: str) -> Table | Diagnostic:
    absent = no_parquet()
    if absent is not None:
        return absent
    import pyarrow
    from pyarrow.parquet import ParquetFile

    try:
        with ParquetFile(path) as file:
            table = file.read()
    except (pyarrow.ArrowException, OSError) as error:
        return _no_table(path, f"is a damaged table: {str(error).splitlines()[0]}")
    name = (table.schema.metadata or {}).get(b"schema", b"").decode(errors="replace")
    schema = _schema()
    if name == OLDER and table.schema.equals(schema.remove(len(schema) - 1)):
        last = schema.field(len(schema) - 1)
        return table.append_column(last, pyarrow.nulls(len(table), last.type)).cast(schema)
    if name != SCHEMA or not table.schema.equals(schema):
        return _no_table(path, f"is not a table of `{SCHEMA}`")
    return table


def _no_table(path: str, what: str) -> Diagnostic:
    return diagnostic("bad_table", Source(path, "").span(), path=path, what=what)


def _schema() -> Schema:
    import pyarrow

    fields = [(name, pyarrow.type_for_alias(kind)) for name, kind in _TYPES.items()]
    return pyarrow.schema(fields, metadata={"schema": SCHEMA})
