"""Iterative squaring: long paths of a relation, without single ticks.

The composition of a relation with itself covers twice as many ticks: a million ticks are twenty
compositions. This pays if counts run by themselves, which keeps the diagrams small.

Source: Burch, Clarke, McMillan, Dill, Hwang, Symbolic model checking: 10^20 states and beyond,
Information and Computation 98 (1992), iterative squaring.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import pairwise

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import Bit, RequirementCounter
from fretc.analysis.arena.transition import State
from fretish.classes.frozen import dataclass

MOST_NODES = 10_000
"""Maximum number of nodes of a relation; larger ones cost more than single ticks."""


class RelationTooLargeError(Exception):
    """The relation has no small diagram."""


_PATIENCE = 16
"""Number of single ticks before the first squaring."""


class IterativeSquaring:
    """Schedule of squarings within a fixpoint; one costs as much as some hundred ticks.

    Each squaring waits longer than the one before: a short fixpoint is not delayed, and one of n
    ticks has at most the root of n squarings.
    """

    def __init__(self, counters: Iterable[RequirementCounter]) -> None:
        """The schedule for a question about such counters."""
        self._ticks = 0
        self._wait = _PATIENCE if _are_side_by_side(counters) else None

    def is_due(self) -> bool:
        """Whether to try a squaring after this tick."""
        self._ticks += 1
        if self._wait is None or self._ticks < self._wait:
            return False
        self._ticks, self._wait = 0, self._wait + _PATIENCE
        return True

    @contextmanager
    def trial(self) -> Iterator[None]:
        """Try a squaring; if a relation is too large, there is no result and no later try."""
        try:
            yield
        except RelationTooLargeError:
            self._wait = None


def _are_side_by_side(counters: Iterable[RequirementCounter]) -> bool:
    """Whether the bits of long counts are interleaved in the variable order.

    Sums of counts that are not interleaved have no small diagrams.
    """
    words = [[bit.now for bit in word] for each in counters for word in each.words]
    spans = sorted((min(word), max(word)) for word in words if len(word) >= _LONG)
    return all(start < end for (_, end), (start, _) in pairwise(spans))


_LONG = 6
"""Number of bits of a long count."""


@dataclass(frozen=True, slots=True)
class TransitionRelation:
    """States and next states, over the bits `now` and `after`."""

    bits: tuple[Bit, ...]
    function: Function
    budget: Budget

    def lasting(self) -> Function:
        """States from which a path never ends.

        Raises:
            RelationTooLargeError: the diagrams grow too large.
            OutOfTimeError: it takes too long.
        """
        relation, after = self.function, bdd.cube(bit.after for bit in self.bits)
        states = bdd.exists(relation, after)
        while True:
            relation = self._squared(relation)
            left = bdd.exists(relation, after)
            if left == states:  # A state with a path of n ticks within the set has one of 2n ticks.
                return states
            states = left

    def reaching(self, goal: Function) -> Function:
        """States with a path into the goal, including those of the goal.

        Raises:
            RelationTooLargeError: the diagrams grow too large.
            OutOfTimeError: it takes too long.
        """
        after = bdd.cube(bit.after for bit in self.bits)
        relation, states = self.function | identity(self.bits), goal
        while True:
            more = bdd.and_exists(relation, _renamed(states, self.bits), after)
            if more == states:
                return states
            relation, states = self._squared(relation), more

    def longest(self, state: State) -> tuple[int, State]:
        """Number of ticks of the path from a state, and its end.

        The relation must be a function, and the path must end.

        Raises:
            RelationTooLargeError: the diagrams grow too large.
            OutOfTimeError: it takes too long.
        """
        powers = [self.function]
        while bdd.at(powers[-1], bdd.point(state)) != bdd.false():
            powers.append(self._squared(powers[-1]))
        ticks = 0
        for exponent, power in reversed([*enumerate(powers)]):
            there = bdd.at(power, bdd.point(state))
            if there != bdd.false():
                values = bdd.witness(there)
                state = {bit.now: values[bit.after] for bit in self.bits}
                ticks += 1 << exponent
        return ticks, state

    def _squared(self, relation: Function) -> Function:
        """The relation composed with itself."""
        self.budget.check()
        if bdd.size(relation) > MOST_NODES:
            raise RelationTooLargeError
        later = [(bit, bdd.variable(bit.later)) for bit in self.bits]
        first = bdd.substitute(relation, {bit.after: variable for bit, variable in later})
        then = bdd.substitute(relation, {bit.now: variable for bit, variable in later})
        return bdd.and_exists(first, then, bdd.cube(bit.later for bit in self.bits))


def identity(bits: tuple[Bit, ...]) -> Function:
    """The relation of each state with itself."""
    function = bdd.true()
    for bit in sorted(bits, key=lambda bit: -bit.now):
        function = -(bdd.variable(bit.now) ^ bdd.variable(bit.after)) & function
    return function


def _renamed(states: Function, bits: tuple[Bit, ...]) -> Function:
    return bdd.substitute(states, {bit.now: bdd.variable(bit.after) for bit in bits})
