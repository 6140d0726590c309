"""Greedy set cover: few and short runs that cover all goals.

Source: Chvatal, A greedy heuristic for the set-covering problem, Mathematics of Operations Research
4 (1979).
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping
from typing import Any, TypeVar

R = TypeVar("R", bound=Hashable)
N = TypeVar("N", bound=Hashable)


def cover(shown: Mapping[R, Collection[N]], rank: Mapping[R, Any]) -> dict[R, tuple[N, ...]]:
    """Selected runs that together cover all goals, each with the goals it was selected for.

    Args:
        shown: goals that each run covers, in a fixed order.
        rank: of runs that cover equally many goals, the one with the lowest rank is selected.
    """
    open_ = dict.fromkeys(need for needs in shown.values() for need in needs)
    chosen: dict[R, tuple[N, ...]] = {}
    while open_:
        best = min(shown, key=lambda run: (-sum(need in open_ for need in shown[run]), rank[run]))
        chosen[best] = tuple(need for need in open_ if need in shown[best])
        for need in chosen[best]:
            del open_[need]
    return chosen
