"""Assembles the `ReportView` from project, evidence, proofs and reviews; reads no file.

`fretc.report.make` reads the files; `fretc.report.sections` builds the parts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from compiler.files.build_id import __version__
from compiler.project.project import Project
from fretc.audit.evidence.probabilities import AVERAGE
from fretc.audit.evidence.result_summaries import EvidenceSource, ResultSummaries
from fretc.audit.evidence.schema import Selection
from fretc.audit.evidence.verdicts import NOT_EXERCISED, RETIRED
from fretc.audit.measurements.confidence_intervals import SUPPORTED
from fretc.audit.outputs.broken_assumptions import broken_assumptions
from fretc.audit.selection.choice import in_words
from fretc.report.across.assembly import across
from fretc.report.diagnostics import idle_waivers, stale_evidence
from fretc.report.front.front import front
from fretc.report.front.gravity import gravities
from fretc.report.front.violations import gravest_first, is_red
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment, Inputs, assessments
from fretc.report.model.marks import verdict_mark
from fretc.report.model.results import ResultView
from fretc.report.model.views import (
    SCHEMA,
    MarkCount,
    NotShown,
    ReportView,
    RequirementView,
    Withdrawal,
    worst_first,
)
from fretc.report.sections import reviews
from fretc.report.sections.details import Details
from fretc.report.sections.matrix import hazard_views, matrix, orphans
from fretc.report.sections.overall import overall
from fretc.report.sections.proofs import SHARED, proof_views
from fretc.report.sections.reproduction import commands, folder_of, manifest
from fretc.report.sections.requirement import remark, section, situation_views
from fretc.report.sections.results import is_bounded
from fretc.report.sections.runs import AuditedFile, damage, run_summaries, runs, trust
from fretc.report.sections.signatures import idle_signatures, signatures
from fretc.report.set_analysis.assembly import in_front, in_overall, set_analysis
from fretc.traceability.acceptances import warnings
from fretc.traceability.artefacts import joint_monitors, shared_products
from fretc.traceability.lock import Lock, withdrawn_requirements
from fretish.diagnostics.diagnostic import Code, Diagnostic
from monitors import kernel


def report(inputs: Inputs) -> tuple[ReportView, Details, tuple[Diagnostic, ...]]:
    """The report, the evidence behind its rows, and diagnostics about its files."""
    project = inputs.project
    lock, together = inputs.lock, inputs.together
    summaries = ResultSummaries.of(inputs.evidence) if inputs.evidence else None
    evidence = summaries.source if summaries else None
    runs_by_key = runs(summaries)
    all_runs = tuple(runs_by_key.values())
    assessed = assessments(project, summaries, lock, inputs.waivers, inputs.proofs, together)
    chains = [assessment.review_status.chain for assessment in assessed]
    withdrawn = withdrawn_requirements(project.requirements, chains, lock)
    anchors = {assessment.id: assessment.anchor for assessment in reversed(assessed)}
    shared = shared_products(project.declarations) if inputs.proofs else ()
    [proof for proof in inputs.proofs if proof.requirement in SHARED]
    joint = joint_monitors(project.formalized, inputs.proofs)
    exercised = situation_views(assessed, evidence)
    sections = tuple(
        section(each, inputs, runs_by_key, anchors, shared, joint, exercised.get(each.id))
        for each in assessed
    )
    assessed_as = {assessment.anchor: assessment for assessment in assessed}
    result_rows = {view.anchor: view.results for view in sections}
    details = Details(evidence, project, assessed_as, runs_by_key, result_rows)
    longest = _longest_waits(assessed, sections, details)
    reservations = (
        *(line for view in sections for line in _reservations(view, longest)),
        *(line for assessment in assessed for line in reviews.reservations(assessment)),
        *_of_assumptions(assessed, project),
    )
    changes = reviews.changes(assessed, project)
    groups = reviews.change_groups(assessed, changes)
    changed = tuple(reviews.change_sentences(changes, groups))
    signature_list = signatures(inputs, assessed)
    rows, hazards = matrix(project, assessed, sections), hazard_views(project)
    grave = gravities(rows, hazards)
    ordered = gravest_first(sections, grave)
    overall_result = overall(
        project,
        [assessed_as[view.anchor] for view in ordered],
        ordered,
        all_runs,
        reservations,
        withdrawn,
        signature_list,
        changed,
    )
    analysis = set_analysis(together, project, anchors) if together else None
    overall_result = in_overall(overall_result, analysis)
    run_list = run_summaries(all_runs, project)
    all_changes = (*changes, *reviews.withdrawals(withdrawn))
    components = tuple(
        sorted({requirement.sentence.component for requirement in project.formalized})
    )
    checked = _checks(project, assessed, lock, evidence)
    first_screen = front(
        ": ".join(filter(None, [phrases.joined(components), folder_of(project)])),
        overall_result,
        sections,
        rows,
        grave,
        assessed,
        all_runs,
        run_list,
        all_changes,
        [text for text in overall_result.sentences if text != trust(all_runs, project)],
        evidence,
    )
    whole = ReportView(
        schema=SCHEMA,
        fretc=__version__,
        project=folder_of(project),
        components=components,
        evidence=phrases.place(inputs.path) if evidence else "",
        audited_by=evidence.fretc if evidence else "",
        overall=overall_result,
        front=in_front(first_screen, analysis),
        runs=run_list,
        claims=_claims(assessed, len(all_runs), evidence.selection if evidence else None),
        counts=_counts(assessed),
        violated=tuple(_not_shown(filter(is_red, ordered))),
        not_shown=tuple(_not_shown(view for view in worst_first(sections) if not is_red(view))),
        damaged=tuple(damage(run_list, sections)),
        reservations=reservations,
        planned=tuple(plan for view in sections for plan in view.planned if view.status != RETIRED),
        proofs=proof_views(
            (proof for proof in inputs.proofs if proof.requirement in SHARED), shared
        ),
        verification=phrases.place(inputs.verification.file) if inputs.verification else "",
        remarks=tuple(remark(diagnostic) for diagnostic in (*project.diagnostics, *checked)),
        hazards=hazards,
        matrix=rows,
        orphans=orphans(project, assessed, summaries),
        reviewed=reviews.summary(assessed, inputs.book),
        changes=all_changes,
        withdrawn=tuple(
            Withdrawal(withdrawal.review.requirement, withdrawal.text) for withdrawal in withdrawn
        ),
        waivers=tuple(view.waiver for view in sections if view.waiver),
        signatures=signature_list,
        requirements=sections,
        assumptions=_assumptions(project, all_runs),
        commands=commands(inputs, sections, all_runs),
        manifest=manifest(inputs, sections, all_runs),
        across=across(details, [view.anchor for view in worst_first(sections)]),
        change_groups=groups,
        analysis=analysis,
    )
    diagnostics = (
        *(diagnostic for diagnostic in checked if diagnostic.accepted),
        *stale_evidence(assessed, summaries, inputs.path),
        *idle_waivers(assessed),
        *inputs.book.diagnostics(),
        *idle_signatures(inputs.book, assessed),
    )
    return whole, details, diagnostics


def _not_shown(views: Iterable[RequirementView]) -> Iterator[NotShown]:
    for view in views:
        if view.reasons:
            yield NotShown(view.id, view.title, view.anchor, view.mark, view.reasons)


def _checks(
    project: Project,
    assessed: Sequence[Assessment],
    lock: Lock | None,
    evidence: EvidenceSource | None,
) -> Sequence[Diagnostic]:
    """The warnings of `fretc check`, without those about reviews."""
    every = warnings(project, [assessment.review_status for assessment in assessed], lock, evidence)
    return [warning for warning in every if warning.accepted or warning.code not in _OF_REVIEWS]


_OF_REVIEWS = (Code.CHANGED_SINCE_REVIEW, Code.NOT_REVIEWED)


def _longest_waits(
    assessed: Sequence[Assessment], sections: Sequence[RequirementView], details: Details
) -> Mapping[str, ResultView]:
    """Requirement → result with the longest latency, for shown requirements without a bound."""
    rows = [
        max(waiting, key=lambda row: row.latency_max_s or 0)
        for assessment, view in zip(assessed, sections, strict=True)
        if view.mark.shows and not is_bounded(assessment.requirement)
        if (waiting := [row for row in view.results if row.at_once < row.answers])
    ]
    return {row.section: result for row, result in details.results(rows)}


def _reservations(view: RequirementView, longest: Mapping[str, ResultView]) -> Sequence[str]:
    """Sentences that qualify a requirement that is shown."""
    if not view.mark.shows:
        return ()
    average = [f"{view.name} is supported: {AVERAGE}."] if view.mark.word == SUPPORTED else []
    unbounded = "" if view.limit else f"{view.name} sets no bound on its response. "
    result = longest.get(view.anchor)
    late = (
        [
            f"{unbounded}The longest answer of {view.name} took {result.latency.longest}, "
            f"in {result.run_label}."
        ]
        if result and result.latency
        else []
    )
    draft = [f"{view.name} is a draft."] if view.status == "draft" else []
    return (*average, *([view.limit] if view.limit else []), *late, *draft)


def _of_assumptions(assessed: Sequence[Assessment], project: Project) -> Iterator[str]:
    """A line for each assumption that runs do not keep."""
    results = (
        (audit.result.run, audit.result.requirement, audit.verdict)
        for assessment in assessed
        if assessment.verdict != RETIRED
        for audit in assessment.audits
    )
    for each in broken_assumptions(results, project.formalized):
        yield each.in_words


def _claims(assessed: Sequence[Assessment], runs: int, selection: Selection | None) -> str:
    active = [assessment for assessment in assessed if assessment.verdict != RETIRED]
    drafts = sum(assessment.entry.status == "draft" for assessment in active)
    retired = len(assessed) - len(active)
    assumed = sum(assessment.entry.is_assumption for assessment in active)
    parts = [
        f"{phrases.times(len(active), 'requirement')} in force",
        f"{drafts} of them {'a draft' if drafts == 1 else 'drafts'}" if drafts else "",
        f"with {phrases.times(assumed, 'assumption')}" if assumed else "",
        f"{retired} retired" if retired else "",
        f"audited against {phrases.times(runs, 'run')}" if runs else "not audited",
        "" if selection is None else f"which are {in_words(selection)}",
    ]
    return f"{', '.join(filter(None, parts))}."


def _counts(assessed: Sequence[Assessment]) -> tuple[MarkCount, ...]:
    active = [assessment for assessment in assessed if assessment.verdict != RETIRED]
    requirements = Counter(assessment.mark for assessment in assessed)
    audits = Counter(audit.mark for assessment in active for audit in assessment.reviewed_audits)
    marks = {*map(verdict_mark, _ALWAYS), *requirements, *audits}
    return tuple(
        MarkCount(mark, requirements[mark], audits[mark])
        for mark in sorted(marks, key=lambda mark: mark.severity)
    )


_ALWAYS = (
    kernel.VIOLATED,
    kernel.NO_DATA,
    kernel.INCONCLUSIVE,
    kernel.VACUOUS,
    NOT_EXERCISED,
    kernel.SATISFIED,
)
"""Verdicts that have a row in the table of counts even if their count is 0."""


def _assumptions(project: Project, runs: Sequence[AuditedFile]) -> tuple[str, ...]:
    """The declared assumptions, then assumptions of the audit that are no longer declared."""
    declared = project.declarations.assumptions if project.declarations else ()
    now = dict.fromkeys(declared)
    audited = (text for run in runs for text in run.facts.assumptions)
    older = dict.fromkeys(f"{text} (in the audit)" for text in audited if text not in now)
    return (*now, *older)
