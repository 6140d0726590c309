"""The game: at each tick the environment sets the inputs, then the system the outputs.

The system wins if it can go on for ever without a violation and meets its liveness again and again.
An environment that has violated its assumptions, or can satisfy them no longer, has lost.

Sources: Piterman, Pnueli, Sa'ar, Synthesis of reactive(1) designs, VMCAI 2006 (the fixpoints);
Zielonka, Infinite games on finitely coloured graphs, TCS 200 (1998) (strategies of both players).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.arena.transition import Transition
from fretc.analysis.games.runs import SatisfyingRuns
from fretc.analysis.games.squaring import IterativeSquaring, TransitionRelation, identity
from fretish.classes.frozen import dataclass

Letter = Mapping[int, bool]
"""A value of each input and output."""
Chain = tuple[tuple[Function, Function], ...]
"""For each link the remaining states, and an escape set that the environment can avoid at the next
tick. Link by link, the run reaches states in which a promise is kept, or an earlier trap."""


@dataclass(frozen=True, slots=True)
class Trap:
    """States from which the environment wins."""

    left: Function
    """States that remain for the system without the trap."""
    chains: tuple[Chain, ...]
    """One chain, or one for each promise of the environment, which it keeps in turn."""
    inputs: Letter | None = None
    """Inputs that the environment repeats until the state is in an earlier trap; None: follow the
    chains."""


@dataclass(frozen=True, slots=True)
class AttractorLayer:
    """States from which the system comes nearer to a goal, or the environment keeps no promise."""

    states: Function
    stays: tuple[Function, ...]
    """For each promise: states in which the system can remain while the promise is not kept."""


@dataclass(frozen=True, slots=True)
class Goal:
    """A liveness goal of the system, reachable from all its winning states."""

    target: Function
    layers: tuple[AttractorLayer, ...]
    """From each layer the system can move into the target or into an earlier layer."""

    @property
    def states(self) -> Function:
        """States from which the goal is reached."""
        return self.layers[-1].states


@dataclass(frozen=True, slots=True)
class Solution:
    """The winner from the initial state, with a strategy."""

    is_realizable: bool
    winning: Function
    """Computed states from which the system wins."""
    traps: tuple[Trap, ...]
    """Traps in the order of their computation; empty if they were not requested."""
    goals: tuple[Goal, ...]


def upheld(
    alphabet: Alphabet, assumptions: Sequence[RequirementCounter], budget: Budget
) -> Function:
    """Whether the environment can satisfy the assumptions for ever after a tick."""
    if not assumptions:
        return bdd.true()
    runs = SatisfyingRuns(alphabet, assumptions, budget)
    return runs.safe_transitions(runs.lasting())


class Game:
    """The game of some counters."""

    def __init__(
        self,
        alphabet: Alphabet,
        counters: Sequence[RequirementCounter],
        assumptions: Sequence[RequirementCounter],
        budget: Budget,
        kept: Function | None = None,
    ) -> None:
        """The game.

        Args:
            alphabet: alphabet of all counters.
            counters: counters of requirements.
            assumptions: counters of assumptions.
            budget: time limit for the fixpoints.
            kept: `upheld` of the assumptions, if known from an earlier game.
        """
        self.alphabet, self.counters, self.assumptions = alphabet, counters, assumptions
        self._budget = budget
        self.transition = Transition([*counters, *assumptions])
        self.legal, self.reachable = alphabet.legal, alphabet.reachable
        self._inputs, self._outputs = bdd.cube(alphabet.inputs), bdd.cube(alphabet.outputs)
        self.safe = self.legal & self.reachable
        """Ticks without a violation, for inputs that can occur together: without `legal`, the
        comparisons of one signal have as many patterns as if they were independent."""
        for counter in counters:
            self.safe = self.safe & counter.safe
        self.kept = upheld(alphabet, assumptions, budget) if kept is None else kept
        """Whether the environment can satisfy the assumptions for ever after a tick."""
        self.promises = [
            assumption.fair for assumption in assumptions if assumption.fair is not None
        ]
        self.duties = [each.fair for each in counters if each.fair is not None]

    @property
    def is_memoryless(self) -> bool:
        """Whether every tick is like the first one, independent of earlier ticks."""
        alone = (counter.safe for counter in self.counters)  # `safe` of all may be constant
        asked = (self.legal, self.reachable, self.safe, self.kept, *alone)
        read = {number for each in asked for number in bdd.support(each)}
        return not self.duties and not self.promises and read.isdisjoint(self.transition.start)

    def forced(self, states: Function, safe: Function | None = None) -> Function:
        """States from which the system can force the next state to be one of these.

        Args:
            states: the target states.
            safe: ticks without a violation; None: those of the game.
        """
        return bdd.forall_implies(self.legal, self.answered(states, safe), self._inputs)

    def answered(self, states: Function, safe: Function | None = None) -> Function:
        """States and inputs for which the system has a reply that leads to one of these states."""
        moved = self.transition.moved(states)
        answer = bdd.and_exists(self.safe if safe is None else safe, moved, self._outputs)
        if self.kept == bdd.true():
            return answer
        return answer | bdd.and_exists(self.reachable, -self.kept, self._outputs)

    def surviving(self, states: Function, inputs: Letter) -> Function:
        """States from which the system can stay in these states while the inputs repeat.

        Raises:
            TooLargeError: the diagrams grow too large.
            OutOfTimeError: it takes too long.
        """
        known, bits = bdd.point(inputs), self.transition.bits
        free = bdd.and_exists(self.reachable, -self.kept, self._outputs) | -self.legal
        moves = self.transition.relation(states & self.safe, self._outputs, known)
        moves = moves | (states & bdd.at(free, known) & identity(bits))
        return TransitionRelation(bits, moves, self._budget).lasting()

    def solution(self, *, traps: bool = False) -> Solution:
        """The winner, with a strategy.

        Args:
            traps: whether to store the traps by which the environment wins.

        Raises:
            OutOfTimeError: it takes too long.
        """
        return _AttractorSearch(self, self._budget, traps=traps).solution(
            self.duties, self.promises
        )


class _AttractorSearch:
    def __init__(self, game: Game, budget: Budget, *, traps: bool) -> None:
        self._game, self._budget, self._keeps = game, budget, traps
        self._initial = game.transition.initial
        self._traps: list[Trap] = []
        self._leaps = IterativeSquaring([*game.counters, *game.assumptions])

    def solution(self, duties: Sequence[Function], promises: Sequence[Function]) -> Solution:
        states = self._safe()
        goals: tuple[Goal, ...] = ()
        while self._holds(states) and duties:
            before, goals = states, ()
            for fair in duties:
                goal = self._goal(fair, states, promises)
                goals = (*goals, goal)
                states = states & goal.states
            if states == before:
                break
        return Solution(self._holds(states), states, tuple(self._traps), goals)

    def _holds(self, states: Function) -> bool:
        return bool((self._initial - states) == bdd.false())

    def _trapped(self, left: Function, *chains: Chain) -> None:
        if self._keeps:
            self._traps.append(Trap(left, chains))

    def _safe(self) -> Function:
        """States from which the system can go on for ever; stops if the initial state is lost."""
        states = bdd.true()
        while True:
            self._budget.check()
            left = states & self._game.forced(states)
            if left == states:
                return states
            self._trapped(left, ((left, states),))
            if not self._holds(left):
                return left
            states = self._leapt(left, states) if self._leaps.is_due() else left

    def _leapt(self, left: Function, before: Function) -> Function:
        """Remaining states after the environment repeats its last winning inputs."""
        game = self._game
        lost = (before - left) & (game.legal - game.answered(before))
        inputs = whole(lost, game.alphabet.inputs)
        states = left
        with self._leaps.trial():
            states = left & game.surviving(left, inputs)
        if self._keeps and states != left:
            self._traps.append(Trap(states, (((states, states),),), inputs))
        return states

    def _goal(self, fair: Function, states: Function, promises: Sequence[Function]) -> Goal:
        """How the system reaches `fair` without leaving the states."""
        target = fair & states
        layers: list[AttractorLayer] = []
        near = bdd.false()
        while True:
            self._budget.check()
            layer = self._layer(target | near, promises)
            states_of = near | layer.states
            if states_of == near:
                break
            near = states_of
            layers.append(AttractorLayer(near, layer.stays))
        if self._keeps:
            left, escape = states & near, target | near
            kept = [self._chain(escape, promise) for promise in promises]
            self._trapped(left, *(kept or [((left, escape),)]))
        return Goal(target, tuple(layers) or (AttractorLayer(bdd.false(), ()),))

    def _layer(self, near: Function, promises: Sequence[Function]) -> AttractorLayer:
        """States from which the system comes near, or a promise is not kept for ever."""
        if not promises:
            return AttractorLayer(self._game.forced(near), ())
        stays = tuple(self._staying(near, promise) for promise in promises)
        function = bdd.false()
        for each in stays:
            function = function | each
        return AttractorLayer(function, stays)

    def _staying(self, near: Function, promise: Function) -> Function:
        chain = self._chain(near, promise)
        return chain[-1][0] if chain else bdd.true()

    def _chain(self, near: Function, promise: Function) -> Chain:
        """How the states with the unkept promise are left, round by round."""
        states = bdd.true()
        links: list[tuple[Function, Function]] = []
        while True:
            self._budget.check()
            escape = near | (states - promise)
            left = self._game.forced(escape)
            if left == states:
                return tuple(links)
            links.append((left, escape))
            states = left


def whole(options: Function, variables: Sequence[int]) -> dict[int, bool]:
    """A value of each variable in one of the options; false if none is required."""
    values = bdd.witness(options)
    return {number: values.get(number, False) for number in variables}
