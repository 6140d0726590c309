"""The planned methods of verification, and which of them have a result."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.emit import TARGETS
from compiler.logic.claims import METHODS, ClaimResult
from fretc.audit.evidence.verdicts import UNFORMALIZED
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.views import Planned, ProofView
from fretc.report.sections.proofs import covering, in_words, is_proved, worst

_AUDIT = "audit"


def planned(assessment: Assessment, proofs: Sequence[ProofView]) -> tuple[Planned, ...]:
    """The planned methods in the requirement's `verify`, in its order.

    Args:
        assessment: of the requirement.
        proofs: proofs about the requirement and about shared parts.
    """
    return tuple(
        _planned(assessment, method, proofs) for method in dict.fromkeys(assessment.entry.verify)
    )


def _planned(assessment: Assessment, method: str, proofs: Sequence[ProofView]) -> Planned:
    if method == _AUDIT:
        return _audit(assessment)
    relevant = covering(method, proofs) if method in METHODS else []
    return _by_proofs(assessment, method, relevant) if relevant else _other(assessment, method)


def _by_proofs(assessment: Assessment, method: str, proofs: Sequence[ProofView]) -> Planned:
    """A method by its proofs: the worst one decides; vacuous and unchecked ones are not results."""
    decisive = worst(proofs)
    refuted = decisive.mark.word == ClaimResult.COUNTEREXAMPLE
    has_result = refuted or is_proved(decisive)
    return Planned(assessment.id, assessment.anchor, method, has_result, in_words(proofs), refuted)


def _audit(assessment: Assessment) -> Planned:
    current = [audit for audit in assessment.audits if not audit.is_stale]
    if current:
        text = f"{phrases.times(len(current), 'run')} audited: {assessment.mark.text}"
        return Planned(assessment.id, assessment.anchor, _AUDIT, True, text)
    suspect = f"all its evidence is suspect; its verdict was {assessment.unwaived}"
    text = suspect if assessment.audits else "no run has been audited"
    return Planned(assessment.id, assessment.anchor, _AUDIT, False, text)


def _other(assessment: Assessment, method: str) -> Planned:
    """A method without a known result, with the files that fretc can generate for it."""
    return Planned(
        assessment.id,
        assessment.anchor,
        method,
        False,
        f"no result is recorded{_at_hand(assessment, method)}",
    )


def _at_hand(assessment: Assessment, method: str) -> str:
    target = TARGETS.get(method)
    if target is None:
        return ""
    if assessment.requirement is None:
        return f", and none is possible: the requirement is {UNFORMALIZED}"
    if target.refuse(assessment.requirement) is not None:
        return f", and none is possible: {method} cannot express the requirement"
    return "; its file can be generated, but no check of it is recorded"
