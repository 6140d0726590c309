"""The rows of the matrix of hazards and requirements, and the missing links."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from compiler.logic.claims import Layer
from compiler.project.hazards import without_hazard
from compiler.project.project import Project
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.evidence.verdicts import RETIRED, WAIVED
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.marks import Mark, sign_mark
from fretc.report.model.views import HazardRequirement, HazardView, Orphans, RequirementView
from fretc.report.sections.proofs import is_proved_layer, is_refuted
from fretish.diagnostics import status_symbols as signs
from fretish.reading.natural_order import natural

_LOOP = Mark("closed loop proved", "◆", "")
_MONITOR = Mark("monitor proved", "◇", "")
_REFUTED = sign_mark("counterexample", signs.BAD)
_REVIEWED = Mark("reviewed", "●", "")
_CHANGED = sign_mark("changed since the review", signs.SUSPECT)
_UNREVIEWED = Mark("not reviewed", "", "")
FACTS = (_LOOP, _MONITOR, _REFUTED, _REVIEWED, _CHANGED)
"""Symbols beside verdicts that the key of the matrix explains."""


def hazard_views(project: Project) -> tuple[HazardView, ...]:
    """The hazards in the order of their ids."""
    return tuple(
        HazardView(hazard.id, hazard.title, hazard.text, hazard.severity, hazard.source)
        for _, hazard in sorted(project.hazards.items())
    )


def matrix(
    project: Project,
    assessments: Sequence[Assessment],
    sections: Sequence[RequirementView],
) -> tuple[HazardRequirement, ...]:
    """A row for each hazard and requirement below it, then requirements without a hazard."""
    parents = {assessment.id: assessment.entry.parents for assessment in assessments}
    chains = [_chains(assessment.id, parents, project) for assessment in assessments]
    pairs = list(zip(assessments, sections, chains, strict=True))
    rows = [
        _row(hazard, via[hazard], assessment, section, project)
        for hazard in sorted(project.hazards)
        for assessment, section, via in pairs
        if hazard in via
    ]
    rest = [
        _row("", (), assessment, section, project) for assessment, section, via in pairs if not via
    ]
    return (*rows, *rest)


def _chains(
    id: str, parents: dict[str, tuple[str, ...]], project: Project
) -> dict[str, tuple[str, ...]]:
    """Hazard above a requirement → the requirements between them."""
    chains: dict[str, tuple[str, ...]] = {}
    visited = {id}
    waiting: list[tuple[str, tuple[str, ...]]] = [(id, ())]
    for requirement, via in waiting:
        for parent in parents.get(requirement, ()):
            if parent in project.hazards:
                chains.setdefault(parent, via)
            elif parent not in visited:
                visited.add(parent)
                waiting.append((parent, (*via, parent)))
    return chains


def _row(
    hazard: str,
    via: tuple[str, ...],
    assessment: Assessment,
    section: RequirementView,
    project: Project,
) -> HazardRequirement:
    return HazardRequirement(
        hazard=hazard,
        hazard_title=project.hazards[hazard].title if hazard else "",
        via=phrases.joined(via),
        requirement=assessment.id,
        title=section.title,
        status=section.status,
        anchor=assessment.anchor,
        mark=assessment.mark,
        runs=_runs(section),
        limit=section.limit,
        proof=_proof(section),
        review=_review(assessment),
        situations=section.situations,
    )


def _runs(section: RequirementView) -> int:
    covered = section.waiver if section.mark.word == WAIVED else None
    word = covered.covers.word if covered else section.mark.word
    return sum(result.mark.word == word for result in section.results)


def _proof(section: RequirementView) -> Mark | None:
    if is_refuted(section):
        return _REFUTED
    if is_proved_layer(section, Layer.LOOP):
        return _LOOP
    return _MONITOR if is_proved_layer(section, Layer.MONITOR) else None


def _review(assessment: Assessment) -> Mark:
    if assessment.review_status.review is None:
        return _UNREVIEWED
    return _CHANGED if assessment.review_status.is_suspect else _REVIEWED


# Orphans ---------------------------------------------------------------------------------------


def orphans(
    project: Project, assessments: Sequence[Assessment], summaries: ResultSummaries | None
) -> Orphans:
    """The missing links of the chain from hazard to verdict."""
    return Orphans(
        hazards=tuple(_uncovered(project, assessments)),
        requirements=(
            *(
                f"{assessment.id} names no parent"
                for assessment in assessments
                if not assessment.entry.parents
            ),
            *_rootless(project),
        ),
        parents=tuple(_undeclared(project, assessments)),
        evidence=tuple(
            f"{id} has evidence, but is not among the requirements"
            for id in unknown_ids(assessments, summaries)
        ),
    )


def _rootless(project: Project) -> Iterable[str]:
    """Requirements in force whose declared parents lead to no hazard, or form a cycle."""
    declared = {*project.hazards, *project.parents}
    known = declared | {requirement.id for requirement in project.requirements}
    active = [r for r in project.requirements if r.is_in_force]
    for requirement in without_hazard(active, declared) if declared else ():
        if known.issuperset(requirement.parents):
            yield f"the parents of {requirement.id} lead to no hazard"


def _uncovered(project: Project, assessments: Sequence[Assessment]) -> Iterable[str]:
    parents = {assessment.id: assessment.entry.parents for assessment in assessments}
    covered: dict[str, set[str]] = {}
    for assessment in assessments:
        for above in _chains(assessment.id, parents, project):
            covered.setdefault(above, set()).add(assessment.entry.status)
    for id in sorted(project.hazards, key=natural):
        hazard = project.hazards[id]
        if id not in covered:
            yield f"{id} ({hazard.title}) has no requirement"
        elif covered[id] == {RETIRED}:
            yield f"{id} ({hazard.title}) has only retired requirements"


def _undeclared(project: Project, assessments: Sequence[Assessment]) -> Iterable[str]:
    declared = {*project.hazards, *project.parents, *(assessment.id for assessment in assessments)}
    for assessment in assessments:
        for parent in assessment.entry.parents:
            if parent not in declared:
                yield f"{assessment.id} names {parent}, which is not declared"


def unknown_ids(
    assessments: Sequence[Assessment], summaries: ResultSummaries | None
) -> tuple[str, ...]:
    """The ids in the evidence that are not in the project."""
    ids = {assessment.id for assessment in assessments}
    audited = summaries.by_requirement.keys() if summaries else ()
    return tuple(sorted({*audited} - ids, key=natural))
