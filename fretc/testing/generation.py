"""Test generation for one requirement: a shortest run for each situation and each mutant."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.situations.mutants import Mutant, mutants
from compiler.situations.situations import Situation, situations
from compiler.targets.python import monitor as emitted
from fretc.analysis.arena.variables import UnsupportedError
from fretc.testing.cover import cover
from fretc.testing.requirement_model import Ids
from fretc.testing.runs import Absence, Answer, FoundRuns, Need, TestRun
from fretc.testing.suite import (
    GoalResult,
    GoalStatus,
    MutantResult,
    MutantStatus,
    Polarity,
    Test,
    Tested,
    unused,
)
from fretc.testing.words import Expected, expected, undecided
from fretish.checking import is_formula
from fretish.classes.frozen import dataclass
from fretish.printer import sentence as printed
from fretish.reading.recursion import with_recursion_limit
from monitors.kernel.verdicts import Verdict
from monitors.loading import load


@dataclass(frozen=True, slots=True)
class Batch:
    """Tests, situations and mutants of one requirement."""

    tested: Tested
    tests: tuple[Test, ...]
    obligations: tuple[GoalResult, ...]
    mutants: tuple[MutantResult, ...]


@with_recursion_limit
def batch(
    requirement: FormalizedRequirement, others: Sequence[FormalizedRequirement], seconds: float
) -> Batch:
    """The tests of a requirement.

    Args:
        requirement: the requirement.
        others: requirements and assumptions that share variables with it, directly or indirectly;
            its tests satisfy them.
        seconds: CPU seconds.
    """
    if is_formula(requirement.sentence):
        return lost(requirement, "it is a formula, and tests are made for sentences")
    try:
        return _Generation(FoundRuns(requirement, others, seconds)).batch()
    except UnsupportedError as error:
        return lost(requirement, str(error))


def lost(requirement: FormalizedRequirement, why: str) -> Batch:
    """The batch of a requirement without a search, with the reason."""
    return Batch(
        _tested(requirement, (), ""),
        (),
        tuple(
            _obligation(requirement, each, polarity, GoalStatus.NOT_SEARCHED, why=why)
            for each in situations(requirement)
            for polarity in _polarities(each)
        ),
        tuple(
            _mutated(requirement, each, MutantStatus.NOT_SEARCHED, why=why)
            for each in mutants(requirement)
        ),
    )


def _tested(requirement: FormalizedRequirement, kept: Ids, uncertainty: str) -> Tested:
    return Tested(
        requirement.id, printed(requirement.written), requirement.fingerprint, kept, uncertainty
    )


def _obligation(
    requirement: FormalizedRequirement,
    situation: Situation,
    polarity: Polarity,
    outcome: GoalStatus,
    *,
    tests: Ids = (),
    by: Ids = (),
    why: str = "",
) -> GoalResult:
    return GoalResult(
        requirement.id, situation.key, situation.words, polarity, outcome, tests, by, why
    )


def _mutated(
    requirement: FormalizedRequirement,
    mutant: Mutant,
    outcome: MutantStatus,
    *,
    tests: Ids = (),
    by: Ids = (),
    why: str = "",
) -> MutantResult:
    return MutantResult(
        requirement.id,
        mutant.key,
        mutant.words,
        printed(mutant.requirement.written),
        outcome,
        tests,
        by,
        why,
    )


def _polarities(situation: Situation) -> tuple[Polarity, ...]:
    """Polarities of the tests of a situation."""
    if situation.unknown is not None:
        return (Polarity.UNKNOWN,)
    return Polarity.KEPT, Polarity.BROKEN


# Choices ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Purpose:
    """Goal for which a run was selected."""

    key: str
    words: str


class _Generation:
    """Generation of a batch from the runs of one requirement."""

    def __init__(self, runs: FoundRuns) -> None:
        self._runs, self._rule = runs, runs.requirement
        self._situations, self._wrong = runs.situations, runs.mutants
        self._monitor = load(f"{self._rule.id}.py", emitted.text(self._rule))

    def batch(self) -> Batch:
        """The whole batch."""
        met = {
            (each.key, polarity): self._runs.meeting(each, polarity)
            for each in self._situations
            for polarity in _polarities(each)
        }
        runs = self._meeting_all(met)
        told = self._telling(runs)
        runs |= self._telling_apart(told, runs)
        names: set[str] = set()
        made = {run: self._test(run, purpose, names) for run, purpose in runs.items()}
        return Batch(
            _tested(self._rule, self._runs.bench.others, self._runs.bench.uncertainty),
            tuple(made.values()),
            tuple(self._obligations(met, made)),
            tuple(self._mutants(told, made)),
        )

    # Choices

    def _meeting_all(self, met: Mapping[Need, Answer]) -> dict[TestRun, _Purpose]:
        """Runs as short as the found ones, one for several goals; each with its goals."""
        runs = {need: run for need, run in met.items() if isinstance(run, TestRun)}
        shown = {
            run: [need for need, shortest in runs.items() if _serves(run, need, shortest)]
            for run in runs.values()
        }
        chosen = cover(shown, {run: run.rank for run in shown})
        common = Counter(need for needs in shown.values() for need in needs)
        special = {min(needs, key=common.__getitem__): run for run, needs in chosen.items()}
        return {special[need]: self._purpose(*need) for need in met if need in special}

    def _purpose(self, key: str, polarity: Polarity) -> _Purpose:
        words = next(situation.words for situation in self._situations if situation.key == key)
        return _Purpose(key if polarity is Polarity.UNKNOWN else f"{key}-{polarity}", words)

    def _telling_apart(
        self, told: Mapping[str, Answer], runs: Collection[TestRun]
    ) -> dict[TestRun, _Purpose]:
        """Runs for the mutants that the given runs do not kill."""
        alive = {mutant.key for mutant in self._wrong}.difference(*(run.kills for run in runs))
        shown = {
            run: [mutant.key for mutant in self._wrong if mutant.key in run.kills & alive]
            for run in told.values()
            if isinstance(run, TestRun)
        }
        chosen = cover(shown, {run: run.rank for run in shown})
        words = {mutant.key: mutant.words for mutant in self._wrong}
        return {
            run: _Purpose(
                f"unlike-{key}", f"distinguishes {self._rule.id} from its mutant with {words[key]}"
            )
            for run, (key, *_) in chosen.items()
        }

    # Records

    def _test(self, run: TestRun, purpose: _Purpose, names: set[str]) -> Test:
        name = re.sub("[^a-z0-9]+", "-", f"{self._rule.id} {purpose.key}".lower()).strip("-")
        says = self._expected(run)
        return Test(
            name=unused(name, names),
            requirement=self._rule.id,
            words="; ".join([purpose.words, *self._outcome(run.polarity, says.verdict)]),
            rows=run.word.rows,
            polarity=run.polarity,
            verdict=says.verdict,
            finite=says.finite,
            decided=says.decided,
            first_violation=says.first_violation,
            because=says.because,
            situations=tuple(
                situation.key for situation in self._situations if situation.key in run.situations
            ),
            kills=tuple(mutant.key for mutant in self._wrong if mutant.key in run.kills),
        )

    def _outcome(self, polarity: Polarity, verdict: Verdict) -> Iterator[str]:
        """Verdict and violation of a run; no violation if only its end is wrong."""
        if polarity is Polarity.BROKEN and verdict == Verdict.INCONCLUSIVE:
            yield f"the run ends while {self._rule.id} is not met"
        elif polarity is not Polarity.UNKNOWN:
            yield f"{self._rule.id} is {polarity}"

    def _expected(self, run: TestRun) -> Expected:
        requirement, monitor = self._rule, self._monitor
        if run.polarity is Polarity.UNKNOWN:
            atom = next(
                situation.unknown
                for situation in self._situations
                if situation.key in run.situations
            )
            assert atom is not None
            return undecided(requirement, monitor, run.word, atom)
        found = expected(requirement, monitor, run.word)
        assert found.finite is (run.polarity is Polarity.KEPT)
        return found

    def _obligations(
        self, met: Mapping[Need, Answer], made: Mapping[TestRun, Test]
    ) -> Iterator[GoalResult]:
        for situation in self._situations:
            for polarity in _polarities(situation):
                answer = met[situation.key, polarity]
                if isinstance(answer, TestRun):
                    runs = [run for run in made if run.polarity is polarity]
                    tests = _names(made, [run for run in runs if situation.key in run.situations])
                    yield _obligation(self._rule, situation, polarity, GoalStatus.MET, tests=tests)
                else:
                    outcome = answer.outcome(
                        GoalStatus.IMPOSSIBLE, GoalStatus.EXCLUDED, GoalStatus.NOT_SEARCHED
                    )
                    yield _obligation(
                        self._rule, situation, polarity, outcome, by=answer.by, why=answer.why
                    )

    def _mutants(
        self, told: Mapping[str, Answer], made: Mapping[TestRun, Test]
    ) -> Iterator[MutantResult]:
        for mutant in self._wrong:
            answer = told.get(mutant.key)
            if isinstance(answer, Absence):
                outcome = answer.outcome(
                    MutantStatus.EQUIVALENT, MutantStatus.EXCLUDED, MutantStatus.NOT_SEARCHED
                )
                yield _mutated(self._rule, mutant, outcome, by=answer.by, why=answer.why)
            else:
                tests = _names(made, [run for run in made if mutant.key in run.kills])
                assert tests
                yield _mutated(self._rule, mutant, MutantStatus.KILLED, tests=tests)

    def _telling(self, chosen: Iterable[TestRun]) -> dict[str, Answer]:
        """A shortest run for each mutant that no selected run kills, one for several mutants."""
        answers: dict[str, Answer] = {}
        runs = list(chosen)
        for mutant in self._wrong:
            if not any(mutant.key in run.kills for run in runs):
                answer = answers[mutant.key] = self._runs.telling(mutant)
                if isinstance(answer, TestRun):
                    runs.append(answer)
        return answers


def _serves(run: TestRun, need: Need, shortest: TestRun) -> bool:
    """Whether a run serves a goal as well as the run that was found for it."""
    key, polarity = need
    met = run.early if key in shortest.early else run.situations
    same = run.polarity is polarity and run.word.ticks == shortest.word.ticks
    return same and key in met


def _names(made: Mapping[TestRun, Test], runs: Iterable[TestRun]) -> Ids:
    """Names of the tests of some runs, the shortest first."""
    return tuple(made[run].name for run in sorted(runs, key=lambda run: run.rank))
