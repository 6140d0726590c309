"""Pictures over all runs: lanes, used bounds and maps, from assessments and evidence."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from math import inf

from fretc.audit.evidence.result_summaries import ResultSummary
from fretc.audit.evidence.schema import Result
from fretc.report.across.lanes import (
    Known,
    LanePlan,
    RunTally,
    left_out,
    plan,
    with_marks,
    worst_first,
    worst_runs,
)
from fretc.report.across.maps import MOST_MAPS, MapResult, run_map
from fretc.report.across.stretches import stretches
from fretc.report.across.uses import RunThresholds, uses
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.pictures import Across, RequirementAcross, RunMap, WordLane
from fretc.report.model.results import ResultRow
from fretc.report.pictures.histograms import is_answered, seconds_allowed
from fretc.report.sections.details import Details, Thresholds
from fretc.report.sections.runs import run_key

_ROWS, _MARKS = 180, 1_500
"""Maximum rows and marks of the pictures of all requirements together."""
PICTURED = 16
"""Maximum number of requirements with their own pictures on a page; `--json` has all."""
_FEWEST, _MOST = 3, 20
"""Minimum and maximum rows of the picture of a requirement."""


def across(details: Details, worst: Sequence[str], pictured: int = PICTURED) -> Across:
    """The lanes of all requirements, and the lanes and the used bounds of the worst.

    Args:
        details: requirements, runs and evidence; retired requirements have no lanes.
        worst: the anchors of the requirements, worst first.
        pictured: how many of these have their own pictures.
    """
    active = [a for a in details.assessments.values() if a.entry.is_in_force]
    most = max(_FEWEST, min(_MOST, _ROWS // max(1, len(active))))
    marks = max(10 * _FEWEST, _MARKS // max(1, len(active)))
    in_force = {assessment.anchor for assessment in active}
    chosen = {*[anchor for anchor in worst if anchor in in_force][:pictured]}
    several = [
        assessment
        for assessment in active
        if assessment.anchor in chosen and len(assessment.audits) > 1
    ]
    tallies = _tallies(active, details)
    of_all = _plan_of_all(active, tallies, details)
    plans = {assessment.anchor: _plan(assessment, details, most, marks) for assessment in several}
    known = _known(
        details, [at for lane_plan in (of_all, *plans.values()) for at in lane_plan.places]
    )
    uses_of = {
        each.anchor: uses(*_numbers(each, details, thresholds, most))
        for each, thresholds in details.thresholds(plans)
    }
    maps, maps_left_out = _maps(active, tallies, details)
    return Across(
        of_all.lanes(known),
        tuple(
            RequirementAcross(
                assessment.id,
                assessment.anchor,
                plans[assessment.anchor].lanes(known) if assessment.anchor in plans else None,
                uses_of.get(assessment.anchor),
            )
            for assessment in active
            if assessment.anchor in chosen
        ),
        maps,
        maps_left_out,
    )


def _plan(assessment: Assessment, details: Details, most: int, marks: int) -> LanePlan:
    """The lanes of the runs of a requirement that have marks; other runs are only counted."""
    of = _results(assessment, details)
    marked = with_marks(of)
    calm = len(of) - len(marked)
    note = f"{phrases.times(calm, 'run')} without such a tick: not drawn." if calm else ""
    return plan(f"{assessment.id} in its runs", marked, most, marks, note)


def _plan_of_all(
    active: Sequence[Assessment], tallies: Mapping[str, RunTally], details: Details
) -> LanePlan:
    """The lanes of the worst runs over all requirements; other runs are only counted."""
    chosen = {*worst_runs(tallies)}
    left = [tally for run, tally in tallies.items() if run not in chosen]
    of = _of_runs(active, details, chosen)
    is_single = len(tallies) == 1
    title = "One run, a lane for each requirement"
    if not is_single:
        title = "All requirements, a lane for each run"
    damaged = {run.anchor for run in details.runs.values() if not run.facts.health.intact}
    return plan(
        title,
        of,
        left=left,
        courses=_courses(details),
        ranked=bool(left),
        damaged=damaged,
        by_requirement=is_single,
    )


def _tallies(active: Sequence[Assessment], details: Details) -> Mapping[str, RunTally]:
    """Run → its worst verdict and counts, in the order of the runs."""
    tallies: dict[str, RunTally] = {}
    for assessment in active:
        for audit in assessment.reviewed_audits:
            run, known = details.runs[run_key(audit.result)].anchor, _count(audit.result)
            before = tallies.get(run)
            tallies[run] = (
                before.with_one(audit.mark, known) if before else RunTally(audit.mark, known)
            )
    return {
        run.anchor: tallies[run.anchor] for run in details.runs.values() if run.anchor in tallies
    }


def _courses(details: Details) -> Mapping[str, int]:
    """Run → index of the result that contains the plot data of the run."""
    return {run.anchor: run.first for run in details.runs.values()}


# Maps ------------------------------------------------------------------------------------------


def _maps(
    active: Sequence[Assessment], tallies: Mapping[str, RunTally], details: Details
) -> tuple[tuple[RunMap, ...], str]:
    """The maps of the worst runs, and a sentence about runs without a map."""
    judged = {
        details.runs[run_key(audit.result)].anchor
        for assessment in active
        for audit in assessment.reviewed_audits
        if audit.result.ticks
    }
    ranked = [run for run in tallies if run in judged]
    ranked.sort(key=lambda run: worst_first(tallies[run]))
    results: dict[str, list[ResultRow]] = {run: [] for run in ranked[:MOST_MAPS]}
    for summary in _of_runs(active, details, results):
        results[summary.run].append(summary)
    courses = _courses(details)
    drawn = [_map(of, courses[run], details) for run, of in results.items()]
    maps = tuple(picture for picture in drawn if picture is not None)
    if not maps:
        return (), ""
    left = left_out([tallies[run] for run in ranked[MOST_MAPS:]], "no map")
    unknown = len(drawn) - len(maps)
    verb = "has" if unknown == 1 else "have"
    lost = f"{phrases.times(unknown, 'run')} {verb} no map, because the path is not known."
    return maps, " ".join(filter(None, [left, lost if unknown else ""]))


def _map(of: Sequence[ResultRow], first: int, details: Details) -> RunMap | None:
    """The map of a run; None if the evidence has no path of the robot.

    Args:
        of: all results of the run.
        first: index of the result that contains the plot data of the run.
        details: the evidence.
    """
    violated = [summary.place for summary in of if summary.count[0]]
    found = dict(details.evidence.details({first, *violated}) if details.evidence else ())
    course = found[first].course
    if not course or course.way is None:
        return None
    return run_map(course.way, [MapResult(summary, found.get(summary.place)) for summary in of])


# What the evidence says ------------------------------------------------------------------------


def _of_runs(
    active: Sequence[Assessment], details: Details, runs: Collection[str]
) -> list[ResultRow]:
    """The results of some runs, by their anchors, in the order of all runs."""
    places = {run.anchor: run.number for run in details.runs.values()}
    found = [result for assessment in active for result in _results(assessment, details, runs)]
    return sorted(found, key=lambda one: places[one.run])


def _results(
    assessment: Assessment, details: Details, of: Collection[str] | None = None
) -> list[ResultRow]:
    """The results of a requirement in some runs, by their anchors; None: in all runs."""
    rows = details.rows[assessment.anchor]
    return [row for row in rows if of is None or row.run in of]


def _count(result: ResultSummary) -> tuple[int, int, int]:
    return result.violations, result.unknown, result.open


def _numbers(
    assessment: Assessment, details: Details, thresholds: Thresholds, most: int
) -> tuple[list[RunThresholds], float | None, int, int]:
    """Arguments of `uses`: current runs, allowed time, number of rows, number of suspect runs."""
    rows = details.rows[assessment.anchor]
    current = [
        (row if row.mark == audit.mark else replace(row, mark=audit.mark), thresholds[audit.place])
        for audit, row in zip(assessment.audits, rows, strict=True)
        if not audit.is_stale
    ]
    is_timed = is_answered(assessment.requirement)
    allowed = seconds_allowed(assessment.requirement) if is_timed else None
    return current, allowed, most, len(rows) - len(current)


def _known(details: Details, places: Collection[int]) -> Mapping[int, Known]:
    """Index of a result → its intervals and signals of words."""
    results = details.evidence.details(places) if details.evidence else ()
    return {index: (stretches(result), word_lanes(result)) for index, result in results}


def word_lanes(result: Result) -> tuple[WordLane, ...]:
    """The signals of words over the whole run; unknown after the last recorded change."""
    if not result.course or result.start_ns is None:
        return ()
    end = stretches(result).length
    origin = result.states[0].ns if result.states else result.start_ns
    found = []
    for name, series in sorted(result.course.words.items()):
        times = [(ns - origin) / 1e9 for ns in series.times_ns]
        words = list(series.words)
        if series.changes_left_out and times:
            words[-1] = None
        ends = [*times[1:], inf][: len(times)]
        pieces = tuple(
            (round(max(0.0, start), 6), round(min(end, after), 6), word)
            for start, after, word in zip(times, ends, words, strict=True)
            if after > 0 and start < end
        )
        found.append(WordLane(name, pieces))
    return tuple(found)
