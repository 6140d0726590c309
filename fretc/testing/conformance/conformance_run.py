"""Conformance test of a program: a run towards each situation of each requirement."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from random import Random

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.evaluation import evaluate
from compiler.logic.formula import Formula
from compiler.targets.python import monitor as emitted
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.components import about, by_variables
from fretc.testing.conformance.driving import ProgramDriver, Start
from fretc.testing.conformance.findings import SCHEMA, Conformance, Failure, GoalOutcome, Situated
from fretc.testing.conformance.oracle import Oracle, ProgramTrace, Tick, reason
from fretc.testing.conformance.requirement_groups import GoalPath, RequirementGroup, TargetState
from fretc.testing.conformance.shrinking import Shrinking
from fretc.testing.suite import Polarity, Repeat
from fretish.printer import sentence as printed

_ROAMING = 24
"""Number of random runs after the directed ones, to find faults between two requirements."""
_CHANGES = (0.5, 0.2, 0.05)
"""Probabilities that an input changes at a tick, used in turn."""
_PATIENCE, _EXTRA = 2, 8
"""Maximum length of a run: a multiple of the shortest way to its goal, and further ticks."""


class ConformanceRun:
    """All runs of one program, and the results so far."""

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        assumptions: Sequence[FormalizedRequirement],
        roles: Roles,
        seconds: float,
    ) -> None:
        """The test before the first run.

        Args:
            requirements: the requirements.
            assumptions: assumptions that the tester satisfies.
            roles: roles of all their variables.
            seconds: CPU seconds for the strategy towards each situation.

        Raises:
            UnsupportedError: the program cannot be given inputs.
            OutOfTimeError: the assumptions take too long.
        """
        refused = {requirement.id: emitted.refuse(requirement) for requirement in requirements}
        self._not_judged = {id: why.message for id, why in refused.items() if why is not None}
        self._rules = {
            requirement.id: requirement
            for requirement in requirements
            if requirement.id not in self._not_judged
        }
        self._seconds = seconds
        judged = [*self._rules.values()]
        if not judged:
            raise UnsupportedError("no requirement has a monitor")
        self.oracle = Oracle(judged, assumptions, roles)
        self._fields = [
            RequirementGroup(group, about(group, assumptions, roles), roles, Budget(seconds))
            for group in by_variables(judged, assumptions, roles)
        ]
        self._failures: dict[str, Failure] = {}
        self._outcomes: dict[TargetState, tuple[GoalOutcome, str]] = {}
        self._triggered: set[str] = set()
        self._runs = self._ticks = self._longest = 0
        self._is_whole = False

    def run(self, start: Start, progress: Callable[[str], None]) -> None:
        """Run all tests.

        Args:
            start: starts the program.
            progress: called with the name of each goal before its runs.

        Raises:
            UnsupportedError: no value is known for an input.
            ProgramError: the program violates the protocol.
        """
        driver = ProgramDriver(self._fields, self.oracle, start)
        try:
            for field in self._fields:
                for aim in field.aims:
                    if aim.requirement.id not in self._failures and aim not in self._outcomes:
                        progress(f"{aim.requirement.id}: {aim.situation.words}; {aim.polarity}")
                        self._go_for(aim, field, driver)
            self._roam(driver, progress)
            self._is_whole = True
        finally:
            self._runs, self._ticks = driver.runs, driver.ticks

    def _go_for(self, aim: TargetState, field: RequirementGroup, driver: ProgramDriver) -> None:
        """Runs towards a goal: one without needless changes of inputs, and random ones."""
        try:
            plan = field.plan(aim, Budget(self._seconds))
            if plan is None:
                return
            run = None
            for choose in self._choices(aim):
                run = self._try(aim, field, plan, choose, driver)
                if aim in self._outcomes or aim.requirement.id in self._failures:
                    return
        except OutOfTimeError as error:
            self._outcomes[aim] = GoalOutcome.NOT_SEARCHED, str(error)
            return
        _, is_forced = plan.distance(field.transition.start) or (0, False)
        first = f"it violates {', '.join(run.broken)} before" if run and run.broken else ""
        self._outcomes[aim] = (
            GoalOutcome.NOT_REACHED if is_forced else GoalOutcome.UP_TO_PROGRAM,
            first,
        )

    def _roam(self, driver: ProgramDriver, progress: Callable[[str], None]) -> None:
        """Random runs while a requirement has no known violation."""
        for number in range(_ROAMING):
            if len(self._failures) < len(self._rules):
                progress(f"random inputs: run {number + 1} of {_ROAMING}")
                change = _CHANGES[number % len(_CHANGES)]
                ticks = _PATIENCE * self._longest + _EXTRA
                run = driver.anywhere(Random(number), change, ticks)
                self._look(run, None, driver)

    def _choices(self, aim: TargetState) -> Iterator[Random | None]:
        """Choices of irrelevant inputs, run by run."""
        if aim.polarity is Polarity.KEPT:
            yield None
        yield Random(aim.name)

    def _try(
        self,
        aim: TargetState,
        field: RequirementGroup,
        plan: GoalPath,
        choose: Random | None,
        driver: ProgramDriver,
    ) -> ProgramTrace:
        ticks, _ = plan.distance(field.transition.start) or (0, False)
        self._longest = max(self._longest, ticks)
        run = driver.towards(field, plan, choose, _PATIENCE * ticks + _EXTRA)
        self._look(run, aim, driver)
        if _shows(run, aim, plan.shown):
            self._outcomes[aim] = GoalOutcome.REACHED, ""
        return run

    def _look(self, run: ProgramTrace, aim: TargetState | None, driver: ProgramDriver) -> None:
        """Record what a run shows about all requirements."""
        self._triggered |= run.triggered
        for id in run.broken:
            if id not in self._failures:
                self._failures[id] = self._failure(aim, self._rules[id], run, driver)
        for field in self._fields:
            for other in field.aims:
                if _shows(run, other, other.shown[0]):
                    self._outcomes[other] = GoalOutcome.REACHED, ""

    def _failure(
        self,
        aim: TargetState | None,
        requirement: FormalizedRequirement,
        run: ProgramTrace,
        driver: ProgramDriver,
    ) -> Failure:
        shrinking = Shrinking(requirement.id, self.oracle.inputs, driver.again, run)
        again = shrinking.again()
        best = shrinking.shrink() if again else run
        return Failure(
            requirement=requirement.id,
            sentence=printed(requirement.written),
            because=reason(requirement, best),
            rows=tuple(_repeats(best.rows)),
            situation="" if aim is None else aim.situation.key,
            ticks=len(run.rows),
            tries=shrinking.tries,
            again=again,
        )

    def findings(self, command: Sequence[str]) -> Conformance:
        """Results so far."""
        return Conformance(
            schema=SCHEMA,
            fretc=__version__,
            command=tuple(command),
            requirements=(*self._rules, *self._not_judged),
            runs=self._runs,
            ticks=self._ticks,
            situations=tuple(self._situated()),
            failures=tuple(self._failures[id] for id in self._rules if id in self._failures),
            untried=tuple(id for id in self._rules if id not in self._triggered),
            whole=self._is_whole,
            not_judged=self._not_judged,
        )

    def _situated(self) -> Iterator[Situated]:
        for field in self._fields:
            for aim in field.aims:
                if aim.polarity is Polarity.KEPT and aim in self._outcomes:
                    outcome, why = self._outcomes[aim]
                    place = aim.situation
                    yield Situated(aim.requirement.id, place.key, place.words, outcome, why)
            for what, why in field.beyond.items():
                id, _, words = what.partition(": ")
                yield Situated(id, "all", words or "all", GoalOutcome.NOT_SEARCHED, why)


def _shows(run: ProgramTrace, aim: TargetState, shown: Formula) -> bool:
    """Whether a run that satisfies a requirement shows a situation of it."""
    if aim.polarity is not Polarity.KEPT or aim.requirement.id in run.broken or not run.is_known:
        return False
    return bool(run.rows and evaluate(shown, run.columns(), len(run.rows)))


def _repeats(rows: Sequence[Tick]) -> Iterator[Repeat]:
    for values, equal in groupby(rows):
        yield Repeat(sum(1 for _ in equal), dict(values))
