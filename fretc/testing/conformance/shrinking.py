"""Minimization of a failing run; each attempt is a run of the program from its start.

Ticks are removed as long as the same requirement is violated; then each input keeps its previous
value where possible. In the end no single tick can be removed. Source: Zeller, Hildebrandt,
Simplifying and isolating failure-inducing input, TSE 28 (2002).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from fretc.testing.conformance.oracle import ProgramTrace, Tick
from fretish.classes.frozen import dataclass

MOST = 400
"""Maximum number of runs for one failure."""
Rows = tuple[Tick, ...]


@dataclass
class Shrinking:
    """The shortest run so far."""

    id: str
    """Id of the violated requirement."""
    inputs: Sequence[str]
    play: Callable[[Sequence[Tick]], ProgramTrace]
    best: ProgramTrace
    tries: int = 0

    def again(self) -> bool:
        """Whether the same inputs give the same outputs again."""
        return self._is_shorter(self.best.rows)

    def shrink(self) -> ProgramTrace:
        """The shortest failing run that was found."""
        self._leave_out_ticks()
        while self.tries < MOST and any(self._is_shorter(rows) for rows in self._calmer()):
            pass
        return self.best

    def _leave_out_ticks(self) -> None:
        size = len(self.best.rows)
        while size and self.tries < MOST:
            if not any(self._is_shorter(rows) for rows in self._without(size)):
                size //= 2

    def _without(self, size: int) -> Iterator[Rows]:
        """The run without some adjacent ticks, the last ones first."""
        rows = self.best.rows
        for start in range(len(rows) - size, -1, -size):
            yield rows[:start] + rows[start + size :]

    def _calmer(self) -> Iterator[Rows]:
        """The run with one change of an input removed."""
        rows = self.best.rows
        for tick in range(1, len(rows)):
            for name in self.inputs:
                was = rows[tick - 1][name]
                if rows[tick][name] != was:
                    yield (*rows[:tick], {**rows[tick], name: was}, *rows[tick + 1 :])

    def _is_shorter(self, rows: Rows) -> bool:
        """Whether the inputs violate the requirement, too; they are then stored as the best."""
        if not rows or self.tries >= MOST:
            return False
        self.tries += 1
        run = self.play(rows)
        if self.id not in run.broken:
            return False
        self.best = run
        return True
