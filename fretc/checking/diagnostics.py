"""Diagnostics of a whole project: its files, what an audit would refuse, reviews and evidence."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeVar

from compiler.files.dates import today
from compiler.logic.claims import Proof
from compiler.project.paths import sibling_path
from compiler.project.project import Project
from compiler.project.stated_numbers import first_unit
from fretc.analysis.evidence import AnalyzedSet
from fretc.analysis.evidence import known as known_analysis
from fretc.audit.evidence.result_summaries import EvidenceSource, ResultSummaries
from fretc.audit.refusals import refusals
from fretc.audit.store.anywhere import required_source, source
from fretc.report.diagnostics import idle_waivers, stale_evidence
from fretc.report.model.assessments import Assessment, assessments
from fretc.traceability.acceptances import warnings
from fretc.traceability.lock import Lock, withdrawal_warnings, withdrawn_requirements
from fretc.traceability.lock import read as read_lock
from fretc.traceability.waivers import read as read_waivers
from fretc.verification.reader import known as proven
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class SideFiles:
    """Paths beside those of the project."""

    requirements: str
    evidence: str
    verification: str | None = None
    analysis: str | None = None
    is_evidence_named: bool = False
    """Whether the user names the evidence, so that it must be there."""


Together = Callable[[Project, AnalyzedSet | None], Iterable[Diagnostic]]
"""A check whether all requirements can be satisfied together."""


@dataclass(frozen=True, slots=True)
class ProjectCheck:
    """The diagnostics of a project, and the results that they were compared with."""

    diagnostics: tuple[Diagnostic, ...]
    """Each once, in the order of the checks."""
    project: Project | None = None
    """None if the check could not be completed."""
    assessments: tuple[Assessment, ...] = ()
    """One for each requirement."""
    summaries: ResultSummaries | None = None
    """The results of the last audit; None if there is no evidence."""
    proofs: tuple[Proof, ...] = ()
    analyzed: AnalyzedSet | None = None
    """The last analysis of the set; None if there is none."""


def project_diagnostics(
    project: Project, files: SideFiles, together: Together | None = None
) -> tuple[Diagnostic, ...]:
    """All diagnostics of a project; the arguments are those of `check_project`."""
    return check_project(project, files, together).diagnostics


def check_project(
    project: Project, files: SideFiles, together: Together | None = None
) -> ProjectCheck:
    """Check a whole project.

    Args:
        project: with or without errors.
        files: the files beside it.
        together: takes the requirements without errors; None: it is not checked.
    """
    wrong: list[Diagnostic] = []
    results = _evidence(files, wrong)
    proofs = _value(proven(files.verification), wrong) or ()
    analyzed = _value(known_analysis(files.analysis), wrong)
    path = sibling_path(files.requirements, "fretc.lock")
    lock = _value(read_lock(path), wrong) if path is not None else None
    waivers, waived = {}, sibling_path(files.requirements, "waivers.toml")
    if waived is not None:
        known, mistakes = read_waivers(waived, [r.id for r in project.requirements], today())
        waivers = {id: waiver for id, waiver in known.items() if waiver.covers(today())}
        wrong.extend(mistakes)
    summaries = ResultSummaries.of(results) if results else None
    assessed = assessments(project, summaries, lock, waivers, proofs, analyzed)
    diagnostics = (
        *project.diagnostics,
        *_units(project),
        *wrong,
        *(_withdrawn(project, assessed, lock, path) if path is not None else ()),
        *stale_evidence(assessed, summaries, files.evidence),
        *idle_waivers(assessed),
        *_refusals(project),
        *(together(project.sound, analyzed) if together is not None else ()),
        *warnings(project, [each.review_status for each in assessed], lock, results),
    )
    return ProjectCheck(
        tuple(dict.fromkeys(diagnostics)), project, assessed, summaries, proofs, analyzed
    )


def quick_diagnostics(project: Project) -> tuple[Diagnostic, ...]:
    """The diagnostics that need neither reviews, evidence nor generated files, each once."""
    return tuple(dict.fromkeys((*project.diagnostics, *_units(project), *_refusals(project))))


def _evidence(files: SideFiles, diagnostics: list[Diagnostic]) -> EvidenceSource | None:
    """The audited results; errors are added to `diagnostics`."""
    audited = (required_source if files.is_evidence_named else source)(files.evidence)
    if not isinstance(audited, Diagnostic):
        return audited
    if audited.is_error:
        diagnostics.append(audited)
    return None


def _withdrawn(
    project: Project, assessed: Sequence[Assessment], lock: Lock | None, path: str
) -> Iterable[Diagnostic]:
    chains = [each.review_status.chain for each in assessed]
    return withdrawal_warnings(withdrawn_requirements(project.requirements, chains, lock), path)


def _units(project: Project) -> Iterator[Diagnostic]:
    units = first_unit(project.formalized)
    if units is not None:
        yield units


def _refusals(project: Project) -> Iterator[Diagnostic]:
    return (reason for _, why in refusals(project) for reason in why)


def _value(read: T | Diagnostic, diagnostics: list[Diagnostic]) -> T | None:
    """The value; a diagnostic is added to `diagnostics` instead."""
    if isinstance(read, Diagnostic):
        diagnostics.append(read)
        return None
    return read
