"""The matrix of hazards, requirements, artefacts and runs, and the links that are missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from compiler.project.ancestry import without_hazard
from compiler.project.folder import Project
from fretc.audit.evidence.briefs import Briefs
from fretc.audit.evidence.verdicts import RETIRED
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.views import Cell, HazardView, Orphans, RequirementView, Row
from fretc.report.sections.results import result_anchor
from fretc.report.sections.runs import Run, RunKey, run_key
from fretish.reading.natural_order import natural

_SINGLE = 6
"""Above this number, the runs of one verdict share one cell."""


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
    runs: Mapping[RunKey, Run],
) -> tuple[Row, ...]:
    """A row for each hazard and requirement below it; then the requirements below none."""
    parents = {assessment.id: assessment.requirement.parents for assessment in assessments}
    chains = [_chains(assessment.id, parents, project) for assessment in assessments]
    pairs = list(zip(assessments, sections, chains, strict=True))
    rows = [
        _row(hazard, via[hazard], assessment, section, project, runs)
        for hazard in sorted(project.hazards)
        for assessment, section, via in pairs
        if hazard in via
    ]
    rest = [
        _row("", (), assessment, section, project, runs)
        for assessment, section, via in pairs
        if not via
    ]
    return (*rows, *rest)


def _chains(
    id: str, parents: dict[str, tuple[str, ...]], project: Project
) -> dict[str, tuple[str, ...]]:
    """Each hazard that a requirement traces to → the requirements in between."""
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
    runs: Mapping[RunKey, Run],
) -> Row:
    return Row(
        hazard=hazard,
        hazard_title=project.hazards[hazard].title if hazard else "",
        via=phrases.joined(via),
        requirement=assessment.id,
        title=section.title,
        status=section.status,
        anchor=assessment.anchor,
        mark=assessment.mark,
        limit=section.limit,
        artefacts=section.artefacts,
        cells=_cells(assessment, runs),
    )


def _cells(assessment: Assessment, runs: Mapping[RunKey, Run]) -> tuple[Cell, ...]:
    """A cell for each run, the worst first; many runs of one verdict share a cell."""
    if not assessment.audits:
        return (Cell(assessment.mark, "", assessment.anchor),)
    counts = Counter(audit.mark for audit in assessment.reviewed_audits)
    single = [
        Cell(audit.mark, runs[run_key(audit.result)].label, result_anchor(assessment, number))
        for number, audit in enumerate(assessment.reviewed_audits, 1)
        if counts[audit.mark] <= _SINGLE
    ]
    shared = [
        Cell(mark, f"in {phrases.times(count, 'run')}", assessment.anchor)
        for mark, count in counts.items()
        if count > _SINGLE
    ]
    return tuple(sorted([*single, *shared], key=lambda cell: cell.mark.severity))


# Orphans ---------------------------------------------------------------------------------------


def orphans(project: Project, assessments: Sequence[Assessment], briefs: Briefs | None) -> Orphans:
    """Every place where the chain from hazard to verdict ends too early."""
    return Orphans(
        hazards=tuple(_uncovered(project, assessments)),
        requirements=(
            *(f"{each.id} names no parent" for each in assessments if not each.requirement.parents),
            *_rootless(project),
        ),
        parents=tuple(_undeclared(project, assessments)),
        evidence=tuple(
            f"{id} has evidence, but is not among the requirements"
            for id in unknown_ids(assessments, briefs)
        ),
    )


def _rootless(project: Project) -> Iterable[str]:
    """The requirements in force whose parents are there, and lead to nothing or in a circle."""
    declared = {*project.hazards, *project.parents}
    known = declared | {requirement.id for requirement in project.requirements}
    active = [r for r in project.requirements if r.status != RETIRED]
    for requirement in without_hazard(active, declared) if declared else ():
        if known.issuperset(requirement.parents):
            yield f"the parents of {requirement.id} lead to no hazard"


def _uncovered(project: Project, assessments: Sequence[Assessment]) -> Iterable[str]:
    parents = {assessment.id: assessment.requirement.parents for assessment in assessments}
    covered: dict[str, set[str]] = {}
    for assessment in assessments:
        for above in _chains(assessment.id, parents, project):
            covered.setdefault(above, set()).add(assessment.requirement.status)
    for id in sorted(project.hazards, key=natural):
        hazard = project.hazards[id]
        if id not in covered:
            yield f"{id} ({hazard.title}) has no requirement"
        elif covered[id] == {RETIRED}:
            yield f"{id} ({hazard.title}) has only retired requirements"


def _undeclared(project: Project, assessments: Sequence[Assessment]) -> Iterable[str]:
    declared = {*project.hazards, *project.parents, *(assessment.id for assessment in assessments)}
    for assessment in assessments:
        for parent in assessment.requirement.parents:
            if parent not in declared:
                yield f"{assessment.id} names {parent}, which is not declared"


def unknown_ids(assessments: Sequence[Assessment], briefs: Briefs | None) -> tuple[str, ...]:
    """The ids in the evidence that are not ids of the project."""
    ids = {assessment.id for assessment in assessments}
    audited = briefs.by_requirement.keys() if briefs else ()
    return tuple(sorted({*audited} - ids, key=natural))
