"""Shortest runs of counters: through a tick of a goal, to a tick at which they may end.

Layers of states are computed backwards from the ends: states one tick away from an end, two ticks,
and so on; then states from which the way leads through the goal. The first layer with the initial
state gives the length of the shortest run; a fixpoint without it proves that there is none. Source:
Clarke, Emerson, Sistla, Automatic verification of finite-state concurrent systems, TOPLAS 8 (1986);
Burch et al., Symbolic model checking, LICS 1990.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.transition import State, Transition
from fretish.classes.frozen import dataclass

Letter = Mapping[int, bool]
"""A value of each variable of the alphabet."""


@dataclass
class RunLayers:
    """States with shortest runs of 0, 1, 2 ... ticks."""

    fresh: list[Function] = field(default_factory=lambda: [bdd.false()])
    """New states of each length."""
    found: Function = field(default_factory=bdd.false)
    """States of all lengths so far."""

    def add(self, states: Function) -> None:
        """Add the states with a run of the next length."""
        self.fresh.append(states - self.found)
        self.found = self.found | states

    @property
    def is_complete(self) -> bool:
        """Whether no longer run is a shortest one."""
        return len(self.fresh) > 1 and self.fresh[-1] == bdd.false()


class Endings:
    """Shortest ways to an end, from any state; layers are computed on demand."""

    def __init__(self, words: RunSearch, end: Function) -> None:
        self._words, self.end = words, end
        self._layers = RunLayers()
        self._ways: list[Function] = []

    def way(self, length: int) -> Function:
        """Ticks, over a state and a valuation, after which an end is at least so many ticks away.

        With length 0, the end itself. False if no way is that long.
        """
        while len(self._ways) <= length:
            self._extend()
        return self._ways[length]

    def is_over(self, length: int) -> bool:
        """Whether no way is so long, or longer."""
        return self._layers.is_complete and length >= len(self._layers.fresh) - 1

    def _extend(self) -> None:
        layers = self._layers
        if not self._ways:
            self._ways.append(self.end)
        elif layers.is_complete:
            self._ways.append(bdd.false())
            return
        else:
            self._ways.append(self._words.moved(layers.fresh[-1]))
        layers.add(self._words.pre_image(self._ways[-1]))


class RunSearch:
    """Runs of some counters without a violation."""

    def __init__(
        self,
        transition: Transition,
        letters: Sequence[int],
        quiet: Iterable[int],
        safe: Function,
        budget: Budget,
    ) -> None:
        """The runs.

        Args:
            transition: transition of all bits of goals and ends.
            letters: variables of the alphabet.
            quiet: variables that are false if possible; the others keep their values.
            safe: allowed ticks of a run, over a state and a valuation.
            budget: time limit for all searches.
        """
        self.transition, self._budget = transition, budget
        self._letters, self._cube = tuple(letters), bdd.cube(letters)
        self._quiet, self._safe = dict.fromkeys(quiet, False), safe
        self._start = bdd.point(transition.start)
        self._moves = {bdd.true(): bdd.true(), bdd.false(): bdd.false()}

    def pre_image(self, ticks: Function) -> Function:
        """States from which one of these ticks can come."""
        self._budget.check()
        return bdd.and_exists(self._safe, ticks, self._cube)

    def moved(self, states: Function) -> Function:
        """Function over a state and a valuation: the next state is one of these.

        Same as `Transition.moved`, but node by node, because layers are small and share most nodes.
        """
        function = self._moves.get(states)
        if function is None:
            bit, high, low = bdd.branches(states)
            after = self.transition.step(bit)
            function = bdd.ite(after, self.moved(high), self.moved(low))
            self._moves[states] = function
        return function

    def endings(self, end: Function) -> Endings:
        """The ways to an end, for any number of goals."""
        return Endings(self, end)

    def shortest(self, goal: Function, endings: Endings) -> tuple[Letter, ...] | None:
        """A shortest run from the initial state through a goal tick to an end; None: there is none.

        Args:
            goal: goal over a state and a valuation; its tick may be the end.
            endings: possible ends of the run.

        Raises:
            OutOfTimeError: it takes too long.
        """
        layers = RunLayers()
        while not self._begins(layers.fresh[-1]):
            length = len(layers.fresh) - 1
            if layers.is_complete and endings.is_over(length):
                return None
            onward = self.moved(layers.fresh[-1])
            layers.add(self.pre_image(onward | (goal & endings.way(length))))
        return tuple(self._descent(layers, goal, endings))

    def _begins(self, states: Function) -> bool:
        return bool(bdd.at(states, self._start) == bdd.true())

    def _descent(self, layers: RunLayers, goal: Function, endings: Endings) -> Iterator[Letter]:
        """Valuations from the initial state to the end, with as few changes as possible."""
        transition = self.transition.needed(self._safe, goal, endings.end)
        state: State = transition.start
        letter: Letter = dict.fromkeys(self._letters, False)
        is_past_goal = False
        for left in range(len(layers.fresh) - 2, -1, -1):
            self._budget.check()
            known = bdd.point(state)
            safe = bdd.at(self._safe, known)
            by_end = safe & bdd.at(endings.way(left), known)
            if not is_past_goal:
                by_goal = by_end & bdd.at(goal, known)
                allowed = by_goal | (safe & transition.moved_from(layers.fresh[left], known))
            else:
                by_goal, allowed = bdd.false(), by_end
            letter = nearest(allowed, {**letter, **self._quiet})
            chosen = bdd.point(letter)
            is_past_goal = is_past_goal or bdd.at(by_goal, chosen) == bdd.true()
            yield letter
            state = transition.next(bdd.point({**state, **letter}))


def nearest(allowed: Function, wanted: Letter) -> Letter:
    """Values that make a function true, with preferred values if possible.

    Args:
        allowed: function over the variables of the valuation; not false.
        wanted: preferred values, tried in the order of the variables.
    """
    values = dict(wanted)
    while allowed != bdd.true():
        variable, high, low = bdd.branches(allowed)
        value = wanted[variable]
        if (high if value else low) == bdd.false():
            value = not value
        values[variable], allowed = value, high if value else low
    return values
