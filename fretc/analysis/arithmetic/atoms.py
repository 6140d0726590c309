"""Atoms that depend on numbers and enumeration values, as formulas of one tick."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.numbers.terms import (
    NoTermError,
    PreviousValue,
    RequirementTerms,
    Term,
    read_by,
)
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.arithmetic.durations import DurationProposition, parted
from fretc.analysis.arithmetic.readings import AtomReading, readings
from fretc.analysis.arithmetic.steps import AtomOfTick, AtomStep, Steps, linked, tick, unknown
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class NumericAtom:
    """Atom of one tick that depends on numbers and enumeration values."""

    over: AtomOfTick
    reads: frozenset[str]
    """Variables for signals at one step, and for whether they are known there."""
    names: tuple[str, ...] = ()
    """Names in the sentence; the player who chooses them chooses the variables."""

    @property
    def formula(self) -> Term:
        """Formula that is true when the atom is."""
        return self.over.formula


class Atoms:
    """Linear atoms of some requirements, by their names in formulas."""

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        *,
        of_moments: bool = False,
        given: Collection[str] = (),
    ) -> None:
        """Collect the atoms.

        Args:
            requirements: the requirements.
            of_moments: whether only atoms of one known sample are read.
            given: variables that are known before the system chooses. A term over these and earlier
                numbers that is not linear may have any value.
        """
        self._given = frozenset(given)
        self._terms = RequirementTerms(requirements, may_be_free=self._is_given)
        self.found: dict[str, NumericAtom] = {}
        self.refused: dict[str, str] = {}
        """Comparison → why it has no formula here."""
        self.lasting: dict[str, DurationProposition] = {}
        """Atom that depends on earlier ticks → its parts."""
        self._of: dict[str, str] = {}
        """Variable of another step → its signal."""
        self._flags: set[str] = set()
        self._parts: set[str] = set()
        moments: dict[str, AtomStep] = {}
        for name, reading in readings(requirements):
            if of_moments and not reading.is_of_moment:
                continue
            if name not in moments and name not in self.refused and name not in self.lasting:
                self._read(name, reading, moments)
        self._sort(moments)

    @property
    def variables(self) -> dict[str, Term]:
        """Constants of z3 for everything that is read."""
        return self._terms.variables

    @property
    def before(self) -> Mapping[str, PreviousValue]:
        """Variables for numbers of the previous tick → the names of these numbers."""
        return self._terms.before

    @property
    def free(self) -> Collection[str]:
        """Variables for terms that may have any value."""
        return self._terms.free

    def begin_apart(self, begun: Collection[str]) -> Mapping[str, str]:
        """Add an atom for the first tick of each atom that reads some earlier numbers.

        Args:
            begun: variables for numbers of the previous tick.

        Returns:
            Atom → the atom that has its value at the first tick.
        """
        variables = self.variables
        firsts = [(variables[name], self.before[name].first) for name in begun]
        apart = {
            name: f"{name} at first"
            for name, atom in self.found.items()
            if not atom.reads.isdisjoint(begun)
        }
        for name, at_first in apart.items():
            over = self.found[name].over
            term = z3.simplify(z3.substitute(over.formula, *firsts))
            self.found[at_first] = NumericAtom(AtomOfTick(term, over.given), read_by(term))
        return apart

    def _is_given(self, names: frozenset[str]) -> bool:
        known = self._given | self._terms.before.keys() | self._terms.free
        return bool(self._given) and names <= known

    @property
    def is_of_moments(self) -> bool:
        """Whether all atoms are about known numbers of one step."""
        return not self._of and not self.lasting

    def of(self, variable: str) -> str:
        """The name of the number that a variable represents at some step."""
        return self._of.get(variable, variable)

    def is_part(self, atom: str) -> bool:
        """Whether the atom is not named in a sentence."""
        return atom in self._parts

    def is_proposition(self, atom: str) -> bool:
        """Whether a sentence names the atom without a comparison."""
        if atom in self.lasting:
            return True
        reading = self.found.get(atom)
        return reading is not None and reading.names == (atom,)

    def domain(self, variable: str) -> Term:
        """Domain of a variable."""
        if variable in self._flags:
            return z3.BoolVal(True)
        of = self.of(variable)
        domain = self._terms.domain(of)
        if of == variable:
            return domain
        return z3.substitute(domain, (self.variables[of], self.variables[variable]))

    def tick(self, numbers: Mapping[str, Fraction]) -> Tick:
        """Numbers of the last step in user notation."""
        return {
            name: self._terms.shown(name, value)
            for name, value in numbers.items()
            if name not in self._of
        }

    def _read(self, name: str, reading: AtomReading, moments: dict[str, AtomStep]) -> None:
        try:
            parts, lasting = parted(name, reading)
            made = {each: self._moment(part) for each, part in parts.items()}
        except (UnsupportedError, NoTermError) as error:
            self.refused[name] = f"`{name}` {error}"
            return
        moments |= made
        if lasting is not None:
            self.lasting[name] = lasting
            self._parts |= {*lasting.atoms}

    def _moment(self, reading: AtomReading) -> AtomStep:
        true, false = (
            self._terms.holds(reading.expression, value, self._known) for value in (True, False)
        )
        signals = frozenset(each for each in read_by(true) if each in self.variables)
        return AtomStep(true, false, signals, reading.aggregate, reading.on_unknown, reading.names)

    def _known(self, compared: Term) -> Term:
        return z3.And([z3.Not(unknown(name)) for name in read_by(compared)])

    # Over a tick

    def _sort(self, moments: Mapping[str, AtomStep]) -> None:
        """Make formulas of a tick from all moments."""
        open_ = {
            signal
            for each in moments.values()
            if each.on_unknown is not None
            for signal in each.signals
        }
        kept = self._settled(moments, open_)
        for name in open_:
            self._add(str(unknown(name)), unknown(name), name)
        for name, moment in kept.items():
            if not moment.is_of_all_steps:
                self._found(name, moment, tick(moment, [moment.true], [moment.false]))
        for group in linked(kept):
            steps = Steps(group, self.variables, open_)
            if steps.is_crossed and steps.has_flags:
                why = "share only some samples, and read values that may be unknown"
                self.refused |= dict.fromkeys(
                    group, f"{' and '.join(f'`{n}`' for n in group)} {why}"
                )
                continue
            for name, copy in steps.copies.items():
                self._add(name, copy, steps.of[name])
            for name, moment in group.items():
                self._found(name, moment, steps.tick(moment))

    def _settled(
        self, moments: Mapping[str, AtomStep], open_: Collection[str]
    ) -> Mapping[str, AtomStep]:
        """Moments in which all other signals are known; durations of these signals are refused."""
        for name, lasting in [*self.lasting.items()]:
            if any(not moments[atom].signals.isdisjoint(open_) for atom in lasting.atoms):
                self.refused[name] = f"`{name}` has a duration of what may be unknown"
                del self.lasting[name]
        needed = {each for lasting in self.lasting.values() for each in lasting.atoms}
        gone = self._parts - needed
        known = [(unknown(name), z3.BoolVal(False)) for name in {*self.variables} - {*open_}]
        return {
            name: replace(
                each,
                true=z3.simplify(z3.substitute(each.true, *known)),
                false=z3.simplify(z3.substitute(each.false, *known)),
            )
            for name, each in moments.items()
            if name not in gone
        }

    def _add(self, variable: str, term: Term, of: str) -> None:
        """Add a variable that is not a number of the last step."""
        self.variables[variable], self._of[variable] = term, of
        if z3.is_bool(term):
            self._flags.add(variable)

    def _found(self, name: str, moment: AtomStep, made: AtomOfTick) -> None:
        reads = read_by(made.formula) | read_by(made.given)
        self.found[name] = NumericAtom(made, reads, moment.names)
