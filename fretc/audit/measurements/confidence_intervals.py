"""Confidence bounds of a probability from the trials of many runs.

The unit of chance is the run: triggers of one run may depend on each other in any way. What is
bounded is the share of answered triggers that is to be expected of runs with these numbers of
triggers, sum(E[answered]) / sum(triggers). Of the runs it is only asked that they are independent.

Each bound is a test of every smaller share m by a bet that is fair if m is true (Waudby-Smith,
Ramdas, Estimating means of bounded random variables by betting, Journal of the Royal Statistical
Society B 86, 2024, section 4; with bets that are fixed beforehand). With at most B triggers in a
run, a stake of 1 and a part u of what is at hand as the bet, the runs leave

    K_u(m) = product over runs of (1 + u * (answered / m - triggers) / B),

no factor of which is negative. If the share is at most m, the factors' expectations have a mean of
at most 1, so their product is at most 1 (the geometric mean is not above the arithmetic one), and
by Markov's inequality a mean of K_u(m) over several u reaches 1 / (1 - confidence) with a
probability of at most 1 - confidence. That holds for any number of runs and any dependence within
them, and K falls with m: the lower bound is the largest m at which it reaches that.

What is open counts both ways: as failed for the lower bound, as answered for the upper one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import ceil, log
from typing import TYPE_CHECKING, TypeAlias

from compiler.files.records import Record, Share
from fretc.audit.measurements.trials import Trials
from fretish.classes.frozen import dataclass
from fretish.expressions import ComparisonOperator

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

SUPPORTED, REFUTED, INCONCLUSIVE = "supported", "refuted", "inconclusive"
ANSWERS = (SUPPORTED, REFUTED, INCONCLUSIVE)
"""The answers of runs about a probability."""
CONFIDENCE = 0.95
_GRAIN = 10**9
"""The precision of bounds; they are rounded outwards, so that every machine gives the same."""
_BETS = (1, 7 / 8, 3 / 4, *(2.0**-k for k in range(1, 17)))
"""Fractions of the capital that a bet stakes. The whole is best if no trigger failed, as with
Clopper-Pearson's bound for so many runs; small fractions are best for many runs that differ
little."""
_STAKES = (1 / 2, 1 / 8, 1 / 8, *(2.0 ** -min(k + 2, 17) for k in range(1, 17)))
"""The initial capital of each bet; their sum is 1."""
_SLACK = 1e-9
"""The tolerance of a logarithm, larger than its rounding error."""


class Bounds(Record, frozen=True):
    """One-sided bounds of a probability: each of the two holds with the stated confidence."""

    low: Share
    high: Share


NOTHING_KNOWN = Bounds(0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Estimate:
    """The estimated share of answered triggers."""

    trials: Trials
    """The trials of all runs together."""
    runs: int
    """The number of runs with a trigger."""
    confidence: float
    bounds: Bounds
    """Bounds over whole runs; from fewer than two runs they are 0 and 1."""
    counted: tuple[Trials, ...] = ()
    """The trials of each run with a trigger."""

    @property
    def share(self) -> float | None:
        """The share of answered triggers among the decided ones; None: none is decided."""
        decided = self.trials.answered + self.trials.failed
        return self.trials.answered / decided if decided else None


def estimated(runs: Iterable[Trials], confidence: float = CONFIDENCE) -> Estimate:
    """The share of triggers that are answered, with its bounds.

    Args:
        runs: the trials of each run; their order does not matter.
        confidence: of each bound, between 0.5 and 1.
    """
    informative = tuple(run for run in runs if run.count)
    answered, failed, open_ = (
        sum(getattr(run, name) for run in informative) for name in ("answered", "failed", "open")
    )
    return Estimate(
        Trials(answered, failed, open_),
        len(informative),
        confidence,
        bounds(informative, confidence),
        informative,
    )


# Whole runs ------------------------------------------------------------------------------------


def bounds(runs: Sequence[Trials], confidence: float) -> Bounds:
    """The bounds of the share of answered triggers, each with the confidence.

    One run does not show how runs differ, and bounds nothing.

    Args:
        runs: with a trigger each.
        confidence: of each bound, between 0.5 and 1.
    """
    if len(runs) < 2:
        return NOTHING_KNOWN
    low = _least([(run.answered, run.count) for run in runs], confidence)
    other = _least([(run.failed, run.count) for run in runs], confidence)
    return Bounds(low, round(1 - other, 9))


Tally = Sequence[tuple[int, int]]
"""For each run, the number of its decided triggers and of all its triggers."""
Table: TypeAlias = "NDArray[np.float64]"
"""Shape (3, n): both numbers, as fractions of the most triggers of a run, and the number of equal
runs."""


def _table(runs: Tally) -> Table:
    import numpy as np  # Reports and evidence without a probability do not need it.

    if not runs:
        return np.empty((3, 0))
    rows, times = np.unique(np.array(runs, np.int64), axis=0, return_counts=True)
    return np.array([*(rows.T / rows[:, 1].max()), times])


def _least(runs: Tally, confidence: float) -> float:
    """The largest share that the bets refute, rounded down."""
    table, below, above = _table(runs), 0, _GRAIN
    while above - below > 1:
        middle = (below + above) // 2
        enough = _reaches(_worths(table, middle / _GRAIN), confidence)
        below, above = (middle, above) if enough else (below, middle)
    return below / _GRAIN


def _worths(table: Table, share: float) -> NDArray[np.float64]:
    """The logarithm of the capital of each bet against the share."""
    import numpy as np

    good, count, times = table
    with np.errstate(divide="ignore"):  # a bet of the whole capital may lose all of it
        return np.asarray(np.log1p(np.outer(_BETS, good / share - count)) @ times)


def _reaches(worths: NDArray[np.float64], confidence: float) -> bool:
    """Whether the mean capital of all bets reaches the level of rejection."""
    import numpy as np

    each = worths + np.log(_STAKES)
    most = float(each.max())
    return most + log(float(np.exp(each - most).sum())) >= _SLACK - log(1 - confidence)


# Answers ---------------------------------------------------------------------------------------


def answer(estimate: Estimate, op: ComparisonOperator, bound: Fraction) -> str:
    """The answer of the estimate about `op bound`: supported, refuted or inconclusive.

    Equality can only be refuted and inequality only be supported; both need two bounds at once, so
    each bound has half of the error: `estimate` is then to be one of `both_sides`. A single failure
    shows that the probability is not 1, and a single answer that it is not 0.
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
    """The confidence that each bound needs for an answer about `op` with the stated confidence."""
    return (1 + confidence) / 2 if op in ("=", "!=") else confidence


