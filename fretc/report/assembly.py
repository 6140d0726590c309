"""The whole report from a project and its evidence."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from compiler.files.edition import __version__
from compiler.logic.claims import Evidence as Line
from compiler.project.folder import Project
from fretc.attestation.signatures import NO_SIGNATURES, Book
from fretc.audit.evidence.declared_units import in_declared_units
from fretc.audit.evidence.probabilities import AVERAGE
from fretc.audit.evidence.schema import Evidence
from fretc.audit.evidence.verdicts import NOT_EXERCISED, RETIRED, WAIVED
from fretc.audit.measurements.confidence_intervals import CONFIDENCE, SUPPORTED
from fretc.report.model import phrases
from fretc.report.model.claims import Claim, claims, idle_waivers
from fretc.report.model.headlines import broken, outdated
from fretc.report.model.views import (
    SCHEMA,
    Count,
    NotShown,
    Overall,
    Planned,
    Report,
    RequirementView,
    Signatures,
    Withdrawal,
    sign_mark,
    verdict_mark,
    worst_first,
)
from fretc.report.sections import reviews
from fretc.report.sections.matrix import hazard_views, matrix, orphans, strangers
from fretc.report.sections.proofs import SHARED, is_refuted, proof_views
from fretc.report.sections.reproduction import commands, folder_of, manifest
from fretc.report.sections.runs import Run, run_views, runs, trust
from fretc.report.sections.sections import remark, section
from fretc.report.sections.signatures import BROKEN, signatures
from fretc.report.sections.signatures import idle as idle_signatures
from fretc.report.traceability.artefacts import shared_products
from fretc.report.traceability.checks import checks
from fretc.report.traceability.lock import Lock, Withdrawn, withdrawn
from fretc.report.traceability.waivers import Waiver
from fretc.verification.ajpf_results import merged
from fretc.verification.reader import Proofs
from fretish.diagnostics import signs
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, has_errors
from fretish.diagnostics.source import Source
from monitors import kernel


def report(
    project: Project,
    evidence: Evidence | None,
    path: str,
    lock: Lock | None = None,
    waivers: Mapping[str, Waiver] = MappingProxyType({}),
    proofs: Proofs | None = None,
    ajpf: Sequence[Line] = (),
    book: Book = NO_SIGNATURES,
) -> tuple[Report, tuple[Diagnostic, ...]]:
    """The report, and what there is to say of the evidence.

    Args:
        project: with or without errors; what could not be formalized is shown as such.
        evidence: None where no run has been audited.
        path: where the evidence is, or is to be.
        lock: None where nothing has been reviewed.
        waivers: those that count now, by the requirement.
        proofs: None where nothing was verified.
        ajpf: what AJPF itself said, held against what is made now.
        book: who signed what.
    """
    measured = in_declared_units(evidence, project.declarations) if evidence else None
    found = runs(measured)
    proved = merged(proofs.proofs if proofs else (), ajpf)
    claimed = claims(project, measured, lock, waivers, proved)
    chains = [claim.standing.chain for claim in claimed]
    gone = withdrawn(project.requirements, chains, lock)
    anchors = {claim.id: claim.anchor for claim in reversed(claimed)}
    audited = evidence is not None
    common = shared_products(project.declarations) if proved else ()
    sections = tuple(
        section(claim, project, found, anchors, audited, proved, common, book) for claim in claimed
    )
    plans = tuple(plan for view in sections for plan in view.planned if view.status != RETIRED)
    reservations = (
        *(line for view in sections for line in _reservations(view)),
        *(line for claim in claimed for line in reviews.reservations(claim)),
    )
    signed = signatures(book, claimed, evidence, proofs)
    return Report(
        schema=SCHEMA,
        fretc=__version__,
        project=folder_of(project),
        components=tuple(sorted({rule.sentence.component for rule in project.rules})),
        evidence=phrases.place(path) if evidence else "",
        audited_by=evidence.fretc if evidence else "",
        overall=_overall(
            project, claimed, sections, tuple(found.values()), reservations, gone, signed
        ),
        runs=run_views(found.values(), project),
        claims=_claims(claimed, len(found)),
        counts=_counts(claimed),
        not_shown=tuple(_not_shown(view) for view in worst_first(sections) if view.reasons),
        reservations=reservations,
        planned=plans,
        proofs=proof_views((each for each in proved if each.requirement in SHARED), common),
        verification=phrases.place(proofs.file) if proofs else "",
        remarks=tuple(remark(diagnostic) for diagnostic in _remarks(project, claimed)),
        hazards=hazard_views(project),
        matrix=matrix(project, claimed, sections, found),
        orphans=orphans(project, claimed, evidence),
        reviewed=reviews.reviewed(claimed, book),
        changes=(*reviews.changes(claimed), *reviews.gone(gone)),
        withdrawn=tuple(Withdrawal(one.review.requirement, one.text) for one in gone),
        waivers=tuple(view.waiver for view in sections if view.waiver),
        signatures=signed,
        requirements=sections,
        assumptions=_assumptions(project, evidence),
        commands=commands(
            project, sections, tuple(found.values()), path, proofs, _confidence(evidence)
        ),
        manifest=manifest(project, sections, tuple(found.values()), evidence, proofs, book.signers),
    ), (
        *stale(claimed, evidence, path),
        *idle_waivers(claimed),
        *book.diagnostics(),
        *idle_signatures(book, claimed),
    )


def _confidence(evidence: Evidence | None) -> float:
    told = evidence.probabilities if evidence else ()
    return next((one.confidence for one in told), CONFIDENCE)


def _remarks(project: Project, claimed: Sequence[Claim]) -> Sequence[Diagnostic]:
    """What reading it has told, and what `fretc check` finds; changes have a part of their own."""
    said = project.diagnostics
    if has_errors(said):
        return said
    found = checks(project, [claim.standing for claim in claimed])
    return [*said, *(d for d in found if d.code is not Code.CHANGED_SINCE_REVIEW)]


def _not_shown(view: RequirementView) -> NotShown:
    return NotShown(view.id, view.title, view.anchor, view.mark, view.reasons)


# In words --------------------------------------------------------------------------------------

_ALL = sign_mark("all shown", signs.GOOD)
_PART = sign_mark("not all shown", signs.OPEN)
_NONE = sign_mark("nothing shown", signs.UNUSED)
_BROKEN = sign_mark("violated", signs.BAD)


def _overall(
    project: Project,
    claimed: Sequence[Claim],
    sections: Sequence[RequirementView],
    runs: Sequence[Run],
    reservations: Sequence[str],
    gone: Sequence[Withdrawn],
    signed: Signatures,
) -> Overall:
    active = [claim for claim in claimed if claim.verdict != RETIRED]
    inforce = [view for view in sections if view.status != RETIRED]
    missing = [plan for view in inforce for plan in view.planned if not plan.has_result]
    refuted = [view.id for view in inforce if is_refuted(view)]
    red = [claim for claim in active if claim.is_broken]
    stale = outdated(active)
    good = [claim for claim in active if claim.is_shown]
    flawed = has_errors(project.diagnostics)
    said = tuple(
        filter(
            None,
            (
                *((stale,) if red else ()),
                *_held(active, good, len(runs)),
                *(f"{one.text}." for one in gone),
                _refuted(refuted),
                *_few(reservations),
                _waived(active),
                _unsigned(sections),
                _unplanned(missing),
                _uncovered(project, claimed),
                trust(runs),
                _FLAWED if flawed else "",
                _forged(signed) if red else "",
            ),
        )
    )
    if red:
        mark = replace(_BROKEN, suspect=all(claim.suspicions for claim in red))
        return Overall(mark, broken(red), said)
    if _forged(signed):
        return Overall(BROKEN, _forged(signed), said)
    if not good:
        return Overall(_NONE, _with("Nothing that was claimed is shown", stale), said)
    if len(good) < len(active) or flawed or gone:
        return Overall(_PART, _with("Not everything that was claimed is shown", stale), said)
    if refuted:
        return Overall(_PART, "What was audited held; verification found counterexamples.", said)
    if missing:
        return Overall(_PART, "What was audited held; not all that was planned is shown.", said)
    return Overall(_ALL, "Everything that was claimed is shown.", said)


def _with(headline: str, stale: str) -> str:
    """A headline, and what is suspect for which reason."""
    return f"{headline}: {stale}" if stale else f"{headline}."


def _held(active: Sequence[Claim], good: Sequence[Claim], runs: int) -> Iterator[str]:
    """Of requirements that each run is judged by, and of those that all runs are."""
    alone = [claim for claim in active if claim.together is None]
    chances = [claim for claim in active if claim.together is not None]
    if alone or not chances:
        yield _held_alone(alone, [claim for claim in good if claim.together is None], runs)
    if chances:
        count = sum(claim.is_shown for claim in chances)
        yield (
            f"{count} of {phrases.times(len(chances), 'probability', 'probabilities')} "
            f"{'is' if len(chances) == 1 else 'are'} supported, on the average over the triggers "
            f"of {phrases.times(runs, 'run')}."
        )


def _held_alone(active: Sequence[Claim], good: Sequence[Claim], runs: int) -> str:
    if not active:
        return "There is no requirement to show."
    if not runs:
        return "No run has been audited."
    if len(active) == 1:
        where = _where(len(active[0].judged))
        held = f"held in {where}" if good else f"was not shown to hold in {where}"
        return f"The one requirement, {active[0].id}, {held if where else 'was not audited'}."
    everywhere = all(len(claim.judged) == runs for claim in good)
    where = _where(runs) if everywhere else "each run in which they were audited"
    return f"{len(good)} of {len(active)} requirements held in {where}."


def _refuted(ids: Sequence[str]) -> str:
    if not ids:
        return ""
    return f"Verification found a counterexample to {phrases.some(ids)}; part 4 has the claim."


def _waived(active: Sequence[Claim]) -> str:
    found = [claim for claim in active if claim.verdict == WAIVED]
    if not found:
        return ""
    verb = "is" if len(found) == 1 else "are"
    names = phrases.some([f"{claim.id} ({claim.unwaived_mark.text})" for claim in found])
    return f"{names} {verb} waived, and not shown."


def _unsigned(sections: Sequence[RequirementView]) -> str:
    """A waiver lets a requirement pass, whoever has written it."""
    waived = [view for view in sections if view.waiver and view.mark.word == WAIVED]
    names = [view.id for view in waived if view.waiver and not view.waiver.signature.is_good]
    return f"Nobody is known to have signed the waiver of {phrases.some(names)}." if names else ""


def _forged(signed: Signatures) -> str:
    places = [one.name for one in signed.signed if one.signature.mark == BROKEN]
    if not places:
        return ""
    verb = "does" if len(places) == 1 else "do"
    count = phrases.times(len(places), "signature")
    return f"{count} {verb} not verify: {phrases.some(places)}."


def _where(runs: int) -> str:
    return ("", "the audited run")[runs] if runs <= 1 else f"every one of the {runs} audited runs"


def _unplanned(missing: Sequence[Planned]) -> str:
    if not missing:
        return ""
    names = phrases.some([f"{plan.method} for {plan.requirement}" for plan in missing])
    return f"No result is known of {phrases.times(len(missing), 'planned method')}: {names}."


def _uncovered(project: Project, claimed: Sequence[Claim]) -> str:
    count = len(orphans(project, claimed, None).hazards)
    verb = "has" if count == 1 else "have"
    return f"{phrases.times(count, 'hazard')} {verb} no requirement in force." if count else ""


_FLAWED = "The requirements or what stands beside them have errors: this report is not complete."


def _few(reservations: Sequence[str]) -> Sequence[str]:
    """The reservations themselves, or that there are many."""
    if len(reservations) <= 3:
        return reservations
    return (f"There are {len(reservations)} reservations about what is shown; part 2 lists them.",)


def _reservations(view: RequirementView) -> Sequence[str]:
    """What a reader has to know of a requirement that is shown."""
    if not view.mark.shows:
        return ()
    average = [f"{view.id} is supported: {AVERAGE}."] if view.mark.word == SUPPORTED else []
    waits = [
        (result.latency.longest_s, result.latency.longest, result.run_label)
        for result in view.results
        if result.latency and not result.latency.is_bounded
        if result.latency.at_once < result.latency.answered
    ]
    unbounded = "" if view.limit else f"{view.id} sets no bound on its response. "
    late = [
        f"{unbounded}The longest answer of {view.id} took {longest}, in {run}."
        for _, longest, run in sorted(waits, key=lambda wait: -wait[0])[:1]
    ]
    draft = [f"{view.id} is a draft."] if view.status == "draft" else []
    return (*average, *([view.limit] if view.limit else []), *late, *draft)


def _claims(claimed: Sequence[Claim], runs: int) -> str:
    active = [claim for claim in claimed if claim.verdict != RETIRED]
    drafts = sum(claim.requirement.status == "draft" for claim in active)
    retired = len(claimed) - len(active)
    parts = [
        f"{phrases.times(len(active), 'requirement')} in force",
        f"{drafts} of them {'a draft' if drafts == 1 else 'drafts'}" if drafts else "",
        f"{retired} retired" if retired else "",
        f"audited against {phrases.times(runs, 'run')}" if runs else "not audited",
    ]
    return f"{', '.join(filter(None, parts))}."


def _counts(claimed: Sequence[Claim]) -> tuple[Count, ...]:
    active = [claim for claim in claimed if claim.verdict != RETIRED]
    of_claims = Counter(claim.mark for claim in claimed)
    of_results = Counter(judged.mark for claim in active for judged in claim.results)
    found = {*map(verdict_mark, _ALWAYS), *of_claims, *of_results}
    return tuple(
        Count(mark, of_claims[mark], of_results[mark])
        for mark in sorted(found, key=lambda mark: mark.severity)
    )


_ALWAYS = (
    kernel.VIOLATED,
    kernel.NO_DATA,
    kernel.INCONCLUSIVE,
    kernel.VACUOUS,
    NOT_EXERCISED,
    kernel.SATISFIED,
)
"""Verdicts that are counted even where there are none."""


def _assumptions(project: Project, evidence: Evidence | None) -> tuple[str, ...]:
    declared = project.declarations.assumptions if project.declarations else ()
    audited = [
        text for result in (evidence.results if evidence else ()) for text in result.assumptions
    ]
    known = dict.fromkeys(declared)
    older = dict.fromkeys(f"{text} (in the audit)" for text in audited if text not in known)
    return (*known, *older)


# F504 ------------------------------------------------------------------------------------------


def stale(claimed: Sequence[Claim], evidence: Evidence | None, path: str) -> tuple[Diagnostic, ...]:
    """F504 for requirements with evidence of something else, and for each id that is unknown.

    Requirements whose evidence is suspect for one and the same reason share a message.
    """
    again = f"audit again: `fretc audit LOG... -o {path}`"
    suspicions: dict[tuple[int, str], list[Claim]] = {}
    for claim in claimed:
        suspicions.setdefault(_suspicions(claim), []).append(claim)
    suspect = [
        Diagnostic(
            Code.STALE_EVIDENCE,
            f"the evidence of {phrases.joined([claim.id for claim in some])} is suspect in "
            f"{phrases.times(count, 'run')}{' each' if len(some) > 1 else ''}: {why}",
            some[0].requirement.wording,
            help=again,
            severity=Severity.WARNING,
        )
        for (count, why), some in suspicions.items()
        if count
    ]
    strange = [
        Diagnostic(
            Code.STALE_EVIDENCE,
            f"there is evidence of {id}, which is not among the requirements",
            Source(path, "").span(),
            help=again,
            severity=Severity.WARNING,
        )
        for id in strangers(claimed, evidence)
    ]
    return (*suspect, *strange)


def _suspicions(claim: Claim) -> tuple[int, str]:
    """In how many runs a claim is suspect, and why."""
    stale = [judged for judged in claim.judged if judged.is_stale]
    reasons = dict.fromkeys(reason for judged in stale for reason in judged.suspicions)
    return len(stale), phrases.joined(list(reasons))
