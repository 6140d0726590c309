"""The last audit, proofs and analysis of each requirement, and whether they are still valid."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isnan

from compiler.logic.claims import ClaimResult
from compiler.project.project import Project
from fretc.analysis.assumptions import assumptions, guarantees
from fretc.analysis.evidence import AnalyzedSet
from fretc.analysis.evidence import suspicions as outdated_analysis
from fretc.audit.evidence.declared_units import thresholds_in_declared_units
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.evidence.schema import ThresholdRecord
from fretc.audit.evidence.verdicts import BROKEN, NOT_EXERCISED
from fretc.checking.diagnostics import ProjectCheck
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.views import ProofView
from fretc.report.sections.proofs import is_proved, proof_views, worst
from fretc.traceability.artefacts import joint_monitors
from fretish.bindings.amounts import exact, margin
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as symbols
from fretish.documents import RequirementEntry

_MOST_RESULTS = 5000
"""Margins of more results than this are left out: all of them would have to be read."""
_MOST_MARGINS = 2


@dataclass(frozen=True, slots=True)
class SignalRange:
    """What a comparison with a constant saw in all results, in declared units."""

    proposition: str
    comparison: str
    """`abs(vx) < 0.01 m/s`."""
    values: str
    """`0 m/s to 0.0075 m/s`; "" if they were never known."""
    margin: str
    """The least distance to the bound; "" if it was crossed or never known."""


@dataclass(frozen=True, slots=True)
class RequirementStatus:
    """The state of one requirement as lines of text; "" where there is nothing to report.

    A result that is out of date begins with `stale`, and has no symbol of success.
    """

    entry: RequirementEntry
    verdict: str
    reasons: tuple[str, ...]
    """Why the verdict is out of date."""
    proof: str
    proofs: tuple[ProofView, ...]
    conflict: str
    ranges: tuple[SignalRange, ...]


def statuses(check: ProjectCheck) -> tuple[RequirementStatus, ...]:
    """The status of each requirement of a checked project, in its order."""
    project = check.project
    if project is None:
        return ()
    joint = joint_monitors(project.formalized, check.proofs)
    ranges = _ranges(check.summaries, project.declarations)
    outdated = _outdated_analysis(check.analyzed, project)
    return tuple(
        _status(each, check, joint, ranges.get(each.id, ()), outdated) for each in check.assessments
    )


def _status(
    assessment: Assessment,
    check: ProjectCheck,
    joint: frozenset[str],
    ranges: tuple[SignalRange, ...],
    outdated_set: tuple[str, ...],
) -> RequirementStatus:
    own = [proof for proof in check.proofs if proof.requirement == assessment.id]
    proofs = proof_views(own, assessment.products, assessment.requirement, joint)
    return RequirementStatus(
        assessment.entry,
        _verdict(assessment, ranges),
        assessment.suspicions,
        _proof(proofs) if proofs else "",
        proofs,
        _conflict(assessment.id, check, outdated_set),
        ranges,
    )


def _verdict(assessment: Assessment, ranges: Iterable[SignalRange]) -> str:
    if assessment.verdict == NOT_EXERCISED and not assessment.audits:
        return "not audited"
    mark = assessment.mark
    counted = [audit for audit in assessment.audits if audit.verdict == assessment.unwaived]
    runs = phrases.times(len(assessment.audits), "run")
    which = f"{len(counted)} of {runs}" if assessment.unwaived in BROKEN else runs
    where = f" in {which}" if assessment.audits else ""
    if mark.suspect:
        is_red = assessment.verdict in BROKEN
        symbol = f"{mark.glyph} {mark.word}{where}, stale" if is_red else f"stale: {mark.word}"
        return f"{symbol} ({phrases.joined(list(assessment.suspicions))})"
    triggers = sum(audit.result.triggers for audit in assessment.audits)
    parts = [f"{mark.glyph} {mark.word}{where}"]
    parts.extend([phrases.times(triggers, "trigger")] if triggers else [])
    kept = [each for each in ranges if each.margin]
    parts.extend(f"margin of {each.proposition} {each.margin}" for each in kept[:_MOST_MARGINS])
    return ", ".join(parts)


def _proof(proofs: Sequence[ProofView]) -> str:
    decisive = worst(proofs)
    layers = phrases.joined(list(dict.fromkeys(proof.layer for proof in proofs)))
    if is_proved(decisive):
        return f"{decisive.mark.glyph} {phrases.times(len(proofs), 'claim')} proved ({layers})"
    if decisive.mark.word == ClaimResult.COUNTEREXAMPLE:
        stale = ", stale" if decisive.mark.suspect else ""
        return f"{decisive.mark.glyph} counterexample{stale}: {decisive.claim}"
    stale_ones = [proof for proof in proofs if proof.suspicions]
    if stale_ones:
        return f"stale: {stale_ones[0].mark.word} ({stale_ones[0].suspicions[0]})"
    return f"{decisive.mark.glyph} {decisive.mark.word}: {decisive.claim}"


# The analysis of the set --------------------------------------------------------------------------


def _conflict(id: str, check: ProjectCheck, outdated: tuple[str, ...]) -> str:
    analyzed = check.analyzed
    if analyzed is None:
        return ""
    groups = [each.requirements for each in analyzed.document.analysis.conflicts]
    own = [group for group in groups if id in group]
    if not own:
        return ""
    others = [each for each in dict.fromkeys(each for group in own for each in group) if each != id]
    with_others = f"in conflict with {phrases.joined(others)}" if others else "cannot be satisfied"
    stale = f", stale ({phrases.joined(list(outdated))})" if outdated else ""
    return f"{symbols.BAD.glyph} {with_others}{stale}"


def _outdated_analysis(analyzed: AnalyzedSet | None, project: Project) -> tuple[str, ...]:
    """Why the analysis is out of date."""
    if analyzed is None:
        return ()
    assumed, _ = assumptions(project.in_force, project.declarations)
    required = guarantees(project.in_force)
    return tuple(outdated_analysis(analyzed.document, required, assumed))


# Ranges of signals --------------------------------------------------------------------------------


def _ranges(
    summaries: ResultSummaries | None, declared: Declarations | None
) -> Mapping[str, tuple[SignalRange, ...]]:
    """The ranges of the comparisons of each requirement, over all of its results."""
    if summaries is None:
        return {}
    owners = {at: id for id, some in summaries.by_requirement.items() for at, _ in some}
    if len(owners) > _MOST_RESULTS:
        return {}
    records: dict[str, dict[str, list[ThresholdRecord]]] = {}
    for at, thresholds in summaries.source.thresholds({*summaries.by_requirement}):
        for each in thresholds_in_declared_units(thresholds, declared):
            named = records.setdefault(owners[at], {})
            named.setdefault(each.proposition, []).append(each)
    return {
        id: tuple(_range(some) for some in named.values() if some) for id, named in records.items()
    }


def _range(records: Sequence[ThresholdRecord]) -> SignalRange:
    last = records[-1]
    unit, bound = last.unit, last.bound
    values = [
        float(each)
        for record in records
        for each in (record.least, record.greatest)
        if each is not None and not isnan(float(each))
    ]
    ends = (
        [phrases.value(each, unit, [bound]) for each in (min(values), max(values))]
        if values
        else []
    )
    margins = [float(record.margin) for record in records if record.margin is not None]
    comparisons = {(record.operator, record.bound, record.unit) for record in records}
    is_kept = len(margins) == len(records) and len(comparisons) == 1
    return SignalRange(
        last.proposition,
        f"{last.signal} {last.operator} {exact(bound, unit)}",
        " to ".join(dict.fromkeys(ends)),
        margin(min(margins), unit, bound) if is_kept else "",
    )
