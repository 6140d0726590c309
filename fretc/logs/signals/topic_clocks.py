"""The clock of one topic of a log: times that were never set, stand still, jump, or are late.

A message has a log time, at which it was recorded, and a declared time, by the clock that the
bindings declare. All times are nanoseconds and stand in the order of the file.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import Late, Times
from fretish.classes.frozen import dataclass

JUMP = 10**9
"""A step of more than this between two messages means that a clock was set: no message is so late.

It is also how long a clock that begins at zero counts as being at its beginning.
"""
STILL_RUN = 10
"""From so many messages in a row with one time on, their clock stands still: a burst is shorter."""


def unset(log_times: Times, times: Times, *, from_zero: bool) -> NDArray[np.bool_]:
    """The messages with a declared time of zero that was never set.

    On a clock that begins at zero, as in simulations, a zero can be a true time: if it comes before
    every other time, was recorded within the first `JUMP`, and fewer than `STILL_RUN` messages have
    one.

    Args:
        log_times: the log times of the messages.
        times: the declared times of the same messages.
        from_zero: whether the clock of the log begins at zero.
    """
    zero: NDArray[np.bool_] = times == 0
    if not from_zero or np.count_nonzero(zero) >= STILL_RUN:
        return zero
    first: NDArray[np.bool_] = np.logical_and.accumulate(zero) & (log_times < JUMP)
    return zero & ~first


def forward_fill(times: Times, missing: NDArray[np.bool_]) -> Times:
    """The times, with each missing one replaced by the last one before it.

    Missing times before the first known time get that one. If all are missing, they are unchanged.
    """
    known_rows = np.flatnonzero(~missing)
    if not len(known_rows):
        return times
    last_known = np.searchsorted(known_rows, np.arange(len(times)), "right") - 1
    result: Times = times[known_rows[last_known.clip(0)]]
    return result


def count_still(times: Times) -> int:
    """The number of messages during which the clock stands still: the sum of all long runs.

    A run consists of consecutive messages with equal times; it is long from `STILL_RUN` on.
    """
    starts = np.flatnonzero(np.append(True, times[1:] != times[:-1]))
    lengths = np.diff(np.append(starts, len(times)))
    return int(lengths[lengths >= STILL_RUN].sum())


def late(log_times: Times, times: Times, lateness: int) -> Late | None:
    """The messages of a topic that are late for any tick; None: there are none."""
    lasts = log_times - lateness - 1
    chosen = lasts >= times
    return Late(times[chosen], lasts[chosen]) if chosen.any() else None


@dataclass(frozen=True, slots=True)
class ClockOffset:
    """The difference of the declared times of a topic's messages and their log times."""

    jumps: int
    """How often the offset changes by more than `JUMP` between two messages."""
    largest_jump: int
    """The largest such change in either direction; 0: there is none."""
    median: int
    """The median of the offsets; negative: the declared times are behind."""


def clock_offset(log_times: Times, times: Times) -> ClockOffset | None:
    """The offset of the declared times of a topic's messages, and its jumps.

    Args:
        log_times: the log times of the messages.
        times: the declared times of the same messages.

    Returns:
        None where there are no messages.
    """
    if not len(times):
        return None
    offsets = times - log_times
    if not offsets.any():  # the declared times are the log times: most often
        return ClockOffset(0, 0, 0)
    steps = np.abs(np.diff(offsets))
    jumps = steps[steps > JUMP]
    return ClockOffset(len(jumps), int(jumps.max(initial=0)), int(np.median(offsets)))
