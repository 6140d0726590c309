"""Views of the situations that audited runs have shown, for sections and matrix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.verdicts import RETIRED
from fretc.coverage.coverage import CoverageStatus, RequirementCoverage, of_requirements
from fretc.report.model.assessments import Assessment
from fretc.report.model.views import SituationsView


def situations(
    assessed: Sequence[Assessment], evidence: EvidenceSource | None
) -> Mapping[str, SituationsView]:
    """Requirement id → view of its situations, for requirements in force with results.

    Suspect results are not counted.

    Args:
        assessed: all requirements.
        evidence: the evidence; None if there is none.
    """
    if evidence is None:
        return {}
    places = {
        assessment.id: {
            audit.place: run for run, audit in enumerate(assessment.audits) if not audit.is_stale
        }
        for assessment in assessed
        if assessment.audits and assessment.verdict != RETIRED
    }
    found = (
        of_requirement
        for of_requirement in of_requirements(evidence, places)
        if of_requirement.id in places
    )
    return {coverage_of_one.id: _view(coverage_of_one) for coverage_of_one in found}


def _view(one: RequirementCoverage) -> SituationsView:
    if not one.measured or not one.situations:
        return SituationsView("", "situations not measured", (), ())
    seen, every = len(one.of(CoverageStatus.SEEN)), len(one.situations)
    return SituationsView(
        f"{seen}/{every}",
        f"{seen} of {every} situations seen",
        tuple(situation.words for situation in one.of(CoverageStatus.PERHAPS)),
        tuple(situation.words for situation in one.of(CoverageStatus.NEVER)),
    )
