"""The traceability report from files: evidence, proofs, lock, waivers, signatures.

This module reads the files; `fretc.report.assembly` makes the report of what they say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from compiler.files.dates import today
from compiler.formalization.formalized import Formalized
from compiler.project.folder import Project
from fretc.attestation.signatures import gathered
from fretc.audit.evidence.declared_units import without_samples
from fretc.audit.evidence.reader import read as read_evidence
from fretc.audit.evidence.schema import Result
from fretc.report.assembly import report
from fretc.report.forms.json_text import json_text
from fretc.report.model.views import Report
from fretc.report.page.html import html
from fretc.report.traceability.lock import read as read_lock
from fretc.report.traceability.waivers import Waiver
from fretc.report.traceability.waivers import read as read_waivers
from fretc.verification.ajpf_results import evidence as read_ajpf
from fretc.verification.reader import read as read_proofs
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class ReportBuild:
    """A report with the diagnostics of its files, and what its forms need beside it."""

    report: Report | None
    """None where the evidence, the proofs, the lock or the signatures cannot be read."""
    diagnostics: tuple[Diagnostic, ...]
    rules: tuple[Formalized, ...] = ()
    """The formalized requirements; the page draws what they mean."""
    results: tuple[Result, ...] = ()
    """Those of the evidence, in its order and in declared units."""

    @property
    def html(self) -> str | None:
        """The page."""
        return None if self.report is None else html(self.report, self.rules)

    @property
    def json(self) -> str | None:
        """The report for programs."""
        return None if self.report is None else json_text(self.report)


def make(
    project: Project,
    evidence: str,
    *,
    lock: str | None = None,
    waivers: str | None = None,
    verification: str | None = None,
    ajpf: Sequence[str] = (),
    signers: str | None = None,
) -> ReportBuild:
    """Read the files and make the report.

    Args:
        project: with or without errors; the report shows what could not be formalized as such.
        evidence: path of an evidence file; where there is none, nothing has been exercised.
        lock: path of a lock; None: nothing has been reviewed.
        waivers: path of a file of waivers; None: nothing is waived.
        verification: path of a file that `fretc verify` wrote; None: nothing was proved.
        ajpf: paths of results that the `run.py` of bundles wrote.
        signers: path of a list of signers; None: no signature counts.
    """
    audit = read_evidence(evidence)
    if isinstance(audit, Diagnostic) and audit.is_error:
        return ReportBuild(None, (audit,))
    proofs = read_proofs(verification) if verification is not None else None
    if isinstance(proofs, Diagnostic):
        return ReportBuild(None, (proofs,))
    reviews = read_lock(lock) if lock is not None else None
    if isinstance(reviews, Diagnostic):
        return ReportBuild(None, (reviews,))
    paths = [path for path in (evidence, verification, lock, waivers) if path is not None]
    book = gathered(paths, signers)
    if isinstance(book, Diagnostic):
        return ReportBuild(None, (book,))
    in_force, waiver_diagnostics = _waivers(project, waivers)
    ajpf_lines, ajpf_diagnostics = read_ajpf(project.rules, ajpf)
    no_evidence = (audit,) if isinstance(audit, Diagnostic) else ()
    present = None if isinstance(audit, Diagnostic) else audit
    whole, diagnostics = report(
        project, present, evidence, reviews, in_force, proofs, ajpf_lines, book
    )
    return ReportBuild(
        whole,
        (*no_evidence, *waiver_diagnostics, *ajpf_diagnostics, *diagnostics),
        project.rules,
        without_samples(present.results, project.declarations) if present else (),
    )


def _waivers(
    project: Project, path: str | None
) -> tuple[Mapping[str, Waiver], tuple[Diagnostic, ...]]:
    """The waivers that count today, and diagnostics about all of them."""
    if path is None:
        return {}, ()
    day = today()
    waivers, diagnostics = read_waivers(path, [r.id for r in project.requirements], day)
    return {id: waiver for id, waiver in waivers.items() if waiver.covers(day)}, diagnostics
