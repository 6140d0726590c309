"""Runs that satisfy requirements, for any choices: reachability and endless runs.

Source: Emerson, Lei, Efficient model checking in fragments of the propositional mu-calculus, LICS
1986 (fair runs).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.arena.transition import Transition
from fretc.analysis.games.squaring import IterativeSquaring, TransitionRelation


class SatisfyingRuns:
    """Runs that satisfy some counters; other counters may be observed along with them."""

    def __init__(
        self,
        alphabet: Alphabet,
        kept: Sequence[RequirementCounter],
        budget: Budget,
        watched: Sequence[RequirementCounter] = (),
        *,
        certain: bool = False,
    ) -> None:
        """The runs.

        Args:
            alphabet: alphabet of all counters.
            kept: counters that the runs satisfy.
            budget: time limit for the fixpoints.
            watched: other counters to observe.
            certain: whether only certain valuations are used.
        """
        self._kept, self._budget = kept, budget
        self._counters = (*kept, *watched)
        self.transition = Transition([*kept, *watched])
        self._letters = bdd.cube([*alphabet.inputs, *alphabet.outputs])
        self.safe = alphabet.certain if certain else alphabet.possible
        for counter in kept:
            self.safe = self.safe & counter.safe
        self._fair = [each.fair for each in kept if each.fair is not None]

    def safe_transitions(self, states: Function) -> Function:
        """Ticks without a violation that lead to one of the states."""
        return self.safe & self.transition.moved(states)

    def _paths(self, through: Function) -> TransitionRelation:
        """Relation of ticks without a violation, from these states."""
        steps = self.transition.relation(self.safe & through, self._letters, bdd.true())
        return TransitionRelation(self.transition.bits, steps, self._budget)

    def pre_image(self, states: Function) -> Function:
        """States with a tick without a violation that leads to one of these."""
        return bdd.and_exists(self.safe, self.transition.moved(states), self._letters)

    def lasting(self, within: Function | None = None) -> Function:
        """States from which an endless run satisfies all counters.

        Args:
            within: states that such a run never leaves; None: all.
        """
        states, leaps = bdd.true() if within is None else within, IterativeSquaring(self._counters)
        while True:
            self._budget.check()
            if leaps.is_due():
                with leaps.trial():
                    states = states & self._paths(states).lasting()
            left = states & self.pre_image(states)
            for fair in self._fair:
                left = left & self._eu_fixpoint(fair & left, left)
            if left == states:
                return states
            states = left

    def _eu_fixpoint(self, target: Function, through: Function) -> Function:
        """States with a run to the target that stays in `through` before it."""
        states, leaps = bdd.false(), IterativeSquaring(self._counters)
        while True:
            self._budget.check()
            if leaps.is_due():
                with leaps.trial():
                    states = states | (through & self._paths(through).reaching(states))
            more = states | (through & self.pre_image(target | states))
            if more == states:
                return states
            states = more

    def is_possible(self) -> bool:
        """Whether an endless run satisfies all counters; tries a run without triggers first."""
        idle = bdd.true()
        for counter in self._kept:
            idle = idle & counter.idle
        initial = self.transition.initial
        quiet = bool((initial & self.lasting(within=idle)) != bdd.false())
        return quiet or bool((initial & self.lasting()) != bdd.false())

    def can_reach(self, ticks: Function, lasting: Function) -> bool:
        """Whether an endless satisfying run has such a tick.

        Args:
            ticks: ticks over a state and a valuation.
            lasting: states of these runs.
        """
        initial, moved = self.transition.initial, self.transition.moved
        states = bdd.and_exists(self.safe & ticks, moved(lasting), self._letters)
        leaps = IterativeSquaring(self._counters)
        while True:
            self._budget.check()
            if leaps.is_due():
                with leaps.trial():
                    states = self._paths(bdd.true()).reaching(states)
            if (initial & states) != bdd.false():
                return True
            more = states | self.pre_image(
                states
            )  # States before such a state are also on an endless run.
            if more == states:
                return False
            states = more

    def can_break(self, counter: RequirementCounter, lasting: Function) -> bool:
        """Whether an endless satisfying run violates an observed counter.

        Args:
            counter: one of the observed counters.
            lasting: states of these runs.
        """
        if self.can_reach(-counter.safe, lasting):
            return True
        if counter.fair is None:
            return False
        starving = self.lasting(lasting - counter.fair)
        return self.can_reach(self.transition.moved(starving), lasting)

    def path(self, goal: Function, through: Function) -> tuple[dict[int, bool], ...] | None:
        """Valuations of a shortest run into a goal; None: there is none.

        Args:
            goal: target states.
            through: all states that such a run may have, including those of the goal.
        """
        levels = [goal]
        while (self.transition.initial & levels[-1]) == bdd.false():
            self._budget.check()
            more = levels[-1] | (through & self.pre_image(levels[-1]))
            if more == levels[-1]:
                return None
            levels.append(more)
        return tuple(self._descent(levels))

    def _descent(self, levels: Sequence[Function]) -> Iterator[dict[int, bool]]:
        """Valuations that lead from the initial state down from level to level."""
        state = self.transition.start
        for level in reversed(levels[:-1]):
            known = bdd.point(state)
            ticks = bdd.at(self.safe, known) & self.transition.moved_from(level, known)
            letter = {**dict.fromkeys(bdd.support(self._letters), False), **bdd.witness(ticks)}
            yield letter
            state = self.transition.next(bdd.point({**state, **letter}))
