"""The front page: facts, headline, five figures, and whether the logs can be trusted.

Each requirement in force is counted once: it is shown, violated, or not shown.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from datetime import date
from math import fsum

from compiler.files.build_id import __version__
from compiler.files.dates import is_date
from compiler.logic.claims import Layer
from fretc.audit.evidence.result_summaries import EvidenceSource, audited_s
from fretc.audit.evidence.verdicts import BROKEN, RETIRED
from fretc.report.front import violations
from fretc.report.front.causes import causes, line, link
from fretc.report.front.gravity import Gravity
from fretc.report.front.groups import run_groups
from fretc.report.front.identity import identity
from fretc.report.front.speech import capital, day, days, duration
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.changes import RequirementChanges
from fretc.report.model.front import Figure, FigureLine, Front
from fretc.report.model.views import HazardRequirement, Overall, RequirementView, RunSummary
from fretc.report.sections.proofs import is_proved_layer, is_refuted
from fretc.report.sections.runs import AuditedFile
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.diagnostic import Severity

_CHANGES = 3
"""Maximum number of changes that a figure names."""


def front(
    title: str,
    overall: Overall,
    sections: Sequence[RequirementView],
    rows: Sequence[HazardRequirement],
    grave: Mapping[str, Gravity],
    assessed: Sequence[Assessment],
    runs: Sequence[AuditedFile],
    views: Sequence[RunSummary],
    changes: Sequence[RequirementChanges],
    notes: Sequence[str],
    evidence: EvidenceSource | None,
) -> Front:
    """The view of the front page.

    Args:
        title: title of the project.
        overall: the overall result; its headline is used if no violation is current.
        sections: views of all requirements.
        rows: rows of the matrix.
        grave: anchor of a requirement → its gravity.
        assessed: the assessment of each section, in the same order.
        runs: runs in the order of the evidence.
        views: views of the runs, in any order.
        changes: changes since the review.
        notes: sentences that qualify the figures.
        evidence: None if no run was audited.
    """
    active = [view for view in sections if view.status != RETIRED]
    red = violations.gravest_first([*filter(violations.is_red, active)], grave)
    groups = run_groups(runs)
    names = {run.anchor: run.name for group in groups for run in group.runs}
    is_current = bool(red) and not any(view.mark.suspect for view in red)
    return Front(
        title=title,
        facts=tuple(_facts(active, runs, assessed)),
        identity=identity(runs, groups, evidence),
        headline=violations.headline(red, len(runs), grave) if is_current else overall.headline,
        sentences=tuple(violations.sentences(red, groups, grave)),
        figures=(
            _claimed(sections, active, rows),
            _shown(active),
            _violated(active, red),
            _not_shown(active, views),
            _changed(active, changes),
        ),
        trust=tuple(_trust(views, names)),
        notes=tuple(notes),
        groups=groups,
    )


def _facts(
    active: Sequence[RequirementView], runs: Sequence[AuditedFile], assessed: Sequence[Assessment]
) -> Iterator[str]:
    yield phrases.times(len(active), "requirement")
    yield _runs(runs) if runs else "no run"
    reviews = [assessment.review_status.review for assessment in assessed]
    dates = sorted(
        date.fromisoformat(review.date) for review in reviews if review and is_date(review.date)
    )
    yield f"reviewed on {days(dates[0], dates[-1])}" if dates else "not reviewed"
    yield f"fretc {__version__}"


def _runs(runs: Sequence[AuditedFile]) -> str:
    """`16 runs of 21 November 2026, 58 min`."""
    results = [run.facts for run in runs]
    dates = [each for result in results if (each := day(result.start_ns))]
    when = f" of {days(min(dates), max(dates))}" if dates else ""
    seconds = fsum(audited_s(result) or 0.0 for result in results)
    return f"{phrases.times(len(runs), 'run')}{when}, {duration(seconds)}"


# The figures -----------------------------------------------------------------------------------


def _claimed(
    sections: Sequence[RequirementView],
    active: Sequence[RequirementView],
    rows: Sequence[HazardRequirement],
) -> Figure:
    in_force = {view.anchor for view in active}
    hazards = {row.hazard for row in rows if row.hazard and row.anchor in in_force}
    rootless = {row.anchor for row in rows if not row.hazard}
    loose = [link(view) for view in active if view.anchor in rootless]
    drafts = [link(view) for view in active if view.status == "draft"]
    retired = [link(view) for view in sections if view.status == RETIRED]
    lines = [FigureLine(f"under {phrases.times(len(hazards), 'hazard')}", (), 0)] if hazards else []
    for text, names in (("under no hazard", loose), ("draft", drafts), ("retired", retired)):
        lines += [line(text, names)] if names else []
    return Figure("claimed", len(active), "claimed", "", "requirements", tuple(lines))


def _shown(active: Sequence[RequirementView]) -> Figure:
    good = [view for view in active if view.mark.shows]
    proved = [
        _proved(active, layer, what)
        for layer, what in ((Layer.MONITOR, "monitor proved"), (Layer.LOOP, "loop proved"))
    ]
    lines = (*([line("", [*map(link, good)])] if good else []), *filter(None, proved))
    kind = signs.GOOD.kind if active and len(good) == len(active) else ""
    return Figure("shown", len(good), "shown in every run", kind, "matrix", lines)


def _proved(active: Sequence[RequirementView], layer: Layer, what: str) -> FigureLine | None:
    """A figure: the number of requirements whose current claims of a layer are all proved."""
    count = sum(is_proved_layer(view, layer) for view in active)
    if not count:
        return None
    return FigureLine(f"{what}: {'all' if count == len(active) else count}", (), 0)


def _violated(active: Sequence[RequirementView], red: Sequence[RequirementView]) -> Figure:
    refuted = [link(view) for view in active if is_refuted(view)]
    lines = [line("", [*map(link, red)])] if red else []
    lines += [line("counterexample of a proof", refuted)] if refuted else []
    waived = [
        link(view)
        for view in active
        if view not in red and any(result.mark.word in BROKEN for result in view.results)
    ]
    lines += [line("violated in a run, but waived or open over all runs", waived)] if waived else []
    kind = signs.BAD.kind if red or refuted else ""
    return Figure("violated", len(red), "violated", kind, "violated", tuple(lines))


def _not_shown(active: Sequence[RequirementView], runs: Sequence[RunSummary]) -> Figure:
    unshown = [view for view in active if not view.mark.shows and not violations.is_red(view)]
    kind = signs.OPEN.kind if unshown else ""
    lines = causes(unshown, runs)
    return Figure("not shown", len(unshown), "not shown", kind, "not-shown", lines)


def _changed(active: Sequence[RequirementView], changes: Sequence[RequirementChanges]) -> Figure:
    words = "changed since the review"
    unreviewed = [link(view) for view in active if view.review.signature is None]
    if active and len(unreviewed) == len(active) and not changes:
        nothing = FigureLine("no requirement is reviewed", (), 0)
        return Figure("changed", None, words, "", "changes", (nothing,))
    roots = [change for change in changes if change.is_root]
    lines = [
        FigureLine(f"{change.requirement}: {'; '.join(change.lines[:2]) or 'verdicts'}", (), 0)
        for change in roots[:_CHANGES]
    ]
    more = len(roots) - _CHANGES
    lines += [FigureLine(f"and {phrases.times(more, 'more requirement')}", (), 0)] * (more > 0)
    others = {change.anchor for change in changes if not change.is_root}
    stale = [link(view) for view in active if view.anchor in others]
    lines += [line("not changed, only need `fretc analyze`", stale)] if stale else []
    verdicts = [(then, now) for change in changes for _, then, now in change.verdicts]
    worse = sum(now in BROKEN and then not in BROKEN for then, now in verdicts)
    became = f"{phrases.times(worse, 'verdict')} became violated"
    lines += [FigureLine(became, (), 0)] * (worse > 0)
    lines += [line("not reviewed", unreviewed)] if unreviewed else []
    kind = signs.OPEN.kind if changes else ""
    return Figure("changed", len(roots), words, kind, "changes", tuple(lines))


# Trust -----------------------------------------------------------------------------------------


def _trust(runs: Sequence[RunSummary], names: Mapping[str, str]) -> Iterator[str]:
    """Two lines about the logs: damage and errors; hashes and findings."""
    if not runs:
        return
    total = phrases.times(len(runs), "log")
    damaged = [names[run.anchor] for run in runs if not run.intact]
    wrong = [
        f"{names[run.anchor]} ({', '.join(errors)})"
        for run in runs
        if run.intact and (errors := _errors(run))
    ]
    parts = [
        f"{len(damaged)} of {total} damaged or not readable: {phrases.some(damaged)}"
        if damaged
        else f"no damage found in {'the log' if len(runs) == 1 else f'any of {total}'}",
        f"errors in {phrases.some(wrong)}, read them before the verdicts" if wrong else "",
    ]
    yield f"{capital('; '.join(filter(None, parts)))}."
    unknown = sum(not run.sha256 for run in runs)
    hashes = f"{unknown} of {total} without a SHA-256" if unknown else "Each log has its SHA-256"
    found = [
        names[run.anchor]
        for run in runs
        if run.intact and not _errors(run) and not all(finding.accepted for finding in run.findings)
    ]
    more = f"other findings in {phrases.some(found, 4)}" if found else "no other findings"
    yield f"{hashes}; {more}."


def _errors(run: RunSummary) -> list[str]:
    """The codes of the errors of a run, without duplicates."""
    errors = (finding.code for finding in run.findings if finding.severity == Severity.ERROR.value)
    return list(dict.fromkeys(errors))
