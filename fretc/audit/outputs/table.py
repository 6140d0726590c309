"""Evidence of many runs as one table: a row for each run and requirement, kept as Parquet.

The only module that imports pyarrow.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from statistics import median
from typing import TYPE_CHECKING, Any

from compiler.files.text_files import regular, unreadable
from fretc.audit.evidence.reader import required
from fretc.audit.evidence.schema import Result
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source

if TYPE_CHECKING:
    import pyarrow
    from pyarrow import Table as Table

SCHEMA, OLDER = "fretc-table-2", "fretc-table-1"
"""The older one does not have the last column, and is read all the same."""
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


def missing() -> Diagnostic | None:
    """F908, where what is needed for tables is not installed."""
    absent = [name for name in ("pyarrow", "duckdb") if find_spec(name) is None]
    if not absent:
        return None
    return Diagnostic(
        Code.MISSING_EXTRA,
        f"a table of runs needs {' and '.join(f'`{name}`' for name in absent)}",
        help="install the extra: pip install 'fretc[fleet]' "
        "(in a checkout: .venv/bin/pip install '.[fleet]')",
    )


def parquet(results: Iterable[Result], fretc: str) -> bytes:
    """The content of a Parquet file: the same results give the same bytes.

    Args:
        results: records of evidence.
        fretc: the version that made them.
    """
    import pyarrow
    from pyarrow.parquet import write_table

    stream = pyarrow.BufferOutputStream()
    write_table(_table([_row(result, fretc) for result in results]), stream, compression="zstd")
    return bytes(stream.getvalue())


def read(paths: Sequence[str]) -> Table | Diagnostic:
    """The rows of all the files, Parquet or evidence; a row that is in several comes once for each.

    Args:
        paths: what `--parquet` or `--output` wrote.
    """
    import pyarrow

    tables = []
    for path in paths:
        table = _read(path)
        if isinstance(table, Diagnostic):
            return table
        tables.append(table)
    return pyarrow.concat_tables(tables)


def _read(path: str) -> Table | Diagnostic:
    try:
        with regular(path) as file:
            start = file.read(64)
    except OSError as error:
        return unreadable(path, error)
    if start.startswith(b"PAR1"):
        return _read_parquet(path)
    if not start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{"):
        return _neither(path)
    return _read_evidence(path)


def _read_evidence(path: str) -> Table | Diagnostic:
    evidence = required(path)
    if isinstance(evidence, Diagnostic):
        return evidence
    return _table([_row(result, evidence.fretc) for result in evidence.results])


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
        return _no_table(path, f"is no table of `{SCHEMA}`")
    return table


def _no_table(path: str, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"`{path}` {what}",
        Source(path, "").span(),
        help=f"audit again: `fretc audit LOG... --parquet {path}`",
    )


def _neither(path: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"`{path}` is neither a table nor evidence",
        Source(path, "").span(),
        help="name what `fretc audit LOG... --parquet FILE` or `-o FILE` wrote",
    )


def _schema() -> pyarrow.Schema:
    import pyarrow

    fields = [(name, pyarrow.type_for_alias(kind)) for name, kind in _TYPES.items()]
    return pyarrow.schema(fields, metadata={"schema": SCHEMA})


def _table(rows: Sequence[Mapping[str, Any]]) -> Table:
    import pyarrow

    return pyarrow.Table.from_pylist(list(rows), schema=_schema())


def _row(result: Result, fretc: str) -> dict[str, Any]:
    """One row; what the record has more than that stays in the evidence."""
    violations, latencies = result.violations, result.latencies
    health, hashes = result.health, result.hashes
    first = violations[0] if violations else None
    return {
        "run": result.run,
        "requirement": result.requirement,
        "verdict": result.verdict,
        "finite": result.finite,
        "reason": result.reason,
        "clock": result.clock,
        "ticks": result.ticks,
        "start_ns": _ns(result.start_ns),
        "end_ns": _ns(result.end_ns),
        "triggers": len(result.triggers),
        "violations": len(violations),
        "violated_ticks": sum(v.last_tick - v.first_tick + 1 for v in violations),
        "first_violation_ns": _ns(first.start_ns) if first else None,
        "first_violation_s": first.start_s if first else None,
        "unknown_ticks": sum(last - first + 1 for first, last in result.unknown),
        "open": len(result.open),
        "answers": len(latencies),
        "latency_median_s": median(latencies) if latencies else None,
        "latency_max_s": max(latencies, default=None),
        "intact": health.intact,
        "size": health.size,
        "gaps": len(health.gaps),
        "findings": len(health.findings),
        "log_sha256": hashes.get("log"),
        "sentence_sha256": hashes["sentence"],
        "bindings_sha256": hashes["bindings"],
        "monitor_sha256": hashes["monitor"],
        "fretc": fretc,
        "log_summary_sha256": hashes.get("log_summary"),
    }


def _ns(time: int | None) -> int | None:
    """None for a time that a column cannot hold: a damaged log may tell one."""
    return time if time is not None and -(2**63) <= time < 2**63 else None
