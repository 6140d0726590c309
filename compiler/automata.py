"""Spot: the only module that imports it, and only when it is called.

Bounds are small here: Spot expands them into chains of X, so nothing on the way from a sentence
to its files may depend on this room.
"""

from __future__ import annotations

from typing import Any

from compiler import printing
from compiler.formula import Formula


def equivalent(left: Formula, right: Formula) -> bool:
    """Whether two future-time formulas hold on the same infinite traces (and `LAST` is free)."""
    return same_language(printing.future(left), printing.future(right))


def same_language(left: str, right: str) -> bool:
    """Whether two LTL formulas in Spot's syntax are equivalent.

    Raises:
        SyntaxError: one of them is not LTL.

    Source: Duret-Lutz et al., From Spot 2.0 to Spot 2.10, CAV 2022.
    """
    spot = _spot()
    return bool(spot.are_equivalent(spot.formula(left), spot.formula(right)))


def simplified(formula: Formula) -> str | None:
    """A shorter formula in Spot's syntax that holds on the same infinite traces, if Spot has one.

    Spot's rewriting by syntax, by semantics and by implication; its result is then proved
    equivalent through automata. Bounds must be small.

    Source: Duret-Lutz et al., CAV 2022, and Spot's documentation of tl_simplifier.
    """
    spot = _spot()
    exact = spot.formula(printing.future(formula))
    shorter = spot.tl_simplifier(spot.tl_simplifier_options(3)).simplify(exact)
    text = f"{shorter}"
    if len(text) >= len(f"{exact}"):
        return None
    assert spot.are_equivalent(exact, shorter), "Spot's own simplification is not equivalent"
    return text


def _spot() -> Any:
    import spot

    return spot
