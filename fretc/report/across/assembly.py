"""The pictures of all runs, from the requirements and what the evidence says of each run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf

from fretc.audit.evidence.briefs import stretches
from fretc.audit.evidence.schema import Result
from fretc.report.across.lanes import RunStretches, lanes, with_marks
from fretc.report.across.maps import MOST_MAPS, RunResult, run_map
from fretc.report.across.uses import RunNumbers, uses
from fretc.report.model import phrases
from fretc.report.model.across import Across, Lanes, RequirementAcross, RunMap
from fretc.report.model.assessments import Assessment
from fretc.report.model.audits import SingleAudit
from fretc.report.model.pictures import WordLane
from fretc.report.pictures.histograms import is_answered, seconds_allowed
from fretc.report.sections.results import result_anchor
from fretc.report.sections.runs import Run, RunKey, run_key

_ROWS, _MARKS = 180, 1_500
"""Of the pictures of all requirements together."""
_FEWEST, _MOST = 3, 20
"""Rows of one picture of a requirement."""


def across(assessed: Sequence[Assessment], runs: Mapping[RunKey, Run]) -> Across:
    """The lanes of all requirements, and the lanes and the used bounds of each.

    Args:
        assessed: all requirements; those that are retired have no lanes.
        runs: all runs.
    """
    active = [each for each in assessed if each.requirement.status != "retired"]
    most = max(_FEWEST, min(_MOST, _ROWS // max(1, len(active))))
    marks = max(10 * _FEWEST, _MARKS // max(1, len(active)))
    of_each = {each.anchor: _results(each, runs) for each in active}
    of_all = _in_order([one for of in of_each.values() for one in of], runs)
    words = _words(active, runs)
    maps, maps_left_out = _maps(active, of_each, runs)
    return Across(
        lanes("All requirements, a lane for each run", of_all, words=words),
        tuple(_requirement(each, of_each[each.anchor], most, marks) for each in active),
        maps,
        maps_left_out,
    )


def _maps(
    active: Sequence[Assessment],
    of_each: Mapping[str, Sequence[RunStretches]],
    runs: Mapping[RunKey, Run],
) -> tuple[tuple[RunMap, ...], str]:
    """The maps of the worst runs, and how many runs with a way have none."""
    grouped: dict[str, list[RunResult]] = {run.anchor: [] for run in runs.values()}
    for assessment in active:
        for audit, of in zip(assessment.audits, of_each[assessment.anchor], strict=True):
            grouped[of.run].append(RunResult(of, audit.result))
    with_way = [of for of in grouped.values() if any(_has_way(one.result) for one in of)]
    ranked = sorted(with_way, key=_badness)
    left = ranked[MOST_MAPS:]
    maps = tuple(filter(None, map(run_map, ranked[:MOST_MAPS])))
    if not left:
        return maps, ""
    violations = sum(len(one.result.violations) for of in left for one in of)
    worst = min((one.of.mark for of in left for one in of), key=lambda mark: mark.severity)
    return maps, (
        f"{phrases.times(len(left), 'run')} without a map, none of them worse: the worst is "
        f"{worst.text}, with {phrases.times(violations, 'violation')}."
    )


def _has_way(result: Result) -> bool:
    return bool(result.course and result.course.way and result.course.way.times_ns)


def _badness(of: Sequence[RunResult]) -> tuple[tuple[int, bool], int]:
    return (
        min(one.of.mark.severity for one in of),
        -sum(len(one.result.violations) for one in of),
    )


def _requirement(
    assessment: Assessment, of: Sequence[RunStretches], most: int, marks: int
) -> RequirementAcross:
    several = len(of) > 1
    return RequirementAcross(
        assessment.id,
        assessment.anchor,
        _lanes(assessment.id, of, most, marks) if several else None,
        uses(*_numbers(assessment, of, most)) if several else None,
    )


def _lanes(id: str, of: Sequence[RunStretches], most: int, marks: int) -> Lanes | None:
    """Of the runs that have anything to mark; the others are counted."""
    marked = with_marks(of)
    calm = len(of) - len(marked)
    note = f" No lane: {phrases.times(calm, 'run')} with nothing of it." if calm else ""
    return lanes(f"{id} in its runs", marked, most, marks, note=note) if marked else None


def _in_order(
    results: Sequence[RunStretches], runs: Mapping[RunKey, Run]
) -> Sequence[RunStretches]:
    """In the order of runs."""
    places = {run.anchor: run.number for run in runs.values()}
    return sorted(results, key=lambda each: places[each.run])


# What the evidence says ------------------------------------------------------------------------


def _results(assessment: Assessment, runs: Mapping[RunKey, Run]) -> list[RunStretches]:
    return [
        RunStretches(
            run.anchor,
            run.label,
            phrases.place(audit.result.run),
            assessment.id,
            assessment.anchor,
            result_anchor(assessment, number),
            audit.mark,
            stretches(audit.result),
        )
        for number, audit in enumerate(assessment.reviewed_audits, 1)
        for run in [runs[run_key(audit.result)]]
    ]


def _numbers(
    assessment: Assessment, of: Sequence[RunStretches], most: int
) -> tuple[list[RunNumbers], float | None, int, int]:
    """The runs whose results are current, the time allowed, the rows, and the other runs."""
    current = [
        _run_numbers(audit, each)
        for audit, each in zip(assessment.audits, of, strict=True)
        if not audit.is_stale
    ]
    allowed = seconds_allowed(assessment.rule) if is_answered(assessment.rule) else None
    return current, allowed, most, len(of) - len(current)


def _run_numbers(audit: SingleAudit, each: RunStretches) -> RunNumbers:
    result = audit.result
    return RunNumbers(
        each.label,
        each.file,
        each.section,
        each.anchor,
        audit.mark,
        len(result.triggers),
        len(result.violations),
        max(result.latencies, default=None),
        result.thresholds,
    )


# Words -----------------------------------------------------------------------------------------


def _words(
    assessed: Sequence[Assessment], runs: Mapping[RunKey, Run]
) -> dict[str, tuple[WordLane, ...]]:
    """The signals of words of each run, by its anchor."""
    lanes: dict[str, tuple[WordLane, ...]] = {}
    for assessment in assessed:
        for audit in assessment.audits:
            anchor = runs[run_key(audit.result)].anchor
            if anchor not in lanes and audit.result.course:
                lanes[anchor] = word_lanes(audit.result)
    return lanes


def word_lanes(result: Result) -> tuple[WordLane, ...]:
    """The signals of words over the whole run; behind changes that are left out it is unknown."""
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
