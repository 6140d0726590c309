"""Hazard by requirement by artefacts by runs, and where the chain has no link."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from compiler.project.ancestry import without_hazard
from compiler.project.folder import Project
from fretc.audit.evidence.schema import Evidence
from fretc.audit.evidence.verdicts import RETIRED
from fretc.report.model import phrases
from fretc.report.model.claims import Claim
from fretc.report.model.views import Cell, HazardView, Orphans, RequirementView, Row
from fretc.report.sections.results import result_anchor
from fretc.report.sections.runs import Key, Run, key
from fretish.reading.natural_order import natural

_SINGLE = 6
"""More runs of one verdict than these share one cell."""


def hazard_views(project: Project) -> tuple[HazardView, ...]:
    """The hazards in the order of their ids."""
    return tuple(
        HazardView(hazard.id, hazard.title, hazard.text, hazard.severity, hazard.source)
        for _, hazard in sorted(project.hazards.items())
    )


def matrix(
    project: Project,
    claims: Sequence[Claim],
    sections: Sequence[RequirementView],
    runs: dict[Key, Run],
) -> tuple[Row, ...]:
    """A row for each hazard and requirement below it; then the requirements below none."""
    parents = {claim.id: claim.requirement.parents for claim in claims}
    chains = [_chains(claim.id, parents, project) for claim in claims]
    pairs = list(zip(claims, sections, chains, strict=True))
    rows = [
        _row(hazard, via[hazard], claim, section, project, runs)
        for hazard in sorted(project.hazards)
        for claim, section, via in pairs
        if hazard in via
    ]
    rest = [_row("", (), claim, section, project, runs) for claim, section, via in pairs if not via]
    return (*rows, *rest)


def _chains(
    id: str, parents: dict[str, tuple[str, ...]], project: Project
) -> dict[str, tuple[str, ...]]:
    """Each hazard that a requirement traces to, and the requirements in between."""
    found: dict[str, tuple[str, ...]] = {}
    seen = {id}
    waiting: list[tuple[str, tuple[str, ...]]] = [(id, ())]
    for requirement, via in waiting:
        for parent in parents.get(requirement, ()):
            if parent in project.hazards:
                found.setdefault(parent, via)
            elif parent not in seen:
                seen.add(parent)
                waiting.append((parent, (*via, parent)))
    return found


def _row(
    hazard: str,
    via: tuple[str, ...],
    claim: Claim,
    section: RequirementView,
    project: Project,
    runs: dict[Key, Run],
) -> Row:
    return Row(
        hazard=hazard,
        hazard_title=project.hazards[hazard].title if hazard else "",
        via=phrases.joined(via),
        requirement=claim.id,
        title=section.title,
        status=section.status,
        anchor=claim.anchor,
        mark=claim.mark,
        limit=section.limit,
        artefacts=section.artefacts,
        cells=_cells(claim, runs),
    )


def _cells(claim: Claim, runs: dict[Key, Run]) -> tuple[Cell, ...]:
    """The worst first, one for each run; many of one verdict share one."""
    if not claim.judged:
        return (Cell(claim.mark, "", claim.anchor),)
    counts = Counter(judged.mark for judged in claim.results)
    single = [
        Cell(judged.mark, runs[key(judged.result)].label, result_anchor(claim, number))
        for number, judged in enumerate(claim.results, 1)
        if counts[judged.mark] <= _SINGLE
    ]
    shared = [
        Cell(mark, f"in {phrases.times(count, 'run')}", claim.anchor)
        for mark, count in counts.items()
        if count > _SINGLE
    ]
    return tuple(sorted([*single, *shared], key=lambda cell: cell.mark.severity))


# Orphans ---------------------------------------------------------------------------------------


def orphans(project: Project, claims: Sequence[Claim], evidence: Evidence | None) -> Orphans:
    """Every place where the chain from hazard to verdict ends too early."""
    return Orphans(
        hazards=tuple(_uncovered(project, claims)),
        requirements=(
            *(f"{claim.id} names no parent" for claim in claims if not claim.requirement.parents),
            *_rootless(project),
        ),
        parents=tuple(_undeclared(project, claims)),
        evidence=tuple(
            f"{id} has evidence, but is not among the requirements"
            for id in strangers(claims, evidence)
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


def _uncovered(project: Project, claims: Sequence[Claim]) -> Iterable[str]:
    parents = {claim.id: claim.requirement.parents for claim in claims}
    covered: dict[str, set[str]] = {}
    for claim in claims:
        for above in _chains(claim.id, parents, project):
            covered.setdefault(above, set()).add(claim.requirement.status)
    for id in sorted(project.hazards, key=natural):
        hazard = project.hazards[id]
        if id not in covered:
            yield f"{id} ({hazard.title}) has no requirement"
        elif covered[id] == {RETIRED}:
            yield f"{id} ({hazard.title}) has only retired requirements"


def _undeclared(project: Project, claims: Sequence[Claim]) -> Iterable[str]:
    known = {*project.hazards, *project.parents, *(claim.id for claim in claims)}
    for claim in claims:
        for parent in claim.requirement.parents:
            if parent not in known:
                yield f"{claim.id} names {parent}, which is not declared"


def strangers(claims: Sequence[Claim], evidence: Evidence | None) -> tuple[str, ...]:
    """Ids that the evidence is about and the project does not have."""
    known = {claim.id for claim in claims}
    results = evidence.results if evidence else ()
    return tuple(sorted({result.requirement for result in results} - known, key=natural))
