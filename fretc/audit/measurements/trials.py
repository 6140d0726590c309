"""The outcome of each trigger of a requirement in one run: the trials of a probability."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from fretish.classes.frozen import dataclass
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class Trials:
    """The numbers of triggers of one run that were answered, failed, and are open."""

    answered: int
    """The demand of these triggers was met. A demand that only forbids (`always`, `until`,
    `before`) and is not broken when the log ends is met, as in the verdict of the run."""
    failed: int
    """The demand of these triggers was broken."""
    open: int
    """The outcome of these triggers is unknown: the log ended before, or values are unknown; also
    ticks of which it is unknown whether they are triggers."""
    met_by_end: int = 0
    """The answered triggers whose demand was met because the log ended."""

    @property
    def count(self) -> int:
        """The number of all triggers."""
        return self.answered + self.failed + self.open

    def before(self, longer: Trials) -> Trials:
        """The trials without effects of the cut tick, given the trials with it as `longer`.

        The cut tick gives no verdict, but a demand that it would break does not count as met.
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
"""The values of each proposition, and the number of ticks → the trials."""
