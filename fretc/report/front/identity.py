"""What an assessor signs: date, robot and software, exposure, confidence and the hash of evidence.

Nothing here depends on the clock of this machine or on a repository: the evidence and
`SOURCE_DATE_EPOCH` have it all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import dist, fsum

from compiler.files.dates import source_date
from fretc.audit.evidence.result_summaries import EvidenceSource, audited_s
from fretc.audit.evidence.schema import RobotPath
from fretc.audit.measurements.binomial import highest, lowest
from fretc.report.front.groups import SCENARIO
from fretc.report.front.speech import day, days, duration
from fretc.report.model import phrases
from fretc.report.model.front import IdentityRow, RunGroup
from fretc.report.sections.runs import AuditedFile
from fretish.reading.natural_order import natural

_VALUES = 3
"""Maximum number of values of a label that the page names."""
_PATHS = 500
"""Maximum number of runs whose paths are read, for the distance."""
_SIDE = 0.975
"""Confidence of each side of an interval of 95 %."""


def identity(
    runs: Sequence[AuditedFile], groups: Sequence[RunGroup], evidence: EvidenceSource | None
) -> tuple[IdentityRow, ...]:
    """The rows of the head.

    Args:
        runs: all runs, in the order of the evidence.
        groups: the same runs by scenario.
        evidence: None if no run was audited.
    """
    rows = [IdentityRow("Date", (_date(runs),))]
    rows += [IdentityRow(f"Label {key}", (text,)) for key, text in _labels(runs)]
    if evidence is not None:
        rows.append(IdentityRow("Evidence", (f"SHA-256 {evidence.sha256}",)))
        rows.append(IdentityRow("Audited by", (f"fretc {evidence.fretc}",)))
    if runs:
        rows.append(IdentityRow("Exposure", tuple(_exposure(runs, groups, evidence))))
        most = percent(highest(0, len(runs), _SIDE))
        text = (
            f"a requirement that holds in {phrases.every(len(runs), 'run')} may fail in up to "
            f"{most} of such runs (95 % interval, Clopper-Pearson, if the runs are independent)"
        )
        rows.append(IdentityRow("Confidence", (text,)))
    return tuple(rows)


def _date(runs: Sequence[AuditedFile]) -> str:
    made = source_date()
    if made is not None:
        return f"{days(made.date(), made.date())}, by SOURCE_DATE_EPOCH"
    found = [each for run in runs if (each := day(run.facts.end_ns))]
    last = max(found, default=None)
    return f"{days(last, last)}, the last day of the logs" if last else "the logs have no date"


def _labels(runs: Sequence[AuditedFile]) -> Iterator[tuple[str, str]]:
    """The labels of the runs with their values; the scenario is a part of the exposure."""
    known = [run.facts.labels for run in runs]
    for key in sorted({key for labels in known for key in labels if key != SCENARIO}, key=natural):
        values = sorted({labels[key] for labels in known if key in labels}, key=natural)
        without = sum(key not in labels for labels in known)
        text = phrases.some(values, _VALUES)
        yield key, f"{text} (not known for {phrases.times(without, 'run')})" if without else text


def _exposure(
    runs: Sequence[AuditedFile], groups: Sequence[RunGroup], evidence: EvidenceSource | None
) -> Iterator[str]:
    """Runs, time and distance of each group, then of all of them."""
    facts = {run.anchor: run for run in runs}
    metres = _distances(runs, evidence)
    every = [run for group in groups for run in group.runs]
    parts = [(group.name or "no scenario", group.runs) for group in groups if len(groups) > 1]
    for name, columns in (*parts, ("all", tuple(every))):
        seconds = fsum(audited_s(facts[column.anchor].facts) or 0.0 for column in columns)
        driven = [metres[column.anchor] for column in columns if column.anchor in metres]
        distance = f", at least {phrases.value(fsum(driven), 'm')}" if driven else ""
        count = phrases.times(len(columns), "run")
        text = f"{count}, {duration(seconds)}{distance}"
        yield f"{name}: {text}" if parts else text


def _distances(runs: Sequence[AuditedFile], evidence: EvidenceSource | None) -> Mapping[str, float]:
    """Run → metres along its recorded path, for runs that have one.

    A path has few points, and parts of it may be unknown: the robot drove at least as far.
    """
    if evidence is None or len(runs) > _PATHS:
        return {}
    anchors = {run.first: run.anchor for run in runs}
    results = evidence.details(anchors)
    ways = ((anchors[index], result.course.way) for index, result in results if result.course)
    return {anchor: _length(way) for anchor, way in ways if way is not None}


def _length(way: RobotPath) -> float:
    points = [*zip(way.x, way.y, strict=True)]
    starts = (*way.starts, len(points))
    return fsum(
        dist(one, other)
        for first, end in pairwise(starts)
        for one, other in pairwise(points[first:end])
    )


def interval(bad: int, undecided: int, total: int) -> str:
    """`22 % to 69 %`: the share of runs that fail, with 95 % confidence.

    An undecided run may have failed or not; the interval covers both.
    """
    low, high = lowest(bad, total, _SIDE), highest(min(total, bad + undecided), total, _SIDE)
    return f"{percent(low)} to {percent(high)}"


def percent(share: float) -> str:
    """A share with two digits: `0.37 %`, `22 %`."""
    return f"{100 * share:.2g} %" if share < 0.995 else "100 %"
