"""The runs of one requirement, while they are gathered: searched for, judged, each kept once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.resolution import candidates
from compiler.logic.decision_diagrams import Function
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
from fretc.testing.words import Naming, Word, blotted, is_killed, judged, word
from fretish import expressions as e

T = TypeVar("T")
F = TypeVar("F")


@dataclass(frozen=True, eq=False)
class Run:
    """A word, and what the sentence, the situations and the mutants make of it."""

    word: Word
    polarity: Polarity
    early: frozenset[str]
    """The situations that it comes by up to where the sentence is broken first."""
    situations: frozenset[str]
    kills: frozenset[str]

    @property
    def rank(self) -> tuple[int, int]:
        """Shorter words are better, and of these the ones with fewer changes."""
        return self.word.ticks, len(self.word.rows)


@dataclass(frozen=True, slots=True)
class Absence:
    """There is no run."""

    by: Ids = ()
    """A minimal set of others without which there is one; empty: there is none at all."""
    why: str = ""
    """Why nothing is known; empty: it is proved."""

    def outcome(self, none: T, excluded: T, unknown: T) -> T:
        """What it is called."""
        if self.why:
            return unknown
        return excluded if self.by else none


Answer = Run | Absence
Find = Callable[[Ids], F | None]
"""What is found among the runs that keep some others."""
Need = tuple[str, Polarity]
_LONG = 64
"""Ticks of a bound that is worth an order of variables of its own."""


class Runs:
    """The runs of one requirement that were found so far.

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
        for each in self.situations:
            try:
                self._formulas[each.key] = places.formula(each)
            except UnsupportedError as error:
                self._formulas[each.key] = Absence(why=str(error))
        more = [*(each.requirement for each in self.mutants), *places.carriers]
        budget = Budget(seconds)
        self.bench = RequirementModel(requirement, others, more, budget)
        every = [requirement, *others]
        signals = {name: read for name, read in _read(every).items() if name not in read}
        self._naming = Naming(_atoms([*every, *more]), _atoms(every), signals, places.pinned)
        self._goals = {key: self._goal(formula) for key, formula in self._formulas.items()}
        if (requirement.ticks or 0) >= _LONG:
            self.bench = RequirementModel(requirement, others, more, budget, self.bench.order())
            self._goals = {key: self._goal(formula) for key, formula in self._formulas.items()}
        self._found: dict[tuple[int, ...], Run] = {}

    def _goal(self, formula: Formula | Absence) -> Function | Absence:
        if isinstance(formula, Absence):
            return formula
        try:
            return self.bench.goal(formula)
        except UnsupportedError as error:
            return Absence(why=str(error))

    # Searches

    def meeting(self, situation: Situation, polarity: Polarity) -> Answer:
        """A shortest run by a situation."""
        goal = self._goals[situation.key]
        if isinstance(goal, Absence):
            return goal
        if polarity is Polarity.UNKNOWN:
            assert situation.unknown is not None
            atom = situation.unknown
            return self._answer(
                partial(self.bench.doubt_of, goal, atom),
                lambda found: self._doubtful(situation, atom, *found),
            )
        found = self._answer(
            lambda kept: self.bench.shortest(goal, polarity, kept, at_end=situation.at_end),
            self._run,
        )
        if isinstance(found, Run):
            assert situation.key in found.situations
            assert found.polarity is polarity
        return found

    def telling(self, mutant: Mutant) -> Answer:
        """A shortest run that kills a mutant."""
        found = self._answer(partial(self.bench.difference, mutant.requirement), self._run)
        if isinstance(found, Run):
            assert mutant.key in found.kills
        return found

    def _answer(self, find: Find[F], run: Callable[[F], Run]) -> Answer:
        try:
            found = find(self.bench.others)
            if found is not None:
                return run(found)
            return Absence() if find(()) is None else Absence(by=self._excluding(find))
        except (UnsupportedError, OutOfTimeError) as error:
            return Absence(why=str(error))

    def _excluding(self, find: Find[F]) -> Ids:
        """A minimal set of others with which nothing is found, a single one if there is one."""
        every = self.bench.others
        alone = next(((id,) for id in every if find((id,)) is None), None)
        return alone or minimal(every, lambda ids: find(tuple(ids)) is None)

    # Judgements

    def _run(self, letters: Sequence[Letter]) -> Run:
        """The run of some letters.

        Raises:
            UnsupportedError: it breaks another requirement, which has no counter.
        """
        made = word(letters, self.bench.alphabet, self._naming)
        key = (made.ticks, *made.columns.values())
        if key not in self._found:
            self._check_others(made)
            self._found[key] = self._judged(made)
        return self._found[key]

    def _check_others(self, made: Word) -> None:
        for each in self.others:
            if judged(each, made).breach:
                why = self.bench.beyond[each.id]  # all others are kept
                raise UnsupportedError(f"the shortest run violates {each.id}, and {why}")

    def _judged(self, made: Word) -> Run:
        own = judged(self.requirement, made)
        columns = {each.key: self._column(each, made) for each in self.situations}
        first = own.breach & -own.breach
        early = (first << 1) - 1 if first else -1
        return Run(
            made,
            Polarity.KEPT if own.accepted >> made.ticks - 1 else Polarity.BROKEN,
            frozenset(key for key, column in columns.items() if column & early),
            frozenset(key for key, column in columns.items() if column),
            frozenset(
                each.key
                for each in self.mutants
                if is_killed(own, judged(each.requirement, made), made.ticks)
            ),
        )

    def _column(self, situation: Situation, made: Word) -> int:
        """Where a word in which all is known comes by a situation."""
        formula = self._formulas[situation.key]
        if isinstance(formula, Absence) or situation.unknown is not None:
            return 0
        column = evaluate(formula, made.columns, made.ticks)
        return column & 1 << made.ticks - 1 if situation.at_end else column

    def _doubtful(
        self, situation: Situation, atom: str, letters: Sequence[Letter], tick: int
    ) -> Run:
        """The run in which an atom is unknown at a tick, as is all that reads the same."""
        made = word(letters, self.bench.alphabet, self._naming)
        self._check_others(made)
        blank = blotted(made, tick, {atom, *self._linked(atom)})
        met = frozenset({situation.key})
        return Run(blank, Polarity.UNKNOWN, met, met, frozenset())

    def _linked(self, atom: str) -> set[str]:
        """What an atom reads, and the other atoms that read some of it."""
        readers = _read([self.requirement, *self.others])
        read = readers.get(atom, frozenset())
        return {*read, *(name for name, theirs in readers.items() if theirs & read)}


