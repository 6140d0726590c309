"""The traceability report: hazard, requirement, formula, artefact, run and verdict in one file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass

from compiler.evidence import read
from compiler.lock import read as read_lock
from compiler.project import Project
from compiler.report.assembly import report
from compiler.report.html import html
from compiler.templating import to_json
from compiler.waivers import Waiver, today
from compiler.waivers import read as read_waivers
from fretish.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Made:
    """The report in both forms (None: the evidence cannot be read), and what there is to say."""

    html: str | None
    json: str | None
    diagnostics: tuple[Diagnostic, ...]


def make(
    project: Project, evidence: str, *, lock: str | None = None, waivers: str | None = None
) -> Made:
    """Make the report.

    Args:
        project: with or without errors; what could not be formalized is reported as such.
        evidence: path of an evidence file; where there is none, nothing has been exercised.
        lock: path of a lock; None: nothing has been reviewed.
        waivers: path of a file of waivers; None: nothing is waived.
    """
    audited = read(evidence)
    if isinstance(audited, Diagnostic) and audited.is_error:
        return Made(None, None, (audited,))
    known = read_lock(lock) if lock is not None else None
    if isinstance(known, Diagnostic):
        return Made(None, None, (known,))
    waived, told = _waived(project, waivers)
    found = None if isinstance(audited, Diagnostic) else audited
    whole, said = report(project, found, evidence, known, waived)
    missing = (audited,) if isinstance(audited, Diagnostic) else ()
    text = f"{to_json(asdict(whole))}\n"
    return Made(html(whole), text, (*missing, *told, *said))


def _waived(
    project: Project, path: str | None
) -> tuple[Mapping[str, Waiver], tuple[Diagnostic, ...]]:
    """The waivers that count today, and what there is to say of all."""
    if path is None:
        return {}, ()
    day = today()
    found, said = read_waivers(path, [r.id for r in project.requirements], day)
    return {id: waiver for id, waiver in found.items() if waiver.covers(day)}, said
