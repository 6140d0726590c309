"""Next state of several counters: as functions, and for one known state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.memory import Bit, RequirementCounter

State = Mapping[int, bool]
"""A value of each bit."""


class Transition:
    """Product of some counters: next-state functions, without a relation."""

    def __init__(self, counters: Sequence[RequirementCounter]) -> None:
        by_number: dict[int, Bit] = {}
        self._steps: dict[int, Function] = {}
        for counter in counters:
            for bit, step in zip(counter.bits, counter.steps, strict=True):
                by_number[bit.now], self._steps[bit.now] = bit, step
        self.bits = tuple(by_number.values())
        self._after = {bit.now: bit.after for bit in self.bits}
        self.start: State = dict.fromkeys(self._steps, False)

    def needed(self, *functions: Function) -> Transition:
        """The transition of the bits on which the functions depend, at a tick or a later one."""
        waiting, bits = list(functions), set[int]()
        while waiting:
            read = {number for number in bdd.support(waiting.pop()) if number in self._steps}
            waiting.extend(self._steps[number] for number in read - bits)
            bits |= read
        kept = Transition(())
        kept._after = {number: self._after[number] for number in self._steps if number in bits}
        kept._steps = {number: self._steps[number] for number in self._steps if number in bits}
        kept.start = dict.fromkeys(kept._steps, False)
        return kept

    @property
    def initial(self) -> Function:
        """The state before the first tick."""
        return bdd.point(self.start)

    def step(self, bit: int) -> Function:
        """The value of a bit after a tick, over a state and a valuation."""
        return self._steps[bit]

    def moved(self, states: Function) -> Function:
        """Function over a state and a valuation: the next state is one of these states."""
        read = [number for number in bdd.support(states) if number in self._steps]
        return bdd.substitute(states, {number: self._steps[number] for number in read}, self._after)

    def relation(self, ticks: Function, letters: Function, known: Function) -> Function:
        """Relation over states and next states.

        Args:
            ticks: the allowed ticks, over a state and a valuation.
            letters: cube of the variables of a valuation.
            known: cube of the variables with known values.
        """
        relation = bdd.at(ticks, known)
        for bit in sorted(self.bits, key=lambda bit: -bit.now):
            step = bdd.at(self._steps[bit.now], known)
            relation = relation & -(bdd.variable(bit.after) ^ step)
        return bdd.exists(relation, letters)

    def moved_from(self, states: Function, known: Function) -> Function:
        """`moved` for a known state, given as a cube: over the other variables of the valuation."""
        read = [number for number in bdd.support(states) if number in self._steps]
        return bdd.substitute(states, {n: bdd.at(self._steps[n], known) for n in read})

    def next(self, known: Function) -> State:
        """The next state of a complete state and valuation, given as a cube."""
        return {number: bdd.at(step, known) == bdd.true() for number, step in self._steps.items()}
