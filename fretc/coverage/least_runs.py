"""The fewest runs that show all that the runs together show.

That is set cover, solved exactly where the search ends within so many nodes, and else greedily,
which is said. Source of the greedy bound: Chvatal, A greedy heuristic for the set-covering problem,
Mathematics of Operations Research 4 (1979).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_NODES = 20_000
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
    """The runs without those of which another one reaches all aims; the first of equal ones."""
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
    """The fewest; None where the search does not end.

    Branch and bound: one run of the aim that has fewest is to be taken, and a run whose turn is
    over is taken by no later branch.
    """
    if len(aims) * len(candidates) > _CELLS:
        return None
    best = [candidates.index(run) for run in _greedy(aims, candidates)]
    reach = np.array([[run in aim for run in candidates] for aim in aims])
    branches = [_Branch((), np.arange(len(aims)), np.arange(len(candidates)))]
    for _ in range(_NODES):
        if not branches:
            return [candidates[place] for place in best]
        branch = branches.pop()
        if not len(branch.aims):
            best = [*branch.chosen] if len(branch.chosen) < len(best) else best
        elif len(branch.chosen) + _at_least(reach[np.ix_(branch.aims, branch.free)]) < len(best):
            branches += _branches(reach, branch)
    return None


@dataclass(frozen=True, slots=True)
class _Branch:
    chosen: tuple[int, ...]
    """Columns: the runs that are taken."""
    aims: NDArray[np.intp]
    """Rows: the aims that none of them reaches."""
    free: NDArray[np.intp]
    """Columns: the runs that may still be taken."""


def _at_least(reach: NDArray[np.bool_]) -> float:
    """No fewer runs reach all aims.

    Each aim counts as the part of the largest run that reaches it; the aims of no run count more
    than 1 so. Infinite where an aim has no run.
    """
    largest = (reach * reach.sum(axis=0)).max(axis=1, initial=0)
    with np.errstate(divide="ignore"):
        return float(np.ceil((1 / largest).sum() - 1e-9))


def _branches(reach: NDArray[np.bool_], branch: _Branch) -> list[_Branch]:
    """One for each run of the aim that has fewest; the last one, of the largest run, is next."""
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
    """The run that reaches most of what is left, the first of equals; and so on."""
    left, chosen = [*aims], []
    while left:
        best = max(candidates, key=lambda run: (sum(run in aim for aim in left), -run))
        chosen.append(best)
        left = [aim for aim in left if best not in aim]
    return chosen