def needed(estimate: Estimate, op: ComparisonOperator, bound: Fraction) -> int | None:
    """The number of further runs without a failure that would support `op bound`.

    All triggers of each are answered for `>=` and `>`, none for `<=` and `<`, and each has as many
    as the run with the most. None: no number is enough, or none is needed.
    """
    down = op in ("<", "<=")
    goal = ceil((1 - bound if down else bound) * _GRAIN) / _GRAIN
    if op in ("=", "!=") or goal >= 1 or answer(estimate, op, bound) == SUPPORTED:
        return None
    if not goal:
        return 1
    import numpy as np

    runs = [(r.failed if down else r.answered, r.count) for r in estimate.counted]
    before, gain = _worths(_table(runs), goal), np.log1p(np.array(_BETS) * (1 / goal - 1))

    def enough(more: int) -> bool:
        return len(runs) + more > 1 and _reaches(before + more * gain, estimate.confidence)

    upper = 1
    while not enough(upper):
        upper *= 2
        if upper > _MOST:
            return None
    lower = upper // 2
    while upper - lower > 1:
        middle = (lower + upper) // 2
        lower, upper = (lower, middle) if enough(middle) else (middle, upper)
    return upper


def fewest(op: ComparisonOperator, bound: Fraction, confidence: float) -> int:
    """The fewest runs that can support `op bound`, whatever their triggers show."""
    return needed(estimated((), both_sides(op, confidence)), op, bound) or 2


_MOST = 1 << 40
