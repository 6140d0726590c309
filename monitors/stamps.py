"""The clocks of a log, topic by topic: where one jumps, and how far it is from the recorder's.

Times are nanoseconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from monitors.samples import Times

JUMP = 10**9
"""By so much from one message to the next, a clock is set anew and not only late."""


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
