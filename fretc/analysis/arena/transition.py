"""How a state of several counters goes on, tick by tick: as functions, and for one known state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.memory import Bit, Counter

State = Mapping[int, bool]
"""A value of each bit."""


class Transition:
    """The product of some counters: next-state functions, no relation."""

    def __init__(self, counters: Sequence[Counter]) -> None:
        by_number: dict[int, Bit] = {}
        self._steps: dict[int, Function] = {}
        for counter in counters:
            for bit, step in zip(counter.bits, counter.steps, strict=True):
                by_number[bit.now], self._steps[bit.now] = bit, step
        self.bits = tuple(by_number.values())
        self._after = {bit.now: bit.after for bit in self.bits}
        self.start: State = dict.fromkeys(self._steps, False)

    def needed(self, *functions: Function) -> Transition:
        """The same of those bits on which the functions depend, at a tick or at a later one."""
        waiting, found = list(functions), set[int]()
        while waiting:
            read = {number for number in bdd.support(waiting.pop()) if number in self._steps}
            waiting.extend(self._steps[number] for number in read - found)
            found |= read
        kept = Transition(())
        kept._after = {number: self._after[number] for number in self._steps if number in found}
        kept._steps = {number: self._steps[number] for number in self._steps if number in found}
        kept.start = dict.fromkeys(kept._steps, False)
        return kept

    @property
    def initial(self) -> Function:
        """The one state before the first tick."""
        return bdd.point(self.start)

    def step(self, bit: int) -> Function:
        """The value of a bit after a tick, over a state and a letter."""
        return self._steps[bit]

    def moved(self, states: Function) -> Function:
        """Over a state and a letter: whether the state after it is one of these.

        A state is renamed first: functions of bits before a tick stand in for bits after it, one
        by one.
        """
        read = [number for number in bdd.support(states) if number in self._steps]
        for number in read:
            states = bdd.compose(states, number, bdd.variable(self._after[number]))
        for number in read:
            states = bdd.compose(states, self._after[number], self._steps[number])
        return states

    def relation(self, ticks: Function, letters: Function, known: Function) -> Function:
        """Over states and those after them: which ones some of these ticks lead to.

        Args:
            ticks: over a state and a letter.
            letters: cube of the variables of a letter.
            known: cube of those whose values are known.
        """
        found = bdd.at(ticks, known)
        for bit in sorted(self.bits, key=lambda bit: -bit.now):
            step = bdd.at(self._steps[bit.now], known)
            found = found & -(bdd.variable(bit.after) ^ step)
        return bdd.exists(found, letters)

    def moved_from(self, states: Function, known: Function) -> Function:
        """The same where a cube holds the whole state: over what it leaves open of the letter."""
        for number in [n for n in bdd.support(states) if n in self._steps]:
            states = bdd.compose(states, number, bdd.at(self._steps[number], known))
        return states

    def next(self, known: Function) -> State:
        """The state after a whole state and a whole letter, given as a cube."""
        return {number: bdd.at(step, known) == bdd.true() for number, step in self._steps.items()}
