"""The traceability report of a project and its files: evidence, proofs, lock, waivers, signatures.

This module reads the files; `fretc.report.assembly` builds the report.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.files.dates import today
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof
from compiler.project.project import Project
from fretc.analysis.evidence import read as read_analysis
from fretc.attestation.signatures import read_signatures
from fretc.audit.store.anywhere import source
from fretc.audit.store.container import StoreError
from fretc.report.assembly import report
from fretc.report.forms.json_text import json_pieces
from fretc.report.model.assessments import Inputs, NamedFiles
from fretc.report.model.views import ReportView
from fretc.report.page.html import html
from fretc.report.sections.details import Details
from fretc.traceability.lock import read as read_lock
from fretc.traceability.waivers import Waiver
from fretc.traceability.waivers import read as read_waivers
from fretc.verification.reader import read as read_proofs
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class ReportBuild:
    """A report, the diagnostics of its files, and further inputs of the formats."""

    report: ReportView | None
    """None if evidence, proofs, analysis, lock or signatures cannot be read.

    Unreadable waivers and results of AJPF are ignored: the report then shows the items as open, and
    the diagnostics give the reason.
    """
    diagnostics: tuple[Diagnostic, ...]
    requirements: tuple[FormalizedRequirement, ...] = ()
    """The formalized requirements; the HTML page has a diagram of each."""
    details: Details | None = None
    """The evidence behind the rows of the report; None if there is no report."""

    @property
    def html(self) -> str | None:
        """The HTML page."""
        if self.report is None or self.details is None:
            return None
        return html(self.report, self.details, self.requirements)

    @property
    def json(self) -> str | None:
        """The report for programs."""
        if self.report is None or self.details is None:
            return None
        return "".join(json_pieces(self.report, self.details))


def make(
    project: Project,
    evidence: str,
    *,
    lock: str | None = None,
    waivers: str | None = None,
    verification: str | None = None,
    ajpf: Sequence[str] = (),
    signers: str | None = None,
    analysis: str | None = None,
    requirements: str | None = None,
    hazards: str | None = None,
    play: bool = False,
) -> ReportBuild:
    """Read the files and make the report.

    Args:
        project: with or without errors; the report lists unformalized requirements.
        evidence: path of a file or of a store; if it does not exist, no requirement is exercised.
        lock: path of a lock; None: no requirement is reviewed.
        waivers: path of a file of waivers; None: nothing is waived.
        verification: path of a file that `fretc verify` wrote; None: nothing was proved.
        ajpf: paths of results that the `run.py` of bundles wrote.
        signers: path of a list of signers; None: no signature is valid.
        analysis: path of a file that `fretc analyze` wrote; None: there is no analysis.
        requirements: the folder or file of the project, as its user named it, for the command that
            the report prints; None: the folder of the first file.
        hazards: path of the hazards of the project, if its user named one, for that command.
        play: whether the page will include the page of `fretc play`, for that command.
    """
    audits = source(evidence)
    if isinstance(audits, Diagnostic) and audits.is_error:
        return ReportBuild(None, (audits,))
    proofs = read_proofs(verification) if verification is not None else None
    if isinstance(proofs, Diagnostic):
        return ReportBuild(None, (proofs,))
    together = read_analysis(analysis) if analysis is not None else None
    if isinstance(together, Diagnostic):
        return ReportBuild(None, (together,))
    reviews = read_lock(lock) if lock is not None else None
    if isinstance(reviews, Diagnostic):
        return ReportBuild(None, (reviews,))
    signed = (evidence, verification, analysis, lock, waivers)
    signed_files = [path for path in signed if path is not None]
    signatures = read_signatures(signed_files, signers)
    if isinstance(signatures, Diagnostic):
        return ReportBuild(None, (signatures,))
    waivers_in_force, waiver_diagnostics = _waivers_in_force(project, waivers)
    all_proofs, ajpf_diagnostics = _with_ajpf(
        proofs.proofs if proofs else (), project.formalized, ajpf
    )
    # A missing file of evidence is only a note: the report shows that nothing was exercised.
    present, notes = (None, (audits,)) if isinstance(audits, Diagnostic) else (audits, ())
    inputs = Inputs(
        project,
        evidence,
        present,
        reviews,
        waivers_in_force,
        proofs,
        all_proofs,
        signatures,
        together,
        NamedFiles(requirements, hazards, lock, waivers, signers, tuple(ajpf), play),
    )
    try:
        full_report, details, report_diagnostics = report(inputs)
    except StoreError as error:
        return ReportBuild(None, (error.diagnostic,))
    return ReportBuild(
        full_report,
        (*notes, *waiver_diagnostics, *ajpf_diagnostics, *report_diagnostics),
        project.formalized,
        details,
    )


def _with_ajpf(
    proofs: Sequence[Proof], requirements: Sequence[FormalizedRequirement], paths: Sequence[str]
) -> tuple[tuple[Proof, ...], tuple[Diagnostic, ...]]:
    """The proofs with those of AJPF's results, and the diagnostics of these files."""
    if not paths and not any(one.layer == Layer.AJPF for one in proofs):
        return tuple(proofs), ()
    from fretc.verification.ajpf_results import ajpf_proofs, merged  # 20 ms: all that makes bundles

    present, diagnostics = ajpf_proofs(requirements, paths)
    return merged(proofs, present), diagnostics


def _waivers_in_force(
    project: Project, path: str | None
) -> tuple[Mapping[str, Waiver], tuple[Diagnostic, ...]]:
    """The waivers that are valid today, and diagnostics about all waivers."""
    if path is None:
        return {}, ()
    day = today()
    waivers, diagnostics = read_waivers(path, [r.id for r in project.requirements], day)
    return {id: waiver for id, waiver in waivers.items() if waiver.covers(day)}, diagnostics
