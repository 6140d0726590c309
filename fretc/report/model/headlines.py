"""The headline of a report: violated requirements, suspect ones, and the changes behind them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.suspicions import changed_since, since_review

_GROUPS = 3
"""Maximum number of reasons that a headline names; others are counted."""


def violated(assessments: Sequence[Assessment]) -> str:
    """Violated requirements: `No contact (R14) is violated`.

    Args:
        assessments: at least one, all of them violated or refuted.
    """
    current = [assessment for assessment in assessments if not assessment.suspicions]
    stale = [assessment for assessment in assessments if assessment.suspicions]
    parts = [f"{_named(current)} {' or '.join(_words(current))}"] if current else []
    return f"{'; '.join([*parts, *_groups(stale)])}."


def outdated(assessments: Sequence[Assessment]) -> str:
    """Suspect requirements that are not violated, with the reasons; "" if there are none."""
    stale = [
        assessment
        for assessment in assessments
        if assessment.suspicions and not assessment.is_broken
    ]
    return f"{'; '.join(_groups(stale))}." if stale else ""


def _groups(stale: Sequence[Assessment]) -> list[str]:
    """A phrase for each verdict and reason, worst first."""
    ordered = sorted(stale, key=lambda assessment: (assessment.mark.severity, _reasons(assessment)))
    groups = [
        (list(same), reasons)
        for (_, reasons), same in groupby(
            ordered, key=lambda assessment: (assessment.mark.word, _reasons(assessment))
        )
    ]
    parts = [
        f"{_named(same, 'was', 'were')} {same[0].mark.word}, and {phrases.joined(reasons)}"
        for same, reasons in groups[:_GROUPS]
    ]
    rest = sum(len(same) for same, _ in groups[_GROUPS:])
    return [*parts, f"{phrases.times(rest, 'more requirement')} suspect"] if rest else parts


def _reasons(assessment: Assessment) -> tuple[str, ...]:
    """The suspicions of a requirement, without changes since its review."""
    status = assessment.review_status
    if status.review is None:
        return assessment.suspicions
    since, brief = since_review(status), changed_since(status.review)
    return tuple(brief if reason in since else reason for reason in assessment.suspicions)


def _named(assessments: Sequence[Assessment], one: str = "is", many: str = "are") -> str:
    names = [assessment.entry.name for assessment in assessments]
    return f"{phrases.some(names)} {one if len(names) == 1 else many}"


def _words(assessments: Sequence[Assessment]) -> Sequence[str]:
    return list(dict.fromkeys(assessment.mark.word for assessment in assessments))
