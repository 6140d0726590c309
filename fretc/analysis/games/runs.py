"""Runs that keep requirements, for any choices: reachability, and what can last for ever.

Source: Emerson, Lei, Efficient model checking in fragments of the propositional mu-calculus, LICS
1986 (runs that are fair).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import Counter
from fretc.analysis.arena.transition import Transition
from fretc.analysis.games.squaring import IterativeSquaring, Relation


class Runs:
    """The runs that keep some counters; others may be watched along with them."""

    def __init__(
        self,
        alphabet: Alphabet,
        kept: Sequence[Counter],
        budget: Budget,
        watched: Sequence[Counter] = (),
        *,
        certain: bool = False,
    ) -> None:
        """The runs.

        Args:
            alphabet: of all counters.
            kept: by the runs.
            budget: for the fixpoints.
            watched: others.
            certain: whether the runs have letters only that there are for certain.
        """
        self._kept, self._budget = kept, budget
        self._counters = (*kept, *watched)
        self.transition = Transition([*kept, *watched])
        self._letters = bdd.cube([*alphabet.inputs, *alphabet.outputs])
        self.safe = alphabet.certain if certain else alphabet.possible
        for counter in kept:
            self.safe = self.safe & counter.safe
        self._fair = [each.fair for each in kept if each.fair is not None]

    def going_on(self, states: Function) -> Function:
        """Ticks that break nothing and lead to one of the states."""
        return self.safe & self.transition.moved(states)

    def _paths(self, through: Function) -> Relation:
        """The steps of runs that break nothing, from such states."""
        steps = self.transition.relation(self.safe & through, self._letters, bdd.true())
        return Relation(self.transition.bits, steps, self._budget)

    def preceding(self, states: Function) -> Function:
        """The states from which a tick that breaks nothing leads to one of these."""
        return bdd.and_exists(self.safe, self.transition.moved(states), self._letters)

    def lasting(self, within: Function | None = None) -> Function:
        """The states from which all that is kept can be kept for ever.

        Args:
            within: states that such a run never leaves; None: all.
        """
        states, leaps = bdd.true() if within is None else within, IterativeSquaring(self._counters)
        while True:
            self._budget.check()
            if leaps.is_due():
                with leaps.trial():
                    states = states & self._paths(states).lasting()
            left = states & self.preceding(states)
            for fair in self._fair:
                left = left & self._leading(fair & left, left)
            if left == states:
                return states
            states = left

    def _leading(self, target: Function, through: Function) -> Function:
        """The states from which a run comes to a target, and nowhere but `through` before it."""
        found, leaps = bdd.false(), IterativeSquaring(self._counters)
        while True:
            self._budget.check()
            if leaps.is_due():
                with leaps.trial():
                    found = found | (through & self._paths(through).reaching(found))
            more = found | (through & self.preceding(target | found))
            if more == found:
                return found
            found = more

    def is_possible(self) -> bool:
        """Whether there is a run that keeps all, for ever; often one that nothing triggers."""
        idle = bdd.true()
        for counter in self._kept:
            idle = idle & counter.idle
        initial = self.transition.initial
        quiet = bool((initial & self.lasting(within=idle)) != bdd.false())
        return quiet or bool((initial & self.lasting()) != bdd.false())

    def can_reach(self, ticks: Function, lasting: Function) -> bool:
        """Whether a run that can be kept for ever has such a tick.

        Args:
            ticks: over a state and a letter.
            lasting: of these runs.
        """
        initial, moved = self.transition.initial, self.transition.moved
        found = bdd.and_exists(self.safe & ticks, moved(lasting), self._letters)
        leaps = IterativeSquaring(self._counters)
        while True:
            self._budget.check()
            if leaps.is_due():
                with leaps.trial():
                    found = self._paths(bdd.true()).reaching(found)
            if (initial & found) != bdd.false():
                return True
            more = found | self.preceding(found)  # what leads to such a state can last, too
            if more == found:
                return False
            found = more

    def can_break(self, counter: Counter, lasting: Function) -> bool:
        """Whether a run that can be kept for ever breaks a counter that is watched, or fails it.

        Args:
            counter: one of those that are watched.
            lasting: of these runs.
        """
        if self.can_reach(-counter.safe, lasting):
            return True
        if counter.fair is None:
            return False
        starving = self.lasting(lasting - counter.fair)
        return self.can_reach(self.transition.moved(starving), lasting)

    def path(self, goal: Function, through: Function) -> tuple[dict[int, bool], ...] | None:
        """The letters of a shortest run into a goal; None: there is none.

        Args:
            goal: states.
            through: the only states, those of the goal among them, that such a run may have.
        """
        levels = [goal]
        while (self.transition.initial & levels[-1]) == bdd.false():
            self._budget.check()
            more = levels[-1] | (through & self.preceding(levels[-1]))
            if more == levels[-1]:
                return None
            levels.append(more)
        return tuple(self._descent(levels))

    def _descent(self, levels: Sequence[Function]) -> Iterator[dict[int, bool]]:
        """Letters that lead from the initial state down from level to level."""
        state = self.transition.start
        for level in reversed(levels[:-1]):
            known = bdd.point(state)
            ticks = bdd.at(self.safe, known) & self.transition.moved_from(level, known)
            letter = {**dict.fromkeys(bdd.support(self._letters), False), **bdd.witness(ticks)}
            yield letter
            state = self.transition.next(bdd.point({**state, **letter}))
