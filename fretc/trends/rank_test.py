"""An exact test whether numbers became larger: the rank-sum test of Wilcoxon, Mann and Whitney.

The numbers are in strata, such as scenarios, which are ranked each by itself. Where nothing has
changed, each way to choose which numbers of a stratum are the later ones is as likely as any other.
The test counts in how many of these the ranks of the later ones sum up to as much as they do, or
to more. That is exact for ties, and for few numbers.

Sources: F. Wilcoxon, Individual Comparisons by Ranking Methods, 1945; P. van Elteren, On the
combination of independent two sample tests of Wilcoxon, 1960 (here without his weights); S. Holm,
A Simple Sequentially Rejective Multiple Test Procedure, 1979; R. Tarone, A Modified Bonferroni
Method for Discrete Data, 1990.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

Stratum = tuple[Sequence[float], Sequence[float]]
"""The earlier and the later numbers; infinite ones may be among them."""
_Shares = NDArray[np.float64]
MOST, MOST_OF_STRATUM = 100, 50
"""Numbers of a side that are counted: of all strata together, and of one."""


@dataclass(frozen=True, slots=True)
class Tail:
    """How likely so large ranks are where nothing has changed."""

    p: float
    least: float
    """The least p that these numbers could have had, however they were arranged."""
    arrangements: int
    """How many there are."""


def larger(strata: Sequence[Stratum]) -> Tail:
    """Whether the later numbers are larger; strata with one side alone say nothing.

    Args:
        strata: no number is NaN.
    """
    both = [(before, after) for before, after in strata if before and after]
    whole, total, arrangements = np.ones(1), 0, 1
    for before, after in both:
        ranks = doubled_ranks([*before, *after])
        total += sum(ranks[len(before) :])
        whole = np.convolve(whole, _sums(ranks, len(after)))
        arrangements *= comb(len(ranks), len(after))
    top = int(np.flatnonzero(whole)[-1]) if whole.any() else 0
    return Tail(min(1.0, float(whole[total:].sum())), float(whole[top]), arrangements)


def doubled_ranks(numbers: Sequence[float]) -> list[int]:
    """Twice the rank of each number from 1 on; equal numbers share the mean of their ranks."""
    order = sorted(range(len(numbers)), key=numbers.__getitem__)
    ranks, i = [0] * len(numbers), 0
    while i < len(order):
        j = i
        while j < len(order) and numbers[order[j]] == numbers[order[i]]:
            j += 1
        for place in order[i:j]:
            ranks[place] = i + j + 1  # twice the mean of i + 1 .. j
        i = j
    return ranks


def _sums(ranks: Sequence[int], chosen: int) -> _Shares:
    """Element s: the share of the ways to choose so many ranks in which they sum up to s."""
    size = sum(sorted(ranks)[-chosen:]) + 1
    ways = np.zeros((chosen + 1, size))
    ways[0, 0] = 1.0
    for rank in ranks:
        ways[1:, rank:] = ways[1:, rank:] + ways[:-1, : size - rank]
    shares: _Shares = ways[chosen] / ways[chosen].sum()
    return shares


def fewer(strata: Sequence[Stratum]) -> list[Stratum]:
    """As many numbers of each side as are counted, so that the work has a bound.

    Args:
        strata: each side from its newest number on; which ones are left out does not depend on
            their values.
    """
    both = [(before, after) for before, after in strata if before and after]
    most = min(MOST_OF_STRATUM, max(2, MOST // max(1, len(both))))
    return [(before[:most], after[:most]) for before, after in both]


def decidable(least: Sequence[float], level: float) -> list[int]:
    """The numbers of the tests that can find something at a level, all of them together.

    Of so many tests each has to reach the level divided by their number: what cannot be that small
    is not one of them.

    Args:
        least: the least p that each test can have.
        level: of all together.
    """
    count = 1
    while len(found := [i for i, each in enumerate(least) if each * count <= level]) > count:
        count += 1
    return found


def holm(values: Sequence[float]) -> list[float]:
    """Each p adjusted for all of them: at most the level where it counts as a finding.

    The chance of even one false finding is then at most the level.
    """
    adjusted, highest = [0.0] * len(values), 0.0
    order = sorted(range(len(values)), key=values.__getitem__)
    for place, i in enumerate(order):
        highest = max(highest, min(1.0, (len(values) - place) * values[i]))
        adjusted[i] = highest
    return adjusted
