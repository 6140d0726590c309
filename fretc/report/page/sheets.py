"""The printed sheets: title, hash of the evidence, date and page number in their margins."""

from __future__ import annotations

from compiler.files.dates import source_date
from fretc.report.model.phrases import visible
from fretc.report.model.views import ReportView

_SHOWN = 16
"""Number of characters of the hash on a sheet; the table of hashes has it in full."""


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
    return f"@page {{ font: 8pt sans-serif; {texts}{number} }}"


def quoted(text: str) -> str:
    """A CSS string; every character except letters, digits and blanks is escaped.

    Source: CSS Syntax Level 3, section 4.3.7.
    """
    safe = (c if c.isascii() and (c.isalnum() or c == " ") else f"\\{ord(c):06x}" for c in text)
    return f'"{"".join(safe)}"'
