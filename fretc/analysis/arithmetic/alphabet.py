"""An alphabet in which comparisons are as true together as numbers allow, and no other way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import z3

from compiler.formalization.formalized import Formalized
from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.alphabet import BeyondError, Numbers, Tick
from fretc.analysis.arena.counters import Counter
from fretc.analysis.arena.memory import Memory
from fretc.analysis.arena.propositions import Propositions
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arithmetic.cells import (
    Cell,
    Pattern,
    Point,
    cells,
    fixed,
    literals,
    patterns,
    point,
    reads,
)
from fretc.analysis.arithmetic.past import remembered
from fretc.analysis.arithmetic.projection import Limit
from fretc.analysis.arithmetic.terms import Atoms, Term
from fretish.bindings.declarations import Role


class Cells:
    """An `Alphabet`: comparisons by groups, all other atoms as `Propositions` has them.

    Args:
        rules: whose atoms it has.
        roles: of their variables.
        fresh: variables for its bits.
        past: who chooses numbers of the tick before, as far as nothing is remembered of them.
    """

    def __init__(
        self,
        rules: Sequence[Formalized],
        roles: Roles,
        fresh: Numbers,
        past: Role = Role.INPUT,
    ) -> None:
        self._past = past
        self._atoms = Atoms(rules)
        self._memory = remembered(self._atoms)
        self._fresh = fresh
        self._groups: list[_Group] = []
        self._of: dict[str, _Group] = {}
        refused = dict(self._atoms.refused)
        for names in _linked(self._atoms):
            try:
                choice = _choice(names, self._atoms, _owners(names, self._atoms, roles, past))
                group = _Group(choice, self._atoms, fresh)
            except BeyondError as error:
                shown = f"`{names[0]}` and others" if len(names) > 1 else f"`{names[0]}`"
                refused |= dict.fromkeys(names, f"{shown} {error}")
            else:
                self._groups.append(group)
                self._of |= dict.fromkeys(names, group)
        self._plain = Propositions(rules, roles, fresh, frozenset(self._of), refused)

    def atom(self, name: str) -> Function:
        """When an atom is true."""
        group = self._of.get(name)
        return self._plain.atom(name) if group is None else group.atom(name)

    @property
    def numbers(self) -> Atoms:
        """The comparisons, as formulas of z3."""
        return self._atoms

    @property
    def formulas(self) -> Mapping[int, Term]:
        """Each bit that stands for a comparison, and its formula."""
        return {bit: formula for each in self._used for bit, formula in each.formulas()}

    @property
    def inputs(self) -> Sequence[int]:
        """Bits of atoms and of cells."""
        return [*self._plain.inputs, *(bit for each in self._used for bit in each.inputs)]

    @property
    def outputs(self) -> Sequence[int]:
        """Bits of atoms."""
        return [*self._plain.outputs, *(bit for each in self._used for bit in each.outputs)]

    @property
    def legal(self) -> Function:
        """The cells that there are, and the patterns of inputs."""
        found = self._plain.legal
        for each in self._used:
            found = found & each.legal
        return found

    @property
    def reachable(self) -> Function:
        """The patterns that the system can bring about."""
        found = self._plain.reachable
        for each in self._used:
            found = found & each.reachable
        return found

    @property
    def doubts(self) -> Mapping[Role, str]:
        """Those of the atoms that are in no group, and of numbers of the tick before."""
        before = next(iter(self._atoms.before), None)
        if before is None:
            return self._plain.doubts
        why = f"of `{before}` no more is remembered than which comparisons it makes true"
        return {self._past: why, **self._plain.doubts}

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each bit; a bit of a cell has none."""
        return {**self._plain.labels, **{n: a for each in self._used for n, a in each.labels()}}

    @property
    def doubtful(self) -> frozenset[str]:
        """The atoms that these doubts are about."""
        found = self._atoms.found.items()
        looking_back = {name for name, atom in found if atom.reads & self._atoms.before.keys()}
        return self._plain.doubtful | looking_back

    def memory(self) -> Counter | None:
        """What is remembered of numbers of the tick before: whoever chooses them keeps to it."""
        pairs = [each for each in self._memory if each.now in self._of and each.then in self._of]
        if not pairs:
            return None
        known = Memory(self._fresh, {})
        begun = known.keep(bdd.true())
        agrees = bdd.true()
        for pair in pairs:
            was, now = known.keep(self.atom(pair.now)), self.atom(pair.then)
            first = {True: now, False: -now, None: bdd.true()}[pair.first]
            agrees = agrees & bdd.choice(begun, -(was ^ now), first)
        bits = known.needed([agrees])
        steps = tuple(known.steps[bit] for bit in bits)
        return Counter("", bits, steps, agrees, None, (), bdd.true(), bdd.true())

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """The truth of propositions, and numbers that make comparisons true and false so."""
        found = self._plain.values(letter)
        for each in self._used:
            found |= each.values(letter)
        return found

    @property
    def _used(self) -> Iterator[_Group]:
        return (each for each in self._groups if each.is_used)


