"""Time of a processor for one question."""

from __future__ import annotations

import time
from dataclasses import dataclass, field


class OutOfTimeError(Exception):
    """The question took longer than it may; the message says how long that is."""


@dataclass(frozen=True, slots=True)
class Budget:
    """A question may take so many seconds from now on."""

    seconds: float
    start: float = field(default_factory=time.process_time)

    @property
    def spent(self) -> float:
        """Seconds so far."""
        return time.process_time() - self.start

    def check(self) -> None:
        """Raise OutOfTimeError where they are over."""
        if self.spent > self.seconds:
            raise OutOfTimeError(f"not answered within {self.seconds:g} s of a processor")
