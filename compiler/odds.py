"""From the trials of many runs to what is known of a probability.

Two intervals are made of the same counts, one-sided at the stated confidence:

- Clopper-Pearson's, exact where trials are independent (Biometrika 26, 1934);
- one by resampling whole runs (Davison, Hinkley, Bootstrap Methods and their Application, 1997,
  section 3.8): triggers of one run are not independent, and how runs differ shows in it.

What is open counts both ways: as failed for the lower bound, as answered for the upper one. The
answer is read off the interval that holds both, so it is no stronger than either of them.

The only module that imports scipy.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib.util import find_spec
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from fretish.diagnostic import Code, Diagnostic
from fretish.expressions import ComparisonOperator
from monitors.trials import Trials

SUPPORTED, REFUTED, INCONCLUSIVE = "supported", "refuted", "inconclusive"
"""What runs say of a probability."""
CONFIDENCE = 0.95
FEW = 30
"""Runs with a trigger below which resampling them is not to be relied on."""
RESAMPLES = 4000
_SEED = 20_240_229
_AT_ONCE = 1 << 22
"""Numbers that are drawn at a time."""
_GRAIN = 10**9
"""Bounds are rounded outwards to this part of 1: the same on every machine."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """With the stated confidence it is not below `low`; with the same, not above `high`."""

    low: float
    high: float

    def around(self, other: Bounds) -> Bounds:
        """The least that holds both."""
        return Bounds(min(self.low, other.low), max(self.high, other.high))


NOTHING_KNOWN = Bounds(0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Estimate:
    """What trials say of the share that is answered."""

    trials: Trials
    """Of all runs together."""
    runs: int
    """Those with a trigger."""
    confidence: float
    exact: Bounds
    """Clopper-Pearson's."""
    resampled: Bounds
    """By whole runs; it says nothing where there are fewer than two."""

    @property
    def share(self) -> float | None:
        """Of those that are decided; None where there are none."""
        decided = self.trials.answered + self.trials.failed
        return self.trials.answered / decided if decided else None

    @property
    def bounds(self) -> Bounds:
        """Those that the answer is read off."""
        return self.exact.around(self.resampled)


def missing() -> Diagnostic | None:
    """F908, where what statistics need is not installed."""
    if find_spec("scipy") is not None:
        return None
    return Diagnostic(
        Code.MISSING_EXTRA,
        "a requirement with a probability needs `scipy`",
        help="install the extra: pip install 'fretc[stats]' "
        "(in a checkout: .venv/bin/pip install '.[stats]')",
    )


def estimated(runs: Iterable[Trials], confidence: float = CONFIDENCE) -> Estimate:
    """The share of triggers that are answered, with both intervals.

    Args:
        runs: the trials of each run; their order does not matter.
        confidence: of each bound, between 0.5 and 1.
    """
    counted = [run for run in runs if run.count]
    answered, failed, open_ = (
        sum(getattr(run, name) for run in counted) for name in ("answered", "failed", "open")
    )
    whole = Trials(answered, failed, open_)
    return Estimate(
        whole,
        len(counted),
        confidence,
        Bounds(
            lowest(answered, whole.count, confidence),
            highest(answered + open_, whole.count, confidence),
        ),
        resampled(counted, confidence),
    )


# Clopper-Pearson -------------------------------------------------------------------------------


def lowest(answered: int, count: int, confidence: float) -> float:
    """The largest p with which so many answers, or more, are no likelier than 1 - confidence.

    Rounded down.
    """
    from scipy.special import betaincinv

    if not answered:
        return 0.0
    found = float(betaincinv(answered, count - answered + 1, 1 - confidence))
    return max(0.0, floor(found * _GRAIN) / _GRAIN)


def highest(answered: int, count: int, confidence: float) -> float:
    """The smallest p with which so many answers, or fewer, are no likelier than 1 - confidence.

    Rounded up.
    """
    from scipy.special import betaincinv

    if answered == count:
        return 1.0
    found = float(betaincinv(answered + 1, count - answered, confidence))
    return min(1.0, ceil(found * _GRAIN) / _GRAIN)


