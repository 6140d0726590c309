"""Proofs about what the compiler makes: the layers of `fretc verify`."""
