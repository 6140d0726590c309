"""How the system wins a game, reply by reply; and when a run first violates each requirement."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.evaluation import evaluate
from fretc.analysis.games.game import Game, Goal, Letter, Solution, whole


@dataclass(frozen=True, slots=True)
class Place:
    """Position of a strategy: the state of the game, and the current goal."""

    state: tuple[bool, ...]
    goal: int = 0


class Strategy:
    """Winning strategy of the system: a Mealy machine, computed reply by reply."""

    def __init__(self, game: Game, solution: Solution) -> None:
        assert solution.is_realizable
        self._game, self._solution = game, solution
        self._bits = tuple(game.transition.start)
        self.start = Place(tuple(game.transition.start.values()))

    def reply(self, place: Place, inputs: Letter) -> tuple[dict[int, bool], Place]:
        """The outputs at a tick, and the next position.

        Args:
            place: position before the tick, reached by earlier replies.
            inputs: values of all inputs, legal.
        """
        game = self._game
        state = dict(zip(self._bits, place.state, strict=True))
        known = bdd.point({**state, **inputs})
        options, goal = self._options(place, known)
        outputs = whole(options, game.alphabet.outputs)
        after = game.transition.next(bdd.point({**state, **inputs, **outputs}))
        return outputs, Place(tuple(after[bit] for bit in self._bits), goal)

    def legal(self, place: Place) -> Function:
        """Legal inputs, over their bits."""
        state = dict(zip(self._bits, place.state, strict=True))
        return bdd.at(self._game.legal, bdd.point(state))

    def _options(self, place: Place, known: Function) -> tuple[Function, int]:
        """Winning outputs, and the next goal."""
        game, goals = self._game, self._solution.goals
        free = bdd.at(game.reachable - game.kept, known)
        if free != bdd.false():
            return free, place.goal
        safe = bdd.at(game.safe, known)
        if not goals:
            return safe & game.transition.moved_from(self._solution.winning, known), 0
        goal = goals[place.goal]
        reached = safe & game.transition.moved_from(goal.target, known)
        if reached != bdd.false():
            return reached, (place.goal + 1) % len(goals)
        return self._nearer(goal, place, safe, known), place.goal

    def _nearer(self, goal: Goal, place: Place, safe: Function, known: Function) -> Function:
        """Outputs that lead to the nearest layer, or stay where a promise is not kept."""
        moved_from = self._game.transition.moved_from
        here = bdd.point(dict(zip(self._bits, place.state, strict=True)))
        number = next(
            number
            for number, layer in enumerate(goal.layers)
            if bdd.at(layer.states, here) == bdd.true()
        )
        for layer in goal.layers[:number]:
            options = safe & moved_from(layer.states, known)
            if options != bdd.false():
                return options
        for stays, promise in zip(goal.layers[number].stays, self._game.promises, strict=True):
            if bdd.at(stays, here) == bdd.true():
                return safe & moved_from(stays - promise, known)
        raise AssertionError("a winning state has a winning reply")


def first_breaches(
    requirements: Sequence[FormalizedRequirement], known: Mapping[str, int], ticks: int
) -> dict[str, int | None]:
    """The tick at which each requirement is first violated; None: it is not.

    Args:
        requirements: requirements whose atoms are all known.
        known: each atom over time.
        ticks: length of the run.
    """
    found: dict[str, int | None] = {}
    for requirement in requirements:
        violation = evaluate(requirement.watch.violation, known, ticks)
        found[requirement.id] = (violation & -violation).bit_length() - 1 if violation else None
    return found
