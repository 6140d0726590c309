"""The map of a run: the path of the robot, and where each violation began."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from math import dist

from fretc.audit.evidence.schema import Result, RobotPath
from fretc.report.model import phrases
from fretc.report.model.pictures import PlaceMark, RunMap
from fretc.report.model.results import ResultRow
from fretish.classes.frozen import dataclass

MOST_MAPS = 8
_NEAR = 0.02
"""Violations nearer than this fraction of the map are merged into one mark."""
_NAMED = 3


@dataclass(frozen=True, slots=True)
class MapResult:
    """A result of a run with a path, and its names."""

    of: ResultRow
    result: Result | None
    """None if the result was not read, because it has no violation."""


def run_map(way: RobotPath, results: Sequence[MapResult]) -> RunMap | None:
    """The map of a run; None if the path has no point.

    Args:
        way: the path of the robot.
        results: all results of the run.
    """
    lines = tuple(
        tuple(zip(map(float, way.x[first:end]), map(float, way.y[first:end]), strict=True))
        for first, end in pairwise((*way.starts, len(way.times_ns)))
    )
    points = [point for line in lines for point in line]
    if not points:
        return None
    placed = [mark for result in results for mark in _marks(result, way)]
    total = sum(result.of.count[0] for result in results)
    marks = tuple(_worded(mark) for mark in _merged(placed, _NEAR * extent(points)))
    first = results[0].of
    worst = min((result.of.mark for result in results), key=lambda mark: mark.severity)
    unplaced = total - len(placed)
    text = _text(lines, way, total, unplaced)
    return RunMap(first.run, first.run_label, first.run_file, worst, lines, marks, unplaced, text)


def extent(points: Iterable[tuple[float, float]]) -> float:
    """The longer side of the bounding box of some points, at least one metre."""
    xs, ys = zip(*points, strict=True)
    return float(max(max(xs) - min(xs), max(ys) - min(ys), 1.0))


def _marks(one: MapResult, way: RobotPath) -> Iterable[PlaceMark]:
    if one.result is None or not one.result.violations:
        return
    from fretc.audit.evidence.run_plot_data import position_at

    for number, violation in enumerate(one.result.violations, 1):
        at = position_at(way, violation.start_ns)
        if at is not None:
            yield PlaceMark(
                *at,
                count=1,
                requirements=(one.of.requirement,),
                anchor=one.of.anchor,
                section=one.of.section,
                number=number,
                text=phrases.seconds(violation.start_s),
            )


def _merged(marks: Iterable[PlaceMark], near: float) -> list[PlaceMark]:
    """Merge nearby marks; a merged mark is at the position of the first one."""
    merged: list[PlaceMark] = []
    for mark in marks:
        near_by = (n for n, m in enumerate(merged) if dist((m.x, m.y), (mark.x, mark.y)) < near)
        found = next(near_by, None)
        if found is None:
            merged.append(mark)
            continue
        before = merged[found]
        names = tuple(dict.fromkeys((*before.requirements, *mark.requirements)))
        merged[found] = replace(before, count=before.count + 1, requirements=names)
    return merged


def _worded(mark: PlaceMark) -> PlaceMark:
    names = phrases.some(mark.requirements, _NAMED)
    what = "violated" if mark.count == 1 else f"{phrases.whole(mark.count)} violations"
    since = "at" if mark.count == 1 else "the first at"
    text = f"{names}: {what}, {since} {mark.text}"
    return replace(mark, x=round(mark.x, 3), y=round(mark.y, 3), text=text)


def _text(
    lines: Sequence[Sequence[tuple[float, float]]], way: RobotPath, violations: int, unplaced: int
) -> str:
    (x, y), (u, v) = lines[0][0], lines[-1][-1]
    parts = [
        f"The path of the robot from ({x:g}, {y:g}) to ({u:g}, {v:g}) in metres, drawn to "
        f"within {phrases.value(float(way.error), 'm')}.",
        f"It has {phrases.times(len(lines), 'part')}: between them the position is unknown."
        if len(lines) > 1
        else "",
        f"{phrases.times(way.lines_left_out, 'short part')} left out."
        if way.lines_left_out
        else "",
        f"{phrases.times(violations, 'violation')}, marked where "
        f"{'it' if violations == 1 else 'each'} began."
        if violations and not unplaced
        else "",
        f"{phrases.times(violations, 'violation')}, of which {phrases.whole(unplaced)} began "
        "where the position is unknown, and have no mark."
        if unplaced
        else "",
        "No violation." if not violations else "",
    ]
    return " ".join(filter(None, parts))
