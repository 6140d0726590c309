"""Bounds of a probability from independent trials (Clopper, Pearson, Biometrika 26, 1934)."""

from __future__ import annotations

from math import comb, exp, log, log1p

_GRAIN = 10**9
"""The precision of bounds; they are rounded outwards, so that every machine gives the same."""


def lowest(good: int, count: int, confidence: float) -> float:
    """The largest p with a probability of at most 1 - confidence for `good` or more successes.

    Rounded down.
    """
    return _least(good, count, 1 - confidence) / _GRAIN


def highest(good: int, count: int, confidence: float) -> float:
    """The smallest p with a probability of at most 1 - confidence for `good` or fewer successes.

    Rounded up.
    """
    return (_GRAIN - _least(count - good, count, 1 - confidence)) / _GRAIN


def _least(good: int, count: int, chance: float) -> int:
    """The largest p, in grains, at which `good` or more successes have at most this probability."""
    if not good:
        return 0
    ways = log(comb(count, good))
    below, above = 0, _GRAIN
    while above - below > 1:
        middle = (below + above) // 2
        rare = _at_least(good, count, middle / _GRAIN, ways) <= chance
        below, above = (middle, above) if rare else (below, middle)
    return below


def _at_least(good: int, count: int, p: float, ways: float) -> float:
    """The probability of `good` or more successes, as a sum over the smaller side.

    Args:
        good: the number of successes, at least 1.
        count: the number of trials.
        p: the probability of success of each trial, between 0 and 1.
        ways: the logarithm of the number of ways to choose the successes.
    """
    odds = p / (1 - p)
    term = exp(ways + good * log(p) + (count - good) * log1p(-p))
    total = 0.0
    if good >= count * p:
        for k in range(good, count + 1):
            if total + term == total:
                break
            total += term
            term *= (count - k) / (k + 1) * odds
        return total
    for k in range(good, 0, -1):
        term *= k / (count - k + 1) / odds
        if total + term == total:
            break
        total += term
    return 1 - total
