"""The game: at each tick the environment sets the inputs, then the system the outputs.

The system wins where it can go on for ever without a breach, and meets its liveness again and
again. An environment that has broken its assumptions, or can keep them no longer, has lost.

Sources: Piterman, Pnueli, Sa'ar, Synthesis of reactive(1) designs, VMCAI 2006 (the fixpoints);
Zielonka, Infinite games on finitely coloured graphs, TCS 200 (1998) (strategies of both).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import Counter
from fretc.analysis.arena.transition import Transition
from fretc.analysis.games.runs import Runs
from fretc.analysis.games.squaring import IterativeSquaring, Relation, identity

Letter = Mapping[int, bool]
"""A value of each input and output."""
Chain = tuple[tuple[Function, Function], ...]
"""Of each link what is left, and an escape: from states of a trap that are not left the environment
can see to it that none of the escape comes next. So it comes, link by link, to where its promise is
kept, or into an earlier trap."""


@dataclass(frozen=True, slots=True)
class Trap:
    """States from which the environment wins."""

    left: Function
    """The states that are left to the system once those of the trap are taken away."""
    chains: tuple[Chain, ...]
    """One, or one for each promise of the environment, which it keeps in turn."""
    inputs: Letter | None = None
    """What the environment repeats until the state is in an earlier trap; None: as chains say."""


@dataclass(frozen=True, slots=True)
class Layer:
    """States from which the system comes nearer to a goal, or the environment keeps no promise."""

    states: Function
    stays: tuple[Function, ...]
    """For each promise: where the system can remain, once it is no nearer, while it is unkept."""


@dataclass(frozen=True, slots=True)
class Goal:
    """A liveness of the system: how it comes nearer to it, from all states that it wins."""

    target: Function
    layers: tuple[Layer, ...]
    """From each layer the system can step into the target or into an earlier layer."""

    @property
    def states(self) -> Function:
        """From where it is reached."""
        return self.layers[-1].states


@dataclass(frozen=True, slots=True)
class Solution:
    """Who wins from the initial state, and how."""

    is_realizable: bool
    winning: Function
    """The states from which the system wins, as far as they were computed."""
    traps: tuple[Trap, ...]
    """In the order in which they were found; empty where they were not asked for."""
    goals: tuple[Goal, ...]


def upheld(alphabet: Alphabet, assumptions: Sequence[Counter], budget: Budget) -> Function:
    """Whether a tick leaves the assumptions such that they can be kept for ever."""
    if not assumptions:
        return bdd.true()
    runs = Runs(alphabet, assumptions, budget)
    return runs.going_on(runs.lasting())


class Game:
    """The game of some counters."""

    def __init__(
        self,
        alphabet: Alphabet,
        counters: Sequence[Counter],
        assumptions: Sequence[Counter],
        budget: Budget,
        kept: Function | None = None,
    ) -> None:
        """The game.

        Args:
            alphabet: of all counters.
            counters: of requirements.
            assumptions: likewise.
            budget: for the fixpoints.
            kept: `upheld` of the assumptions, where it is known from an earlier game.
        """
        self.alphabet, self.counters, self.assumptions = alphabet, counters, assumptions
        self._budget = budget
        self.transition = Transition([*counters, *assumptions])
        self.legal, self.reachable = alphabet.legal, alphabet.reachable
        self._inputs, self._outputs = bdd.cube(alphabet.inputs), bdd.cube(alphabet.outputs)
        self.safe = self.reachable
        for counter in counters:
            self.safe = self.safe & counter.safe
        self.kept = upheld(alphabet, assumptions, budget) if kept is None else kept
        """Whether a tick leaves the assumptions such that they can be kept for ever."""
        self.promises = [each.fair for each in assumptions if each.fair is not None]
        self.duties = [each.fair for each in counters if each.fair is not None]

    @property
    def is_memoryless(self) -> bool:
        """Whether each tick is like the first one, whatever was done before it."""
        asked = (self.legal, self.reachable, self.safe, self.kept)
        read = {number for each in asked for number in bdd.support(each)}
        return not self.duties and not self.promises and read.isdisjoint(self.transition.start)

    def forced(self, states: Function, safe: Function | None = None) -> Function:
        """The states from which the system can see to it that one of these comes next.

        Args:
            states: those.
            safe: ticks that break nothing; None: those of the game.
        """
        return bdd.forall_implies(self.legal, self.answered(states, safe), self._inputs)

    def answered(self, states: Function, safe: Function | None = None) -> Function:
        """States and inputs to which the system has an answer that leads to one of these states."""
        moved = self.transition.moved(states)
        answer = bdd.and_exists(self.safe if safe is None else safe, moved, self._outputs)
        if self.kept == bdd.true():
            return answer
        return answer | bdd.and_exists(self.reachable, -self.kept, self._outputs)

    def surviving(self, states: Function, inputs: Letter) -> Function:
        """From where the system can stay in these states, while the environment repeats inputs.

        Raises:
            TooLargeError: their diagrams grow.
            OutOfTimeError: it takes too long.
        """
        known, bits = bdd.point(inputs), self.transition.bits
        free = bdd.and_exists(self.reachable, -self.kept, self._outputs) | -self.legal
        moves = self.transition.relation(states & self.safe, self._outputs, known)
        moves = moves | (states & bdd.at(free, known) & identity(bits))
        return Relation(bits, moves, self._budget).lasting()

    def solution(self, *, traps: bool = False) -> Solution:
        """Who wins.

        Args:
            traps: whether those are kept, by which the environment wins.

        Raises:
            OutOfTimeError: it takes too long.
        """
        return _Search(self, self._budget, traps=traps).solution(self.duties, self.promises)


class _Search:
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
        """The states from which the system can go on for ever, or where the initial one is lost."""
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
        """What is left where the environment repeats the inputs by which it has won last."""
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
        """How the system reaches `fair` from states without leaving them."""
        target = fair & states
        layers: list[Layer] = []
        near = bdd.false()
        while True:
            self._budget.check()
            layer = self._layer(target | near, promises)
            states_of = near | layer.states
            if states_of == near:
                break
            near = states_of
            layers.append(Layer(near, layer.stays))
        if self._keeps:
            left, escape = states & near, target | near
            kept = [self._chain(escape, promise) for promise in promises]
            self._trapped(left, *(kept or [((left, escape),)]))
        return Goal(target, tuple(layers) or (Layer(bdd.false(), ()),))

    def _layer(self, near: Function, promises: Sequence[Function]) -> Layer:
        """From where the system comes near, or a promise stays unkept for ever."""
        if not promises:
            return Layer(self._game.forced(near), ())
        stays = tuple(self._staying(near, promise) for promise in promises)
        found = bdd.false()
        for each in stays:
            found = found | each
        return Layer(found, stays)

    def _staying(self, near: Function, promise: Function) -> Function:
        chain = self._chain(near, promise)
        return chain[-1][0] if chain else bdd.true()

    def _chain(self, near: Function, promise: Function) -> Chain:
        """How the states are left, round by round, in which the promise stays unkept."""
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
    """A value of each variable, as one of the options has them; false where none asks for more."""
    values = bdd.witness(options)
    return {number: values.get(number, False) for number in variables}
