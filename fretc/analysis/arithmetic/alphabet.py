"""An alphabet in which comparisons are as true together as numbers allow, and no other way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.numbers.terms import Term
from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import Counter, Memory
from fretc.analysis.arena.propositions import Propositions
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.course import NumberCourse
from fretc.analysis.arithmetic.durations import Duration, Held, held
from fretc.analysis.arithmetic.groups import Group, choice, linked, owners
from fretc.analysis.arithmetic.past import Remembered, remembered
from fretc.analysis.arithmetic.projection import Limit
from fretish.bindings.declarations import Role


class Cells:
    """An `Alphabet`: comparisons by groups, all other atoms as `Propositions` has them.

    Args:
        requirements: whose atoms it has.
        roles: of their variables.
        fresh: variables for its bits.
        favoured: who chooses what is not known: numbers of the tick before, as far as nothing is
            remembered of them, whether a signal is unknown, and what was before the first tick.
        budget: for sorting the comparisons.
        steps: how many ticks before a bound it is remembered whether that is within reach.
        of_moments: whether propositions over several samples are left to `Propositions`.

    Raises:
        OutOfTimeError: the budget is over.
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
    ) -> None:
        self._favoured = favoured
        self._atoms = Atoms(requirements, of_moments=of_moments)
        self._pairs = remembered(self._atoms, steps)
        self._fresh = fresh
        self._kept = Memory(fresh, {})
        self._groups: list[Group] = []
        self._of: dict[str, Group] = {}
        self._lasted: dict[Duration, Held] = {}
        self._asked: dict[str, Function] = {}
        self._free: list[int] = []
        """Bits of the favoured player: whether what lasts has done so since before the run."""
        refused = dict(self._atoms.refused)
        for names in linked(self._atoms):
            budget.check()
            try:
                chosen = choice(names, self._atoms, owners(names, self._atoms, roles, favoured))
                group = Group(chosen, self._atoms, fresh, favoured, Limit(budget))
            except UnsupportedError as error:
                shown = f"`{names[0]}` and others" if len(names) > 1 else f"`{names[0]}`"
                refused |= dict.fromkeys(names, f"{shown} {error}")
            else:
                self._groups.append(group)
                self._of |= dict.fromkeys(names, group)
        self._lasting = {
            name: lasting
            for name, lasting in self._atoms.lasting.items()
            if not any(each in refused for each in lasting.atoms)
        }
        for name in self._atoms.lasting.keys() - self._lasting.keys():
            parts = self._atoms.lasting[name].atoms
            refused[name] = next(refused[each] for each in parts if each in refused)
        elsewhere = frozenset([*self._of, *self._lasting])
        self._plain = Propositions(requirements, roles, fresh, elsewhere, refused)

    def atom(self, name: str) -> Function:
        """When an atom is true; over what is remembered, too, where it depends on that."""
        if name not in self._asked:
            self._asked[name] = self._atom(name)
        return self._asked[name]

    def _atom(self, name: str) -> Function:
        if name in self._lasting:
            return self._in_time(name)
        found = self._atoms.found.get(name)
        if found is not None and (z3.is_true(found.formula) or z3.is_false(found.formula)):
            return bdd.true() if z3.is_true(found.formula) else bdd.false()
        group = self._of.get(name)
        return self._plain.atom(name) if group is None else group.atom(name)

    def _in_time(self, name: str) -> Function:
        """When a proposition is true that depends on earlier ticks, over their memory, too."""
        lasting = self._lasting[name]
        lasted = [self._lasted_so(each) for each in lasting.durations]
        found = bdd.false()
        for values, case in lasting.cases.items():
            term = self.atom(case)
            for value, each in zip(values, lasted, strict=True):
                term = term & (each.is_so if value else -each.is_so)
            found = found | term
        return found

    def _lasted_so(self, duration: Duration) -> Held:
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
    def possible(self) -> Function:
        """All patterns."""
        found = self._plain.possible
        for each in self._used:
            found = found & each.possible
        return found

    @property
    def certain(self) -> Function:
        """Those with nothing unknown; of numbers of the tick before none is certain."""
        if self._atoms.before:
            return bdd.false()
        found = self._plain.certain
        for each in self._used:
            found = found & each.known
        for lasted in self._lasted.values():
            found = found - lasted.is_open
        return found

    @property
    def is_refinable(self) -> bool:
        """Whether comparisons look back at a number."""
        return bool(self._atoms.before)

    @property
    def open(self) -> str | None:
        """What the favoured player chooses though nobody does; None: nothing."""
        before = next(iter(self._atoms.before), None)
        if before is not None:
            return f"of the previous value `{before}` only the truth of its comparisons is kept"
        unknown = next((why for each in self._used if (why := each.open) is not None), None)
        if unknown is not None:
            return unknown
        first = next(iter(self._lasting), None)
        if first is not None:
            return f"the value of `{first}` before the first tick is unknown"
        return None

    @property
    def doubts(self) -> Mapping[Role, str]:
        """Those of the atoms that are in no group, and what is `open`."""
        return {**({} if self.open is None else {self._favoured: self.open}), **self._plain.doubts}

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each bit; a bit of a cell has none."""
        return {**self._plain.labels, **{n: a for each in self._used for n, a in each.labels()}}

    def doubtful(self, role: Role) -> frozenset[str]:
        """The atoms of which a player has too many letters."""
        found = set(self._plain.doubtful(role))
        if role is self._favoured:
            atoms = self._atoms.found.items()
            found |= {name for name, atom in atoms if atom.reads & self._atoms.before.keys()}
            found |= {name for name, group in self._of.items() if group.open is not None}
            found |= self._lasting.keys()
        return frozenset(found)

    def memory(self) -> Counter | None:
        """What is remembered of earlier ticks: the player who chooses their numbers keeps to it."""
        pairs = [each for each in self._pairs if each.now in self._of and each.then in self._of]
        agrees = self._agreement(pairs) if pairs else bdd.true()
        bits = self._kept.needed([agrees, *(each.is_so for each in self._lasted.values())])
        if not bits:
            return None
        steps = tuple(self._kept.steps[bit] for bit in bits)
        words = tuple(self._kept.words)
        return Counter("", bits, steps, agrees, None, words, bdd.true(), bdd.true())

    def _agreement(self, pairs: Sequence[Remembered]) -> Function:
        """Whether numbers of the tick before are as they were, where they have a pattern at all.

        Without the patterns the bits of many bounds would agree in too many ways to write down.
        """
        then = [self.atom(pair.then) for pair in pairs]
        mine = {bit for function in then for bit in bdd.support(function)}
        others = [bit for bit in bdd.support(self.possible) if bit not in mine]
        agrees = bdd.some(self.possible, bdd.cube(others))
        begun = self._kept.keep(bdd.true())
        for pair, now in zip(pairs, then, strict=True):
            was = self._kept.keep(self.atom(pair.now))
            first = {True: now, False: -now, None: bdd.true()}[pair.first]
            agrees = agrees & bdd.choice(begun, -(was ^ now), first)
        return agrees

    def course(self, budget: Budget) -> NumberCourse | None:
        """A run that has not begun; None: no letter depends on earlier numbers."""
        if not self._atoms.before or self._favoured is not Role.OUTPUT:
            return None
        return NumberCourse([*self._used], self._atoms, budget)

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """The truth of propositions, and numbers that make comparisons true and false so."""
        found = self._plain.values(letter)
        for each in self._used:
            found |= each.values(letter)
        known = bdd.point(letter)
        for name, function in self._asked.items():
            value = bdd.at(function, known)
            if self._atoms.is_proposition(name) and value in (bdd.true(), bdd.false()):
                found[name] = value == bdd.true()
        return found

    @property
    def _used(self) -> Iterator[Group]:
        return (each for each in self._groups if each.is_used)
