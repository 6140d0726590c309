"""SQL queries on a table of runs: counts of verdicts, the worst runs, the longest latencies.

The only module that imports duckdb.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors import kernel

if TYPE_CHECKING:
    import duckdb

    from fretc.audit.outputs.table import EvidenceTables

SCHEMA = "fretc-summary-1"
MOST = 10
"""The most runs, and the most latencies, that are listed."""

COUNTED: Mapping[str, str] = {
    "satisfied": kernel.SATISFIED,
    "violated": kernel.VIOLATED,
    "inconclusive": kernel.INCONCLUSIVE,
    "vacuous": kernel.VACUOUS,
    "no_data": kernel.NO_DATA,
}
"""Column of a summary → the verdict that it counts."""

_COUNTS = ", ".join(
    f"count(*) FILTER (verdict = '{verdict}') AS {name}" for name, verdict in COUNTED.items()
)
_NOT_SHOWN = f"verdict NOT IN ('{kernel.SATISFIED}', '{kernel.VIOLATED}')"
_LOG = "coalesce('log ' || log_sha256, 'summary ' || log_summary_sha256, 'run ' || run)"
"""The identity of a log, equal for copies; for a log that was not read, its name."""
_WORST_FIRST = " ".join(
    f"WHEN '{verdict}' THEN {rank}"
    for rank, verdict in enumerate(
        (kernel.VIOLATED, kernel.NO_DATA, kernel.INCONCLUSIVE, kernel.VACUOUS, kernel.SATISFIED)
    )
)
_COUNTED = f"""
    CREATE TABLE counted AS
    SELECT * EXCLUDE place REPLACE (min(run) OVER (PARTITION BY log) AS run)
    FROM (SELECT *, rowid AS place, {_LOG} AS log FROM results)
    QUALIFY row_number() OVER (
        PARTITION BY log, requirement
        ORDER BY CASE verdict {_WORST_FIRST} END, violations DESC, place) = 1
    ORDER BY run, requirement"""
"""Each log once for a requirement, under one name: the worst result of several audits."""
_WHOLE = """
    SELECT count(DISTINCT log) AS runs, count(DISTINCT requirement) AS requirements,
        (SELECT round(coalesce(sum(seconds), 0.0), 3) FROM (
            SELECT max(end_ns::DOUBLE - start_ns::DOUBLE) / 1e9 AS seconds
            FROM counted GROUP BY log)) AS seconds,
        count(DISTINCT log) FILTER (NOT intact) AS damaged
    FROM counted"""
_REQUIREMENTS = f"""
    SELECT requirement, count(*) AS runs, {_COUNTS}, sum(triggers)::BIGINT AS triggers,
        sum(violations)::BIGINT AS violations, max(latency_max_s) AS latency_max_s
    FROM counted GROUP BY requirement ORDER BY requirement"""
_FAILED = f"""
    SELECT min(run) AS run, count(*) FILTER (verdict = '{kernel.VIOLATED}') AS violated,
        count(*) FILTER ({_NOT_SHOWN}) AS not_shown, sum(violations)::BIGINT AS violations,
        min(first_violation_s) AS first_violation_s,
        arg_min(reason, (verdict = '{kernel.SATISFIED}', verdict <> '{kernel.VIOLATED}',
            first_violation_s, requirement)) AS reason
    FROM counted GROUP BY log HAVING violated + not_shown > 0
    ORDER BY violated DESC, violations DESC, not_shown DESC, run"""
_SLOWEST = f"""
    SELECT run, requirement, latency_max_s, latency_median_s, answers
    FROM counted WHERE latency_max_s IS NOT NULL
    ORDER BY latency_max_s DESC, run, requirement LIMIT {MOST}"""
_MIXED = """
    SELECT requirement, count(DISTINCT (sentence_sha256, bindings_sha256, monitor_sha256, fretc))
        AS kinds
    FROM results GROUP BY requirement HAVING kinds > 1 ORDER BY requirement"""
_TORN = f"""
    SELECT requirement, min(run) AS run, list(DISTINCT verdict ORDER BY verdict) AS verdicts
    FROM (SELECT *, {_LOG} AS log FROM results)
    GROUP BY requirement, log HAVING len(verdicts) > 1 ORDER BY requirement, run"""


@dataclass(frozen=True, slots=True)
class QueryResult:
    """The result of a query."""

    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    @property
    def records(self) -> list[dict[str, Any]]:
        """An object for each row."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


