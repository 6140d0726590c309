"""The strategy of a system as functions: each output, and each bit of its memory.

Of all winning replies one is chosen: output by output, false if possible. The strategy makes the
environment violate assumptions only if nothing else wins.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget
from fretc.analysis.games.game import Game, Goal, Solution
from fretish.classes.frozen import dataclass


class NoMachineError(Exception):
    """The strategy has no such form; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class MealyMachine:
    """A Mealy machine. Before the first tick all bits are false."""

    inputs: Mapping[int, str]
    """Name of each variable that the environment sets."""
    outputs: Mapping[int, str]
    """Name of each variable that the machine sets."""
    replies: Mapping[int, Function]
    """The value of each output, over bits and inputs."""
    steps: Mapping[int, Function]
    """The value of each bit after a tick, over bits, inputs and outputs."""
    legal: Function
    """Possible inputs."""


def machine(game: Game, solution: Solution, budget: Budget) -> MealyMachine:
    """A winning machine of the system.

    Args:
        game: a game that the system wins.
        solution: solution of the game.
        budget: time limit.

    Raises:
        NoMachineError: the valuations are not propositions.
        OutOfTimeError: it takes too long.
    """
    alphabet = game.alphabet
    named = alphabet.labels
    if any(number not in named for number in (*alphabet.inputs, *alphabet.outputs)):
        raise NoMachineError("it compares numbers, and controllers cannot compare numbers yet")
    goals = solution.goals
    turns = _Turns(game, len(goals))
    moves = [_Moves(game, budget).of(solution.winning, goal) for goal in goals or (None,)]
    relation = bdd.false()
    for number, move in enumerate(moves):
        relation = relation | (turns.is_turn(number) & move)
    steps = {bit: game.transition.step(bit) for bit in game.transition.start}
    steps |= turns.steps([game.safe & game.transition.moved(goal.target) for goal in goals])
    return MealyMachine(
        {number: named[number] for number in alphabet.inputs},
        {number: named[number] for number in alphabet.outputs},
        _chosen(_with_broken_word(game, relation), alphabet.outputs, budget),
        steps,
        game.legal,
    )


class _Turns:
    """The number of the next goal, in bits of its own."""

    def __init__(self, game: Game, size: int) -> None:
        letters = (*game.alphabet.inputs, *game.alphabet.outputs)
        first = 2 + max(
            (*letters, *game.transition.start), default=0
        )  # Each bit has an `after` variable.
        self._bits = [first + i for i in range((max(size, 1) - 1).bit_length())]
        self._size = size

    def is_turn(self, number: int) -> Function:
        """Whether this goal is the next one."""
        return bdd.point({bit: bool(number >> i & 1) for i, bit in enumerate(self._bits)})

    def steps(self, reached: Sequence[Function]) -> dict[int, Function]:
        """The value of each bit after a tick; reaching a goal selects the next one."""
        steps = dict.fromkeys(self._bits, bdd.false())
        for number, ticks in enumerate(reached):
            following = (number + 1) % self._size
            for i, bit in enumerate(self._bits):
                if following >> i & 1:
                    steps[bit] = steps[bit] | (self.is_turn(number) & ticks)
                if number >> i & 1:
                    steps[bit] = steps[bit] | (self.is_turn(number) - ticks)
        return steps


class _Moves:
    """The moves of the system towards one goal."""

    def __init__(self, game: Game, budget: Budget) -> None:
        self._game, self._budget = game, budget
        self._outputs = bdd.cube(game.alphabet.outputs)

    def _into(self, states: Function) -> Function:
        self._budget.check()
        return self._game.safe & self._game.transition.moved(states)

    def or_else(self, first: Function, second: Function) -> Function:
        """The first function where the system has such a reply, else the second."""
        return first | (second - bdd.exists(first, self._outputs))

    def of(self, winning: Function, goal: Goal | None) -> Function:
        """All moves towards a goal.

        Args:
            winning: states that the system never leaves.
            goal: the goal; None: staying in `winning` is enough.
        """
        if goal is None:
            return winning & self._into(winning)
        nearer = self._into(goal.target)
        function = bdd.false()
        layers = (None, *goal.layers)
        for before, layer in pairwise(layers):
            assert layer is not None
            own = layer.states if before is None else layer.states - before.states
            function = function | (own & self._waiting(nearer, layer.stays))
            nearer = self.or_else(nearer, self._into(layer.states))
        return function

    def _waiting(self, nearer: Function, stays: Sequence[Function]) -> Function:
        """Moves that come nearer to the goal, or stay where the environment violates a promise."""
        function, left = nearer, bdd.true()
        for states, promise in zip(stays, self._game.promises, strict=True):
            mine = states & left
            left = left - states
            function = function | self.or_else(nearer, mine & self._into(states - promise)) & mine
        return function


def _with_broken_word(game: Game, moves: Function) -> Function:
    """Moves after the environment has violated an assumption, or while it does."""
    if game.kept == bdd.true():
        return moves
    outputs = bdd.cube(game.alphabet.outputs)
    for other in _last_resorts(game):
        moves = moves | (other - bdd.exists(moves, outputs))
    return moves


def _last_resorts(game: Game) -> Iterator[Function]:
    free = game.reachable - game.kept
    yield free & game.safe
    yield free
    yield game.safe


def _chosen(relation: Function, outputs: Sequence[int], budget: Budget) -> dict[int, Function]:
    """One value of each output, over the other variables."""
    functions: dict[int, Function] = {}
    for index, output in enumerate(outputs):
        budget.check()
        others = bdd.cube(outputs[index + 1 :])
        when = {value: bdd.at(relation, bdd.literal(output, value)) for value in (False, True)}
        possible = {value: bdd.exists(when[value], others) for value in when}
        functions[output] = possible[True] - possible[False]
        relation = bdd.ite(functions[output], when[True], when[False])
    return functions
