"""All minimal conflicts at once, for requirements without memory.

Each requirement gets a switch, which turns it off. One tick of the game of all requirements then
gives the switch settings for which the system wins, in place of hundreds of games.
"""

from __future__ import annotations

from collections.abc import Iterator

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.variables import Numbers
from fretc.analysis.games.cores import Members
from fretc.analysis.games.game import Game
from fretish.classes.frozen import dataclass

MOST_NODES = 100_000
"""Maximum number of nodes of the diagram of requirements and switches."""


@dataclass(frozen=True, slots=True)
class Switched:
    """Requirements with switches."""

    switches: tuple[int, ...]
    """The switch variable of each requirement."""
    lost: Function
    """Switch settings for which the environment wins."""

    def cores(self, budget: Budget) -> Iterator[Members]:
        """Each minimal conflict; minimal settings of the switches are enumerated.

        Raises:
            OutOfTimeError: there are too many.
        """
        rest = self.lost
        while rest != bdd.false():
            budget.check()
            on = [switch for switch, value in bdd.witness(rest).items() if value]
            yield frozenset(self.switches.index(switch) for switch in on)
            rest = rest - bdd.cube(on)


def switched(game: Game, fresh: Numbers) -> Switched | None:
    """The requirements of a game with switches; None: they have memory, or are too many."""
    if not game.is_memoryless:
        return None
    safe, switches = game.legal & game.reachable, [next(fresh) for _ in game.counters]
    for counter, switch in zip(game.counters, switches, strict=True):
        safe = safe & (counter.safe | -bdd.variable(switch))
        if bdd.size(safe) > MOST_NODES:
            return None
    return Switched(tuple(switches), -game.forced(bdd.true(), safe))
