"""The test is exact: it is compared with its definition, against scipy, and against chance."""

from __future__ import annotations

import random
from collections import Counter
from fractions import Fraction
from itertools import combinations, product
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.trends.rank_test import MOST, Stratum, decidable, doubled_ranks, fewer, holm, larger
from tests.effort import examples
from tests.programs import needs_package

NUMBERS = st.sampled_from([0.0, 1.0, 1.5, 2.0, 7.0, inf])
SIDES = st.lists(NUMBERS, max_size=4)
STRATA = st.lists(st.tuples(SIDES, SIDES), max_size=3)


def rank(number: float, among: list[float]) -> Fraction:
    """One more than how many are less, and half of how many others are equal."""
    less = sum(other < number for other in among)
    return less + Fraction(among.count(number) + 1, 2)


def sums(strata: list[Stratum]) -> Counter[Fraction]:
    """How many arrangements have each rank sum."""
    found = Counter({Fraction(): 1})
    for before, after in strata:
        together = [*before, *after]
        ranks = [rank(number, together) for number in together]
        own = Counter(sum(some, Fraction()) for some in combinations(ranks, len(after)))
        summed = Counter[Fraction]()
        for (one, count), (other, more) in product(found.items(), own.items()):
            summed[one + other] += count * more
        found = summed
    return found


def observed(strata: list[Stratum]) -> Fraction:
    return sum(
        (rank(number, [*before, *after]) for before, after in strata for number in after),
        Fraction(),
    )


def both(strata: list[tuple[list[float], list[float]]]) -> list[Stratum]:
    return [(before, after) for before, after in strata if before and after]


@pytest.mark.slow
@examples(60)
@given(STRATA)
def test_p_is_the_share_of_arrangements_that_are_as_large(
    strata: list[tuple[list[float], list[float]]],
) -> None:
    tail, known = larger(strata), both(strata)
    every = sums(known)
    assert tail.arrangements == every.total()
    as_large = sum(count for one, count in every.items() if one >= observed(known))
    assert tail.p == pytest.approx(as_large / every.total(), abs=1e-12)
    least = Fraction(every[max(every)], every.total())
    assert tail.least == pytest.approx(float(least), abs=1e-12)


@examples(40)
@given(st.lists(NUMBERS, min_size=3, max_size=7), st.integers(1, 3))
def test_it_alarms_no_more_often_than_it_says(pooled: list[float], after: int) -> None:
    """Of all arrangements of the same numbers, at most a share of p has a p of at most p."""
    places = list(combinations(range(len(pooled)), min(after, len(pooled) - 1)))
    found = []
    for chosen in places:
        rest = [number for i, number in enumerate(pooled) if i not in chosen]
        found.append(larger([(rest, [pooled[i] for i in chosen])]).p)
    for level in found:
        assert sum(p <= level + 1e-12 for p in found) / len(found) <= level + 1e-9


@pytest.mark.slow
@needs_package("scipy")
@examples(40)
@given(st.lists(st.integers(0, 10**6), min_size=2, max_size=40, unique=True), st.data())
def test_without_ties_it_is_scipy_s(numbers: list[int], data: st.DataObject) -> None:
    from scipy import stats

    cut = data.draw(st.integers(1, len(numbers) - 1))
    before, after = numbers[:cut], numbers[cut:]
    there = stats.mannwhitneyu(after, before, alternative="greater", method="exact").pvalue
    assert larger([(before, after)]).p == pytest.approx(there, abs=1e-9)


def test_ranks_of_equal_numbers_are_shared() -> None:
    assert doubled_ranks([3.0, 1.0, 3.0, inf]) == [5, 2, 5, 8]


def test_more_numbers_than_are_counted_cost_no_more() -> None:
    long = [float(i) for i in range(1000)]
    assert [(len(a), len(b)) for a, b in fewer([(long, long)])] == [(50, 50)]
    many = fewer([(long, long)] * 10)
    assert sum(len(after) for _, after in many) <= MOST
    assert larger(fewer([(long, long)] * 10)).p > 0.4
    assert fewer([([], long)]) == []


@given(st.lists(st.floats(0, 1), max_size=8))
def test_holm_is_its_definition(values: list[float]) -> None:
    """Rejected at a level is what the procedure of stepping down rejects at it."""
    adjusted = holm(values)
    for level in {*adjusted, 0.05}:
        rejected: set[int] = set()
        for step, i in enumerate(sorted(range(len(values)), key=lambda i: values[i])):
            if min(1.0, (len(values) - step) * values[i]) > level:
                break
            rejected.add(i)
        assert {i for i, p in enumerate(adjusted) if p <= level} == rejected


@given(st.lists(st.floats(0, 1), max_size=8))
def test_each_test_that_is_made_can_find_something_beside_the_others(least: list[float]) -> None:
    made = decidable(least, 0.05)
    assert all(least[i] * len(made) <= 0.05 for i in made)
    counts = range(1, len(least) + 2)
    beside = next(k for k in counts if sum(each * k <= 0.05 for each in least) <= k)
    assert made == [i for i, each in enumerate(least) if each * beside <= 0.05]


@pytest.mark.slow
def test_all_together_alarm_no_more_often_than_the_level() -> None:
    """400 times ten comparisons of which none has changed; with ties, in strata of any size."""
    chance = random.Random(19)
    alarms = 0
    for _ in range(400):
        found = []
        for _ in range(10):
            strata = [
                (
                    [float(chance.randint(0, 9)) for _ in range(chance.randint(1, 6))],
                    [float(chance.randint(0, 9)) for _ in range(chance.randint(1, 5))],
                )
                for _ in range(2)
            ]
            found.append(larger(strata))
        family = decidable([tail.least for tail in found], 0.05)
        alarms += min(holm([found[i].p for i in family]), default=1.0) <= 0.05
    assert alarms <= 0.05 * 400 + 3 * (400 * 0.05 * 0.95) ** 0.5
    assert alarms > 0, "a test that never alarms is none"
