"""`--json`: the report for programs, field by field."""

from __future__ import annotations

from dataclasses import asdict

from compiler.files.templating import to_json
from fretc.report.model.views import Report


def json_text(report: Report) -> str:
    """The whole file."""
    return f"{to_json(asdict(report))}\n"
