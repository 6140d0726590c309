"""The fewest runs that show all that the runs together show.

That is set cover: an integer program, solved exactly by HiGHS (scipy) where it ends within so many
nodes, and else greedily, which is said. Source of the greedy bound: Chvatal, A greedy heuristic
for the set-covering problem, Mathematics of Operations Research 4 (1979).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

_NODES = 100
"""Of the search tree; a number of nodes, and no time: the same runs give the same answer."""
_CELLS = 20_000
"""Runs times aims, above which no exact answer is tried."""


@dataclass(frozen=True, slots=True)
class LeastRuns:
    """Places of runs, in their order, and whether it is proved that no fewer would do."""

    runs: tuple[int, ...]
    is_exact: bool


def least_runs(aims: Iterable[frozenset[int]]) -> LeastRuns:
    """The fewest runs of which each aim has one.

    Args:
        aims: the runs that reach it, at least one each.
    """
    needed = _minimal(aims)
    # A run that all others of an aim need anyway is no question: what is left is small.
    forced = {run for aim in needed if len(aim) == 1 for run in aim}
    open_aims = [aim for aim in needed if forced.isdisjoint(aim)]
    if not open_aims:
        return LeastRuns(tuple(sorted(forced)), is_exact=True)
    candidates = _candidates(open_aims)
    exact = _exact(open_aims, candidates)
    chosen = _greedy(open_aims, candidates) if exact is None else exact
    return LeastRuns(tuple(sorted({*forced, *chosen})), exact is not None)


def _minimal(aims: Iterable[frozenset[int]]) -> list[frozenset[int]]:
    """The aims that no other one implies: those without a smaller one within them."""
    kept: list[frozenset[int]] = []
    for aim in sorted(set(aims), key=lambda each: (len(each), sorted(each))):
        if not any(other <= aim for other in kept):
            kept.append(aim)
    return kept


def _candidates(aims: Sequence[frozenset[int]]) -> list[int]:
    """One run, the first, of those that reach the same aims."""
    reached: dict[int, list[int]] = {}
    for number, aim in enumerate(aims):
        for run in aim:
            reached.setdefault(run, []).append(number)
    first: dict[tuple[int, ...], int] = {}
    for run in sorted(reached):
        first.setdefault(tuple(reached[run]), run)
    return sorted(first.values())


def _exact(aims: Sequence[frozenset[int]], candidates: Sequence[int]) -> list[int] | None:
    """The fewest; None where the search does not end."""
    if len(aims) * len(candidates) > _CELLS:
        return None
    import numpy as np
    from scipy.optimize import Bounds, LinearConstraint, milp

    matrix = np.array([[run in aim for run in candidates] for aim in aims], np.float64)
    count = len(candidates)
    found = milp(
        np.ones(count),
        integrality=np.ones(count),
        bounds=Bounds(0, 1),
        constraints=LinearConstraint(matrix, lb=1),
        options={"node_limit": _NODES, "mip_rel_gap": 0},
    )
    if found.status != 0:
        return None
    chosen = [run for run, taken in zip(candidates, found.x, strict=True) if taken > 0.5]
    assert all(aim.intersection(chosen) for aim in aims), "the solver keeps its constraints"
    return chosen


def _greedy(aims: Sequence[frozenset[int]], candidates: Sequence[int]) -> list[int]:
    """The run that reaches most of what is left, the first of equals; and so on."""
    left, chosen = [*aims], []
    while left:
        best = max(candidates, key=lambda run: (sum(run in aim for aim in left), -run))
        chosen.append(best)
        left = [aim for aim in left if best not in aim]
    return chosen
