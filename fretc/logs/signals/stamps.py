"""The clocks of a log, topic by topic: where one was never set, stands still, or jumps.

Times are nanoseconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import Times

JUMP = 10**9
"""A step so large between two messages means that a clock was set, not that it is late."""
STILL = 10
"""So many messages with one time are no burst: their clock stands still."""


def unset(logs: Times, times: Times, *, from_zero: bool) -> NDArray[np.bool_]:
    """Which messages of one topic have a zero for a time, one that was never set.

    A clock may begin at zero, as those of simulations do: then a few messages of that time may
    come first, as long as they were recorded at the beginning too.

    Args:
        logs: when they were recorded, in the order of the file.
        times: when they were, on the declared clock.
        from_zero: whether the clock is known to begin there: it goes on within `JUMP`.
    """
    zero: NDArray[np.bool_] = times == 0
    if not from_zero or np.count_nonzero(zero) >= STILL:
        return zero
    first: NDArray[np.bool_] = np.logical_and.accumulate(zero) & (logs < JUMP)
    return zero & ~first


def placed(times: Times, lost: NDArray[np.bool_]) -> Times:
    """The times; a lost one becomes the one before it, or the first good one.

    Unchanged where all are lost.
    """
    good = np.flatnonzero(~lost)
    if not len(good):
        return times
    before = np.searchsorted(good, np.arange(len(times)), "right") - 1
    result: Times = times[good[before.clip(0)]]
    return result


def still(times: Times) -> int:
    """How many messages, in the order of the file, stand in runs of equal times.

    Runs of fewer than `STILL` messages do not count.
    """
    starts = np.flatnonzero(np.append(True, times[1:] != times[:-1]))
    lengths = np.diff(np.append(starts, len(times)))
    return int(lengths[lengths >= STILL].sum())


@dataclass(frozen=True, slots=True)
class Stamps:
    """The declared times of the messages of one topic against their log times."""

    jumps: int
    """How often their difference changes by more than `JUMP` from a message to the next."""
    largest: int
    """The largest such change, whichever its direction; 0 where there is none."""
    ahead: int
    """By how much they are ahead of the log times, in the middle; negative: behind."""


def stamps(logs: Times, times: Times) -> Stamps | None:
    """Compare the times of the messages of one topic, in the order of the file.

    Args:
        logs: when they were recorded.
        times: when they were, on the declared clock.

    Returns:
        None where there are no messages, or none has a declared time.
    """
    if not len(times):
        return None
    ahead = times - logs
    steps = np.abs(np.diff(ahead))
    jumps = steps[steps > JUMP]
    return Stamps(len(jumps), int(jumps.max(initial=0)), int(np.median(ahead)))
