"""The tests of one requirement: each situation met by a shortest run, each mutant told apart."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from compiler.formalization.formalized import Formalized
from compiler.logic.decision_diagrams import Function
from compiler.logic.evaluation import evaluate
from compiler.situations.mutants import Mutant, mutants
from compiler.situations.situations import Situation, situations
from compiler.targets.python import monitor as emitted
from fretc.analysis.arena.alphabet import BeyondError
from fretc.analysis.games.budget import Budget, OutOfTimeError
from fretc.analysis.games.cores import minimal
from fretc.testing.bench import Bench, Ids, demands
from fretc.testing.cover import cover
from fretc.testing.search import Letter
from fretc.testing.suite import Fate, Met, Mutated, Obligation, Polarity, Test, Tested, unused
from fretc.testing.words import Judged, Word, expected, is_killed, judged, word
from fretish.printer import sentence as printed
from fretish.reading.recursion import deep
from monitors.loading import load


@dataclass(frozen=True, slots=True)
class Batch:
    """What was made of one requirement."""

    tested: Tested
    tests: tuple[Test, ...]
    obligations: tuple[Obligation, ...]
    mutants: tuple[Mutated, ...]


@deep
def batch(rule: Formalized, others: Sequence[Formalized], seconds: float) -> Batch:
    """The tests of a requirement.

    Args:
        rule: the requirement.
        others: requirements and assumptions whose variables hang together with its own; its tests
            keep them.
        seconds: of a processor.
    """
    wrong = mutants(rule)
    try:
        bench = Bench(rule, others, [each.rule for each in wrong], Budget(seconds))
    except BeyondError as error:
        return lost(rule, str(error))
    return _Generation(bench, others, wrong).batch()


def lost(rule: Formalized, why: str) -> Batch:
    """What stands there where nothing could be searched, for a reason."""
    return Batch(
        _tested(rule, (), ""),
        (),
        tuple(
            _obligation(rule, each, polarity, Met.NOT_SEARCHED, why=why)
            for each in situations(rule)
            for polarity in Polarity
        ),
        tuple(_mutated(rule, each, Fate.NOT_SEARCHED, why=why) for each in mutants(rule)),
    )


def _tested(rule: Formalized, kept: Ids, doubt: str) -> Tested:
    return Tested(rule.id, printed(rule.written), rule.fingerprint, kept, doubt)


def _obligation(
    rule: Formalized,
    situation: Situation,
    polarity: Polarity,
    outcome: Met,
    *,
    tests: Ids = (),
    by: Ids = (),
    why: str = "",
) -> Obligation:
    return Obligation(rule.id, situation.key, situation.words, polarity, outcome, tests, by, why)


def _mutated(
    rule: Formalized,
    mutant: Mutant,
    outcome: Fate,
    *,
    tests: Ids = (),
    by: Ids = (),
    why: str = "",
) -> Mutated:
    return Mutated(
        rule.id, mutant.key, mutant.words, printed(mutant.rule.written), outcome, tests, by, why
    )


# Runs -------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Run:
    """A word, and what the sentence, the situations and the mutants make of it."""

    word: Word
    own: Judged
    early: frozenset[str]
    """The situations that it comes by up to where the sentence is broken first."""
    situations: frozenset[str]
    kills: frozenset[str]

    @property
    def polarity(self) -> Polarity:
        """Whether it keeps the sentence."""
        return Polarity.KEPT if self.own.accepted >> self.word.ticks - 1 else Polarity.BROKEN

    @property
    def rank(self) -> tuple[int, int]:
        """Shorter words are better, and of these the ones with fewer changes."""
        return self.word.ticks, len(self.word.rows)


@dataclass(frozen=True, slots=True)
class _Purpose:
    """What a run was chosen for."""

    key: str
    words: str


@dataclass(frozen=True, slots=True)
class _Absence:
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


T = TypeVar("T")
_Find = Callable[[Ids], tuple[Letter, ...] | None]
_Need = tuple[str, Polarity]


class _Generation:
    """The runs of one requirement."""

    def __init__(self, bench: Bench, others: Sequence[Formalized], wrong: Sequence[Mutant]) -> None:
        self._bench, self._others, self._wrong = bench, others, wrong
        self._rule = bench.rule
        self._monitor = load(f"{self._rule.id}.py", emitted.text(self._rule))
        every = [self._rule, *others, *(each.rule for each in wrong)]
        self._atoms = tuple(dict.fromkeys(name for each in every for name in demands(each).atoms))
        self._situations = situations(self._rule)
        self._goals = {each.key: self._goal(each) for each in self._situations}
        self._runs: dict[tuple[int, ...], _Run] = {}

    def _goal(self, situation: Situation) -> Function | _Absence:
        try:
            return self._bench.goal(situation.formula)
        except BeyondError as error:
            return _Absence(why=str(error))

    def batch(self) -> Batch:
        """All of it."""
        met = {
            (each.key, polarity): self._meeting(each, polarity)
            for each in self._situations
            for polarity in Polarity
        }
        runs = self._meeting_all(met)
        told = self._telling(runs)
        runs |= self._telling_apart(told, runs)
        names: set[str] = set()
        made = {run: self._test(run, purpose, names) for run, purpose in runs.items()}
        return Batch(
            _tested(self._rule, self._bench.others, self._bench.doubt),
            tuple(made.values()),
            tuple(self._obligations(met, made)),
            tuple(self._mutants(told, made)),
        )

    # Choices

    def _meeting_all(self, met: Mapping[_Need, _Run | _Absence]) -> dict[_Run, _Purpose]:
        """Runs as short as those that were found, one for several needs; and what each is for."""
        found = {need: run for need, run in met.items() if isinstance(run, _Run)}
        shown = {
            run: [need for need, shortest in found.items() if _serves(run, need, shortest)]
            for run in found.values()
        }
        chosen = cover(shown, {run: run.rank for run in shown})
        common = Counter(need for needs in shown.values() for need in needs)
        special = {min(needs, key=common.__getitem__): run for run, needs in chosen.items()}
        return {special[need]: self._purpose(*need) for need in met if need in special}

    def _purpose(self, key: str, polarity: Polarity) -> _Purpose:
        words = next(each.words for each in self._situations if each.key == key)
        return _Purpose(f"{key}-{polarity}", f"{words}; {self._rule.id} is {polarity}")

    def _telling_apart(
        self, told: Mapping[str, _Run | _Absence], runs: Collection[_Run]
    ) -> dict[_Run, _Purpose]:
        """Runs for the mutants that those do not kill."""
        alive = {each.key for each in self._wrong}.difference(*(run.kills for run in runs))
        shown = {
            run: [each.key for each in self._wrong if each.key in run.kills & alive]
            for run in told.values()
            if isinstance(run, _Run)
        }
        chosen = cover(shown, {run: run.rank for run in shown})
        words = {each.key: each.words for each in self._wrong}
        return {
            run: _Purpose(f"unlike-{key}", f"{self._rule.id} and not the same with {words[key]}")
            for run, (key, *_) in chosen.items()
        }

    # Records

    def _test(self, run: _Run, purpose: _Purpose, names: set[str]) -> Test:
        name = re.sub("[^a-z0-9]+", "-", f"{self._rule.id} {purpose.key}".lower()).strip("-")
        says = expected(self._rule, self._monitor, run.word)
        assert says.finite is (run.polarity is Polarity.KEPT)
        return Test(
            name=unused(name, names),
            requirement=self._rule.id,
            words=purpose.words,
            rows=run.word.rows,
            polarity=run.polarity,
            verdict=says.verdict,
            finite=says.finite,
            decided=says.decided,
            first_violation=says.first_violation,
            because=says.because,
            situations=tuple(each.key for each in self._situations if each.key in run.situations),
            kills=tuple(each.key for each in self._wrong if each.key in run.kills),
        )

    def _obligations(
        self, met: Mapping[_Need, _Run | _Absence], made: Mapping[_Run, Test]
    ) -> Iterator[Obligation]:
        for each in self._situations:
            for polarity in Polarity:
                found = met[each.key, polarity]
                if isinstance(found, _Run):
                    runs = [run for run in made if run.polarity is polarity]
                    tests = _names(made, [run for run in runs if each.key in run.situations])
                    yield _obligation(self._rule, each, polarity, Met.MET, tests=tests)
                else:
                    outcome = found.outcome(Met.IMPOSSIBLE, Met.EXCLUDED, Met.NOT_SEARCHED)
                    yield _obligation(
                        self._rule, each, polarity, outcome, by=found.by, why=found.why
                    )

    def _mutants(
        self, told: Mapping[str, _Run | _Absence], made: Mapping[_Run, Test]
    ) -> Iterator[Mutated]:
        for each in self._wrong:
            found = told.get(each.key)
            if isinstance(found, _Absence):
                outcome = found.outcome(Fate.EQUIVALENT, Fate.EXCLUDED, Fate.NOT_SEARCHED)
                yield _mutated(self._rule, each, outcome, by=found.by, why=found.why)
            else:
                tests = _names(made, [run for run in made if each.key in run.kills])
                assert tests
                yield _mutated(self._rule, each, Fate.KILLED, tests=tests)

    # Searches

    def _meeting(self, situation: Situation, polarity: Polarity) -> _Run | _Absence:
        """A shortest run by a situation."""
        goal = self._goals[situation.key]
        if isinstance(goal, _Absence):
            return goal
        found = self._found(
            lambda kept: self._bench.shortest(goal, polarity, kept, at_end=situation.at_end)
        )
        if isinstance(found, _Run):
            assert situation.key in found.situations
            assert found.polarity is polarity
        return found

    def _telling(self, chosen: Iterable[_Run]) -> dict[str, _Run | _Absence]:
        """Of each mutant that no chosen run kills: a shortest run that does, one for several."""
        found: dict[str, _Run | _Absence] = {}
        runs = list(chosen)
        for each in self._wrong:
            if not any(each.key in run.kills for run in runs):
                answer = self._found(partial(self._bench.difference, each.rule))
                found[each.key] = answer
                if isinstance(answer, _Run):
                    assert each.key in answer.kills
                    runs.append(answer)
        return found

    def _found(self, find: _Find) -> _Run | _Absence:
        try:
            letters = find(self._bench.others)
            if letters is not None:
                return self._run(letters)
            return _Absence() if find(()) is None else _Absence(by=self._excluding(find))
        except (BeyondError, OutOfTimeError) as error:
            return _Absence(why=str(error))

    def _excluding(self, find: _Find) -> Ids:
        """A minimal set of others with which nothing is found, a single one if there is one."""
        every = self._bench.others
        alone = next(((id,) for id in every if find((id,)) is None), None)
        return alone or minimal(every, lambda ids: find(tuple(ids)) is None)

    def _run(self, letters: Sequence[Letter]) -> _Run:
        """The run of some letters.

        Raises:
            BeyondError: it breaks another requirement, which has no counter.
        """
        made = word(letters, self._bench.alphabet, self._atoms)
        key = (made.ticks, *made.columns.values())
        if key not in self._runs:
            self._runs[key] = self._judged(made)
        return self._runs[key]

    def _judged(self, made: Word) -> _Run:
        for each in self._others:
            if judged(each, made).breach:
                why = self._bench.beyond[each.id]  # all others are kept
                raise BeyondError(f"the shortest run breaks {each.id}, and of that {why}")
        own = judged(self._rule, made)
        columns = {
            each.key: evaluate(each.formula, made.columns, made.ticks)
            & (1 << made.ticks - 1 if each.at_end else -1)
            for each in self._situations
        }
        first = own.breach & -own.breach
        early = (first << 1) - 1 if first else -1
        return _Run(
            made,
            own,
            frozenset(key for key, column in columns.items() if column & early),
            frozenset(key for key, column in columns.items() if column),
            frozenset(
                each.key
                for each in self._wrong
                if is_killed(own, judged(each.rule, made), made.ticks)
            ),
        )


def _serves(run: _Run, need: _Need, shortest: _Run) -> bool:
    """Whether a run meets a need as well as the one that was found for it."""
    key, polarity = need
    met = run.early if key in shortest.early else run.situations
    same = run.polarity is polarity and run.word.ticks == shortest.word.ticks
    return same and key in met


def _names(made: Mapping[_Run, Test], runs: Iterable[_Run]) -> Ids:
    """Of the tests of some runs, the shortest first."""
    return tuple(made[run].name for run in sorted(runs, key=lambda run: run.rank))