@dataclass(frozen=True, slots=True)
class Difference:
    """A shortest word that two sentences judge differently."""

    word: Word
    doubt: str
    """Why nobody may be able to bring its values about; empty: they are real."""


def difference(
    requirement: FormalizedRequirement, other: FormalizedRequirement, seconds: float
) -> Difference | Absence:
    """What tells two sentences apart; without it they judge all finite runs alike.

    Args:
        requirement: a sentence.
        other: another one, over the same bindings.
        seconds: of a processor.
    """
    both = [requirement, other]
    try:
        bench = RequirementModel(requirement, (), [other], Budget(seconds))
        letters = bench.difference(other, ())
    except (UnsupportedError, OutOfTimeError) as error:
        return Absence(why=str(error))
    if letters is None:
        return Absence()
    atoms = _atoms(both)
    signals = {name: read for name, read in _read(both).items() if name not in read}
    made = word(letters, bench.alphabet, Naming(atoms, atoms, signals, {}))
    assert is_killed(judged(requirement, made), judged(other, made), made.ticks)
    return Difference(made, bench.doubt)


def _read(requirements: Iterable[FormalizedRequirement]) -> dict[str, frozenset[str]]:
    """The signals or variables that each atom reads."""
    found: dict[str, frozenset[str]] = {}
    for each in requirements:
        declared = each.declarations.propositions if each.declarations else {}
        for name, part in candidates(each.sentence):
            bound = declared.get(name)
            found[name] = frozenset(bound.signals if bound else (n.id for n in e.names(part)))
    return found


def _atoms(requirements: Iterable[FormalizedRequirement]) -> tuple[str, ...]:
    return tuple(
        dict.fromkeys(name for requirement in requirements for name in demands(requirement).atoms)
    )