# Whole runs ------------------------------------------------------------------------------------


def resampled(runs: Sequence[Trials], confidence: float) -> Bounds:
    """The percentile bounds of the share over runs drawn anew; the same runs give the same.

    Args:
        runs: with a trigger each.
        confidence: of each bound.
    """
    if len(runs) < 2:
        return NOTHING_KNOWN
    table = np.array(sorted((r.answered, r.answered + r.open, r.count) for r in runs), np.int64)
    sums = np.concatenate([table[places].sum(1) for places in _draws(len(runs))])
    low, high = (np.sort(sums[:, column] / sums[:, 2]) for column in (0, 1))
    tail = floor((1 - confidence) * (RESAMPLES + 1))
    if not tail:
        return NOTHING_KNOWN
    return Bounds(
        floor(float(low[tail - 1]) * _GRAIN) / _GRAIN,
        min(1.0, ceil(float(high[-tail]) * _GRAIN) / _GRAIN),
    )


def _draws(runs: int) -> Iterable[NDArray[np.int64]]:
    """Shape (some, runs), so often that there are `RESAMPLES` rows: places of runs.

    Of the bits of PCG64, whose stream NumPy promises not to change; of 64 bits the remainder is as
    good as uniform.
    """
    bits = np.random.PCG64(_SEED)
    rows = max(1, _AT_ONCE // runs)
    for first in range(0, RESAMPLES, rows):
        size = min(rows, RESAMPLES - first)
        drawn = bits.random_raw(size * runs) % np.uint64(runs)
        yield drawn.astype(np.int64).reshape(size, runs)


# Answers ---------------------------------------------------------------------------------------


def answer(estimate: Estimate, op: ComparisonOperator, bound: Fraction) -> str:
    """What the estimate says of `op bound`: supported, refuted or inconclusive.

    That it is some number can only be refuted, that it is not can only be supported; both need
    two bounds at once, so each has half of the doubt: `estimate` is then to be one of
    `both_sides`. A single failure shows that it is not 1, and a single answer that it is not 0.
    """
    if not estimate.trials.count:
        return INCONCLUSIVE
    low, high = estimate.bounds.low, estimate.bounds.high
    above = low > bound or (bound == 0 and estimate.trials.answered > 0)
    below = high < bound or (bound == 1 and estimate.trials.failed > 0)
    supported, refuted = {
        ">=": (low >= bound, below),
        ">": (above, high <= bound),
        "<=": (high <= bound, above),
        "<": (below, low >= bound),
        "=": (False, above or below),
        "!=": (above or below, False),
    }[op]
    return SUPPORTED if supported else REFUTED if refuted else INCONCLUSIVE


def both_sides(op: ComparisonOperator, confidence: float) -> float:
    """The confidence that each bound needs, so that an answer about `op` has the stated one."""
    return (1 + confidence) / 2 if op in ("=", "!=") else confidence


def needed(estimate: Estimate, op: ComparisonOperator, bound: Fraction) -> int | None:
    """How many further triggers, all as they should be, the exact interval needs for `op bound`.

    All are answered for `>=` and `>`, none for `<=` and `<`. Without failures these are
    ln(1 - confidence) / ln(bound) in all. None: no number is enough, or none is needed.
    """
    down = op in ("<", "<=")
    goal = float(1 - bound if down else bound)
    if op in ("=", "!=") or goal >= 1 or answer(estimate, op, bound) == SUPPORTED:
        return None
    whole = estimate.trials
    good, count = whole.failed if down else whole.answered, whole.count

    def enough(more: int) -> bool:
        return more + good > 0 and lowest(good + more, count + more, estimate.confidence) >= goal

    upper = 1
    while not enough(upper):
        upper *= 2
        if upper > _MOST:
            return None
    lower = upper // 2
    while upper - lower > 1:
        middle = (lower + upper) // 2
        lower, upper = (lower, middle) if enough(middle) else (middle, upper)
    return upper if upper > 1 or not enough(0) else None


_MOST = 1 << 40
