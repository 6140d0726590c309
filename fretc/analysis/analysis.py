"""The analysis of a requirement set: all questions, component by component."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import TypeVar

from compiler.files.build_id import __version__
from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import all_comparisons, temporal_predicate
from fretc.analysis import implications as of_runs
from fretc.analysis.answers import fingerprint
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.components import about, by_outputs, by_variables
from fretc.analysis.conflicts import Completeness, conflicts
from fretc.analysis.controllers.circuit import Circuit
from fretc.analysis.controllers.files import ControllerFormat
from fretc.analysis.controllers.moves import Mealy
from fretc.analysis.findings import (
    SCHEMA,
    Analysis,
    Assumption,
    Component,
    Conflict,
    Inconsistency,
    OpenQuestion,
    RealizabilityVerdict,
    Redundancy,
    Repair,
    Vacuity,
)
from fretc.analysis.formula_games import formula_game
from fretc.analysis.games import job as of_games
from fretc.analysis.implications import Consistency, ConstantRequirement, Removable
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretc.analysis.repairs import repairs
from fretc.analysis.verdicts import component, strategy, verdict
from fretish.bindings.declarations import Role
from fretish.checking import NUMBERS_BACK, calls, conditions, is_formula
from fretish.classes.frozen import dataclass
from fretish.printer import sentence as printed
from fretish.reading.recursion import with_recursion_limit


@dataclass(frozen=True, slots=True)
class AnalysisOptions:
    """Options of an analysis."""

    seconds: float = 20.0
    """CPU time limit in seconds, for each question about each component."""
    as_fret: bool = False
    """Answer FRET's question: the past form of each requirement holds at every tick, so that
    `eventually` means at once."""
    repairs: bool = True
    """Whether to search for repairs of conflicts."""


DEFAULT = AnalysisOptions()
F = TypeVar("F", bound="Finding")
Finding = (
    Component
    | Conflict
    | Completeness
    | Consistency
    | ConstantRequirement
    | Redundancy
    | Removable
    | Vacuity
    | Inconsistency
    | Repair
    | OpenQuestion
    | Circuit
    | Mealy
)


Job = of_games.Job[Finding]


@with_recursion_limit
def analyze(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    assumptions: Sequence[FormalizedRequirement] = (),
    options: AnalysisOptions = DEFAULT,
) -> Analysis:
    """The analysis of the requirements, computed in this process.

    Args:
        requirements: the requirements, in the order of the files.
        roles: role of every variable of requirements and assumptions.
        assumptions: the assumptions about the environment.
        options: time limits, and whether FRET's question is answered.
    """
    findings: list[Finding] = []
    for job in jobs(requirements, roles, assumptions, options):
        try:
            findings.extend(job.ask(findings))
        except MemoryError:
            findings.append(job.out_of_memory())
    return assembled(requirements, roles, assumptions, options, findings)


Question = Callable[[RealizabilityProblem, Budget], Iterator[Finding]]
_OF_GROUPS: Mapping[str, Question] = {
    "is any of {} satisfied by every run?": of_runs.constants,
    "is each of {} ever triggered?": of_runs.vacuities,
    "do some of {} imply others?": of_runs.redundancies,
    "can a run make {} impossible to satisfy together?": of_runs.inconsistencies,
}


def jobs(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    assumptions: Sequence[FormalizedRequirement],
    options: AnalysisOptions,
) -> tuple[Job, ...]:
    """All questions, the most important ones first."""
    components = [
        _Setting("component", each, roles, assumptions, options)
        for each in by_outputs(requirements, assumptions, roles)
    ]
    groups = [
        _Setting("group", each, roles, assumptions, options)
        for each in by_variables(requirements, assumptions, roles)
    ]
    return (
        *([_promises(assumptions, roles, options)] if assumptions else []),
        *(setting.verdict() for setting in components),
        *(setting.conflicts() for setting in components),
        *(setting.consistency() for setting in groups),
        *(
            setting.job(title, question)
            for title, question in _OF_GROUPS.items()
            for setting in groups
        ),
        *(setting.repairs() for setting in components if options.repairs),
    )


def _promises(
    assumptions: Sequence[FormalizedRequirement], roles: Roles, options: AnalysisOptions
) -> Job:
    """Job: whether any run satisfies the assumptions; otherwise every result would follow."""
    title = f"can any run satisfy the assumptions {', '.join(each.id for each in assumptions)}?"

    def ask(known: Sequence[Finding]) -> Iterator[Finding]:
        for group in by_variables(assumptions, (), roles):
            budget = Budget(options.seconds)
            setting = stage(group, (), roles, budget=budget)
            for each in of_runs.consistency(setting, budget):
                if isinstance(each, Consistency) and each.holds is False:
                    ids = ", ".join(each.requirements)
                    yield OpenQuestion(
                        "what follows from the assumptions", f"no run satisfies {ids}"
                    )

    problem = cache(partial(_fingerprint, "assumptions", (), roles, assumptions, options))
    return Job(title, ask, partial(OpenQuestion, title), problem)


def _fingerprint(
    kind: str,
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    assumptions: Sequence[FormalizedRequirement],
    options: AnalysisOptions,
) -> str:
    """Fingerprint of a problem with the assumptions that concern it, or of assumptions alone."""
    near = about(requirements, assumptions, roles) if requirements else assumptions
    choices = (options.seconds, options.as_fret, options.repairs, bool(assumptions))
    return fingerprint(kind, requirements, near, roles, choices)


def controllers(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    assumptions: Sequence[FormalizedRequirement],
    options: AnalysisOptions,
    form: ControllerFormat,
) -> tuple[Job, ...]:
    """Jobs that compute a controller of each realizable component in the given form."""
    return tuple(
        _Setting("component", each, roles, assumptions, options).controller(number, form)
        for number, each in enumerate(by_outputs(requirements, assumptions, roles), 1)
    )


class _Setting:
    """Requirements that are examined together; their arena is built when it is first needed."""

    def __init__(
        self,
        kind: str,
        requirements: Sequence[FormalizedRequirement],
        roles: Roles,
        assumptions: Sequence[FormalizedRequirement],
        options: AnalysisOptions,
    ) -> None:
        self._problem = cache(
            partial(_fingerprint, kind, requirements, roles, assumptions, options)
        )
        self._rules, self._roles, self._assumptions = requirements, roles, assumptions
        self._options = options
        ids = [requirement.id for requirement in requirements]
        self._name = (
            f"{ids[0]} and {len(ids) - 1} others" if len(ids) > _MOST_NAMES else ", ".join(ids)
        )
        self._ids = tuple(ids)
        self._built: RealizabilityProblem | None = None

    def _stage(self, budget: Budget) -> RealizabilityProblem:
        """The realizability problem, built within the time of the first question."""
        if self._built is None:
            as_fret = self._options.as_fret
            self._built = stage(
                self._rules, self._assumptions, self._roles, as_fret=as_fret, budget=budget
            )
        return self._built

    def verdict(self) -> Job:
        """Job: whether a component is realizable."""

        def not_checked(why: str) -> Component:
            return component(self._rules, self._roles, RealizabilityVerdict.NOT_CHECKED, why)

        def ask(known: Sequence[Finding]) -> Iterator[Finding]:
            budget = Budget(self._options.seconds)
            try:
                found, self._built = verdict(self._stage(budget), budget)
            except (UnsupportedError, OutOfTimeError) as error:
                found = not_checked(str(error))
            yield self._by_formulas(found)

        title = f"can {self._name} be satisfied together?"
        return Job(title, ask, not_checked, self._problem)

    def _by_formulas(self, found: Component) -> Component:
        """A component that is not checked, decided by the game of its formulas if it has any."""
        if found.verdict is not RealizabilityVerdict.NOT_CHECKED or self._options.as_fret:
            return found
        near = about(self._rules, self._assumptions, self._roles)
        answer = formula_game(self._rules, near, self._roles)
        return found if answer is None else component(self._rules, self._roles, *answer)

    def consistency(self) -> Job:
        """Job: whether any run satisfies all requirements of a group.

        A run exists if the group is realizable. None exists if a part is unrealizable even for a
        system that chooses every variable.
        """
        title = f"can any run satisfy {self._name}?"

        def ask(known: Sequence[Finding]) -> Iterator[Finding]:
            kept, lost = (
                {
                    id
                    for each in known
                    if isinstance(each, Component) and each.verdict is verdict
                    for id in each.requirements
                }
                for verdict in (RealizabilityVerdict.REALIZABLE, RealizabilityVerdict.UNREALIZABLE)
            )
            names = (name for requirement in self._rules for name in requirement.variables)
            chosen = [*map(self._roles.get, names)]
            if not self._assumptions and kept.issuperset(self._ids):
                yield Consistency(self._ids, True)
            elif not self._assumptions and lost & {*self._ids} and Role.INPUT not in chosen:
                yield Consistency(self._ids, False)
            else:
                yield from self._answers(title, of_runs.consistency)

        return self._job(title, ask)

    def conflicts(self) -> Job:
        """Job: the minimal conflicts of a component that is unrealizable or undecided."""
        title = f"which of {self._name} conflict?"

        def ask(known: Sequence[Finding]) -> Iterator[Finding]:
            mine = [
                each
                for each in known
                if isinstance(each, Component) and each.requirements == self._ids
            ]
            if any(each.verdict is RealizabilityVerdict.REALIZABLE for each in mine):
                yield Completeness(self._ids)
            else:
                yield from self._answers(title, conflicts)

        return self._job(title, ask)

    def repairs(self) -> Job:
        """Job: changes that would resolve the conflicts of a component."""
        title = f"what would resolve the conflicts of {self._name}?"

        def ask(known: Sequence[Finding]) -> Iterator[Finding]:
            mine = [
                each
                for each in known
                if isinstance(each, Conflict) and set(each.requirements) <= set(self._ids)
            ]
            if mine:
                yield from self._answers(title, lambda there, budget: repairs(there, mine, budget))

        return self._job(title, ask)

    def controller(self, number: int, form: ControllerFormat) -> Job:
        """Job: a controller of a realizable component."""
        title = f"how can {self._name} be satisfied?"

        def ask(known: Sequence[Finding]) -> Iterator[Finding]:
            yield from self._answers(title, partial(strategy, number=number, form=form))

        return Job(title, ask, partial(OpenQuestion, title))

    def job(self, title: str, question: Question) -> Job:
        """Job that asks one question about a group."""
        title = title.format(self._name)
        return self._job(title, lambda known: self._answers(title, question))

    def _job(self, title: str, ask: Callable[[Sequence[Finding]], Iterator[Finding]]) -> Job:
        return Job(title, ask, partial(OpenQuestion, title), self._problem)

    def _answers(self, title: str, question: Question) -> Iterator[Finding]:
        budget = Budget(self._options.seconds)
        try:
            yield from question(self._stage(budget), budget)
        except (UnsupportedError, OutOfTimeError) as error:
            yield OpenQuestion(title, str(error))


_MOST_NAMES = 4


# Assembly -------------------------------------------------------------------------------------


def assembled(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    assumptions: Sequence[FormalizedRequirement],
    options: AnalysisOptions,
    findings: Iterable[Finding],
) -> Analysis:
    """The findings as one analysis; a question without a finding is not checked."""
    found = tuple(findings)
    conflicting = [frozenset(each.requirements) for each in _of(Conflict, found)]
    components = tuple(_fought(each, conflicting) for each in _of(Component, found))
    fights = sorted(
        _of(Conflict, found), key=lambda each: (len(each.requirements), each.requirements)
    )
    open_ = _of(OpenQuestion, found)
    missing = [
        requirement.id
        for requirement in requirements
        if not any(requirement.id in c.requirements for c in components)
    ]
    overall, why = _verdict(components, missing)
    constants = _of(ConstantRequirement, found)
    known = {id for each in _of(Completeness, found) for id in each.requirements}
    return Analysis(
        schema=SCHEMA,
        fretc=__version__,
        verdict=overall,
        why=why,
        components=components,
        conflicts=tuple(fights),
        complete=known.issuperset(requirement.id for requirement in requirements),
        repairs=_of(Repair, found),
        redundant=_of(Redundancy, found),
        removable=tuple(sorted(id for each in _of(Removable, found) for id in each.requirements)),
        vacuous=_of(Vacuity, found),
        consistent=_consistent(requirements, _of(Consistency, found)),
        inconsistent=_of(Inconsistency, found),
        always=tuple(each.requirement for each in constants if each.always),
        never=tuple(each.requirement for each in constants if not each.always),
        assumptions=tuple(
            Assumption(assumption.id, assumption.entry.text, printed(assumption.written))
            for assumption in assumptions
        ),
        roles={name: roles[name] for name in sorted(roles)},
        terms=tuple(_terms([*requirements, *assumptions], bool(assumptions), options)),
        open=open_,
    )


def _of(kind: type[F], findings: Sequence[Finding]) -> tuple[F, ...]:
    return tuple(each for each in findings if isinstance(each, kind))


def _looks_back(requirement: FormalizedRequirement) -> bool:
    if is_formula(requirement.sentence):
        return False
    if temporal_predicate(requirement.sentence):
        return True
    return any(NUMBERS_BACK & {*calls(each)} for each in conditions(requirement.sentence))


def _verdict(
    components: Sequence[Component], missing: Sequence[str]
) -> tuple[RealizabilityVerdict, str]:
    """Verdict of the whole set: one unrealizable component is enough."""
    bad = [each for each in components if each.verdict is RealizabilityVerdict.UNREALIZABLE]
    unknown = [each for each in components if each.verdict is RealizabilityVerdict.NOT_CHECKED]
    if bad:
        which = "; ".join(", ".join(each.requirements) for each in bad)
        return RealizabilityVerdict.UNREALIZABLE, f"cannot be satisfied together: {which}"
    if missing:
        return RealizabilityVerdict.NOT_CHECKED, f"not examined: {', '.join(missing)}"
    if unknown:
        return RealizabilityVerdict.NOT_CHECKED, "; ".join(each.why for each in unknown)
    return RealizabilityVerdict.REALIZABLE, "for each component the system has a strategy"


def _fought(component: Component, conflicts: Sequence[frozenset[str]]) -> Component:
    """The component as unrealizable if it has a conflict, also if its own question timed out."""
    if component.verdict is RealizabilityVerdict.NOT_CHECKED and any(
        conflict.issubset(component.requirements) for conflict in conflicts
    ):
        return replace(
            component, verdict=RealizabilityVerdict.UNREALIZABLE, why="some of them conflict"
        )
    return component


def _consistent(
    requirements: Sequence[FormalizedRequirement], answers: Sequence[Consistency]
) -> bool | None:
    if any(each.holds is False for each in answers):
        return False
    known = {id for each in answers if each.holds for id in each.requirements}
    return True if known.issuperset(requirement.id for requirement in requirements) else None


def _terms(
    requirements: Sequence[FormalizedRequirement], assumes: bool, options: AnalysisOptions
) -> Iterator[str]:
    """Sentences with the assumptions of the analysis.

    Args:
        requirements: the requirements and the assumptions.
        assumes: whether there are assumptions.
        options: options of the analysis.
    """
    yield (
        "at each tick the environment sets all inputs, then the system all outputs, which may "
        "depend on them (Mealy)"
    )
    if options.as_fret:
        yield (
            "as FRET: the past form of each requirement holds at every tick, so that `eventually` "
            "means at once"
        )
    else:
        yield "an `eventually` may take any number of ticks, but not for ever"
    if assumes:
        yield "results about runs hold for the runs that satisfy all assumptions"
    if any(_looks_back(requirement) for requirement in requirements):
        yield (
            "before the first tick every proposition is false; `preBool`, `preInt` and `preReal` "
            "state their own first value"
        )
    if any(all_comparisons(requirement) for requirement in requirements):
        yield (
            "numbers are exact integers or reals without bounds; rounding of floats is not modelled"
        )
