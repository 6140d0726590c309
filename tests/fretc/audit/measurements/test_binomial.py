"""Clopper and Pearson's bounds against binomial sums in fractions."""

from fractions import Fraction
from itertools import pairwise
from math import comb

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.measurements.binomial import highest, lowest
from tests.programs import needs_package


def at_least(k: int, n: int, p: Fraction) -> Fraction:
    """The probability of k or more of n."""
    return sum((comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k, n + 1)), Fraction(0))


def exact(bound: float) -> Fraction:
    """A bound is a multiple of this."""
    return Fraction(round(bound * 10**9), 10**9)


def bisected(k: int, n: int, alpha: Fraction) -> Fraction:
    """The p with `at_least(k, n, p) == alpha`, to 2**-40."""
    low, high = Fraction(0), Fraction(1)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if at_least(k, n, middle) <= alpha else (low, middle)
    return low


@pytest.mark.slow
@pytest.mark.parametrize("confidence", [Fraction(9, 10), Fraction(95, 100), Fraction(99, 100)])
def test_the_bounds_are_those_of_exact_binomial_sums(confidence: Fraction) -> None:
    for n in (1, 2, 5, 12):
        for k in range(n + 1):
            low = bisected(k, n, 1 - confidence) if k else Fraction(0)
            high = 1 - bisected(n - k, n, 1 - confidence) if k < n else Fraction(1)
            assert lowest(k, n, float(confidence)) == pytest.approx(float(low), abs=2e-9)
            assert highest(k, n, float(confidence)) == pytest.approx(float(high), abs=2e-9)


@pytest.mark.parametrize(("k", "n"), [(59, 59), (299, 299), (298, 300), (7, 40)])
def test_rounding_never_makes_a_bound_tighter(k: int, n: int) -> None:
    assert at_least(k, n, exact(lowest(k, n, 0.95))) <= Fraction(5, 100)
    if k < n:
        assert 1 - at_least(k + 1, n, exact(highest(k, n, 0.95))) <= Fraction(5, 100)


def test_a_bound_is_wrong_no_more_often_than_stated() -> None:
    """Every outcome of n trials, weighed by its probability, for each p of a grid."""
    for n in (1, 3, 10, 20):
        lows = [exact(lowest(k, n, 0.95)) for k in range(n + 1)]
        highs = [exact(highest(k, n, 0.95)) for k in range(n + 1)]
        for p in (Fraction(i, 50) for i in range(51)):
            weights = [comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1)]
            over = sum((w for w, low in zip(weights, lows, strict=True) if low > p), Fraction(0))
            under = sum(
                (w for w, high in zip(weights, highs, strict=True) if high < p), Fraction(0)
            )
            assert over <= Fraction(5, 100)
            assert under <= Fraction(5, 100)


@pytest.mark.slow
@needs_package("scipy")
@given(st.integers(1, 5000), st.data(), st.sampled_from([0.5, 0.9, 0.95, 0.975, 0.99, 0.999]))
def test_the_bounds_are_those_of_the_beta_distribution(
    count: int, data: st.DataObject, confidence: float
) -> None:
    from scipy.special import betaincinv

    good = data.draw(st.integers(0, count))
    low = betaincinv(good, count - good + 1, 1 - confidence) if good else 0.0
    high = betaincinv(good + 1, count - good, confidence) if good < count else 1.0
    assert lowest(good, count, confidence) == pytest.approx(low, abs=2e-9)
    assert highest(good, count, confidence) == pytest.approx(high, abs=2e-9)


def test_more_good_trials_never_lower_a_bound() -> None:
    assert all(a < b for a, b in pairwise([lowest(k, 20, 0.95) for k in range(21)]))
