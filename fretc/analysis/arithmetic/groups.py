"""Groups of comparisons that share variables, and their bits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import z3

from compiler.formalization.numbers.terms import Term
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.cells import (
    Cell,
    Pattern,
    Point,
    another,
    cells,
    fixed,
    literals,
    patterns,
    point,
    reads,
)
from fretc.analysis.arithmetic.projection import Limit
from fretish.bindings.declarations import Role


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


class Group:
    """Comparisons that share variables; bits are created when the first of them is asked for."""

    def __init__(
        self, choice: GroupContent, atoms: Atoms, fresh: Numbers, favoured: Role, limit: Limit
    ) -> None:
        """A group of comparisons.

        Args:
            choice: content of the group.
            atoms: atoms of the content.
            fresh: variables for its bits.
            favoured: player who decides which signals are unknown.
            limit: time limit for solving the group.

        Raises:
            UnsupportedError: it has too many patterns, or takes too long.
        """
        self._choice, self._atoms, self._fresh = choice, atoms, fresh
        found = _sorted_out(choice, limit)
        self._patterns, self._cells, self._open = found.patterns, found.cells, found.open
        self._is_favoured = choice.role is favoured
        self._bits: dict[int, int] = {}
        """Bits of the formulas that a cell does not decide."""
        self._cell_bits: list[int] = []
        self._points: dict[tuple[int, Pattern], Point] = {}
        self._in_cell: dict[int, Point] = {}

    @property
    def open(self) -> str | None:
        """What is unknown about the group; None: nothing that matters."""
        if not self._open:
            return None
        signals = dict.fromkeys(self._atoms.of(str(flag)) for flag in self._choice.flags)
        shown = " and ".join(f"`{each}`" for each in signals)
        return f"it is not declared when {shown} may be unknown"

    @property
    def is_used(self) -> bool:
        """Whether it has bits."""
        return bool(self._bits)

    def atom(self, name: str) -> Function:
        """Function of one of its atoms."""
        if not self._bits:
            size = max(0, len(self._cells) - 1).bit_length()
            self._cell_bits = [next(self._fresh) for _ in range(size)]
            free = [n for n in range(len(self._choice.formulas)) if not self._is_of_cell(n)]
            self._bits = {number: next(self._fresh) for number in free}
        number, is_so = self._choice.of[name]
        found = self._formula(number)
        return found if is_so else -found

    def _is_of_cell(self, number: int) -> bool:
        """Whether a formula reads only inputs, in a group of both players."""
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
        """Possible cells, or input patterns."""
        if self._choice.role is Role.INPUT:
            return self._of_player()
        found = bdd.false() if self._cells else bdd.true()
        for place in range(len(self._cells)):
            found = found | self._cell(place)
        return found

    @property
    def reachable(self) -> Function:
        """Output patterns, in each cell those that the inputs leave."""
        if self._choice.role is Role.INPUT:
            return bdd.true()
        if not self._cells:
            return self._of_player()
        found = bdd.false()
        for place, cell in enumerate(self._cells):
            found = found | (self._cell(place) & self._some_of(cell.patterns))
        return found

    def _of_player(self) -> Function:
        """Patterns of the player who chooses the numbers."""
        return self.possible if self._is_favoured else self.known

    @property
    def known(self) -> Function:
        """Patterns without unknown values."""
        return self.legal & self.reachable if self._cells else self._some_of(self._patterns)

    @property
    def possible(self) -> Function:
        """All possible patterns."""
        return self.known | self._some_of(self._open)

    def _some_of(self, known: Iterable[Pattern]) -> Function:
        found = bdd.false()
        for pattern in known:
            found = found | bdd.point({bit: pattern[n] for n, bit in self._bits.items()})
        return found

    def formulas(self) -> Iterator[tuple[int, Term]]:
        """Bit → its formula."""
        return ((bit, self._choice.formulas[number]) for number, bit in self._bits.items())

    def labels(self) -> Iterator[tuple[int, str]]:
        """Bit of a formula → an atom of a sentence with this formula."""
        for name, (number, is_so) in self._choice.of.items():
            if is_so and number in self._bits and self._atoms.found[name].names:
                yield self._bits[number], name

    @property
    def names(self) -> frozenset[str]:
        """Names of its variables."""
        return frozenset(str(each) for some in self._choice.variables.values() for each in some)

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Numbers for a valuation; numbers of inputs do not depend on the system."""
        place = self._place(letter)
        if place is None:
            return {}
        if not all(bit in letter for bit in self._bits.values()):
            return self._atoms.tick(self._of_cell(place)) if self._cells else {}
        key = place, self._signs(letter)
        if key not in self._points:
            self._points[key] = self._point(*key)
        return self._atoms.tick(self._points[key])

    def numbers(self, letter: Mapping[int, bool], given: Sequence[Term]) -> Point:
        """Numbers for a complete valuation; `given` are constraints that some numbers satisfy."""
        place = self._place(letter)
        assert place is not None, "the letter is whole"
        return self._point(place, self._signs(letter), given)

    def left(self, inputs: Mapping[int, bool], given: Sequence[Term], limit: Limit) -> Function:
        """Function over outputs: the patterns of numbers that satisfy the constraints."""
        choice, place = self._choice, self._place(inputs)
        assert place is not None, "the inputs are whole"
        if choice.role is Role.INPUT:
            return bdd.true()
        free = [choice.formulas[number] for number in self._bits]
        domain = z3.And(*choice.domains.values(), *given, *self._chosen(place))
        found = bdd.false()
        for pattern in patterns(free, domain, limit):
            found = found | bdd.point(dict(zip(self._bits.values(), pattern, strict=True)))
        return found

    def _place(self, letter: Mapping[int, bool]) -> int | None:
        """Index of the cell; 0 without cells; None: the valuation does not determine it."""
        if not all(bit in letter for bit in self._cell_bits):
            return None
        return sum(letter[bit] << i for i, bit in enumerate(self._cell_bits))

    def _signs(self, letter: Mapping[int, bool]) -> Pattern:
        return tuple(letter[bit] for bit in self._bits.values())

    def _of_cell(self, place: int) -> Point:
        if place not in self._in_cell:
            inputs = self._choice.variables[Role.INPUT]
            self._in_cell[place] = point([self._cells[place].region], inputs)
        return self._in_cell[place]

    def _chosen(self, place: int) -> list[Term]:
        """Numbers that the environment chooses in a cell."""
        if not self._cells:
            return []
        return fixed(self._of_cell(place), self._choice.variables[Role.INPUT])

    def _point(self, place: int, signs: Pattern, given: Sequence[Term] = ()) -> Point:
        formulas = [self._choice.formulas[number] for number in self._bits]
        kept = [*literals(formulas, signs), *self._choice.domains.values(), *given]
        if signs not in self._open:
            kept += [z3.Not(flag) for flag in self._choice.flags]
        inputs, outputs = (self._choice.variables[role] for role in (Role.INPUT, Role.OUTPUT))
        if not self._cells:
            return point(kept, [*inputs, *outputs])
        return self._of_cell(place) | point([*kept, *self._chosen(place)], outputs)


