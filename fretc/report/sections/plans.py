"""The planned methods of verification, and which of them have a result."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.emit import TARGETS
from compiler.logic.claims import METHODS, Result
from fretc.audit.evidence.verdicts import UNFORMALIZED
from fretc.report.model import phrases
from fretc.report.model.claims import Claim
from fretc.report.model.views import Planned, ProofView
from fretc.report.sections.proofs import covering, in_words, is_proved, worst

_AUDIT = "audit"


def planned(claim: Claim, proofs: Sequence[ProofView]) -> tuple[Planned, ...]:
    """Every method that the requirement's `verify` names, in its order.

    Args:
        claim: the requirement.
        proofs: of it, and of what all requirements share.
    """
    return tuple(
        _planned(claim, method, proofs) for method in dict.fromkeys(claim.requirement.verify)
    )


def _planned(claim: Claim, method: str, proofs: Sequence[ProofView]) -> Planned:
    if method == _AUDIT:
        return _audit(claim)
    found = covering(method, proofs) if method in METHODS else []
    return _proved(claim, method, found) if found else _other(claim, method)


def _proved(claim: Claim, method: str, found: Sequence[ProofView]) -> Planned:
    """The worst of its proofs decides; what was not checked or says nothing is no result."""
    decisive = worst(found)
    refuted = decisive.mark.word == Result.COUNTEREXAMPLE
    known = refuted or is_proved(decisive)
    return Planned(claim.id, claim.anchor, method, known, in_words(found), refuted)


def _audit(claim: Claim) -> Planned:
    counted = [judged for judged in claim.judged if not judged.is_stale]
    if counted:
        text = f"{phrases.times(len(counted), 'run')} audited: {claim.mark.text}"
        return Planned(claim.id, claim.anchor, _AUDIT, True, text)
    suspect = f"all its evidence is suspect; it said {claim.unwaived}"
    text = suspect if claim.judged else "no run has been audited"
    return Planned(claim.id, claim.anchor, _AUDIT, False, text)


def _other(claim: Claim, method: str) -> Planned:
    """A method whose result nothing tells this report: it says so, and what is at hand for it."""
    return Planned(
        claim.id, claim.anchor, method, False, f"no result is known{_at_hand(claim, method)}"
    )


def _at_hand(claim: Claim, method: str) -> str:
    target = TARGETS.get(method)
    if target is None:
        return ""
    if claim.rule is None:
        return f", and none can be: the requirement is {UNFORMALIZED}"
    if target.refuse(claim.rule) is not None:
        return f", and none can be: {method} cannot express the requirement"
    return "; the file for it can be made, and whether it was checked is not recorded"
