"""The pictures of all runs, from the requirements and what the evidence says of each run."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from math import inf

from fretc.audit.evidence.briefs import EvidenceSource, stretches
from fretc.audit.evidence.declared_units import thresholds_in_declared_units
from fretc.audit.evidence.schema import Result, Threshold
from fretc.report.across.lanes import RunStretches, Words, lanes, with_marks
from fretc.report.across.uses import RunNumbers, uses
from fretc.report.model import phrases
from fretc.report.model.across import Across, Lanes, RequirementAcross
from fretc.report.model.assessments import Assessment
from fretc.report.model.audits import SingleAudit
from fretc.report.model.pictures import WordLane
from fretc.report.pictures.histograms import is_answered, seconds_allowed
from fretc.report.sections.results import result_anchor
from fretc.report.sections.runs import Run, RunKey, run_key
from fretish.bindings.declarations import Declarations

_ROWS, _MARKS = 180, 1_500
"""Of the pictures of all requirements together."""
_FEWEST, _MOST = 3, 20
"""Rows of one picture of a requirement."""


def across(
    assessed: Sequence[Assessment],
    runs: Mapping[RunKey, Run],
    evidence: EvidenceSource | None,
    declared: Declarations | None,
) -> Across:
    """The lanes of all requirements, and the lanes and the used bounds of each.

    Args:
        assessed: all requirements; those that are retired have no lanes.
        runs: all runs.
        evidence: None where no run was audited.
        declared: the bindings.
    """
    active = [each for each in assessed if each.requirement.status != "retired"]
    most = max(_FEWEST, min(_MOST, _ROWS // max(1, len(active))))
    marks = max(10 * _FEWEST, _MARKS // max(1, len(active)))
    of_each = {each.anchor: _results(each, runs, evidence) for each in active}
    of_all = _in_order([one for of in of_each.values() for one in of], runs)
    words = _words(active, runs, evidence)
    return Across(
        lanes("All requirements, a lane for each run", of_all, words=words),
        tuple(
            _requirement(each, of_each[each.anchor], most, marks, evidence, declared)
            for each in active
        ),
    )


def _requirement(
    assessment: Assessment,
    of: Sequence[RunStretches],
    most: int,
    marks: int,
    evidence: EvidenceSource | None,
    declared: Declarations | None,
) -> RequirementAcross:
    several = len(of) > 1
    return RequirementAcross(
        assessment.id,
        assessment.anchor,
        _lanes(assessment.id, of, most, marks) if several else None,
        uses(*_numbers(assessment, of, most, evidence, declared)) if several else None,
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


def _results(
    assessment: Assessment, runs: Mapping[RunKey, Run], evidence: EvidenceSource | None
) -> list[RunStretches]:
    stretches_at = dict(evidence.stretches(assessment.id)) if evidence else {}
    return [
        RunStretches(
            run.anchor,
            run.label,
            phrases.place(audit.result.run),
            assessment.id,
            assessment.anchor,
            result_anchor(assessment, number),
            audit.mark,
            stretches_at[audit.place],
        )
        for number, audit in enumerate(assessment.reviewed_audits, 1)
        for run in [runs[run_key(audit.result)]]
    ]


def _numbers(
    assessment: Assessment,
    of: Sequence[RunStretches],
    most: int,
    evidence: EvidenceSource | None,
    declared: Declarations | None,
) -> tuple[list[RunNumbers], float | None, int, int]:
    """The runs whose results are current, the time allowed, the rows, and the other runs."""
    thresholds_at = {
        place: thresholds_in_declared_units(thresholds, declared)
        for place, thresholds in (evidence.thresholds(assessment.id) if evidence else ())
    }
    current = [
        _run_numbers(audit, each, thresholds_at[audit.place])
        for audit, each in zip(assessment.audits, of, strict=True)
        if not audit.is_stale
    ]
    allowed = seconds_allowed(assessment.rule) if is_answered(assessment.rule) else None
    return current, allowed, most, len(of) - len(current)


def _run_numbers(
    audit: SingleAudit, each: RunStretches, thresholds: tuple[Threshold, ...]
) -> RunNumbers:
    result = audit.result
    return RunNumbers(
        each.label,
        each.file,
        each.section,
        each.anchor,
        audit.mark,
        result.triggers,
        result.violations,
        result.latency_max_s,
        thresholds,
    )


# Words -----------------------------------------------------------------------------------------


def _words(
    assessed: Sequence[Assessment], runs: Mapping[RunKey, Run], evidence: EvidenceSource | None
) -> Words:
    """Reads the signals of words of some runs, by their anchors: each from one of its results."""
    places: dict[str, int] = {}
    for assessment in assessed:
        for audit in assessment.audits:
            if audit.result.ticks:
                places.setdefault(runs[run_key(audit.result)].anchor, audit.place)

    def words(anchors: Collection[str]) -> Mapping[str, tuple[WordLane, ...]]:
        run_at = {places[anchor]: anchor for anchor in anchors if anchor in places}
        results = evidence.details(run_at) if evidence else ()
        return {run_at[place]: word_lanes(result) for place, result in results}

    return words


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
        ends = [*times[1:], inf]
        pieces = tuple(
            (round(max(0.0, start), 6), round(min(end, after), 6), word)
            for start, after, word in zip(times, ends, words, strict=True)
            if after > 0 and start < end
        )
        found.append(WordLane(name, pieces))
    return tuple(found)
