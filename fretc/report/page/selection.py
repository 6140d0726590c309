"""The content of the page: all verdicts, and as many details as a browser can handle.

The page states how many unsatisfied runs it leaves out; the evidence file has them all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice, zip_longest

from fretc.audit.evidence.verdicts import SUSPECT
from fretc.report.model import phrases
from fretc.report.model.pictures import Timeline
from fretc.report.model.results import ResultRow, ResultView
from fretc.report.model.views import ReportView, RequirementView, RunSummary, RunView
from fretc.report.sections.details import Details
from fretish.classes.frozen import dataclass

COMPACT = 1_000
"""Above this number of results, only runs that are not satisfied have a row."""
DETAILED, PICTURES = 100, 24
"""Maximum results with all details, and maximum pictures of violations, on one page."""
_FEW_DETAILED, _FEW_PICTURES = 40, 20
"""Maximum results with all details, and maximum pictures, on a compact page."""
_ROWS = 10
"""Maximum rows of a requirement on a compact page."""
_RUNS, _RUN_ROWS = 8, 200
"""Number of runs above which they are in a table, and maximum rows of that table."""
_FOLDED = 60
"""Up to this number of results, the page has the details of satisfied runs too, folded."""
_VIOLATIONS, _FEW_VIOLATIONS = 8, 6
"""Maximum violations of one result above `_FOLDED` results, and on a compact page."""
_WHOLE = 200
"""Above this number of requirements, a compact page has no formulas, artefacts and pictures."""
_REASONS = 3
"""Maximum reasons per unshown requirement on a compact page."""


@dataclass(frozen=True, slots=True)
class RunRow:
    """A row of the table of runs of a requirement, with texts for the reader."""

    result: ResultRow
    longest: str
    """The longest latency."""
    reason: str
    has_details: bool
    """Whether the page has the details of the result; its anchor is theirs, or that of the row."""


@dataclass(frozen=True, slots=True)
class SectionRuns:
    """The runs in the section of a requirement."""

    rows: tuple[RunRow, ...]
    details: tuple[ResultView, ...]
    folded: tuple[ResultView, ...]
    """Folded details of satisfied runs."""
    left_out: tuple[str, ...]
    """Sentences about omitted content and where to find it."""
    is_short: bool
    """Whether formulas, propositions and artefacts are left out."""
    repeated: frozenset[int]
    """Indices of the reasons of the requirement that the details of their runs give again."""


@dataclass(frozen=True, slots=True)
class PageContent:
    """The content of the page for each requirement and for the runs."""

    by_anchor: Mapping[str, SectionRuns]
    runs: tuple[RunView, ...]
    """Runs with a section of their own."""
    run_rows: tuple[RunSummary, ...]
    """Runs in a table; empty where each run has a section."""
    runs_left_out: str
    notes: tuple[str, ...]
    is_compact: bool
    anchors: frozenset[str]
    """The anchors of all results and runs in the page."""


def selection(report: ReportView, details: Details) -> PageContent:
    """The content of the page for a report; only the details of selected results are read."""
    total = sum(len(view.results) for view in report.requirements)
    compact = total > COMPACT
    limits = _limits(total, compact)
    detailed = _detailed(report.requirements, limits.results)
    rest = [
        row
        for view in report.requirements
        for row in view.results
        if total <= _FOLDED and row.anchor not in detailed and _is_good(row)
    ]
    views = {row.anchor: view for row, view in details.results((*detailed.values(), *rest))}
    open_ = _shortened([views[anchor] for anchor in detailed], limits)
    folded = {row.anchor: views[row.anchor] for row in rest}
    by_anchor = {
        view.anchor: _section_runs(view, open_, folded, compact, len(report.requirements))
        for view in report.requirements
    }
    many = len(report.runs) > _RUNS
    alone = [run for run in report.runs if run.findings or run.gaps or not run.intact]
    sections = details.run_views(alone[:_RUNS] if many else report.runs)
    own = {run.anchor: run for run in sections}
    rows = report.runs[:_RUN_ROWS] if many else ()  # runs with errors and damage come first
    run_rows = tuple(own.get(run.anchor, run) for run in rows)
    left = len(report.runs) - len(run_rows) if many else 0
    anchors = {
        *(row.result.anchor for section in by_anchor.values() for row in section.rows),
        *(
            view.anchor
            for section in by_anchor.values()
            for view in (*section.details, *section.folded)
        ),
        *(run.anchor for run in (*sections, *run_rows)),
    }
    return PageContent(
        by_anchor=by_anchor,
        runs=sections,
        run_rows=run_rows,
        runs_left_out=_runs_left_out(left, len(alone) - len(sections) if many else 0),
        notes=tuple(_notes(total, compact, len(report.requirements))),
        is_compact=compact,
        anchors=frozenset(anchors),
    )


def _runs_left_out(rows: int, sections: int) -> str:
    parts = [
        f"{phrases.times(rows, 'run')} without a row" if rows else "",
        f"{phrases.times(sections, 'run')} whose findings are not shown" if sections else "",
    ]
    omissions = phrases.joined(list(filter(None, parts)))
    return f"Left out here: {omissions}. The evidence file has them all." if omissions else ""


def _notes(total: int, compact: bool, requirements: int) -> Iterator[str]:
    if not compact:
        return
    yield (
        f"This page is compact, because {phrases.whole(total)} results are more than "
        f"{phrases.whole(COMPACT)}: runs that satisfy a requirement have a mark in the matrix and "
        "no row of their own, and there are neither diagrams nor histograms."
    )
    if requirements > _WHOLE:
        yield (
            f"With more than {_WHOLE} requirements, their formulas, propositions and artefacts are "
            "left out as well."
        )
    yield "`fretc report --json` and `--csv` write all content; the evidence file has every event."


# The results of a requirement ------------------------------------------------------------------


def _is_good(result: ResultRow) -> bool:
    return result.mark.shows


@dataclass(frozen=True, slots=True)
class _Limits:
    """Maximum amounts of details on a page."""

    results: int
    """Maximum number of results with details."""
    pictures: int
    violations: int | None
    """Maximum number of violations of one result; None: no limit."""


def _limits(total: int, compact: bool) -> _Limits:
    if compact:
        return _Limits(min(DETAILED, _FEW_DETAILED), min(PICTURES, _FEW_PICTURES), _FEW_VIOLATIONS)
    return _Limits(DETAILED, PICTURES, None if total <= _FOLDED else _VIOLATIONS)


def _detailed(views: Sequence[RequirementView], most: int) -> Mapping[str, ResultRow]:
    """The results with all details: the worst of each requirement, then the next of each, ..."""
    wanted = [
        sorted(
            (r for r in view.results if not _is_good(r) or len(view.results) == 1),
            key=lambda result: result.mark.severity,
        )[:most]
        for view in views
    ]
    in_turn = (r for turn in zip_longest(*wanted) for r in turn if r is not None)
    return {row.anchor: row for row in islice(in_turn, most)}


def _shortened(results: Sequence[ResultView], limits: _Limits) -> Mapping[str, ResultView]:
    """The results in their order, with as many pictures and violations as the limits allow.

    The first violation of each result comes first, then runs in which unknown values decided, then
    other runs without a violation, then other violations.
    """
    drawn = [[*filter(_has_content, result.timelines)] for result in results]
    calm = [each for each in enumerate(results) if not each[1].violations_total]
    turns = [
        [(number, 0) for number, result in enumerate(results) if result.violations_total],
        [(number, 0) for number, result in calm if result.unknown_inputs.total],
        [(number, 0) for number, result in calm if not result.unknown_inputs.total],
        [(number, i) for i in range(1, limits.pictures) for number in range(len(results))],
    ]
    wanted = [(number, i) for turn in turns for number, i in turn if i < len(drawn[number])]
    kept = Counter(number for number, _ in wanted[: limits.pictures])
    return {
        result.anchor: replace(
            result,
            timelines=tuple(drawn[number][: kept[number]]),
            violations=result.violations[: limits.violations],
        )
        for number, result in enumerate(results)
    }


def _has_content(timeline: Timeline) -> bool:
    """Whether the picture has more than an empty axis."""
    return bool(timeline.panels or timeline.words or any(lane.marks for lane in timeline.lanes))


def _section_runs(
    view: RequirementView,
    detailed: Mapping[str, ResultView],
    foldable: Mapping[str, ResultView],
    compact: bool,
    requirements: int,
) -> SectionRuns:
    worst_first = sorted(view.results, key=lambda result: result.mark.severity)
    details = [r for r in worst_first if r.anchor in detailed]
    folded = [r for r in view.results if r.anchor in foldable]
    rows: Sequence[ResultRow] = view.results if len(view.results) > 1 else ()
    if compact:
        bad = [result for result in rows if not _is_good(result)]
        rows = sorted(bad, key=lambda result: result.mark.severity)[:_ROWS]
    elif view.results and not (details or folded):
        rows = view.results  # A single result without details has a row.
    open_ = {result.anchor for result in (*details, *folded)}
    return SectionRuns(
        rows=tuple(_row(result, result.anchor in open_) for result in rows),
        details=tuple(detailed[result.anchor] for result in details),
        folded=tuple(foldable[result.anchor] for result in folded),
        left_out=tuple(_left_out(view, rows, details, folded)),
        is_short=compact and requirements > _WHOLE,
        repeated=frozenset(_repeated(view, open_)),
    )


def _repeated(view: RequirementView, open_: Container[str]) -> Iterator[int]:
    """Indices of the reasons that the details give again; none if an unsatisfied run has none.

    The number of further runs is one of them: these have details, too.
    """
    bad = [result for result in view.results if not _is_good(result)]
    if all(result.anchor in open_ for result in bad):
        starts = ("and ", *(f"{result.run_label}: " for result in bad))
        yield from (i for i, reason in enumerate(view.reasons) if reason.startswith(starts))


def _row(result: ResultRow, has_details: bool) -> RunRow:
    longest = result.latency_max_s
    why = f"; {SUSPECT}, because {'; '.join(result.suspicions)}" if result.suspicions else ""
    longest_text = "\N{EN DASH}" if longest is None else phrases.duration(longest)
    missing = result.triggers - result.answers - result.open
    if longest is not None and result.violations_total and missing > 0:
        longest_text = f"> {longest_text} ({phrases.whole(missing)} unanswered)"
    return RunRow(result, longest_text, f"{result.reason}{why}", has_details)


def _left_out(
    view: RequirementView,
    rows: Sequence[ResultRow],
    details: Sequence[ResultRow],
    folded: Sequence[ResultRow],
) -> Iterator[str]:
    bad = sum(not _is_good(result) for result in view.results)
    good = len(view.results) - bad
    open_good = sum(map(_is_good, (*details, *folded)))
    open_bad = len(details) + len(folded) - open_good
    if view.results and len(rows) < len(view.results) and len(view.results) > 1:
        listed = sum(not _is_good(result) for result in rows)
        yield (
            f"Rows: {phrases.whole(listed)} of {phrases.times(bad, 'run')} not satisfied, "
            f"{phrases.whole(len(rows) - listed)} of {phrases.whole(good)} satisfied."
        )
    if open_bad < bad:
        yield (
            f"Details below: {phrases.whole(open_bad)} of {phrases.times(bad, 'run')} that are "
            "not satisfied. Details of the others are in the evidence file and in `--json`."
        )
    if open_good < good:
        yield "Details of satisfied runs are in the evidence file and in `--json`."


# The report for the page -----------------------------------------------------------------------


def slimmed(report: ReportView, chosen: PageContent) -> ReportView:
    """The report without the omitted content."""
    views = tuple(_slim(view, chosen) for view in report.requirements)
    not_shown = tuple(
        replace(each, reasons=_few(each.reasons, "in its section")) for each in report.not_shown
    )
    violated = tuple(
        replace(each, reasons=_few(each.reasons, "in its section")) for each in report.violated
    )
    return replace(
        report, requirements=views, violated=violated, not_shown=not_shown, runs=chosen.runs
    )


def _slim(view: RequirementView, chosen: PageContent) -> RequirementView:
    """A section without its results, which the template takes from the selection."""
    where = "in the table of its runs"
    reasons = _few(view.reasons, where) if chosen.is_compact else view.reasons
    kept = replace(view, results=(), reasons=reasons)
    if chosen.is_compact:
        kept = replace(kept, diagram="")
    if not chosen.by_anchor[view.anchor].is_short:
        return kept
    return replace(kept, formulas=(), propositions=(), artefacts=())


def _few(reasons: Sequence[str], where: str) -> tuple[str, ...]:
    left = len(reasons) - _REASONS
    if left <= 1:
        return tuple(reasons)
    return (*reasons[:_REASONS], f"and {left} more, {where}")
