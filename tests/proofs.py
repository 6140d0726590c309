"""Proofs in tests."""

from collections.abc import Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimOutcome, Proof
from fretc.verification.monitor.verifying import MOST_STATES, verified_beside, written


def outcome(proof: Proof) -> ClaimOutcome:
    """What the engine answered."""
    return ClaimOutcome(proof.result, proof.detail, proof.run)


def verified(
    requirement: FormalizedRequirement,
    text: str,
    limit: int = MOST_STATES,
    others: Sequence[FormalizedRequirement] = (),
) -> ClaimOutcome:
    """The comparison of a monitor's text with its requirement, among the others of the text."""
    return verified_beside(requirement, text, written(text, (requirement, *others)), limit)
