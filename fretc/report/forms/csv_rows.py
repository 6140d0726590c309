"""`--csv`: a row for each requirement and run, for a spreadsheet.

Sources: RFC 4180 for the form; OWASP, CSV Injection, for texts that a spreadsheet would execute.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from fretc.audit.evidence.verdicts import CURRENT, SUSPECT
from fretc.report.model import phrases
from fretc.report.model.views import Mark, Report, RequirementView, ResultRow

HEAD = (
    "hazards", "requirement", "title", "status", "coverage", "verdict", "currency",
    "suspect_because", "sentence", "review", "run", "log_sha256", "run_verdict", "run_currency",
    "run_suspect_because", "reason", "violations", "latency_median", "latency_longest",
)  # fmt: skip
_EXECUTED = ("=", "+", "-", "@", "\t", "\r")


def csv_text(report: Report) -> str:
    """The whole table, with its head."""
    stream = io.StringIO()
    writer = csv.writer(stream)
    writer.writerow(HEAD)
    hashes = {run.anchor: run.sha256 for run in report.runs}
    for view in report.requirements:
        for row in _rows(report, view, hashes):
            writer.writerow([_harmless(cell) for cell in row])
    return stream.getvalue()


def _rows(
    report: Report, view: RequirementView, hashes: dict[str, str]
) -> Iterator[tuple[str, ...]]:
    hazards = dict.fromkeys(row.hazard for row in report.matrix if row.anchor == view.anchor)
    head = (
        " ".join(filter(None, hazards)),
        view.id,
        view.title,
        view.status,
        view.coverage,
        view.mark.word,
        _currency(view.mark),
        "; ".join(view.suspicions),
        view.sentence,
        view.review.text,
    )
    for result in view.results:
        yield (*head, *_run(result, hashes))
    if not view.results:
        yield (*head, "", "", "", "", "", "; ".join(view.reasons), "", "", "")


def _run(result: ResultRow, hashes: dict[str, str]) -> tuple[str, ...]:
    return (
        result.run_file,
        hashes.get(result.run, ""),
        result.mark.word,
        _currency(result.mark),
        "; ".join(result.suspicions),
        result.reason,
        str(result.violations_total),
        _seconds(result.latency_median_s),
        _seconds(result.latency_max_s),
    )


def _seconds(latency: float | None) -> str:
    return "" if latency is None else phrases.seconds(latency)


def _currency(mark: Mark) -> str:
    return SUSPECT if mark.suspect else CURRENT


def _harmless(cell: str) -> str:
    """No cell is a formula."""
    return f"'{cell}" if cell.startswith(_EXECUTED) else cell
