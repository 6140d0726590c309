"""The content of a group of comparisons: its formulas, and the variables of each player."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import z3

from compiler.formalization.numbers.terms import Term
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.arithmetic.atoms import Atoms
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class GroupContent:
    """Content of a group; equal contents are equal values."""

    text: str
    formulas: tuple[Term, ...] = field(compare=False)
    """Formulas without duplicates; a formula also represents its negation."""
    of: Mapping[str, tuple[int, bool]] = field(compare=False)
    """Atom → index of its formula, and whether it is the formula or its negation."""
    variables: Mapping[Role, tuple[Term, ...]] = field(compare=False)
    """Variables of each player."""
    domains: Mapping[Role, Term] = field(compare=False)
    flags: tuple[Term, ...] = field(compare=False)
    """Flags for unknown signals."""
    carried: tuple[Term, ...] = field(compare=False)
    """Formulas for signals without a new sample, and their constraints; empty: no difference."""

    @property
    def is_mixed(self) -> bool:
        """Whether both players choose numbers."""
        return all(self.variables.values())

    @property
    def role(self) -> Role:
        """The player who chooses the numbers; the system, if both do."""
        return Role.OUTPUT if self.variables[Role.OUTPUT] else Role.INPUT


def linked(atoms: Atoms) -> list[tuple[str, ...]]:
    """Names of atoms that share variables, directly or indirectly."""
    groups: list[tuple[list[str], set[str]]] = []
    for name, atom in atoms.found.items():
        if not atom.reads:
            continue
        touched = [group for group in groups if group[1] & atom.reads]
        groups = [group for group in groups if group not in touched]
        names = [each for group in touched for each in group[0]]
        groups.append(([*names, name], set(atom.reads).union(*(group[1] for group in touched))))
    return [tuple(names) for names, _ in groups]


def owners(names: Sequence[str], atoms: Atoms, roles: Roles, past: Role) -> Mapping[str, Role]:
    """Player of each variable of a group; a signal without a role has that of its proposition.

    Raises:
        UnsupportedError: a variable has two roles.
    """
    found: dict[str, Role] = {}
    for name in names:
        atom = atoms.found[name]
        theirs = {roles[each] for each in atom.names}
        own = theirs.pop() if len(theirs) == 1 else None
        for read in sorted(atom.reads):
            of = atoms.of(read)
            role = past if of in atoms.before else roles.get(of) or own
            if role is None or found.setdefault(read, role) is not role:
                raise UnsupportedError(f"read `{of}`, which has no single role")
    return found


def choice(names: Sequence[str], atoms: Atoms, owners: Mapping[str, Role]) -> GroupContent:
    """Content of a group.

    Raises:
        UnsupportedError: both players choose its numbers, and it needs a feature for one player
            only.
    """
    names = sorted(names, key=atoms.is_part, reverse=True)  # what users wrote names the bits
    formulas: list[Term] = []
    numbers: dict[int, int] = {}  # equal terms have equal ids
    of: dict[str, tuple[int, bool]] = {}
    for name in names:
        formula = atoms.found[name].formula
        number = numbers.setdefault(_bare(formula).get_id(), len(formulas))
        if number == len(formulas):
            formulas.append(formula)
        of[name] = number, formulas[number].eq(formula)
    players = (Role.INPUT, Role.OUTPUT)
    theirs = {role: sorted(n for n in owners if owners[n] is role) for role in players}
    variables = {r: tuple(atoms.variables[name] for name in theirs[r]) for r in players}
    flags = tuple(each for r in players for each in variables[r] if z3.is_bool(each))
    given = [atoms.found[name].over.given for name in names]
    domains = {r: z3.And([atoms.domain(name) for name in theirs[r]]) for r in players}
    carried = _carried(names, of, atoms)
    if all(variables.values()) and (flags or carried):
        raise UnsupportedError("compare numbers of the environment and the system sample by sample")
    only = Role.OUTPUT if variables[Role.OUTPUT] else Role.INPUT
    domains[only] = z3.simplify(z3.And(domains[only], *given))
    terms = [*formulas, *domains.values(), *flags, *carried]
    sorts = [f"{each}: {each.sort()}, {role}" for role in players for each in variables[role]]
    text = "\n".join([*(term.sexpr() for term in terms), *sorts])
    return GroupContent(text, tuple(formulas), of, variables, domains, flags, carried)


def _carried(
    names: Sequence[str], of: Mapping[str, tuple[int, bool]], atoms: Atoms
) -> tuple[Term, ...]:
    """Formulas for signals without a new sample, then their constraints."""
    ticks = {name: atoms.found[name].over for name in names}
    if all(each.carried is None for each in ticks.values()):
        return ()
    terms: dict[int, Term] = {}
    links: list[Term] = []
    for name, tick in ticks.items():
        number, is_so = of[name]
        formula = tick.formula if tick.carried is None else tick.carried
        terms[number] = formula if is_so else z3.Not(formula)
        links.extend([] if tick.links is None else [tick.links])
    return (*(terms[number] for number in sorted(terms)), z3.And(links))


def _bare(formula: Term) -> Term:
    """Formula without its negation."""
    return formula.arg(0) if z3.is_not(formula) else formula
