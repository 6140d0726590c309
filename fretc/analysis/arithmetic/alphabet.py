"""An alphabet whose truth patterns of comparisons are exactly those that numbers allow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.numbers.terms import Term, read_by
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import Memory, RequirementCounter
from fretc.analysis.arena.propositions import Propositions
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.course import SolvedNumericTrace
from fretc.analysis.arithmetic.durations import DurationValue, StoredDuration, held
from fretc.analysis.arithmetic.group_content import choice, linked, owners
from fretc.analysis.arithmetic.groups import ComparisonGroup
from fretc.analysis.arithmetic.past import Remembered, remembered
from fretc.analysis.arithmetic.projection import Limit
from fretish.bindings.declarations import Role


class Cells:
    """An `Alphabet` with comparisons in groups, and all other atoms as in `Propositions`.

    Args:
        requirements: requirements with the atoms.
        roles: roles of their variables.
        fresh: variables for the bits.
        favoured: player who chooses unknown values: numbers of the previous tick as far as nothing
            is stored about them, whether a signal is unknown, and values before the first tick.
        budget: time limit for solving the comparisons.
        steps: number of ticks before a bound for which its reachability is stored.
        of_moments: whether propositions over several samples are left to `Propositions`.
        functions: whether a term over inputs that is not linear may have any value, which the
            favoured player chooses, and whether the first tick has atoms of its own where a number
            begins with outputs of that tick.

    Raises:
        OutOfTimeError: the budget is exceeded.
    """

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        roles: Roles,
        fresh: Numbers,
        favoured: Role,
        budget: Budget,
        steps: int = 0,
        *,
        of_moments: bool = False,
        functions: bool = False,
    ) -> None:
        self._favoured, self._roles, self._functions = favoured, roles, functions
        given = [name for name, role in roles.items() if role is Role.INPUT] if functions else ()
        self._atoms = Atoms(requirements, of_moments=of_moments, given=given)
        self._at_first = self._atoms.begin_apart(self._begun_by_outputs)
        self._pairs = remembered(self._atoms, steps)
        self._fresh = fresh
        self._kept = Memory(fresh, {})
        self._groups: list[ComparisonGroup] = []
        self._of: dict[str, ComparisonGroup] = {}
        self._lasted: dict[StoredDuration, DurationValue] = {}
        self._asked: dict[str, Function] = {}
        self._free: list[int] = []
        """Bits of the favoured player: whether a duration has lasted since before the run."""
        refused = dict(self._atoms.refused)
        for names in linked(self._atoms):
            budget.check()
            try:
                chosen = choice(names, self._atoms, owners(names, self._atoms, roles, favoured))
                group = ComparisonGroup(chosen, self._atoms, fresh, favoured, Limit(budget))
            except UnsupportedError as error:
                shown = f"`{names[0]}` and others" if len(names) > 1 else f"`{names[0]}`"
                refused |= dict.fromkeys(names, f"{shown} {error}")
            else:
                self._groups.append(group)
                self._of |= dict.fromkeys(names, group)
        self._lasting = {
            name: lasting
            for name, lasting in self._atoms.lasting.items()
            if not any(atom in refused for atom in lasting.atoms)
        }
        for name in self._atoms.lasting.keys() - self._lasting.keys():
            parts = self._atoms.lasting[name].atoms
            refused[name] = next(refused[part] for part in parts if part in refused)
        elsewhere = frozenset([*self._of, *self._lasting])
        self._plain = Propositions(requirements, roles, fresh, elsewhere, refused)

    def atom(self, name: str) -> Function:
        """Function of an atom, also over `memory` if it depends on earlier ticks."""
        if name not in self._asked:
            self._asked[name] = self._atom(name)
        return self._asked[name]

    def _atom(self, name: str) -> Function:
        if name in self._lasting:
            return self._in_time(name)
        atom = self._atoms.found.get(name)
        if atom is not None and (z3.is_true(atom.formula) or z3.is_false(atom.formula)):
            return bdd.true() if z3.is_true(atom.formula) else bdd.false()
        group = self._of.get(name)
        value = self._plain.atom(name) if group is None else group.atom(name)
        if name not in self._at_first:
            return value
        return bdd.ite(self._begun, value, self._atom(self._at_first[name]))

    @property
    def _begun(self) -> Function:
        """Whether the first tick is over."""
        return self._kept.keep(bdd.true())

    def _in_time(self, name: str) -> Function:
        """Function of a proposition that depends on earlier ticks, also over their memory."""
        lasting = self._lasting[name]
        lasted = [self._lasted_so(each) for each in lasting.durations]
        function = bdd.false()
        for values, case in lasting.cases.items():
            term = self.atom(case)
            for value, each in zip(values, lasted, strict=True):
                term = term & (each.is_so if value else -each.is_so)
            function = function | term
        return function

    def _lasted_so(self, duration: StoredDuration) -> DurationValue:
        if duration not in self._lasted:
            throughout, at_last = self.atom(duration.throughout), self.atom(duration.at_last)
            self._free.append(next(self._fresh))
            open_ = bdd.variable(self._free[-1])
            held_ = held(self._kept, duration.ticks, throughout, at_last, open_)
            self._lasted[duration] = held_
        return self._lasted[duration]

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
        of_groups = (bit for each in self._used for bit in each.inputs)
        return [*self._plain.inputs, *of_groups, *self._free_of(Role.INPUT)]

    @property
    def outputs(self) -> Sequence[int]:
        """Bits of atoms."""
        of_groups = (bit for each in self._used for bit in each.outputs)
        return [*self._plain.outputs, *of_groups, *self._free_of(Role.OUTPUT)]

    def _free_of(self, role: Role) -> Sequence[int]:
        return self._free if self._favoured is role else []

    @property
    def legal(self) -> Function:
        """Possible cells, and input patterns."""
        function = self._plain.legal
        for each in self._used:
            function = function & each.legal
        return function

    @property
    def reachable(self) -> Function:
        """Patterns that the system can choose."""
        function = self._plain.reachable
        for each in self._used:
            function = function & each.reachable
        return function

    @property
    def possible(self) -> Function:
        """All patterns."""
        function = self._plain.possible
        for each in self._used:
            function = function & each.possible
        return function

    @property
    def certain(self) -> Function:
        """Patterns without unknown values; patterns of earlier numbers are never certain."""
        if self._atoms.before or self._atoms.free:
            return bdd.false()
        function = self._plain.certain
        for each in self._used:
            function = function & each.known
        for lasted in self._lasted.values():
            function = function - lasted.is_open
        return function

    @property
    def is_refinable(self) -> bool:
        """Whether comparisons read a number of the previous tick."""
        return bool(self._atoms.before)

    @property
    def not_computed(self) -> frozenset[str]:
        """Atoms with a term that is not linear."""
        atoms = self._atoms.found.items()
        return frozenset(
            name for name, atom in atoms if not atom.reads.isdisjoint(self._atoms.free)
        )

    @property
    def open(self) -> str | None:
        """What the favoured player chooses although no player does; None: nothing."""
        before = next(iter(self._atoms.before), None)
        if before is not None:
            return f"of the previous value `{before}` only the truth of its comparisons is kept"
        free = min(self._atoms.free, default=None)
        if free is not None:
            return f"`{free}` is not computed, and may have any value"
        unknown = next((why for each in self._used if (why := each.open) is not None), None)
        if unknown is not None:
            return unknown
        first = next(iter(self._lasting), None)
        if first is not None:
            return f"the value of `{first}` before the first tick is unknown"
        return None

    @property
    def is_approximate(self) -> bool:
        """Whether truth values are free that numbers decide, besides those in `open`."""
        return bool(self._plain.uncertainties)

    @property
    def _begun_by_outputs(self) -> frozenset[str]:
        """Earlier numbers whose value at the first tick depends on outputs of that tick.

        A favoured environment would state them before the system chooses, and so too early.
        """
        if not self._functions:
            return frozenset()
        return frozenset(
            name
            for name, before in self._atoms.before.items()
            if any(self._roles.get(each) is not Role.INPUT for each in read_by(before.first))
        )

    @property
    def uncertainties(self) -> Mapping[Role, str]:
        """Reasons for atoms outside the groups, and the reasons in `open`."""
        return {
            **({} if self.open is None else {self._favoured: self.open}),
            **self._plain.uncertainties,
        }

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each bit; a bit of a cell has none."""
        return {**self._plain.labels, **{n: a for each in self._used for n, a in each.labels()}}

    def uncertain_atoms(self, role: Role) -> frozenset[str]:
        """Atoms for which a player has valuations that may be impossible."""
        names = set(self._plain.uncertain_atoms(role))
        if role is self._favoured:
            atoms = self._atoms.found.items()
            open_ = self._atoms.before.keys() | self._atoms.free
            names |= {name for name, atom in atoms if atom.reads & open_}
            names |= {name for name, group in self._of.items() if group.open is not None}
            names |= self._lasting.keys()
        return frozenset(names)

    def memory(self) -> RequirementCounter | None:
        """Stored facts about earlier ticks, which the player of the numbers must respect."""
        pairs = [pair for pair in self._pairs if pair.now in self._of and pair.then in self._of]
        agrees = self._agreement(pairs) if pairs else bdd.true()
        begun = [self._begun] if self._at_first else []
        bits = self._kept.needed([agrees, *begun, *(each.is_so for each in self._lasted.values())])
        if not bits:
            return None
        steps = tuple(self._kept.steps[bit] for bit in bits)
        words = tuple(self._kept.words)
        return RequirementCounter("", bits, steps, agrees, None, words, bdd.true(), bdd.true())

    def _agreement(self, pairs: Sequence[Remembered]) -> Function:
        """Whether numbers of the previous tick agree with the stored facts, if they have a pattern.

        Without the patterns, the bits of many bounds would have too many combinations.
        """
        then = [self.atom(pair.then) for pair in pairs]
        mine = {bit for function in then for bit in bdd.support(function)}
        others = [bit for bit in bdd.support(self.possible) if bit not in mine]
        agrees = bdd.exists(self.possible, bdd.cube(others))
        begun = self._begun
        for pair, now in zip(pairs, then, strict=True):
            was = self._kept.keep(self.atom(pair.now))
            first = {True: now, False: -now, None: bdd.true()}[pair.first]
            agrees = agrees & bdd.ite(begun, -(was ^ now), first)
        return agrees

    def course(self, budget: Budget) -> SolvedNumericTrace | None:
        """A run before its first tick; None: no valuation depends on earlier numbers."""
        if not self._atoms.before or self._favoured is not Role.OUTPUT:
            return None
        return SolvedNumericTrace([*self._used], self._atoms, budget)

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Truth values of propositions, and numbers that satisfy the comparisons' truth values."""
        values = self._plain.values(letter)
        for each in self._used:
            values |= each.values(letter)
        known = bdd.point(letter)
        for name, function in self._asked.items():
            value = bdd.at(function, known)
            if self._atoms.is_proposition(name) and value in (bdd.true(), bdd.false()):
                values[name] = value == bdd.true()
        return values

    @property
    def _used(self) -> Iterator[ComparisonGroup]:
        return (group for group in self._groups if group.is_used)
