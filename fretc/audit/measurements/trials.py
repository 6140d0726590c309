"""The outcome of each trigger of a requirement in one run: the trials of a probability."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class Trials:
    """How many triggers of one run were answered, failed, and are open."""

    answered: int
    """Their demand was met. One that only forbids (`always`, `until`, `before`) and is not broken
    when the log ends is met, as it is in the verdict of the run."""
    failed: int
    """Their demand was broken."""
    open: int
    """The log does not tell: it ended before, or holds unknown values where it matters; also
    triggers of which it is unknown whether they are any."""
    met_by_end: int = 0
    """Of the answered ones, those that are met because the log ended."""

    @property
    def count(self) -> int:
        """All of them."""
        return self.answered + self.failed + self.open

    def before(self, longer: Trials) -> Trials:
        """The trials, where those of the same run with its last, cut tick are `longer`.

        What that tick shows is no verdict; but what it would break is not met either.
        """
        if longer.failed <= self.failed:
            return self
        answered, still_open = self.answered - self.met_by_end, max(1, self.open + self.met_by_end)
        return replace(self, answered=answered, open=still_open, met_by_end=0)

    def __str__(self) -> str:
        """`11 of 12 triggers answered, 1 failed`."""
        parts = [
            f"{self.answered} of {self.count} trigger{'' if self.count == 1 else 's'} answered"
        ]
        parts += [f"{self.failed} failed"] if self.failed else []
        parts += [f"{self.open} open"] if self.open else []
        return ", ".join(parts)


NO_TRIALS = Trials(0, 0, 0)

Count = Callable[[Mapping[str, Column], int], Trials]
"""The truth of each proposition, and the number of ticks → the trials."""
