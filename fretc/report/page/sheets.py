"""The printed sheets: title, hash of the evidence, date and page number in their margins."""

from __future__ import annotations

from compiler.files.dates import source_date
from fretc.report.model.phrases import visible
from fretc.report.model.views import ReportView

_SHOWN = 16
"""Number of characters of the hash on a sheet; the table of hashes has it in full."""
MOST_COLUMNS = 60
"""Above this number of runs, a printed matrix has a card for each requirement, since smaller
symbols cannot be read."""
_WIDE, _HEADS, _COLUMN = 58, 27, 1.2
"""Widths in root ems of the printed style: of the sheet, of the first columns, and of a run."""


def sheet_style(report: ReportView) -> str:
    """The CSS rule of the sheets.

    Source: CSS Paged Media Level 3, section 5, page-margin boxes. The date is that of
    `SOURCE_DATE_EPOCH` if it is set, so that the same inputs give the same bytes.
    """
    hashes = [line.sha256 for line in report.manifest if line.kind == "evidence"]
    made = source_date()
    evidence = f"evidence SHA-256 {hashes[0][:_SHOWN]}" if hashes else "no hash of the evidence"
    runs = next((fact for fact in report.front.facts if "run" in fact.split(", ")[0]), "")
    boxes = {
        "top-left": visible(report.front.title),
        "top-right": f"made {made.date().isoformat()}" if made else runs,
        "bottom-left": evidence,
    }
    texts = "".join(f"@{box} {{ content: {quoted(text)}; }} " for box, text in boxes.items())
    number = '@bottom-right { content: "page " counter(page) " of " counter(pages); }'
    page = f"@page {{ font: 8pt sans-serif; {texts}{number} }}"
    runs_in_matrix = sum(len(group.runs) for group in report.front.groups)
    return (
        f"{page} @media print {{ .matrix:not(.small, .wide) {{ zoom: {_zoom(runs_in_matrix)} }} }}"
    )


def _zoom(columns: int) -> str:
    """The scale at which a matrix with so many runs is as wide as the paper; at most 1.

    Without it, a browser would shrink the whole page, and cut what is still too wide.
    """
    return f"{min(1.0, _WIDE / (_HEADS + _COLUMN * columns)):.3f}"


def quoted(text: str) -> str:
    """A CSS string; every character except letters, digits and blanks is escaped.

    A blank ends each escape. It belongs to the escape and is not shown, so that a blank of the text
    after it is.
    Source: CSS Syntax Level 3, section 4.3.7.
    """
    safe = (c if c.isascii() and (c.isalnum() or c == " ") else f"\\{ord(c):x} " for c in text)
    return f'"{"".join(safe)}"'
