"""SQL queries on a table of runs: counts of verdicts, the worst runs, the longest latencies."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fretc.audit.evidence.reader import VERDICTS
from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN
from fretc.audit.outputs.table import READS
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors import kernel

SCHEMA = "fretc-summary-1"
MOST = 10
"""The most runs, and the most latencies, that are listed."""

COUNTED: Mapping[str, str] = {
    "satisfied": kernel.SATISFIED,
    "violated": kernel.VIOLATED,
    "assumption_broken": ASSUMPTION_BROKEN,
    "inconclusive": kernel.INCONCLUSIVE,
    "vacuous": kernel.VACUOUS,
    "no_data": kernel.NO_DATA,
}
"""Column of a summary → the verdict that it counts."""

_COUNTS = ", ".join(
    f"count(*) FILTER (WHERE verdict = '{verdict}') AS {name}" for name, verdict in COUNTED.items()
)
_NOT_SHOWN = f"verdict NOT IN ('{kernel.SATISFIED}', '{kernel.VIOLATED}')"
_LOG = "coalesce('log ' || log_sha256, 'summary ' || log_summary_sha256, 'run ' || run)"
"""The identity of a log, equal for copies; for a log that was not read, its name."""
_WORST_FIRST = " ".join(f"WHEN '{verdict}' THEN {rank}" for rank, verdict in enumerate(VERDICTS))
_LOGS = f"(SELECT *, rowid AS place, {_LOG} AS log FROM results)"
_USED = (
    "run, requirement, verdict, reason, start_ns, end_ns, triggers, violations, first_violation_s, "
    "answers, latency_median_s, latency_max_s, intact, log, place"
)
_COUNTED = f"""
    CREATE TEMP TABLE counted AS SELECT * FROM (
        SELECT {_USED}, min(run) OVER (PARTITION BY log) AS name, row_number() OVER (
            PARTITION BY log, requirement
            ORDER BY CASE verdict {_WORST_FIRST} END, violations DESC, place) AS rank
        FROM {_LOGS})
    WHERE rank = 1 ORDER BY name, requirement"""
"""Each log once for a requirement, under one name: the worst result of several audits."""
_WHOLE = """
    SELECT count(DISTINCT log) AS runs, count(DISTINCT requirement) AS requirements,
        (SELECT round(coalesce(sum(seconds), 0.0), 3) FROM (
            SELECT max(1.0 * end_ns - start_ns) / 1e9 AS seconds
            FROM counted GROUP BY log)) AS seconds,
        count(DISTINCT log) FILTER (WHERE NOT intact) AS damaged
    FROM counted"""
_REQUIREMENTS = f"""
    SELECT requirement, count(*) AS runs, {_COUNTS}, sum(triggers) AS triggers,
        sum(violations) AS violations, max(latency_max_s) AS latency_max_s
    FROM counted GROUP BY requirement ORDER BY requirement"""
_FAILED = f"""
    SELECT min(name) AS run, count(*) FILTER (WHERE verdict = '{kernel.VIOLATED}') AS violated,
        count(*) FILTER (WHERE {_NOT_SHOWN}) AS not_shown, sum(violations) AS violations,
        min(first_violation_s) AS first_violation_s, why AS reason
    FROM (SELECT *, first_value(reason) OVER (PARTITION BY log ORDER BY
            verdict = '{kernel.SATISFIED}', verdict <> '{kernel.VIOLATED}',
            first_violation_s NULLS LAST, requirement) AS why
        FROM counted
        WHERE log IN (SELECT log FROM counted WHERE verdict <> '{kernel.SATISFIED}'))
    GROUP BY log HAVING violated + not_shown > 0
    ORDER BY violated DESC, violations DESC, not_shown DESC, run"""
_SLOWEST = f"""
    SELECT name AS run, requirement, latency_max_s, latency_median_s, answers
    FROM counted WHERE latency_max_s IS NOT NULL
    ORDER BY latency_max_s DESC, run, requirement LIMIT {MOST}"""
_MIXED = """
    SELECT requirement, count(*) AS kinds
    FROM (SELECT DISTINCT requirement, sentence_sha256, bindings_sha256, monitor_sha256, fretc
        FROM results)
    GROUP BY requirement HAVING kinds > 1 ORDER BY requirement"""
_TORN = f"""
    SELECT requirement, min(run) AS run, group_concat(DISTINCT verdict) AS verdicts
    FROM {_LOGS}
    GROUP BY requirement, log HAVING count(DISTINCT verdict) > 1 ORDER BY requirement, run"""
_MOST_SECONDS = 600
_STEPS = 100_000
"""Steps of a query after which its time is looked at."""


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


def summarize(tables: sqlite3.Connection) -> TableSummary:
    """The summary of all results."""
    tables.execute(_COUNTED)
    (totals,) = _answer(tables, _WHOLE).records
    return TableSummary(
        totals,
        _answer(tables, _REQUIREMENTS),
        _answer(tables, _FAILED),
        _answer(tables, _SLOWEST),
        (
            *(_mixed(row["requirement"], row["kinds"]) for row in _answer(tables, _MIXED).records),
            *_torn(_answer(tables, _TORN).records),
        ),
    )


def run_query(tables: sqlite3.Connection, query: str) -> QueryResult | Diagnostic:
    """The answer to a query of the user, which can only read these tables."""
    end = time.monotonic() + _MOST_SECONDS
    tables.set_authorizer(
        lambda action, *_: sqlite3.SQLITE_OK if action in READS else sqlite3.SQLITE_DENY
    )
    tables.set_progress_handler(lambda: time.monotonic() > end, _STEPS)
    try:
        answer = _answer(tables, query)
    except (sqlite3.Error, sqlite3.Warning, ValueError) as error:
        return diagnostic("query_fails", message=str(error))
    return answer if answer.columns else diagnostic("query_fails", message="it is empty")


def _answer(tables: sqlite3.Connection, query: str) -> QueryResult:
    found = tables.execute(query)
    columns = tuple(column[0] for column in found.description or ())
    return QueryResult(columns, tuple(found.fetchall()))


def _mixed(requirement: str, kinds: int) -> Diagnostic:
    return diagnostic("audited_differently", requirement=requirement, kinds=kinds)


def _torn(rows_of_all: Sequence[Mapping[str, Any]]) -> Iterator[Diagnostic]:
    """F555, once for each requirement."""
    of_requirement: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows_of_all:
        of_requirement.setdefault(row["requirement"], []).append(row)
    for requirement, rows in of_requirement.items():
        first = rows[0]
        verdicts = " and ".join(sorted(first["verdicts"].split(",")))
        others = "" if len(rows) == 1 else f", and so it is with {len(rows) - 1:,} more"
        yield diagnostic(
            "several_verdicts",
            requirement=requirement,
            log=first["run"],
            verdicts=verdicts,
            others=others,
        )
