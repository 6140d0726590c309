"""Numbers of the tick before: one player chooses them, and keeps to what is remembered.

What is remembered of a number is which comparisons it makes true. Where the environment chooses any
number of which these are true, and the system wins, it wins with the one that it was, too. Where
the system chooses, and the environment wins, it wins with the one that it was. So there are two
games, each with one certain answer; between them nothing is known.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor

import z3

from compiler.formalization.numbers.terms import PreviousValue, Term, read_by
from fretc.analysis.arithmetic.atoms import Atom, Atoms
from fretc.analysis.arithmetic.steps import AtomOfTick
from fretc.analysis.arithmetic.thresholds import Bound, reached


@dataclass(frozen=True, slots=True)
class Remembered:
    """A comparison of a number, and the same of that number at the tick before, by their names."""

    now: str
    then: str
    first: bool | None
    """Whether the second one is true at the first tick; None: that depends."""


def remembered(atoms: Atoms, steps: int) -> tuple[Remembered, ...]:
    """What is remembered; atoms that it lacks are added.

    Args:
        atoms: of some requirements.
        steps: from how many ticks before a bound it is remembered whether it is within reach.
    """
    found: list[Remembered] = []
    for name, before in atoms.before.items():
        for condition in _conditions(atoms, name, before, steps):
            found.append(_remembered(atoms, name, before, condition))
    return tuple(found)


def _conditions(atoms: Atoms, name: str, before: PreviousValue, steps: int) -> list[Term]:
    """Comparisons of the number alone, as formulas of the tick; one says that it is as at first."""
    now, then = atoms.variables[before.of], atoms.variables[name]
    found: dict[str, Term] = {}
    if not read_by(before.first):
        as_at_first = z3.simplify(now == before.first)
        found[as_at_first.sexpr()] = as_at_first
    for atom in atoms.found.values():
        if atom.reads == {before.of}:
            found.setdefault(atom.formula.sexpr(), atom.formula)
        elif atom.reads == {name}:
            formula = z3.simplify(z3.substitute(atom.formula, (then, now)))
            found.setdefault(formula.sexpr(), formula)
    if steps:
        formulas = [atom.formula for atom in atoms.found.values()]
        for bound in reached(now, then, [*formulas, *found.values()], steps):
            formula = _compared(now, bound)
            found.setdefault(formula.sexpr(), formula)
    return list(found.values())


def _compared(variable: Term, bound: Bound) -> Term:
    """Whether a variable is below a bound, or at most that."""
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
    """The name of the atom of a formula."""
    same = (name for name, atom in atoms.found.items() if atom.formula.eq(formula))
    found = next(same, None)
    if found is None:
        found = formula.sexpr()
        atoms.found[found] = Atom(AtomOfTick(formula, z3.BoolVal(True)), read_by(formula))
    return found