# Groups -----------------------------------------------------------------------------------------


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
    found: dict[int, Term] = {}
    links: list[Term] = []
    for name, tick in ticks.items():
        number, is_so = of[name]
        formula = tick.formula if tick.carried is None else tick.carried
        found[number] = formula if is_so else z3.Not(formula)
        links.extend([] if tick.links is None else [tick.links])
    return (*(found[number] for number in sorted(found)), z3.And(links))


@dataclass(frozen=True, slots=True)
class _Sorted:
    """Possible patterns of a group."""

    patterns: Sequence[Pattern]
    cells: Sequence[Cell] = ()
    """Cells, if both players choose its numbers."""
    open: Sequence[Pattern] = ()
    """Patterns that exist only if something is unknown."""


_SORTED: dict[str, _Sorted | str] = {}
"""Cache of solved groups by content, because every question about the requirements needs them.
Timeouts of a question are not cached."""
_MOST_SORTED = 64


def _sorted_out(choice: GroupContent, limit: Limit) -> _Sorted:
    """The patterns of a group, and its cells if both players choose.

    Raises:
        UnsupportedError: there are too many, or it takes too long.
        OutOfTimeError: the time of the question is over.
    """
    if choice.text not in _SORTED:
        if len(_SORTED) >= _MOST_SORTED:
            _SORTED.clear()
        try:
            _SORTED[choice.text] = _found(choice, limit)
        except UnsupportedError as error:
            _SORTED[choice.text] = str(error)
    found = _SORTED[choice.text]
    if isinstance(found, str):
        raise UnsupportedError(found)
    return found


def _found(choice: GroupContent, limit: Limit) -> _Sorted:
    domain = z3.And(list(choice.domains.values()))
    certain = z3.And(domain, *(z3.Not(flag) for flag in choice.flags))
    known = patterns(choice.formulas, certain, limit)
    if choice.is_mixed:
        outputs = choice.variables[Role.OUTPUT]
        domains = choice.domains[Role.INPUT], choice.domains[Role.OUTPUT]
        return _Sorted(known, cells(choice.formulas, known, outputs, domains, limit))
    if choice.carried:
        *formulas, links = choice.carried
        if another(formulas, known, z3.And(domain, links), limit):
            raise UnsupportedError("share only some samples")
    if not choice.flags:
        return _Sorted(known)
    every = patterns(choice.formulas, domain, limit)
    return _Sorted(known, open=[each for each in every if each not in set(known)])


def _bare(formula: Term) -> Term:
    """Formula without its negation, and whether it was negated."""
    return formula.arg(0) if z3.is_not(formula) else formula
