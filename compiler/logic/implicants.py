"""Truth tables as a few conjunctions of a few literals.

Source: Brayton et al., Logic Minimization Algorithms for VLSI Synthesis, 1984, section 4.2
(expansion of implicants against the off-set).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

Vector = tuple[bool, ...]
"""The truth values of some variables, in a given order."""
Term = Mapping[int, bool]
"""A conjunction: the value of each variable that it names; empty, it is true."""


def cover(certain: Sequence[Vector], others: Iterable[Vector]) -> list[Term]:
    """Few conjunctions of few literals that hold at all of the first and at none of the others.

    Vectors that are neither may be covered or not.
    """
    off = set(others)
    terms: list[Term] = []
    for vector in certain:
        if any(matches(term, vector) for term in terms):
            continue
        term = dict(enumerate(vector))
        for place in reversed(range(len(vector))):
            shorter = {i: value for i, value in term.items() if i != place}
            if not any(matches(shorter, other) for other in off):
                term = shorter
        terms.append(term)
    return terms


def matches(term: Term, vector: Vector) -> bool:
    """Whether the conjunction holds there."""
    return all(vector[i] is value for i, value in term.items())
