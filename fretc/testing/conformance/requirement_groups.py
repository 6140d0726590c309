"""The game of a tester against the program under test: how inputs lead to a situation.

From some states the tester can force the situation against any program that satisfies its
requirements: a strategy. From others it needs the program's cooperation, and takes the inputs of a
shortest run. Sources: David, Larsen, Li, Nielsen, A game-theoretic approach to real-time system
testing, DATE 2008 (strategies); Cooperative testing of timed systems, ENTCS 220 (2008) (cooperation
without a strategy).
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.situations.situations import Situation, situations
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.counters import counter
from fretc.analysis.arena.memory import Bit, Memory, PastMemory, RequirementCounter
from fretc.analysis.arena.product import Fixed, near_each_other
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.transition import State, Transition
from fretc.analysis.arena.variables import UnsupportedError, numbers
from fretc.analysis.games.game import upheld
from fretc.analysis.realizability_problem import alphabet_of
from fretc.testing.requirement_model import demands
from fretc.testing.search import Letter, nearest
from fretc.testing.suite import Polarity
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True, eq=False)
class TargetState:
    """Goal of a run."""

    requirement: FormalizedRequirement
    situation: Situation
    polarity: Polarity
    shown: tuple[f.Formula, ...]
    """Formulas of the past: a run has reached the goal if the first one holds; the next one counts
    if no run can satisfy the one before."""
    goals: tuple[Function, ...]
    """The formulas over a state and a valuation."""

    @property
    def name(self) -> str:
        """Name for people, also used as a random seed."""
        return f"{self.requirement.id} {self.situation.key} {self.polarity}"


class RequirementGroup:
    """Requirements that share variables, directly or indirectly, with their assumptions."""

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        assumptions: Sequence[FormalizedRequirement],
        roles: Roles,
        budget: Budget,
    ) -> None:
        """The group.

        Raises:
            UnsupportedError: an assumption has no counter, or no values are known for an input.
            OutOfTimeError: the assumptions take too long.
        """
        every = [*requirements, *assumptions]
        fresh = numbers()
        alphabet = alphabet_of(every, roles, fresh, Role.INPUT, of_moments=True)
        shared: dict[Function, Bit] = {}
        counters: dict[str, RequirementCounter] = {}
        self.beyond: dict[str, str] = {}
        """Id of a requirement without a counter → the reason."""
        for each in near_each_other(every):
            try:
                counters[each.id] = counter(each, alphabet, fresh, shared)
            except UnsupportedError as error:
                if each in assumptions:
                    raise
                self.beyond[each.id] = str(error)
        self.names = tuple(dict.fromkeys(name for each in every for name in demands(each).atoms))
        for name in self.names:
            alphabet.atom(name)
        before = alphabet.memory()
        self.alphabet = Fixed(alphabet)
        self._memory = Memory(fresh, shared)
        self._past = PastMemory(self.alphabet.atom, self._memory)
        self._counters = {
            requirement.id: counters[requirement.id]
            for requirement in requirements
            if requirement.id in counters
        }
        given = [counters[assumption.id] for assumption in assumptions]
        given += [before] if before is not None else []
        self.aims = tuple(aim for requirement in requirements for aim in self._aims(requirement))
        self.transition = Transition([*self._counters.values(), *given, self._remembered()])
        self._kept = upheld(self.alphabet, given, budget)
        self._safe = self.alphabet.reachable
        for each_counter in self._counters.values():
            self._safe = self._safe & each_counter.safe
        self._inputs = bdd.cube(self.alphabet.inputs)
        self._outputs = bdd.cube(self.alphabet.outputs)
        self.allowed = self._allowed()

    def _remembered(self) -> RequirementCounter:
        bits = tuple(dict.fromkeys(self._memory.bits))
        steps = tuple(self._memory.steps[bit] for bit in bits)
        yes = bdd.true()
        return RequirementCounter("", bits, steps, yes, None, (), yes, yes)

    def _allowed(self) -> Function:
        """Inputs that satisfy the assumptions for any program that satisfies its requirements."""
        return self.alphabet.legal & bdd.forall_implies(self._safe, self._kept, self._outputs)

    def _aims(self, requirement: FormalizedRequirement) -> Iterator[TargetState]:
        if requirement.id not in self._counters:
            return
        for situation in situations(requirement):
            if situation.unknown is not None or situation.place is not None:
                continue  # Inputs that the strategy ignores need values, too.
            try:
                yield self._kept_aim(requirement, situation)
                yield self._broken_aim(requirement, situation)
            except UnsupportedError as error:
                self.beyond[f"{requirement.id}: {situation.words}"] = str(error)

    def _kept_aim(self, requirement: FormalizedRequirement, situation: Situation) -> TargetState:
        """The situation, then if possible a tick without an open obligation."""
        if situation.at_end:
            return self._aim(requirement, situation, Polarity.KEPT, situation.formula)
        seen = f.once(situation.formula)
        done = f.and_(seen, f.not_(requirement.watch.obligation_pending))
        return self._aim(requirement, situation, Polarity.KEPT, done, seen)

    def _broken_aim(self, requirement: FormalizedRequirement, situation: Situation) -> TargetState:
        """The situation, and a tick at which the requirement is violated."""
        return self._aim(requirement, situation, Polarity.BROKEN, f.once(situation.formula))

    def _aim(
        self,
        requirement: FormalizedRequirement,
        situation: Situation,
        polarity: Polarity,
        *shown: f.Formula,
    ) -> TargetState:
        own = self._counters[requirement.id].safe
        goals = tuple(self._past.value(formula) for formula in shown)
        if polarity is Polarity.BROKEN:
            goals = tuple(goal - own for goal in goals)
        return TargetState(requirement, situation, polarity, shown, goals)

    # Plans

    def plan(self, aim: TargetState, budget: Budget) -> GoalPath | None:
        """Way to a goal; None: no run that satisfies the assumptions reaches it.

        Raises:
            OutOfTimeError: it takes too long.
        """
        start = self.transition.start
        for shown, goal in zip(aim.shown, aim.goals, strict=True):
            reached = goal & self._reached(aim)
            path = GoalPath(
                DistanceLayers(partial(self._forced, reached), self._inputs, budget),
                DistanceLayers(partial(self._helped, reached), self._inputs, budget),
                reached,
                shown,
            )
            if path.helped.number(start) is not None:
                return path
        return None

    def _reached(self, aim: TargetState) -> Function:
        """Ticks of a goal that violate nothing else."""
        if aim.polarity is not Polarity.BROKEN:
            return self._safe
        function = self.alphabet.reachable
        for id, each in self._counters.items():
            if id != aim.requirement.id:
                function = function & each.safe
        return function

    def _forced(self, goal: Function, states: Function) -> Function:
        """Inputs that force the goal or the states, for all outputs."""
        ends = goal | self.transition.moved(states)
        return self.allowed & bdd.forall_implies(self._safe, ends, self._outputs)

    def _helped(self, goal: Function, states: Function) -> Function:
        """Inputs that lead to the goal or the states for some outputs."""
        ends = (goal | (self._safe & self.transition.moved(states))) & self._kept
        return self.allowed & bdd.exists(ends & self.alphabet.reachable, self._outputs)

    def inputs(self, options: Function, wanted: Letter) -> Letter:
        """Values of the inputs among the options, with preferred values if possible.

        Args:
            options: function over inputs; not false.
            wanted: a preferred value of each input.
        """
        return nearest(options, {bit: wanted[bit] for bit in self.alphabet.inputs})

    # Values

    def values(self, inputs: Letter) -> Tick:
        """Truth values of input atoms, and numbers that satisfy the comparisons' truth values."""
        known, found = bdd.point(inputs), self.alphabet.values(inputs)
        for name in self.names:
            truth = bdd.at(self.alphabet.atom(name), known)
            if truth in (bdd.true(), bdd.false()):
                found[name] = bool(truth == bdd.true())
        return found

    def letter(self, inputs: Letter, truths: Mapping[str, bool | None]) -> Letter | None:
        """Valuation of a tick; None: the analysis has no valuation with these truth values.

        Args:
            inputs: chosen inputs.
            truths: truth values of atoms, from the values of both sides; None: unknown, and chosen
                freely.
        """
        here = bdd.point(inputs)
        fits = bdd.at(self.alphabet.reachable, here)
        for name in self.names:
            truth = truths.get(name)
            if truth is not None:
                atom = bdd.at(self.alphabet.atom(name), here)
                fits = fits & (atom if truth else -atom)
        if fits == bdd.false():
            return None
        return {**inputs, **nearest(fits, dict.fromkeys(self.alphabet.outputs, False))}


