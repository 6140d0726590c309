"""Proofs in tests."""

from compiler.logic.claims import Outcome, Proof


def outcome(proof: Proof) -> Outcome:
    """What the engine answered."""
    return Outcome(proof.result, proof.detail, proof.run)
