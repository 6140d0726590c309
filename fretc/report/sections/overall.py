"""The overall result in words: a mark, a headline, and sentences about what is not shown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from compiler.project.project import Project
from fretc.audit.evidence.verdicts import RETIRED, WAIVED
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.headlines import outdated, violated
from fretc.report.model.marks import sign_mark
from fretc.report.model.views import Overall, Planned, RequirementView, Signatures
from fretc.report.sections.matrix import orphans
from fretc.report.sections.proofs import is_refuted
from fretc.report.sections.runs import AuditedFile, trust
from fretc.report.sections.signatures import BROKEN
from fretc.traceability.lock import WithdrawnRequirement
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.diagnostic import has_errors

_ALL = sign_mark("all shown", signs.GOOD)
_PART = sign_mark("not all shown", signs.OPEN)
_NONE = sign_mark("nothing shown", signs.UNUSED)
_VIOLATED = sign_mark("violated", signs.BAD)


def overall(
    project: Project,
    assessments: Sequence[Assessment],
    sections: Sequence[RequirementView],
    runs: Sequence[AuditedFile],
    reservations: Sequence[str],
    withdrawn: Sequence[WithdrawnRequirement],
    signatures: Signatures,
    changed: Sequence[str] = (),
) -> Overall:
    """The overall result: mark, headline and sentences.

    Args:
        project: with or without errors.
        assessments: of all requirements.
        sections: the view of each assessment, in the same order.
        runs: all audited runs.
        reservations: about requirements that are shown.
        withdrawn: reviewed requirements that are no longer in force.
        signatures: all of them.
        changed: sentences about changes since the review.
    """
    active = [assessment for assessment in assessments if assessment.verdict != RETIRED]
    active_views = [view for view in sections if view.status != RETIRED]
    missing = [plan for view in active_views for plan in view.planned if not plan.has_result]
    refuted = [view.name for view in active_views if is_refuted(view)]
    red = [assessment for assessment in active if assessment.is_broken]
    stale = outdated(active)
    good = [assessment for assessment in active if assessment.is_shown]
    has_flaws = has_errors(project.diagnostics)
    forged = _forged(signatures)
    sentences = tuple(
        filter(
            None,
            (
                *((stale,) if red else ()),
                *changed,
                *_held(active, good, len(runs)),
                *(f"{withdrawal.text}." for withdrawal in withdrawn),
                _refuted(refuted),
                *_few(reservations),
                _waived(active),
                _unsigned(sections),
                _unplanned(missing, {view.id: view.name for view in sections}),
                _uncovered(project, assessments),
                trust(runs, project),
                _FLAWED if has_flaws else "",
                forged if red else "",
            ),
        )
    )
    if red:
        mark = replace(_VIOLATED, suspect=all(assessment.suspicions for assessment in red))
        return Overall(mark, violated(red), sentences)
    if forged:
        return Overall(BROKEN, forged, sentences)
    if not good:
        return Overall(_NONE, _with("None of the claimed requirements is shown", stale), sentences)
    if len(good) < len(active) or has_flaws or withdrawn:
        return Overall(_PART, _with("Not all claimed requirements are shown", stale), sentences)
    if refuted:
        headline = "All audited requirements held, but verification found counterexamples."
        return Overall(_PART, headline, sentences)
    if missing:
        headline = "All audited requirements held, but some planned methods have no result."
        return Overall(_PART, headline, sentences)
    return Overall(_ALL, "All claimed requirements are shown.", sentences)


def _with(headline: str, stale: str) -> str:
    """A headline with the reasons why results are suspect."""
    return f"{headline}: {stale}" if stale else f"{headline}."


# The sentences ---------------------------------------------------------------------------------


def _held(active: Sequence[Assessment], good: Sequence[Assessment], runs: int) -> Iterator[str]:
    """Sentences with the number of requirements that hold, and of supported probabilities."""
    single = [assessment for assessment in active if assessment.probability is None]
    probable = [assessment for assessment in active if assessment.probability is not None]
    if single or not probable:
        yield _held_in_runs(
            single, [assessment for assessment in good if assessment.probability is None], runs
        )
    if probable:
        count = sum(assessment.is_shown for assessment in probable)
        yield (
            f"{count} of {phrases.times(len(probable), 'probability', 'probabilities')} "
            f"{'is' if len(probable) == 1 else 'are'} supported, as an average over the triggers "
            f"of {phrases.times(runs, 'run')}."
        )


def _held_in_runs(active: Sequence[Assessment], good: Sequence[Assessment], runs: int) -> str:
    if not active:
        return "There is no requirement in force."
    if not runs:
        return "No run has been audited."
    if len(active) == 1:
        where = _where(len(active[0].audits))
        held = f"held in {where}" if good else f"was not shown to hold in {where}"
        name = active[0].entry.name
        return f"The one requirement, {name}, {held if where else 'was not audited'}."
    everywhere = all(len(assessment.audits) == runs for assessment in good)
    where = _where(runs) if everywhere else "each run in which they were audited"
    return f"{len(good)} of {phrases.times(len(active), 'requirement')} held in {where}."


def _where(runs: int) -> str:
    return ("", "the audited run")[runs] if runs <= 1 else f"every one of the {runs} audited runs"


def _refuted(ids: Sequence[str]) -> str:
    if not ids:
        return ""
    found = f"Verification found a counterexample to {phrases.some(ids)}"
    return f"{found}; their sections list the claims."


def _waived(active: Sequence[Assessment]) -> str:
    waived = [assessment for assessment in active if assessment.verdict == WAIVED]
    if not waived:
        return ""
    verb = "is" if len(waived) == 1 else "are"
    names = phrases.some(
        [f"{assessment.entry.name}: {assessment.unwaived_mark.text}" for assessment in waived]
    )
    return f"{phrases.times(len(waived), 'requirement')} {verb} waived, and not shown: {names}."


def _unsigned(sections: Sequence[RequirementView]) -> str:
    """A sentence about effective waivers without a valid signature."""
    waived = [view for view in sections if view.waiver and view.mark.word == WAIVED]
    names = [view.name for view in waived if view.waiver and not view.waiver.signature.is_good]
    return f"There is no valid signature for the waiver of {phrases.some(names)}." if names else ""


def _forged(signatures: Signatures) -> str:
    places = [entry.name for entry in signatures.signed if entry.signature.mark == BROKEN]
    if not places:
        return ""
    verb = "does" if len(places) == 1 else "do"
    count = phrases.times(len(places), "signature")
    return f"{count} {verb} not verify: {phrases.some(places)}."


def _unplanned(missing: Sequence[Planned], names: Mapping[str, str]) -> str:
    if not missing:
        return ""
    methods = phrases.some([f"{plan.method} for {names[plan.requirement]}" for plan in missing])
    return f"No result is recorded for {phrases.times(len(missing), 'planned method')}: {methods}."


def _uncovered(project: Project, assessments: Sequence[Assessment]) -> str:
    count = len(orphans(project, assessments, None).hazards)
    verb = "has" if count == 1 else "have"
    return f"{phrases.times(count, 'hazard')} {verb} no requirement in force." if count else ""


_FLAWED = "The requirements, bindings or hazards have errors: this report is not complete."


def _few(reservations: Sequence[str]) -> Sequence[str]:
    """The reservations, or a sentence with their number if there are many."""
    if len(reservations) <= 3:
        return reservations
    count = phrases.times(len(reservations), "reservation")
    return (f"{count}, listed under “Shown, with a reservation”.",)
