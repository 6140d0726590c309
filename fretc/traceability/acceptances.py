"""Warnings about a whole project, with those that `[accept]` tables accept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.files.records import UNSET
from compiler.project.acceptances import unused_acceptances
from compiler.project.project import Project
from compiler.project.refusals import unreviewable
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import LogFinding
from fretc.traceability.checks import checks, unreviewed
from fretc.traceability.lock import Lock, ReviewStatus
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, has_errors
from fretish.diagnostics.source import Source

_CODES = {code.number: code for code in Code}


def warnings(
    project: Project,
    statuses: Sequence[ReviewStatus],
    lock: Lock | None,
    evidence: EvidenceSource | None,
) -> tuple[Diagnostic, ...]:
    """Warnings about a project that are not about a single file.

    Findings about audited logs are included only if they are accepted: the audit reports the
    others.

    Args:
        project: with or without errors; requirements that an error affects are skipped.
        statuses: each requirement with its review, in the order of the project.
        lock: None if no requirement was reviewed.
        evidence: None if no run was audited.
    """
    refused = unreviewable(project)
    pairs = zip(project.requirements, statuses, strict=True)
    sound = [each for requirement, each in pairs if requirement not in refused]
    new = unreviewed(project, sound) if lock is not None and lock.reviews else ()
    diagnostics = project.answered((*checks(project, sound), *new))
    if not project.acceptances:  # No finding about the logs is accepted, so they need not be read.
        return diagnostics
    if has_errors(project.diagnostics):  # An error may hide the warning that an acceptance is for.
        return diagnostics
    logged = project.answered(_of_logs(evidence)) if evidence is not None else ()
    every = (*project.diagnostics, *diagnostics, *logged)
    recorded = _recorded(evidence) if evidence is not None else None
    return (
        *diagnostics,
        *(diagnostic for diagnostic in logged if diagnostic.accepted),
        *unused_acceptances(project.acceptances, every, project.declarations, recorded),
    )


def as_diagnostic(finding: LogFinding) -> Diagnostic:
    """A finding of the evidence as a diagnostic, without its line."""
    return Diagnostic(
        _CODES.get(finding.code, Code.BAD_EVIDENCE),
        finding.message,
        Source(finding.file, "").span() if finding.file is not None else None,
        finding.help,
        Severity(finding.severity),
        subject="" if finding.subject is UNSET else finding.subject,
    )


def _of_logs(evidence: EvidenceSource) -> Iterator[Diagnostic]:
    """The findings of all runs, without duplicates."""
    findings = (finding for run in evidence.runs() for finding in run.health.findings)
    yield from dict.fromkeys(as_diagnostic(finding) for finding in findings)


def _recorded(evidence: EvidenceSource) -> set[str]:
    return {topic for run in evidence.runs() for topic in run.health.topics}
