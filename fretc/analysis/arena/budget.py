"""Time of a processor for one question."""

from __future__ import annotations

import math
import signal
import time
from dataclasses import dataclass, field


class OutOfTimeError(Exception):
    """The question took longer than it may; the message says how long that is."""


@dataclass(frozen=True, slots=True)
class Budget:
    """A question may take so many seconds from now on."""

    seconds: float
    start: float = field(default_factory=time.process_time)

    def __post_init__(self) -> None:
        """Guard the question, where its process is to be guarded."""
        if _is_guarded and math.isfinite(self.seconds):
            signal.setitimer(signal.ITIMER_PROF, _OVERTIME * self.seconds + 1)

    def again(self) -> Budget:
        """As many seconds, from now on."""
        return Budget(self.seconds)

    @property
    def spent(self) -> float:
        """Seconds so far."""
        return time.process_time() - self.start

    @property
    def left(self) -> float:
        """Seconds that are left, none or more."""
        return max(0.0, self.seconds - self.spent)

    def check(self) -> None:
        """Raise OutOfTimeError where they are over."""
        if self.spent > self.seconds:
            raise self.over

    @property
    def over(self) -> OutOfTimeError:
        """What is raised then."""
        return OutOfTimeError(f"not answered within {self.seconds:g} CPU seconds")


_is_guarded = False
_OVERTIME = 1.5
"""A question asks often whether its time is over; what lies between may take so much more."""


def guard() -> None:
    """From now on a question that takes far longer than it may ends the process.

    A single operation on large diagrams cannot be interrupted otherwise.
    """
    global _is_guarded
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    _is_guarded = True


ENDLESS = Budget(math.inf)
"""For what takes no time that counts."""
