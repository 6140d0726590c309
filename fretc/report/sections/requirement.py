"""The section of one requirement: its text, meaning, formulas, proofs, runs and review."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import Any

from compiler.explanation.diagram import diagram, words
from compiler.explanation.violability import limit
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.logic import printing
from compiler.project.project import Project
from fretc.audit.evidence.probabilities import shown
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.verdicts import RETIRED
from fretc.coverage.coverage import CoverageStatus, RequirementCoverage, of_requirements
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment, Inputs
from fretc.report.model.marks import verdict_mark
from fretc.report.model.results import BoundsView, ProbabilityView
from fretc.report.model.views import (
    Formula,
    ParentView,
    PropositionView,
    Remark,
    RequirementView,
    SignalView,
    SituationsView,
)
from fretc.report.pictures.histograms import exercise
from fretc.report.sections.plans import planned
from fretc.report.sections.proofs import SHARED, proof_views
from fretc.report.sections.results import reasons, result_rows
from fretc.report.sections.reviews import review, waiver
from fretc.report.sections.runs import AuditedFile, RunKey
from fretc.traceability.artefacts import Product
from fretish.bindings.declarations import ComputedSignal, Declarations, Proposition, Signal
from fretish.clock import Clock
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.meaning import meaning
from fretish.printer import expression as printed
from fretish.printer import sentence


def section(
    assessment: Assessment,
    inputs: Inputs,
    runs: Mapping[RunKey, AuditedFile],
    anchors: Mapping[str, str],
    shared_products: Sequence[Product],
    joint: Collection[str],
    situations: SituationsView | None,
) -> RequirementView:
    """The view of one requirement.

    Args:
        assessment: of the requirement.
        inputs: of the report.
        runs: all runs.
        anchors: id → anchor of the section of a requirement.
        shared_products: files that targets generate from the bindings.
        joint: SHA-256 of the joint monitors.
        situations: situations that runs have shown; None if no run was audited.
    """
    entry, requirement = assessment.entry, assessment.requirement
    project, proofs = inputs.project, inputs.proofs
    products = (*assessment.products, *shared_products)
    own = (proof for proof in proofs if proof.requirement == assessment.id)
    own_proofs = proof_views(own, products, requirement, joint)
    shared_proofs = proof_views((p for p in proofs if p.requirement in SHARED), shared_products)
    clock = project.declarations.clock if project.declarations else None
    return RequirementView(
        id=assessment.id,
        anchor=assessment.anchor,
        title=entry.title,
        mark=assessment.mark,
        suspicions=assessment.suspicions,
        status=entry.status,
        source=f"{phrases.place(entry.wording.source.name)}:{entry.wording.line}",
        text=entry.text,
        sentence=wording(entry),
        canonical=sentence(requirement.written) if requirement else "",
        fingerprint=requirement.fingerprint if requirement else "",
        meaning=meaning(requirement.written, requirement.ticks, requirement.clock)
        if requirement
        else "",
        error=remark(assessment.diagnostic) if assessment.diagnostic else None,
        diagram=words(diagram(requirement)) if requirement else "",
        formulas=_formulas(requirement) if requirement else (),
        propositions=tuple(
            _proposition(name, project.declarations)
            for name in (requirement.propositions if requirement else ())
        ),
        clock=_clock(clock),
        parents=tuple(_parent(parent, project, anchors) for parent in entry.parents),
        rationale=entry.rationale,
        params=dict(entry.params),
        planned=planned(assessment, (*own_proofs, *shared_proofs)),
        artefacts=assessment.products,
        probability=_probability(assessment),
        proofs=own_proofs,
        exercise=exercise(assessment),
        histograms=(),
        results=result_rows(assessment, runs),
        reasons=reasons(assessment, runs, audited=inputs.evidence is not None),
        limit=_limit(requirement),
        coverage=assessment.coverage,
        situations=situations,
        review=review(assessment, inputs.book),
        waiver=waiver(assessment, inputs.book),
    )


def _limit(requirement: FormalizedRequirement | None) -> str:
    """Why no run can violate the requirement, or ""; a probability is judged over many runs."""
    return (
        ""
        if requirement is None or requirement.sentence.probability is not None
        else limit(requirement)
    )


def _probability(assessment: Assessment) -> ProbabilityView | None:
    if assessment.probability is None:
        return None
    estimation, suspicions = assessment.probability.estimation, assessment.probability.suspicions
    share = "not known" if estimation.estimate is None else f"{estimation.estimate:.4f}"
    return ProbabilityView(
        mark=verdict_mark(estimation.answer, suspect=bool(suspicions)),
        suspicions=suspicions,
        stated=estimation.text,
        bound=float(estimation.bound),
        reason=estimation.reason,
        lines=estimation.lines[1:],
        estimate=estimation.estimate,
        bars=(BoundsView("by whole logs", estimation.bounds.low, estimation.bounds.high),),
        text=f"Estimate {share}; bounds (the logs are the independent units) "
        f"{shown(estimation.bounds)}; "
        f"the bound of the sentence is {estimation.bound}.",
    )


def remark(diagnostic: Diagnostic) -> Remark:
    """The view of a diagnostic."""
    span = diagnostic.span
    place = phrases.place(span.source.name) if span else ""
    where = f":{span.line}:{span.column}" if span and span.source.text else ""
    return Remark(
        diagnostic.code.number,
        str(diagnostic.severity),
        diagnostic.message,
        f"{place}{where}",
        diagnostic.help or "",
        diagnostic.accepted,
    )


def _formulas(requirement: FormalizedRequirement) -> tuple[Formula, ...]:
    return (
        Formula("Future time", "infinite traces", printing.readable(requirement.ft_infinite)),
        Formula(
            "Future time, finite",
            "finite traces, evaluated at the first tick; LAST holds at the last tick",
            printing.readable(requirement.ft_finite),
        ),
        Formula(
            "Past time",
            "finite traces, evaluated at the last tick",
            printing.readable(requirement.pt),
        ),
    )


def _clock(clock: Clock | None) -> str:
    if clock is None:
        return "not declared"
    return (
        f"a tick with {clock}, by {clock.time}"
        if clock.period is None
        else (f"a tick every {clock}, by {clock.time}")
    )


def _parent(id: str, project: Project, anchors: Mapping[str, str]) -> ParentView:
    hazard = project.hazards.get(id)
    if hazard is not None:
        return ParentView(id, hazard.title, "hazards")
    outside = project.parents.get(id)
    if outside is not None:
        return ParentView(id, f"{outside.title} ({phrases.place(outside.source)})", "")
    above = next((r for r in project.requirements if r.id == id), None)
    return ParentView(id, above.title if above else "not declared", anchors.get(id, ""))


# Situations ------------------------------------------------------------------------------------


def situation_views(
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
    views = (
        of_requirement
        for of_requirement in of_requirements(evidence, places)
        if of_requirement.id in places
    )
    return {coverage_of_one.id: _situations(coverage_of_one) for coverage_of_one in views}


def _situations(one: RequirementCoverage) -> SituationsView:
    if not one.measured or not one.situations:
        return SituationsView("", "situations not measured", (), ())
    seen, every = len(one.of(CoverageStatus.SEEN)), len(one.situations)
    return SituationsView(
        f"{seen}/{every}",
        f"{seen} of {every} situations seen",
        tuple(situation.words for situation in one.of(CoverageStatus.PERHAPS)),
        tuple(situation.words for situation in one.of(CoverageStatus.NEVER)),
    )


# Propositions ----------------------------------------------------------------------------------


def _proposition(name: str, declared: Declarations | None) -> PropositionView:
    bound = declared.propositions.get(name) if declared else None
    if bound is None or declared is None:
        return PropositionView(name, False, "", "", "", ())
    return PropositionView(
        name=name,
        is_bound=True,
        text=bound.text,
        expression=_expression(declared, bound),
        properties=_properties(bound),
        signals=(
            *(_signal(declared.signals[signal]) for signal in bound.signals),
            *(_computed(declared.computed[signal]) for signal in bound.calculations),
        ),
    )


def _expression(declared: Declarations, bound: Proposition) -> str:
    """The expression of a proposition, in the syntax of the bindings."""
    written = _written(declared.source.text)
    if bound.name not in written:
        return printed(bound.expression)
    return str(written[bound.name]["expr"])


@lru_cache(maxsize=1)
def _written(bindings: str) -> Mapping[str, Any]:
    """Proposition → its text in the bindings."""
    written: Mapping[str, Any] = tomllib.loads(bindings).get("proposition", {})
    return written


def _properties(bound: Proposition) -> str:
    unknown = "unknown" if bound.on_unknown is None else str(bound.on_unknown).lower()
    parts = [str(bound.role), *([bound.kind] if bound.kind else [])]
    return f"{', '.join(parts)}; value of a tick: {bound.aggregate}; if unknown: {unknown}"


def _computed(signal: ComputedSignal) -> SignalView:
    return SignalView(
        signal.name,
        signal.text,
        "computed",
        signal.unit_name or "1",
        "from the values of its signals at the same instant",
    )


def _signal(signal: Signal) -> SignalView:
    age = f"{phrases.decimal(signal.max_age / 1e6)} ms" if signal.max_age else ""
    reading = [
        f"one of {', '.join(signal.values)}" if signal.values else "",
        str(signal.reduce) if signal.reduce else "",
        f"unknown when older than {age}" if age else "a sample never grows too old",
    ]
    return SignalView(
        signal.name,
        signal.origin,
        signal.type or "any type",
        "word" if signal.values else signal.unit_name or "1",
        "; ".join(filter(None, reading)),
    )
