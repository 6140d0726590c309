"""Proofs about generated monitors, interceptors and agents: the layers of `fretc verify`.

Input is a `Project` and a `Request`. Output is a `Proof` for each claim.
"""
