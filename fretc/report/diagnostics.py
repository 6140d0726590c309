"""Warnings about outdated evidence (F504) and waivers without effect (F543)."""

from __future__ import annotations

from collections.abc import Sequence

from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.evidence.verdicts import WAIVED
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.sections.matrix import unknown_ids
from fretc.traceability.waivers import idle_waiver
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source


def stale_evidence(
    assessments: Sequence[Assessment], briefs: ResultSummaries | None, path: str
) -> tuple[Diagnostic, ...]:
    """F504 for requirements with outdated evidence, and for unknown ids in the evidence.

    Requirements whose evidence is suspect for the same reason share a message.
    """
    again = f"audit again: `fretc audit LOG... -o {path}`"
    suspicions: dict[tuple[int, str], list[Assessment]] = {}
    for assessment in assessments:
        suspicions.setdefault(_suspicions(assessment), []).append(assessment)
    suspect = [
        Diagnostic(
            Code.STALE_EVIDENCE,
            f"the evidence of {phrases.joined([each.id for each in some])} is suspect in "
            f"{phrases.times(count, 'run')}{' each' if len(some) > 1 else ''}: {why}",
            some[0].entry.wording,
            help=again,
            severity=Severity.WARNING,
        )
        for (count, why), some in suspicions.items()
        if count
    ]
    strange = [
        Diagnostic(
            Code.STALE_EVIDENCE,
            f"there is evidence for {id}, which is not among the requirements",
            Source(path, "").span(),
            help=again,
            severity=Severity.WARNING,
        )
        for id in unknown_ids(assessments, briefs)
    ]
    return (*suspect, *strange)


def _suspicions(assessment: Assessment) -> tuple[int, str]:
    """The number of runs in which a requirement is suspect, and the reason."""
    stale = [audit for audit in assessment.audits if audit.is_stale]
    reasons = dict.fromkeys(reason for audit in stale for reason in audit.suspicions)
    return len(stale), phrases.joined(list(reasons))


def idle_waivers(assessments: Sequence[Assessment]) -> tuple[Diagnostic, ...]:
    """F543 for each waiver of another verdict than the present one."""
    return tuple(
        idle_waiver(assessment.waiver, assessment.verdict)
        for assessment in assessments
        if assessment.waiver is not None and assessment.verdict != WAIVED
    )