class DistanceLayers:
    """States that are 1, 2, ... ticks away from a target; computed on demand."""

    def __init__(
        self, step: Callable[[Function], Function], inputs: Function, budget: Budget
    ) -> None:
        """No layer is computed yet.

        Args:
            step: for states, the inputs that lead from a state to one of them or to the target.
            inputs: cube of the inputs.
            budget: time limit for all layers.
        """
        self._step, self._inputs, self._budget = step, inputs, budget
        self._ways: list[Function] = []
        self._states: list[Function] = [bdd.false()]
        self._is_complete = False

    def number(self, state: State) -> int | None:
        """Number of ticks from a state to the target; None: it is in no layer."""
        known = bdd.point(state)

        def is_in(number: int) -> bool:
            return bool(bdd.at(self._states[number], known) == bdd.true())

        while not is_in(len(self._ways)):
            if self._is_complete:
                return None
            self._extend()
        return bisect_left(range(len(self._states)), True, key=is_in)

    def way(self, number: int, state: State) -> Function:
        """Inputs that lead nearer, in a state that is so many ticks away."""
        return bdd.at(self._ways[number - 1], bdd.point(state))

    def _extend(self) -> None:
        self._budget.check()
        way = self._step(self._states[-1])
        states = bdd.exists(way, self._inputs)
        self._is_complete = bool(states == self._states[-1])
        self._ways.append(way)
        self._states.append(states)


@dataclass(frozen=True, slots=True)
class GoalPath:
    """Way to a goal."""

    forced: DistanceLayers
    """States from which the tester can force the goal."""
    helped: DistanceLayers
    """States from which the goal can be reached with the program's cooperation."""
    goal: Function
    """The goal over a state and a valuation."""
    shown: f.Formula
    """Formula of the past for the goal, without the program's requirements."""

    def is_reached(self, tick: Letter) -> bool:
        """Whether a tick, with the state before it, is the goal."""
        return bool(bdd.at(self.goal, bdd.point(tick)) == bdd.true())

    def distance(self, state: State) -> tuple[int, bool] | None:
        """Remaining ticks, and whether they can be forced; None: there is no way."""
        forced = self.forced.number(state)
        if forced is not None:
            return forced, True
        helped = self.helped.number(state)
        return None if helped is None else (helped, False)

    def options(self, state: State) -> Function | None:
        """Inputs that lead nearer; None: there are none."""
        distance = self.distance(state)
        if distance is None:
            return None
        number, is_forced = distance
        return (self.forced if is_forced else self.helped).way(number, state)
