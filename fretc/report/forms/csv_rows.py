"""`--csv`: a row for each requirement and run, for a spreadsheet.

Numbers have the unit that the header names. Texts are quoted, so that programs can distinguish them
from numbers. A cell without a number is empty.

Sources: RFC 4180 for the form; OWASP, CSV Injection, for texts that a spreadsheet would execute.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator

from fretc.audit.evidence.verdicts import CURRENT, SUSPECT
from fretc.report.model.marks import Mark
from fretc.report.model.results import ResultRow
from fretc.report.model.views import ReportView, RequirementView

HEAD = (
    "hazards", "requirement", "title", "status", "coverage", "verdict", "currency",
    "suspect_because", "sentence", "review", "run", "log_sha256", "run_verdict", "run_currency",
    "run_suspect_because", "reason", "triggers", "answers", "open", "violations",
    "latency_median_s", "latency_longest_s",
)  # fmt: skip
_EXECUTED = tuple("=+-@\t\r\n\N{FULLWIDTH EQUALS SIGN}\N{FULLWIDTH PLUS SIGN}"
                  "\N{FULLWIDTH HYPHEN-MINUS}\N{FULLWIDTH COMMERCIAL AT}")  # fmt: skip
_NUMBER = re.compile(r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?")
Cell = str | int | float | None


def csv_text(report: ReportView) -> str:
    """The CSV table with its header."""
    stream = io.StringIO()
    writer = csv.writer(stream, quoting=csv.QUOTE_NONNUMERIC)
    writer.writerow(HEAD)
    hashes = {run.anchor: run.sha256 for run in report.runs}
    for view in report.requirements:
        for row in _rows(report, view, hashes):
            writer.writerow([_harmless(cell) for cell in row])
    return stream.getvalue()


def _rows(
    report: ReportView, view: RequirementView, hashes: dict[str, str]
) -> Iterator[tuple[Cell, ...]]:
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
        yield (*head, "", "", "", "", "", "; ".join(view.reasons), *(None,) * 6)


def _run(result: ResultRow, hashes: dict[str, str]) -> tuple[Cell, ...]:
    median = result.latency_median_s
    return (
        result.run_file,
        hashes.get(result.run, ""),
        result.mark.word,
        _currency(result.mark),
        "; ".join(result.suspicions),
        result.reason,
        result.triggers,
        result.answers,
        result.open,
        result.violations_total,
        None if median is None else round(median, 9),
        result.latency_max_s,
    )


def _currency(mark: Mark) -> str:
    return SUSPECT if mark.suspect else CURRENT


def _harmless(cell: Cell) -> Cell:
    """The cell, escaped if a spreadsheet would execute it; numbers such as `-5` are unchanged."""
    if not isinstance(cell, str) or not cell.startswith(_EXECUTED) or _NUMBER.fullmatch(cell):
        return cell
    return f"'{cell}"
