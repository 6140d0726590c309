"""Warnings about outdated evidence (F504) and waivers without effect (F543)."""

from __future__ import annotations

from collections.abc import Sequence

from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.evidence.verdicts import WAIVED
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.sections.matrix import unknown_ids
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source


def stale_evidence(
    assessments: Sequence[Assessment], summaries: ResultSummaries | None, path: str
) -> tuple[Diagnostic, ...]:
    """F504 for requirements with outdated evidence, and for unknown ids in the evidence.

    Requirements whose evidence is suspect for the same reason share a message.
    """
    again = f"audit again: `fretc audit LOG... -o {path}`"
    suspicions: dict[tuple[int, str], list[Assessment]] = {}
    for assessment in assessments:
        suspicions.setdefault(_suspicions(assessment), []).append(assessment)
    suspect = [
        diagnostic(
            "suspect_evidence",
            some[0].entry.wording,
            requirements=phrases.joined([each.id for each in some]),
            runs=phrases.times(count, "run"),
            each=" each" if len(some) > 1 else "",
            why=why,
            help=again,
        )
        for (count, why), some in suspicions.items()
        if count
    ]
    strange = [
        diagnostic("evidence_of_unknown_requirement", Source(path, "").span(), id=id, help=again)
        for id in unknown_ids(assessments, summaries)
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
        diagnostic(
            "idle_waiver",
            assessment.waiver.span,
            requirement=assessment.waiver.requirement,
            waived=assessment.waiver.verdict,
            verdict=assessment.verdict,
        )
        for assessment in assessments
        if assessment.waiver is not None and assessment.verdict != WAIVED
    )
