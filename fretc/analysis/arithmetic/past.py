"""Numbers of the previous tick: one player chooses them, within the stored facts.

The stored facts about a number are the truth values of its comparisons. If the environment chooses
any number with these truth values and the system wins, the system also wins with the real number;
the converse holds for the other player. So two games give one certain answer each; between them the
result is unknown.
"""

from __future__ import annotations

from math import ceil, floor

import z3

from compiler.formalization.numbers.terms import PreviousValue, Term, read_by
from fretc.analysis.arithmetic.atoms import Atoms, NumericAtom
from fretc.analysis.arithmetic.steps import AtomOfTick
from fretc.analysis.arithmetic.thresholds import Bound, reached
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Remembered:
    """Names of a comparison of a number, and of that comparison for the previous tick."""

    now: str
    then: str
    first: bool | None
    """Value of the second comparison at the first tick; None: it depends."""


def remembered(atoms: Atoms, steps: int) -> tuple[Remembered, ...]:
    """Stored comparisons; missing atoms are added.

    Args:
        atoms: atoms of some requirements.
        steps: number of ticks before a bound for which its reachability is stored.
    """
    found: list[Remembered] = []
    for name, before in atoms.before.items():
        for condition in _conditions(atoms, name, before, steps):
            found.append(_remembered(atoms, name, before, condition))
    return tuple(found)


def _conditions(atoms: Atoms, name: str, before: PreviousValue, steps: int) -> list[Term]:
    """Formulas of the tick that compare the number alone; one compares with the first value."""
    now, then = atoms.variables[before.of], atoms.variables[name]
    conditions: dict[str, Term] = {}
    if not read_by(before.first):
        as_at_first = z3.simplify(now == before.first)
        conditions[as_at_first.sexpr()] = as_at_first
    for atom in atoms.found.values():
        if atom.reads == {before.of}:
            conditions.setdefault(atom.formula.sexpr(), atom.formula)
        elif atom.reads == {name}:
            formula = z3.simplify(z3.substitute(atom.formula, (then, now)))
            conditions.setdefault(formula.sexpr(), formula)
    if steps:
        formulas = [atom.formula for atom in atoms.found.values()]
        for bound in reached(now, then, [*formulas, *conditions.values()], steps):
            formula = _compared(now, bound)
            conditions.setdefault(formula.sexpr(), formula)
    return list(conditions.values())


def _compared(variable: Term, bound: Bound) -> Term:
    """Formula: a variable is below a bound, or at most that."""
    if not variable.is_int():
        number = z3.RealVal(str(bound.number))
        return z3.simplify(variable < number if bound.is_below else variable <= number)
    least = ceil(bound.number) - 1 if bound.is_below else floor(bound.number)
    return z3.simplify(variable <= least)


def _remembered(atoms: Atoms, name: str, before: PreviousValue, condition: Term) -> Remembered:
    now, then = atoms.variables[before.of], atoms.variables[name]
    of_then = z3.simplify(z3.substitute(condition, (now, then)))
    at_first = z3.simplify(z3.substitute(condition, (now, before.first)))
    is_known = z3.is_true(at_first) or z3.is_false(at_first)
    first = z3.is_true(at_first) if is_known else None
    return Remembered(_named(atoms, condition), _named(atoms, of_then), first)


def _named(atoms: Atoms, formula: Term) -> str:
    """Name of the atom of a formula."""
    same = (name for name, atom in atoms.found.items() if atom.formula.eq(formula))
    found = next(same, None)
    if found is None:
        found = formula.sexpr()
        atoms.found[found] = NumericAtom(AtomOfTick(formula, z3.BoolVal(True)), read_by(formula))
    return found
