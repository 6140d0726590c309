"""Covers of truth tables by few, short conjunctions.

Source: Brayton et al., Logic Minimization Algorithms for VLSI Synthesis, 1984, section 4.2
(expansion of implicants against the off-set).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

Vector = tuple[bool, ...]
"""The truth values of some variables, in a given order."""
Term = Mapping[int, bool]
"""A conjunction: the value of each variable in it; the empty one is true."""


def cover(certain: Sequence[Vector], excluded: Iterable[Vector]) -> list[Term]:
    """A few short conjunctions that hold at all `certain` vectors and at no `excluded` one.

    Any other vector may satisfy them or not.
    """
    off = set(excluded)
    terms: list[Term] = []
    for vector in certain:
        if any(matches(term, vector) for term in terms):
            continue
        term = dict(enumerate(vector))
        for index in reversed(range(len(vector))):
            shorter = {i: value for i, value in term.items() if i != index}
            if not any(matches(shorter, row) for row in off):
                term = shorter
        terms.append(term)
    return terms


def matches(term: Term, vector: Vector) -> bool:
    """Whether the conjunction holds at the vector."""
    return all(vector[i] is value for i, value in term.items())
