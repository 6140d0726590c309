"""The result of `fretc analyze` for each requirement, and whether it is up to date.

A result covers a component: the requirements that shared outputs at the analysis or share them now,
and the assumptions. A change of another requirement does not affect it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain

from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project
from fretc.analysis.arena.systems import systems
from fretc.analysis.assumptions import assumptions, guarantees
from fretc.analysis.components import by_outputs
from fretc.analysis.evidence import AnalyzedRequirement, AnalyzedSet, members
from fretc.analysis.findings import Analysis, RealizabilityVerdict
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Realizability:
    """Whether one requirement is realizable together with the others of its component."""

    verdict: RealizabilityVerdict
    findings: tuple[str, ...]
    """A sentence for each conflict of the requirement, then for each assumption of the analysis."""
    differing: tuple[str, ...]
    """Ids of requirements and assumptions that have changed or disappeared since the analysis."""

    @property
    def texts(self) -> tuple[str, ...]:
        """The verdict, then the findings."""
        return (str(self.verdict), *self.findings)


def answers(analyzed: AnalyzedSet | None, project: Project) -> Mapping[str, Realizability]:
    """Requirement id → answer, for each requirement that was analyzed and still exists.

    Args:
        analyzed: the file of `fretc analyze`; None if there is none.
        project: the present project.
    """
    if analyzed is None:
        return {}
    document = analyzed.document
    requirements = guarantees(project.in_force)
    assumed, _ = assumptions(project.in_force, project.declarations)
    old = _differences(document.requirements, members(requirements))
    promises = _differences(document.assumptions, members(assumed))
    now = _components(requirements, assumed)
    answers_of: dict[str, Realizability] = {}
    for requirement in requirements:
        if requirement.id in document.requirements:
            then = _component(document.analysis, requirement.id)
            mates = {requirement.id, *then, *now[requirement.id]}
            differing = (*(id for id in old if id in mates), *promises)
            answers_of[requirement.id] = _answer(
                document.analysis, requirement.id, differing, document.as_fret
            )
    return answers_of


def _answer(
    analysis: Analysis, id: str, differing: tuple[str, ...], as_fret: bool
) -> Realizability:
    own = [component for component in analysis.components if id in component.requirements]
    verdict = own[0].verdict if own else RealizabilityVerdict.NOT_CHECKED
    return Realizability(verdict, tuple(_findings(analysis, id, as_fret)), differing)


def _findings(analysis: Analysis, id: str, as_fret: bool) -> Iterator[str]:
    for conflict in analysis.conflicts:
        if id in conflict.requirements:
            yield f"conflict of {', '.join(conflict.requirements)}"
    for assumption in analysis.assumptions:
        yield f"assumed {assumption.id}: {assumption.sentence}"
    if as_fret:
        yield "FRET's question"


def _component(analysis: Analysis, id: str) -> tuple[str, ...]:
    own = (
        component.requirements for component in analysis.components if id in component.requirements
    )
    return tuple(chain.from_iterable(own))


def _components(
    requirements: Sequence[FormalizedRequirement],
    assumed: Sequence[FormalizedRequirement],
) -> Mapping[str, tuple[str, ...]]:
    """Requirement id → ids in its present component."""
    groups: dict[str, tuple[str, ...]] = {}
    for system in systems(requirements, assumed).every:
        for group in by_outputs(system.requirements, system.assumptions, system.roles):
            ids = tuple(requirement.id for requirement in group)
            groups |= dict.fromkeys(ids, ids)
    return groups


def _differences(
    then: Mapping[str, AnalyzedRequirement], now: Mapping[str, AnalyzedRequirement]
) -> tuple[str, ...]:
    return tuple(
        id
        for id in dict.fromkeys((*then, *now))
        if id not in then or id not in now or then[id].sha256 != now[id].sha256
    )
