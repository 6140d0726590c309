"""Numbers of a run, tick by tick, where each tick depends on the previous one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.formalization.numbers.terms import Term
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.cells import Point, fixed
from fretc.analysis.arithmetic.groups import ComparisonGroup
from fretc.analysis.arithmetic.projection import Limit


class SolvedNumericTrace:
    """Implementation of `NumericTrace`."""

    def __init__(self, groups: Sequence[ComparisonGroup], atoms: Atoms, budget: Budget) -> None:
        """A run before its first tick.

        Args:
            groups: groups with bits.
            atoms: atoms of the groups.
            budget: time limit for choosing numbers.
        """
        self._groups, self._atoms, self._budget = groups, atoms, budget
        self._numbers: Point | None = None
        self.ticks: list[Tick] = []

    @property
    def last(self) -> tuple[object, ...]:
        """Numbers of the last tick, which the next tick reads."""
        names = (before.of for before in self._atoms.before.values())
        return () if self._numbers is None else tuple(self._numbers[name] for name in names)

    def possible(self, inputs: Mapping[int, bool]) -> Function:
        """Function over outputs: the valuations that are possible at the next tick."""
        function = bdd.true()
        for group in self._groups:
            before = self._before(group)
            if before:
                function = function & group.left(inputs, before, Limit(self._budget))
        return function

    def follow(self, letter: Mapping[int, bool]) -> None:
        """Choose numbers for the next tick."""
        numbers: Point = {}
        for group in self._groups:
            numbers |= group.numbers(letter, self._before(group))
        self._numbers = numbers
        self.ticks.append(self._atoms.tick(numbers))

    def _before(self, group: ComparisonGroup) -> list[Term]:
        """Values of the previous tick that a group reads."""
        terms: list[Term] = []
        for name, before in self._atoms.before.items():
            if name not in group.names:
                continue
            variable = self._atoms.variables[name]
            if self._numbers is None:
                terms.append(variable == before.first)
            else:
                terms += fixed({name: self._numbers[before.of]}, [variable])
        return terms
