"""The traceability report: hazard, requirement, formula, artefact, run and verdict in one file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

from compiler.files.dates import today
from compiler.files.templating import to_json
from compiler.formalization.formalized import Formalized
from compiler.project.folder import Project
from fretc.attestation.signatures import gathered
from fretc.audit.evidence.reader import read
from fretc.audit.evidence.schema import Result
from fretc.report.assembly import report
from fretc.report.model.views import Report
from fretc.report.page.html import html
from fretc.report.traceability.lock import read as read_lock
from fretc.report.traceability.waivers import Waiver
from fretc.report.traceability.waivers import read as read_waivers
from fretc.verification.ajpf_results import evidence as ajpf_evidence
from fretc.verification.reader import read as read_proofs
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Made:
    """The report (None: the evidence or the lock cannot be read), and what there is to say."""

    report: Report | None
    diagnostics: tuple[Diagnostic, ...]
    rules: tuple[Formalized, ...] = ()
    """Those that the report is about; the page draws what they mean."""
    results: tuple[Result, ...] = ()
    """Those of the evidence, in its order."""

    @property
    def html(self) -> str | None:
        """The page."""
        return None if self.report is None else html(self.report, self.rules)

    @property
    def json(self) -> str | None:
        """What it says, for programs."""
        return None if self.report is None else f"{to_json(asdict(self.report))}\n"


def make(
    project: Project,
    evidence: str,
    *,
    lock: str | None = None,
    waivers: str | None = None,
    verification: str | None = None,
    ajpf: Sequence[str] = (),
    signers: str | None = None,
) -> Made:
    """Make the report.

    Args:
        project: with or without errors; what could not be formalized is reported as such.
        evidence: path of an evidence file; where there is none, nothing has been exercised.
        lock: path of a lock; None: nothing has been reviewed.
        waivers: path of a file of waivers; None: nothing is waived.
        verification: path of what `fretc verify` wrote; None: nothing was proved.
        ajpf: paths of what the `run.py` of bundles wrote.
        signers: path of a list of signers; None: no signature counts.
    """
    audited = read(evidence)
    if isinstance(audited, Diagnostic) and audited.is_error:
        return Made(None, (audited,))
    proofs = read_proofs(verification) if verification is not None else None
    if isinstance(proofs, Diagnostic):
        return Made(None, (proofs,))
    known = read_lock(lock) if lock is not None else None
    if isinstance(known, Diagnostic):
        return Made(None, (known,))
    signed = [path for path in (evidence, verification, lock, waivers) if path is not None]
    book = gathered(signed, signers)
    if isinstance(book, Diagnostic):
        return Made(None, (book,))
    waived, told = _waived(project, waivers)
    found = None if isinstance(audited, Diagnostic) else audited
    lines, unread = ajpf_evidence(project.rules, ajpf)
    whole, said = report(project, found, evidence, known, waived, proofs, lines, book)
    missing = (audited,) if isinstance(audited, Diagnostic) else ()
    results = found.results if found else ()
    return Made(whole, (*missing, *told, *unread, *said), project.rules, results)


def _waived(
    project: Project, path: str | None
) -> tuple[Mapping[str, Waiver], tuple[Diagnostic, ...]]:
    """The waivers that count today, and what there is to say of all."""
    if path is None:
        return {}, ()
    day = today()
    found, said = read_waivers(path, [r.id for r in project.requirements], day)
    return {id: waiver for id, waiver in found.items() if waiver.covers(day)}, said
