"""The traceability report: hazard, requirement, formula, artefact, run and verdict in one file."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from compiler.project import Project
from compiler.report.assembly import report
from compiler.report.evidence import read
from compiler.report.html import html
from compiler.templating import to_json
from fretish.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Made:
    """The report in both forms (None: the evidence cannot be read), and what there is to say."""

    html: str | None
    json: str | None
    diagnostics: tuple[Diagnostic, ...]


def make(project: Project, evidence: str) -> Made:
    """Make the report.

    Args:
        project: with or without errors; what could not be formalized is reported as such.
        evidence: path of an evidence file; where there is none, nothing has been exercised.
    """
    audited = read(evidence)
    if not isinstance(audited, Diagnostic):
        whole, said = report(project, audited, evidence)
    elif audited.is_error:
        return Made(None, None, (audited,))
    else:
        whole, said = report(project, None, evidence)
        said = (audited, *said)
    return Made(html(whole), f"{to_json(asdict(whole))}\n", said)