@dataclass(frozen=True, slots=True)
class TableSummary:
    """The summary of a table."""

    whole: Mapping[str, Any]
    requirements: QueryResult
    failed: QueryResult
    """Runs in which not every requirement is satisfied, the worst first."""
    slowest: QueryResult
    remarks: tuple[Diagnostic, ...]
    """Requirements with several fingerprints, and logs with several verdicts."""

    @property
    def violated(self) -> bool:
        """Whether any requirement is violated in any run."""
        return any(row["violated"] for row in self.requirements.records)

    @property
    def shown(self) -> bool:
        """Whether every requirement is satisfied in every run."""
        return all(row["satisfied"] == row["runs"] for row in self.requirements.records)

    @property
    def as_record(self) -> dict[str, Any]:
        """The JSON object."""
        return {
            "schema": SCHEMA,
            **self.whole,
            "by_requirement": self.requirements.records,
            "failed_runs": len(self.failed.rows),
            "worst_runs": self.failed.records[:MOST],
            "slowest_answers": self.slowest.records,
        }


def summarize(known: EvidenceTables) -> TableSummary:
    """The summary of all results."""
    with _asked(known, _COUNTED) as ask:
        (totals,) = _answer(ask, _WHOLE).records
        return TableSummary(
            totals,
            _answer(ask, _REQUIREMENTS),
            _answer(ask, _FAILED),
            _answer(ask, _SLOWEST),
            (
                *(_mixed(row["requirement"], row["kinds"]) for row in _answer(ask, _MIXED).records),
                *_torn(_answer(ask, _TORN).records),
            ),
        )


def run_query(known: EvidenceTables, query: str) -> QueryResult | Diagnostic:
    """The answer to a query of the user, which can read only these tables."""
    import duckdb

    with _asked(known) as ask:
        try:
            if not ask.extract_statements(query):
                return diagnostic("query_fails", message="it is empty")
            return _answer(ask, query)
        except duckdb.Error as error:
            return diagnostic("query_fails", message=str(error).strip().splitlines()[0])


def _answer(ask: duckdb.DuckDBPyConnection, query: str) -> QueryResult:
    ask.execute(query)
    columns = tuple(str(column[0]) for column in ask.description or ())
    return QueryResult(columns, tuple(ask.fetchall()) if columns else ())


@contextmanager
def _asked(known: EvidenceTables, *more: str) -> Iterator[duckdb.DuckDBPyConnection]:
    """A connection with the tables, each result once; `more` are further statements."""
    import duckdb

    # A query reads no file, writes none, and fetches no extension from anywhere.
    with duckdb.connect(":memory:", config={"enable_external_access": False}) as connection:
        connection.register("given", known.results)
        connection.execute("CREATE TABLE results AS SELECT DISTINCT * FROM given ORDER BY ALL")
        connection.unregister("given")
        for name, rows in (("violations", known.violations), ("runs", known.runs)):
            connection.register(name, rows)
        for statement in more:
            connection.execute(statement)
        connection.execute("SET lock_configuration = true")
        yield connection


def _mixed(requirement: str, kinds: int) -> Diagnostic:
    return diagnostic("audited_differently", requirement=requirement, kinds=kinds)


def _torn(rows_of_all: Sequence[Mapping[str, Any]]) -> Iterator[Diagnostic]:
    """F555, once for each requirement."""
    of_requirement: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows_of_all:
        of_requirement.setdefault(row["requirement"], []).append(row)
    for requirement, rows in of_requirement.items():
        first = rows[0]
        others = "" if len(rows) == 1 else f", and so it is with {len(rows) - 1:,} more"
        yield diagnostic(
            "several_verdicts",
            requirement=requirement,
            log=first["run"],
            verdicts=" and ".join(first["verdicts"]),
            others=others,
        )
