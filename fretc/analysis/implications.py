"""Implications among requirements, for any choice of outputs: about runs, not games."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations, islice
from operator import attrgetter

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.findings import Inconsistency, OpenQuestion, Redundancy, Vacuity
from fretc.analysis.games.cores import minimal
from fretc.analysis.realizability_problem import RealizabilityProblem
from fretc.analysis.reasons import listed
from fretish.classes.frozen import dataclass

MOST_TRIPLES = 500
"""Maximum number of triples of linked requirements that are examined."""
_FEW = 3
"""Number of requirements up to which they are examined by themselves."""


@dataclass(frozen=True, slots=True)
class Consistency:
    """Whether a run satisfies all requirements; None: unknown."""

    requirements: tuple[str, ...]
    holds: bool | None


@dataclass(frozen=True, slots=True)
class ConstantRequirement:
    """A requirement that every run satisfies, or no run."""

    requirement: str
    always: bool


@dataclass(frozen=True, slots=True)
class Removable:
    """Redundant requirements that the others imply even together."""

    requirements: tuple[str, ...]


def consistency(
    setting: RealizabilityProblem, budget: Budget
) -> Iterator[Consistency | OpenQuestion]:
    """Whether any run satisfies all requirements."""
    ids = tuple(requirement.id for requirement in setting.requirements)
    question = f"whether any run satisfies {listed(ids)}"
    uncertainty = setting.left_out or setting.of_inputs or setting.of_outputs
    try:
        there = setting.close(ids, budget)
        counters = there.counters(ids)
        is_possible = there.runs(counters, budget).is_possible()
        if is_possible and setting.left_out is None and uncertainty is not None:
            is_certain = there.runs(counters, budget, certain=True).is_possible()
            uncertainty = None if is_certain else uncertainty
    except OutOfTimeError as error:
        yield Consistency(ids, None)
        yield OpenQuestion(question, str(error))
        return
    if is_possible and uncertainty is not None:
        yield Consistency(ids, None)
        yield OpenQuestion(question, uncertainty)
    else:
        yield Consistency(ids, is_possible)


def constants(
    setting: RealizabilityProblem, budget: Budget
) -> Iterator[ConstantRequirement | OpenQuestion]:
    """Requirements that every run satisfies, or no run."""
    for counter in setting.arena.counters:
        try:
            if not setting.runs((counter,), budget.again()).is_possible():
                yield ConstantRequirement(counter.id, always=False)
            elif _is_implied(setting, counter, (), budget.again()):
                yield ConstantRequirement(counter.id, always=True)
        except OutOfTimeError as error:
            yield OpenQuestion(f"whether every run satisfies {counter.id}", str(error))


def redundancies(
    setting: RealizabilityProblem, budget: Budget
) -> Iterator[Redundancy | Removable | OpenQuestion]:
    """Requirements that others imply, one at a time; then those that can be removed together."""
    counters = setting.arena.counters
    found: list[str] = []
    for counter in counters:
        others = [each for each in counters if each is not counter]
        try:
            by = _implying(setting, counter, others, budget.again())
        except OutOfTimeError as error:
            yield OpenQuestion(f"whether others imply {counter.id}", str(error))
            continue
        if by is not None:
            found.append(counter.id)
            yield Redundancy(counter.id, tuple(sorted(by)))
    try:
        yield Removable(_removable(setting, found, budget.again()))
    except OutOfTimeError as error:
        yield OpenQuestion(f"which of {listed(found)} can be removed together", str(error))


def _removable(
    setting: RealizabilityProblem, redundant: Sequence[str], budget: Budget
) -> tuple[str, ...]:
    gone: list[str] = []
    for id in redundant:
        (counter,) = setting.counters([id])
        rest = [each for each in setting.arena.counters if each.id not in (*gone, id)]
        if _is_implied(setting, counter, rest, budget):
            gone.append(id)
    return tuple(sorted(gone))


def _implying(
    setting: RealizabilityProblem,
    counter: RequirementCounter,
    others: Sequence[RequirementCounter],
    budget: Budget,
) -> tuple[str, ...] | None:
    """A minimal set of others that implies a counter; None: there is none."""

    def implied(ids: Sequence[str]) -> bool:
        return _is_implied(setting, counter, setting.counters(ids), budget)

    every = [other.id for other in others]
    if not implied(every):
        return None
    single = next((ids for ids in ([], *([id] for id in every)) if implied(ids)), None)
    return tuple(single) if single is not None else minimal(every, implied)


def _is_implied(
    setting: RealizabilityProblem,
    counter: RequirementCounter,
    others: Sequence[RequirementCounter],
    budget: Budget,
) -> bool:
    """Whether runs satisfy the others, and none of these runs violates the counter."""
    setting = setting.close((each.id for each in (counter, *others)), budget)
    (counter,) = setting.counters([counter.id])
    kept = setting.counters(other.id for other in others)
    runs = setting.runs(kept, budget, watched=(counter,))
    lasting = runs.lasting()
    if (runs.transition.initial & lasting) == bdd.false():
        return False  # Without any run, every statement about runs holds.
    return not runs.can_break(counter, lasting)


def vacuities(setting: RealizabilityProblem, budget: Budget) -> Iterator[Vacuity | OpenQuestion]:
    """Requirements whose scope or trigger never occurs in runs that satisfy the others."""
    requirements = {requirement.id: requirement for requirement in setting.requirements}
    for counter in setting.arena.counters:
        others = [each.id for each in setting.arena.counters if each is not counter]
        try:
            vacuity = _vacuity(setting, requirements[counter.id], counter, others, budget.again())
        except OutOfTimeError as error:
            yield OpenQuestion(f"whether {counter.id} is ever triggered", str(error))
            continue
        if vacuity is not None:
            yield vacuity


def _vacuity(
    setting: RealizabilityProblem,
    requirement: FormalizedRequirement,
    counter: RequirementCounter,
    others: Sequence[str],
    budget: Budget,
) -> Vacuity | None:
    def excluded(ids: Sequence[str], ticks: Callable[[RequirementCounter], Function]) -> bool:
        there = setting.close([*ids, counter.id], budget)
        (watched,) = there.counters([counter.id])
        runs = there.runs(there.counters(ids), budget, watched=(watched,))
        lasting = runs.lasting()
        if (runs.transition.initial & lasting) == bdd.false():
            return False
        return not runs.can_reach(ticks(watched), lasting)

    def by(ticks: Callable[[RequirementCounter], Function]) -> tuple[str, ...]:
        return tuple(sorted(minimal(others, lambda ids: excluded(ids, ticks))))

    in_scope, begun = attrgetter("enforced"), attrgetter("triggered")
    if requirement.sentence.scope is not None and excluded(others, in_scope):
        return Vacuity(counter.id, by(in_scope), "scope")
    if requirement.sentence.condition is not None and excluded(others, begun):
        return Vacuity(counter.id, by(begun), "trigger")
    return None


def inconsistencies(
    setting: RealizabilityProblem, budget: Budget
) -> Iterator[Inconsistency | OpenQuestion]:
    """Pairs and triples that can become impossible to satisfy together; else the whole set.

    Source: Post, Hoenicke, Podelski, rt-Inconsistency: a new property for real-time requirements,
    FASE 2011. The property is not monotone, so leaving requirements out does not minimize it.
    """
    if len(setting.requirements) == 1:
        return
    uncertainty = setting.of_inputs or setting.of_outputs
    counters = setting.arena.counters
    names = listed([requirement.id for requirement in setting.requirements])
    question = f"whether a run can make {names} impossible to satisfy together"
    if uncertainty is not None:
        yield OpenQuestion(question, uncertainty)
        return
    groups: list[frozenset[str]] = []
    try:
        alone = {counter.id: setting.runs((counter,), budget).lasting() for counter in counters}
        for members in _candidates(setting, counters):
            ids = frozenset(member.id for member in members)
            if any(smaller <= ids for smaller in groups):
                continue
            if len(members) > _FEW and groups:
                continue
            clash = _inconsistency(setting, members, alone, budget)
            if clash is not None:
                groups.append(ids)
                yield clash
    except OutOfTimeError as error:
        yield OpenQuestion(question, str(error))


def _candidates(
    setting: RealizabilityProblem, counters: Sequence[RequirementCounter]
) -> Iterator[tuple[RequirementCounter, ...]]:
    """Pairs and triples that share variables, and the whole set."""
    read = {
        requirement.id: frozenset(requirement.variables) for requirement in setting.requirements
    }

    def near(left: RequirementCounter, right: RequirementCounter) -> bool:
        return bool(read[left.id] & read[right.id])

    yield from (pair for pair in combinations(counters, 2) if near(*pair))
    near_triples = (
        (a, b, c)
        for a, b, c in combinations(counters, 3)
        if near(a, b) + near(b, c) + near(a, c) > 1
    )
    triples = list(islice(near_triples, MOST_TRIPLES + 1))
    if len(triples) <= MOST_TRIPLES:
        yield from triples
    if len(counters) > _FEW:
        yield tuple(counters)


def _inconsistency(
    setting: RealizabilityProblem,
    members: Sequence[RequirementCounter],
    alone: Mapping[str, Function],
    budget: Budget,
) -> Inconsistency | None:
    ids = sorted(member.id for member in members)
    there = setting.close(ids, budget)
    if there is not setting:
        setting, members = there, there.counters(ids)
        alone = {member.id: setting.runs((member,), budget).lasting() for member in members}
    runs = setting.runs(members, budget)
    each_alone = bdd.true()
    for counter in members:
        each_alone = each_alone & alone[counter.id]
    clash = each_alone - runs.lasting()
    if clash == bdd.false():
        return None
    letters = runs.path(clash, each_alone)
    if letters is None:
        return None
    return Inconsistency(tuple(ids), setting.ticks(ids, [(letter, 1) for letter in letters]))