@dataclass(frozen=True, slots=True)
class _Choice:
    """What a group is made of; two are equal that say the same."""

    text: str
    formulas: tuple[Term, ...] = field(compare=False)
    """Each once, be it the formula of an atom or of its opposite."""
    of: Mapping[str, tuple[int, bool]] = field(compare=False)
    """The formula of each atom, and whether it is that or the opposite."""
    variables: Mapping[Role, tuple[Term, ...]] = field(compare=False)
    """Of each player."""
    domains: Mapping[Role, Term] = field(compare=False)

    @property
    def is_mixed(self) -> bool:
        """Whether both players choose numbers."""
        return all(self.variables.values())

    @property
    def role(self) -> Role:
        """Who chooses the numbers, where one player does; the system, where both do."""
        return Role.OUTPUT if self.variables[Role.OUTPUT] else Role.INPUT


class _Group:
    """Comparisons that share variables; its bits are made when the first of them is asked for."""

    def __init__(self, choice: _Choice, atoms: Atoms, fresh: Numbers) -> None:
        self._choice, self._atoms, self._fresh = choice, atoms, fresh
        found = _sorted_out(choice)
        if isinstance(found, str):
            raise BeyondError(found)
        self._patterns, self._cells = found
        self._bits: dict[int, int] = {}
        """Of the formulas that a cell does not decide."""
        self._cell_bits: list[int] = []
        self._points: dict[tuple[int, Pattern], Point] = {}
        self._in_cell: dict[int, Point] = {}

    @property
    def is_used(self) -> bool:
        """Whether it has bits."""
        return bool(self._bits)

    def atom(self, name: str) -> Function:
        """When one of its atoms is true."""
        if not self._bits:
            size = max(0, len(self._cells) - 1).bit_length()
            self._cell_bits = [next(self._fresh) for _ in range(size)]
            free = [n for n in range(len(self._choice.formulas)) if not self._is_of_cell(n)]
            self._bits = {number: next(self._fresh) for number in free}
        number, is_so = self._choice.of[name]
        found = self._formula(number)
        return found if is_so else -found

    def _is_of_cell(self, number: int) -> bool:
        """Whether a formula reads inputs alone, in a group of both players."""
        outputs = self._choice.variables[Role.OUTPUT]
        return self._choice.is_mixed and not reads(self._choice.formulas[number], outputs)

    def _formula(self, number: int) -> Function:
        if number in self._bits:
            return bdd.variable(self._bits[number])
        found = bdd.false()
        for place, cell in enumerate(self._cells):
            if next(iter(cell.patterns))[number]:  # they agree on what is of inputs
                found = found | self._cell(place)
        return found

    def _cell(self, place: int) -> Function:
        return bdd.point({bit: bool(place >> i & 1) for i, bit in enumerate(self._cell_bits)})

    @property
    def inputs(self) -> Sequence[int]:
        """The bits of the environment."""
        return self._cell_bits if self._choice.role is Role.OUTPUT else [*self._bits.values()]

    @property
    def outputs(self) -> Sequence[int]:
        """The bits of the system."""
        return [*self._bits.values()] if self._choice.role is Role.OUTPUT else []

    @property
    def legal(self) -> Function:
        """The cells that there are, or the patterns of inputs."""
        if self._choice.role is Role.INPUT:
            return self._some_of(self._patterns)
        found = bdd.false() if self._cells else bdd.true()
        for place in range(len(self._cells)):
            found = found | self._cell(place)
        return found

    @property
    def reachable(self) -> Function:
        """The patterns of outputs, in each cell those that it leaves."""
        if self._choice.role is Role.INPUT:
            return bdd.true()
        if not self._cells:
            return self._some_of(self._patterns)
        found = bdd.false()
        for place, cell in enumerate(self._cells):
            found = found | (self._cell(place) & self._some_of(cell.patterns))
        return found

    def _some_of(self, known: Iterable[Pattern]) -> Function:
        found = bdd.false()
        for pattern in known:
            found = found | bdd.point({bit: pattern[n] for n, bit in self._bits.items()})
        return found

    def formulas(self) -> Iterator[tuple[int, Term]]:
        """Each bit of a formula, and that."""
        return ((bit, self._choice.formulas[number]) for number, bit in self._bits.items())

    def labels(self) -> Iterator[tuple[int, str]]:
        """Each bit of a formula, and an atom that has it."""
        for name, (number, is_so) in self._choice.of.items():
            if is_so and number in self._bits:
                yield self._bits[number], name

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Numbers of a letter; those of inputs depend on nothing that the system does."""
        if not all(bit in letter for bit in self._cell_bits):
            return {}
        place = sum(letter[bit] << i for i, bit in enumerate(self._cell_bits))
        if not all(bit in letter for bit in self._bits.values()):
            return self._shown(self._of_cell(place)) if self._cells else {}
        key = place, tuple(letter[bit] for bit in self._bits.values())
        if key not in self._points:
            self._points[key] = self._point(place, key[1])
        return self._shown(self._points[key])

    def _of_cell(self, place: int) -> Point:
        if place not in self._in_cell:
            inputs = self._choice.variables[Role.INPUT]
            self._in_cell[place] = point([self._cells[place].region], inputs)
        return self._in_cell[place]

    def _point(self, place: int, signs: Pattern) -> Point:
        formulas = [self._choice.formulas[number] for number in self._bits]
        kept = [*literals(formulas, signs), *self._choice.domains.values()]
        inputs, outputs = (self._choice.variables[role] for role in (Role.INPUT, Role.OUTPUT))
        if not self._cells:
            return point(kept, [*inputs, *outputs])
        of_inputs = self._of_cell(place)
        return of_inputs | point([*kept, *fixed(of_inputs, inputs)], outputs)

    def _shown(self, numbers: Point) -> Tick:
        return {name: self._atoms.shown(name, value) for name, value in numbers.items()}


# Groups -----------------------------------------------------------------------------------------


def _linked(atoms: Atoms) -> list[tuple[str, ...]]:
    """The names of atoms that share variables, directly or by way of others."""
    groups: list[tuple[list[str], set[str]]] = []
    for name, atom in atoms.found.items():
        touched = [group for group in groups if group[1] & atom.reads]
        groups = [group for group in groups if group not in touched]
        names = [each for group in touched for each in group[0]]
        groups.append(([*names, name], set(atom.reads).union(*(group[1] for group in touched))))
    return [tuple(names) for names, _ in groups]


def _owners(names: Sequence[str], atoms: Atoms, roles: Roles, past: Role) -> Mapping[str, Role]:
    """Who chooses each variable of a group: a signal without a role has that of its proposition."""
    found: dict[str, Role] = {}
    for name in names:
        for read in sorted(atoms.found[name].reads):
            role = past if read in atoms.before else roles.get(read) or roles[name]
            if found.setdefault(read, role) is not role:
                raise BeyondError(f"read `{read}`, which is not of one role")
    return found


def _choice(names: Sequence[str], atoms: Atoms, owners: Mapping[str, Role]) -> _Choice:
    formulas: list[Term] = []
    of: dict[str, tuple[int, bool]] = {}
    for name in names:
        formula = atoms.found[name].formula
        number = next((n for n, f in enumerate(formulas) if _bare(f).eq(_bare(formula))), None)
        if number is None:
            number = len(formulas)
            formulas.append(formula)
        of[name] = number, formulas[number].eq(formula)
    players = (Role.INPUT, Role.OUTPUT)
    theirs = {role: sorted(n for n in owners if owners[n] is role) for role in players}
    variables = {r: tuple(atoms.variables[name] for name in theirs[r]) for r in players}
    domains = {r: z3.And([atoms.domain(name) for name in theirs[r]]) for r in players}
    terms = [*formulas, *domains.values()]
    sorts = [f"{each}: {each.sort()}, {role}" for role in players for each in variables[role]]
    text = "\n".join([*(term.sexpr() for term in terms), *sorts])
    return _Choice(text, tuple(formulas), of, variables, domains)


@lru_cache(maxsize=64)
def _sorted_out(choice: _Choice) -> tuple[Sequence[Pattern], Sequence[Cell]] | str:
    """The patterns of a group, and its cells where both players choose; or why it has none.

    Every question about the same requirements asks for them.
    """
    limit = Limit()
    try:
        known = patterns(choice.formulas, z3.And(list(choice.domains.values())), limit)
        if not choice.is_mixed:
            return known, ()
        outputs = choice.variables[Role.OUTPUT]
        domains = choice.domains[Role.INPUT], choice.domains[Role.OUTPUT]
        return known, cells(choice.formulas, known, outputs, domains, limit)
    except BeyondError as error:
        return str(error)


def _bare(formula: Term) -> Term:
    """The same of a formula and of its opposite."""
    return formula.arg(0) if z3.is_not(formula) else formula
