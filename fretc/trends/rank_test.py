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
from math import comb

import numpy as np
from numpy.typing import NDArray

from fretish.classes.frozen import dataclass

Stratum = tuple[Sequence[float], Sequence[float]]
"""The earlier and the later numbers, which may be infinite."""
_Shares = NDArray[np.float64]
MOST, MOST_OF_STRATUM = 100, 50
"""The most numbers of a side: of all strata together, and of one."""


@dataclass(frozen=True, slots=True)
class RankTest:
    """The probability of ranks at least so large if nothing has changed."""

    p: float
    least: float
    """The least p that these numbers could have in any arrangement."""
    arrangements: int
    """The number of arrangements."""


def larger(strata: Sequence[Stratum]) -> RankTest:
    """Test whether the later numbers are larger; strata with one side only are skipped.

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
    return RankTest(min(1.0, float(whole[total:].sum())), float(whole[top]), arrangements)


def doubled_ranks(numbers: Sequence[float]) -> list[int]:
    """Twice the rank of each number from 1 on; equal numbers share the mean of their ranks."""
    order = sorted(range(len(numbers)), key=numbers.__getitem__)
    ranks, i = [0] * len(numbers), 0
    while i < len(order):
        j = i
        while j < len(order) and numbers[order[j]] == numbers[order[i]]:
            j += 1
        for index in order[i:j]:
            ranks[index] = i + j + 1  # twice the mean of i + 1 .. j
        i = j
    return ranks


def _sums(ranks: Sequence[int], chosen: int) -> _Shares:
    """Element s: the share of the selections of so many ranks whose sum is s."""
    size = sum(sorted(ranks)[-chosen:]) + 1
    ways = np.zeros((chosen + 1, size))
    ways[0, 0] = 1.0
    for rank in ranks:
        ways[1:, rank:] = ways[1:, rank:] + ways[:-1, : size - rank]
    shares: _Shares = ways[chosen] / ways[chosen].sum()
    return shares


def fewer(strata: Sequence[Stratum]) -> list[Stratum]:
    """At most so many numbers of each side, to limit the cost.

    Args:
        strata: each side from its newest number on; the omitted ones do not depend on their values.
    """
    both = [(before, after) for before, after in strata if before and after]
    most = min(MOST_OF_STRATUM, max(2, MOST // max(1, len(both))))
    return [(before[:most], after[:most]) for before, after in both]


def decidable(least: Sequence[float], level: float) -> list[int]:
    """The indices of the tests that can be significant at a level, all of them together.

    With so many tests, each has to reach the level divided by their number: a test that cannot
    reach it is not counted.

    Args:
        least: the least p that each test can have.
        level: the level of all tests together.
    """
    count = 1
    while len(indices := [i for i, each in enumerate(least) if each * count <= level]) > count:
        count += 1
    return indices


def holm(values: Sequence[float]) -> list[float]:
    """Each p-value adjusted for all of them: a finding has at most the level.

    The probability of even one false finding is then at most the level.
    """
    adjusted, highest = [0.0] * len(values), 0.0
    order = sorted(range(len(values)), key=values.__getitem__)
    for index, i in enumerate(order):
        highest = max(highest, min(1.0, (len(values) - index) * values[i]))
        adjusted[i] = highest
    return adjusted
