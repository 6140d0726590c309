"""CPU time limit of one question."""

from __future__ import annotations

import math
import signal
import sys
import time
from dataclasses import field

from fretish.classes.frozen import dataclass


class OutOfTimeError(Exception):
    """The question exceeded its time limit, which the message states."""


@dataclass(frozen=True, slots=True)
class Budget:
    """CPU seconds that a question may take from now on."""

    seconds: float
    start: float = field(default_factory=time.process_time)

    def __post_init__(self) -> None:
        """Start the guard of the process, if requested."""
        if sys.platform != "win32" and _is_guarded and math.isfinite(self.seconds):
            signal.setitimer(signal.ITIMER_PROF, _OVERTIME * self.seconds + 1)

    def again(self) -> Budget:
        """A new budget of as many seconds, from now on."""
        return Budget(self.seconds)

    @property
    def spent(self) -> float:
        """Seconds used so far."""
        return time.process_time() - self.start

    @property
    def left(self) -> float:
        """Remaining seconds, 0 or more."""
        return max(0.0, self.seconds - self.spent)

    def check(self) -> None:
        """Raise OutOfTimeError if no time is left."""
        if self.spent > self.seconds:
            raise self.over

    @property
    def over(self) -> OutOfTimeError:
        """The exception for an exceeded budget."""
        return OutOfTimeError(f"not answered within {self.seconds:g} CPU seconds")


_is_guarded = False
_OVERTIME = 1.5
"""Factor by which a single operation may exceed the limit before the guard ends the process."""


def guard() -> None:
    """Make the process end if the question takes far longer than its limit.

    A single operation on large diagrams cannot be interrupted in another way.
    """
    global _is_guarded
    if sys.platform != "win32":
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        _is_guarded = True


ENDLESS = Budget(math.inf)
"""Budget without a limit."""
