"""The smallest set of runs that shows every situation that all runs show.

This is the set cover problem. It is solved exactly if the search ends within `_NODES` nodes, and
otherwise greedily, as the result states. Source of the greedy bound: Chvatal, A greedy heuristic
for the set-covering problem, Mathematics of Operations Research 4 (1979).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from fretish.classes.frozen import dataclass

_NODES = 20_000
"""Maximum nodes of the search tree; not a time, so that the result is reproducible."""
_CELLS = 20_000
"""Maximum number of runs times goals for an exact solution."""


@dataclass(frozen=True, slots=True)
class LeastRuns:
    """Sorted indices of runs, and whether the set is proved to be minimal."""

    runs: tuple[int, ...]
    is_exact: bool


def least_runs(aims: Iterable[frozenset[int]]) -> LeastRuns:
    """The smallest set with at least one run of each goal.

    Args:
        aims: for each goal the runs that reach it, at least one.
    """
    needed = _minimal(aims)
    # Reductions leave a small problem for the exact search.
    forced = {run for aim in needed if len(aim) == 1 for run in aim}
    open_aims = [aim for aim in needed if forced.isdisjoint(aim)]
    if not open_aims:
        return LeastRuns(tuple(sorted(forced)), is_exact=True)
    candidates = _candidates(open_aims)
    exact = _exact(open_aims, candidates)
    chosen = _greedy(open_aims, candidates) if exact is None else exact
    return LeastRuns(tuple(sorted({*forced, *chosen})), exact is not None)


def _minimal(aims: Iterable[frozenset[int]]) -> list[frozenset[int]]:
    """The goals that no other goal implies: those without a proper subset among the goals."""
    kept: list[frozenset[int]] = []
    for aim in sorted(set(aims), key=lambda each: (len(each), sorted(each))):
        if not any(other <= aim for other in kept):
            kept.append(aim)
    return kept


def _candidates(aims: Sequence[frozenset[int]]) -> list[int]:
    """The runs that no other run dominates; the first of equal runs."""
    reached: dict[int, int] = {}
    for number, aim in enumerate(aims):
        for run in aim:
            reached[run] = reached.get(run, 0) | 1 << number
    kept: list[int] = []
    for run in sorted(reached, key=lambda each: (-reached[each].bit_count(), each)):
        if not any(reached[run] & ~reached[other] == 0 for other in kept):
            kept.append(run)
    return sorted(kept)


def _exact(aims: Sequence[frozenset[int]], candidates: Sequence[int]) -> list[int] | None:
    """A minimal set, or None if the search exceeds its nodes.

    Branch and bound: branch on the runs of the goal with the fewest runs; later branches exclude
    the runs of earlier ones.
    """
    if len(aims) * len(candidates) > _CELLS:
        return None
    best = [candidates.index(run) for run in _greedy(aims, candidates)]
    reach = np.array([[run in aim for run in candidates] for aim in aims])
    branches = [_Branch((), np.arange(len(aims)), np.arange(len(candidates)))]
    for _ in range(_NODES):
        if not branches:
            return [candidates[index] for index in best]
        branch = branches.pop()
        if not len(branch.aims):
            best = [*branch.chosen] if len(branch.chosen) < len(best) else best
        elif len(branch.chosen) + _at_least(reach[np.ix_(branch.aims, branch.free)]) < len(best):
            branches += _branches(reach, branch)
    return None


@dataclass(frozen=True, slots=True)
class _Branch:
    chosen: tuple[int, ...]
    """Column indices of the chosen runs."""
    aims: NDArray[np.intp]
    """Row indices of the goals that no chosen run reaches."""
    free: NDArray[np.intp]
    """Column indices of the runs that may still be chosen."""


def _at_least(reach: NDArray[np.bool_]) -> float:
    """A lower bound on the number of runs that reach all goals.

    Each goal has the weight 1/n, where n is the size of the largest run that reaches it, so that
    the goals of a run weigh at most 1. Infinite if a goal has no run.
    """
    largest = (reach * reach.sum(axis=0)).max(axis=1, initial=0)
    with np.errstate(divide="ignore"):
        return float(np.ceil((1 / largest).sum() - 1e-9))


def _branches(reach: NDArray[np.bool_], branch: _Branch) -> list[_Branch]:
    """A branch for each run of the goal with the fewest runs; the largest run comes last."""
    free, rest = branch.free, reach[np.ix_(branch.aims, branch.free)]
    aim = int(rest.sum(axis=1).argmin())
    takers = np.flatnonzero(rest[aim])
    takers = takers[np.argsort(-rest[:, takers].sum(axis=0), kind="stable")]
    return [
        _Branch(
            (*branch.chosen, int(free[taker])),
            branch.aims[~rest[:, taker]],
            np.delete(free, takers[: turn + 1]),
        )
        for turn, taker in enumerate(takers)
    ][::-1]


def _greedy(aims: Sequence[frozenset[int]], candidates: Sequence[int]) -> list[int]:
    """Greedy cover: repeatedly the run that reaches most open goals, the first of equal runs."""
    left, chosen = [*aims], []
    while left:
        best = max(candidates, key=lambda run: (sum(run in aim for aim in left), -run))
        chosen.append(best)
        left = [aim for aim in left if best not in aim]
    return chosen
