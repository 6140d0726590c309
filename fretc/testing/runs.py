"""Runs of one requirement: searched for, evaluated, and stored without duplicates."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import TypeVar

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.resolution import candidates
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.evaluation import evaluate
from compiler.logic.formula import Formula
from compiler.situations.mutants import Mutant, mutants
from compiler.situations.situations import Situation, situations
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.games.cores import minimal
from fretc.testing.places import Places
from fretc.testing.requirement_model import Ids, RequirementModel, demands
from fretc.testing.search import Letter
from fretc.testing.suite import Polarity
from fretc.testing.words import Naming, RunColumns, blotted, is_killed, judged, word
from fretish import expressions as e
from fretish.classes.frozen import dataclass

T = TypeVar("T")
F = TypeVar("F")


@dataclass(frozen=True, eq=False)
class TestRun:
    """A run, with its results for the sentence, the situations and the mutants."""

    word: RunColumns
    polarity: Polarity
    early: frozenset[str]
    """Situations that it covers up to the first violation."""
    situations: frozenset[str]
    kills: frozenset[str]

    @property
    def rank(self) -> tuple[int, int]:
        """Sort key: shorter runs first, then runs with fewer changes."""
        return self.word.ticks, len(self.word.rows)


@dataclass(frozen=True, slots=True)
class Absence:
    """There is no run with the required properties."""

    by: Ids = ()
    """Minimal set of other requirements that exclude such a run; empty: there is none at all."""
    why: str = ""
    """Why the absence is unknown; empty: it is proved."""

    def outcome(self, none: T, excluded: T, unknown: T) -> T:
        """Name of the outcome."""
        if self.why:
            return unknown
        return excluded if self.by else none


Answer = TestRun | Absence
Find = Callable[[Ids], F | None]
"""Search among the runs that satisfy some other requirements."""
Need = tuple[str, Polarity]
_LONG = 64
"""Bound in ticks from which a better variable order is built."""


class FoundRuns:
    """Runs of one requirement that were found so far.

    Raises:
        UnsupportedError: the requirement has no counter.
    """

    def __init__(
        self,
        requirement: FormalizedRequirement,
        others: Sequence[FormalizedRequirement],
        seconds: float,
    ) -> None:
        self.requirement, self.others = requirement, others
        self.situations, self.mutants = situations(requirement), mutants(requirement)
        places = Places(requirement)
        self._formulas: dict[str, Formula | Absence] = {}
        for situation in self.situations:
            try:
                self._formulas[situation.key] = places.formula(situation)
            except UnsupportedError as error:
                self._formulas[situation.key] = Absence(why=str(error))
        more = [*(mutant.requirement for mutant in self.mutants), *places.carriers]
        budget = Budget(seconds)
        self.bench = RequirementModel(requirement, others, more, budget)
        every = [requirement, *others]
        signals = {name: read for name, read in _read(every).items() if name not in read}
        self._naming = Naming(_atoms([*every, *more]), _atoms(every), signals, places.pinned)
        self._goals = {key: self._goal(formula) for key, formula in self._formulas.items()}
        if (requirement.ticks or 0) >= _LONG:
            self.bench = RequirementModel(requirement, others, more, budget, self.bench.order())
            self._goals = {key: self._goal(formula) for key, formula in self._formulas.items()}
        self._found: dict[tuple[int, ...], TestRun] = {}

    def _goal(self, formula: Formula | Absence) -> Function | Absence:
        if isinstance(formula, Absence):
            return formula
        try:
            return self.bench.goal(formula)
        except UnsupportedError as error:
            return Absence(why=str(error))

    # Searches

    def meeting(self, situation: Situation, polarity: Polarity) -> Answer:
        """A shortest run that covers a situation."""
        goal = self._goals[situation.key]
        if isinstance(goal, Absence):
            return goal
        if polarity is Polarity.UNKNOWN:
            assert situation.unknown is not None
            atom = situation.unknown
            return self._answer(
                partial(self.bench.dependence, goal, atom),
                lambda found: self._unknown_run(situation, atom, *found),
            )
        found = self._answer(
            lambda kept: self.bench.shortest(goal, polarity, kept, at_end=situation.at_end),
            self._run,
        )
        if isinstance(found, TestRun):
            assert situation.key in found.situations
            assert found.polarity is polarity
        return found

    def telling(self, mutant: Mutant) -> Answer:
        """A shortest run that kills a mutant."""
        found = self._answer(partial(self.bench.difference, mutant.requirement), self._run)
        if isinstance(found, TestRun):
            assert mutant.key in found.kills
        return found

    def _answer(self, find: Find[F], run: Callable[[F], TestRun]) -> Answer:
        try:
            found = find(self.bench.others)
            if found is not None:
                return run(found)
            return Absence() if find(()) is None else Absence(by=self._excluding(find))
        except (UnsupportedError, OutOfTimeError) as error:
            return Absence(why=str(error))

    def _excluding(self, find: Find[F]) -> Ids:
        """Minimal set of other requirements that exclude a run, a single one if possible."""
        every = self.bench.others
        alone = next(((id,) for id in every if find((id,)) is None), None)
        return alone or minimal(every, lambda ids: find(tuple(ids)) is None)

    # Judgements

    def _run(self, letters: Sequence[Letter]) -> TestRun:
        """The run of some valuations.

        Raises:
            UnsupportedError: it violates another requirement, which has no counter.
        """
        made = word(letters, self.bench.alphabet, self._naming)
        key = (made.ticks, *made.columns.values())
        if key not in self._found:
            self._check_others(made)
            self._found[key] = self._judged(made)
        return self._found[key]

    def _check_others(self, made: RunColumns) -> None:
        for each in self.others:
            if judged(each, made).violation:
                why = self.bench.beyond[each.id]  # All other requirements are satisfied.
                raise UnsupportedError(f"the shortest run violates {each.id}, and {why}")

    def _judged(self, made: RunColumns) -> TestRun:
        own = judged(self.requirement, made)
        columns = {situation.key: self._column(situation, made) for situation in self.situations}
        first = own.violation & -own.violation
        early = (first << 1) - 1 if first else -1
        return TestRun(
            made,
            Polarity.KEPT if own.accepted >> made.ticks - 1 else Polarity.BROKEN,
            frozenset(key for key, column in columns.items() if column & early),
            frozenset(key for key, column in columns.items() if column),
            frozenset(
                mutant.key
                for mutant in self.mutants
                if is_killed(own, judged(mutant.requirement, made), made.ticks)
            ),
        )

    def _column(self, situation: Situation, made: RunColumns) -> int:
        """Ticks at which a run with known values covers a situation."""
        formula = self._formulas[situation.key]
        if isinstance(formula, Absence) or situation.unknown is not None:
            return 0
        column = evaluate(formula, made.columns, made.ticks)
        return column & 1 << made.ticks - 1 if situation.at_end else column

    def _unknown_run(
        self, situation: Situation, atom: str, letters: Sequence[Letter], tick: int
    ) -> TestRun:
        """The run with an atom unknown at a tick, and all atoms that read the same names."""
        made = word(letters, self.bench.alphabet, self._naming)
        self._check_others(made)
        blank = blotted(made, tick, {atom, *self._linked(atom)})
        met = frozenset({situation.key})
        return TestRun(blank, Polarity.UNKNOWN, met, met, frozenset())

    def _linked(self, atom: str) -> set[str]:
        """Names that an atom reads, and the other atoms that read some of them."""
        readers = _read([self.requirement, *self.others])
        read = readers.get(atom, frozenset())
        return {*read, *(name for name, theirs in readers.items() if theirs & read)}


@dataclass(frozen=True, slots=True)
class DistinguishingRun:
    """A shortest run with different verdicts of two sentences."""

    word: RunColumns
    uncertainty: str
    """Why its values may be impossible; empty: they are possible."""


def difference(
    requirement: FormalizedRequirement,
    other: FormalizedRequirement,
    seconds: float,
    beside: Sequence[FormalizedRequirement] = (),
) -> DistinguishingRun | Absence:
    """A run that distinguishes two sentences, or proof that they agree on all finite runs.

    Args:
        requirement: a sentence.
        other: another sentence over the same bindings.
        seconds: CPU seconds.
        beside: further sentences whose atoms the run has, too.
    """
    every = [requirement, other, *beside]
    try:
        bench = RequirementModel(requirement, (), every[1:], Budget(seconds))
        letters = bench.difference(other, ())
    except (UnsupportedError, OutOfTimeError) as error:
        return Absence(why=str(error))
    if letters is None:
        return Absence()
    atoms = _atoms(every)
    signals = {name: read for name, read in _read(every).items() if name not in read}
    made = word(letters, bench.alphabet, Naming(atoms, atoms, signals, {}))
    assert is_killed(judged(requirement, made), judged(other, made), made.ticks)
    return DistinguishingRun(made, bench.uncertainty)


def _read(requirements: Iterable[FormalizedRequirement]) -> dict[str, frozenset[str]]:
    """Signals or variables that each atom reads."""
    found: dict[str, frozenset[str]] = {}
    for requirement in requirements:
        declared = requirement.declarations.propositions if requirement.declarations else {}
        for name, part in candidates(requirement.sentence):
            bound = declared.get(name)
            found[name] = frozenset(bound.signals if bound else (n.id for n in e.names(part)))
    return found


def _atoms(requirements: Iterable[FormalizedRequirement]) -> tuple[str, ...]:
    return tuple(
        dict.fromkeys(name for requirement in requirements for name in demands(requirement).atoms)
    )
