"""An alphabet with a bit for each comparison; z3 decides which of them are true together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.numbers.terms import Term
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.propositions import Propositions
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import Numbers
from fretc.analysis.arithmetic.atoms import Atoms


class SeparateComparisons(Propositions):
    """An `Alphabet` of requirements without inputs, whose comparisons are not solved beforehand.

    Its functions have no constraints between comparisons: who uses it adds `formulas` to a solver.

    Args:
        requirements: requirements with the atoms.
        roles: roles of their variables, none of them an input.
        fresh: variables for the bits.
    """

    def __init__(
        self, requirements: Sequence[FormalizedRequirement], roles: Roles, fresh: Numbers
    ) -> None:
        self.numbers = Atoms(requirements)
        """The comparisons, as formulas of z3."""
        self._bits: dict[str, int] = {}
        self._names: dict[int, str] = {}
        self.formulas: dict[int, Term] = {}
        """Each bit that stands for a comparison, and its formula."""
        refused = dict(self.numbers.refused)
        super().__init__(requirements, roles, fresh, frozenset(self.numbers.found), refused)

    def atom(self, name: str) -> Function:
        """The bit of an atom, or a constant."""
        atom = self.numbers.found.get(name)
        if atom is None:
            return super().atom(name)
        is_negated = z3.is_not(atom.formula)
        formula = atom.formula.arg(0) if is_negated else atom.formula
        if z3.is_true(formula) or z3.is_false(formula):
            return bdd.true() if z3.is_true(formula) is not is_negated else bdd.false()
        text = formula.sexpr()
        if text not in self._bits:
            self._bits[text] = next(self._fresh)
            self.formulas[self._bits[text]] = formula
        if not is_negated:
            self._names.setdefault(self._bits[text], name)
        bit = bdd.variable(self._bits[text])
        return -bit if is_negated else bit

    @property
    def outputs(self) -> Sequence[int]:
        """The bits of propositions and of comparisons."""
        return [*super().outputs, *self.formulas]

    @property
    def free(self) -> Sequence[int]:
        """The bits of propositions."""
        return super().outputs

    @property
    def labels(self) -> Mapping[int, str]:
        """An atom of each bit."""
        return {**super().labels, **self._names}

    def shown(self, letter: Mapping[int, bool]) -> Mapping[str, bool]:
        """Proposition → its value, also if numbers decide it."""
        known = bdd.point(letter)
        names = (name for name in self.numbers.found if self.numbers.is_proposition(name))
        decided = {name: bdd.at(self.atom(name), known) == bdd.true() for name in names}
        return {**self.values(letter), **decided}
