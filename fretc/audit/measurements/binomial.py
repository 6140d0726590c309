"""Bounds of a probability from independent trials: Clopper, Pearson, Biometrika 26, 1934.

The only module that imports scipy.
"""

from __future__ import annotations

from math import ceil, floor

_GRAIN = 10**9
"""Bounds are rounded outwards to this part of 1: the same on every machine."""


def lowest(good: int, count: int, confidence: float) -> float:
    """The largest p with which so many good trials, or more, are no likelier than 1 - confidence.

    Rounded down.
    """
    from scipy.special import betaincinv

    if not good:
        return 0.0
    bound = float(betaincinv(good, count - good + 1, 1 - confidence))
    return max(0.0, floor(bound * _GRAIN) / _GRAIN)


def highest(good: int, count: int, confidence: float) -> float:
    """The smallest p with which so many good trials, or fewer, are no likelier than 1 - confidence.

    Rounded up.
    """
    from scipy.special import betaincinv

    if good == count:
        return 1.0
    bound = float(betaincinv(good + 1, count - good, confidence))
    return min(1.0, ceil(bound * _GRAIN) / _GRAIN)
