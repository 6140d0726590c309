"""Evidence as tables for queries, with a row for each run and requirement."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from compiler.files.text_files import open_regular, unreadable
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import Result
from fretc.audit.store.anywhere import required_source
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source

if TYPE_CHECKING:
    import pyarrow
    from pyarrow import Table as Table

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


@dataclass(frozen=True, slots=True)
class EvidenceTables:
    """Tables for queries, of results; from stores and evidence also of violations and runs."""

    results: Table
    violations: Table
    runs: Table


def parquet(results: Table) -> bytes:
    """The content of a Parquet file: equal rows give equal bytes."""
    import pyarrow
    from pyarrow.parquet import write_table

    stream = pyarrow.BufferOutputStream()
    write_table(results.combine_chunks(), stream, compression="zstd")
    return bytes(stream.getvalue())


def table(source: EvidenceSource) -> Table:
    """A row for each result of evidence, in memory or in a store."""
    return _known(source).results


def read(paths: Sequence[str]) -> EvidenceTables | Diagnostic:
    """The rows of all the files; a row that several files contain comes once for each.

    Args:
        paths: stores, evidence files, and tables that `--parquet` wrote.
    """
    import pyarrow

    tables = []
    for path in paths:
        tables_of_path = _read(path)
        if isinstance(tables_of_path, Diagnostic):
            return tables_of_path
        tables.append(tables_of_path)
    return EvidenceTables(
        pyarrow.concat_tables([tables_of_path.results for tables_of_path in tables]),
        pyarrow.concat_tables([tables_of_path.violations for tables_of_path in tables]),
        pyarrow.concat_tables([tables_of_path.runs for tables_of_path in tables]),
    )


def _read(path: str) -> EvidenceTables | Diagnostic:
    if not os.path.isdir(path):
        try:
            with open_regular(path) as file:
                start = file.read(64)
        except OSError as error:
            return unreadable(path, error)
        if start.startswith(b"PAR1"):
            rows = _read_parquet(path)
            return rows if isinstance(rows, Diagnostic) else _alone(rows)
        if not start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{"):
            return diagnostic("neither_table_nor_evidence", Source(path, "").span(), path=path)
    evidence = required_source(path)
    return evidence if isinstance(evidence, Diagnostic) else _known(evidence)


def _alone(results: Table) -> EvidenceTables:
    from fretc.audit.store.tables import RUNS, VIOLATIONS, schema

    return EvidenceTables(results, schema(VIOLATIONS).empty_table(), schema(RUNS).empty_table())


def _known(source: EvidenceSource) -> EvidenceTables:
    from fretc.audit.store.reader import Store
    from fretc.audit.store.tables import RESULTS, RUNS, VIOLATIONS, Tables, to_tables

    of_name: Tables
    if isinstance(source, Store):
        of_name = {name: source.whole(name) for name in (RESULTS, VIOLATIONS, RUNS)}
    else:
        places = [place for place, _ in source.briefs()]
        of_name = to_tables([result for _, result in source.details(places)], source.fretc)
    rows = of_name[RESULTS].select([*_TYPES]).cast(_schema())
    return EvidenceTables(rows, of_name[VIOLATIONS], of_name[RUNS])


def rows(results: Sequence[Result], fretc: str) -> Table:
    """A row for each result.

    Args:
        results: records of evidence.
        fretc: the version of fretc that wrote the results.
    """
    from fretc.audit.store.tables import RESULTS, to_tables

    return to_tables(results, fretc)[RESULTS].select([*_TYPES]).cast(_schema())


def _read_parquet(path: str) -> Table | Diagnostic:
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


def _schema() -> pyarrow.Schema:
    import pyarrow

    fields = [(name, pyarrow.type_for_alias(kind)) for name, kind in _TYPES.items()]
    return pyarrow.schema(fields, metadata={"schema": SCHEMA})
