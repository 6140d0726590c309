"""A timeline with one lane per run: violations, unknown and open intervals, signals of words.

Each interval of the evidence is in exactly one mark, unless its run has no lane. Runs without a
lane are counted; none of them is worse than a run with a lane.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from math import inf
from types import MappingProxyType

from fretc.report.across.stretches import Stretches
from fretc.report.model import phrases
from fretc.report.model.marks import Mark
from fretc.report.model.pictures import LaneMark, Lanes, RunLane, WordLane
from fretc.report.model.results import ResultRow
from fretish.classes.frozen import dataclass

NO_COURSES: Mapping[str, int] = MappingProxyType({})
MOST_LANES = 40
"""Maximum number of lanes of the picture of all requirements."""
_DETAIL, _COARSEST = 240, 4
"""Marks nearer than 1/240 of the picture are merged; down to 1/4 if there are too many."""
_MOST_MARKS = 1_200
"""Maximum number of marks per picture; exceeded only if there are more runs than that."""
_NAMED = 3
"""Maximum number of runs that the text names."""


_NO_COUNT = (0, 0, 0)
Known = tuple[Stretches, tuple[WordLane, ...]]
"""The intervals of a result, and the signals of words of its run."""


@dataclass(frozen=True, slots=True)
class RunTally:
    """The worst verdict and the counts of a run."""

    mark: Mark
    count: tuple[int, int, int]

    def with_one(self, mark: Mark, count: tuple[int, int, int]) -> RunTally:
        """The tally with one more result."""
        if mark is self.mark and count == _NO_COUNT:  # so are most results
            return self
        worst = mark if mark.severity < self.mark.severity else self.mark
        a, b, c = self.count
        return RunTally(worst, (a + count[0], b + count[1], c + count[2]))


def worst_runs(tallies: Mapping[str, RunTally], most: int = MOST_LANES) -> Sequence[str]:
    """The runs that get a lane: all in their order, or the worst if there are too many."""
    if len(tallies) <= most:
        return [*tallies]
    return sorted(tallies, key=lambda run: worst_first(tallies[run]))[:most]


@dataclass(frozen=True, slots=True)
class _Lane:
    """A lane without its marks."""

    results: tuple[ResultRow, ...]
    course: int | None = None
    """Index of the result with the signals of words; None if these are not shown."""
    known: Mapping[int, Known] = field(default_factory=dict)
    """Index of a result → its data, for results that were read."""
    requirement: str = ""
    """The requirement of a lane of one requirement; "" if the lane is of a run."""
    is_damaged: bool = False

    @property
    def first(self) -> ResultRow:
        return self.results[0]

    @property
    def name(self) -> str:
        return self.requirement or f"{self.first.run_label} ({self.first.run_file})"

    @property
    def mark(self) -> Mark:
        """The worst verdict of the results."""
        return min((result.mark for result in self.results), key=lambda mark: mark.severity)

    @property
    def length(self) -> float:
        return max((end for known, _ in self.known.values() for end in _ends(known)), default=0.0)

    @property
    def places(self) -> Iterator[int]:
        """Indices of the results to read: those with marks or words, and one with ticks."""
        judged = [result for result in self.results if result.ticks]
        yield from (result.place for result in (*judged[:1], *with_marks(self.results)))
        if self.course is not None:
            yield self.course

    @property
    def words(self) -> tuple[WordLane, ...]:
        return self.known[self.course][1] if self.course is not None else ()

    @property
    def count(self) -> tuple[int, int, int]:
        """Numbers of violations, unknown intervals and open obligations."""
        violations, unknown, waiting = zip(*(result.count for result in self.results), strict=True)
        return sum(violations), sum(unknown), sum(waiting)


def _ends(stretches: Stretches) -> Iterable[float]:
    yield stretches.length
    yield from (end for _, end in (*stretches.violations, *stretches.unknown))
    yield from stretches.open


@dataclass(frozen=True, slots=True)
class LanePlan:
    """The runs that get a lane, before their data is read."""

    title: str
    chosen: tuple[_Lane, ...]
    left: tuple[RunTally | _Lane, ...]
    marks: int
    """Approximate maximum number of marks."""
    note: str
    """A further sentence about runs without a lane."""

    @property
    def places(self) -> Iterator[int]:
        """Indices of the results to read."""
        return (place for lane in self.chosen for place in lane.places)

    def lanes(self, known: Mapping[int, Known]) -> Lanes | None:
        """The lanes; None if no run has a duration.

        Args:
            known: index of a result → its data.
        """
        chosen = [replace(e, known={at: known[at] for at in e.places}) for e in self.chosen]
        end = max((lane.length for lane in chosen), default=0.0)
        if not end:
            return None
        drawn = _drawn(chosen, end, self.marks)
        others = " ".join(filter(None, [left_out(self.left, "no lane"), self.note]))
        text = " ".join(filter(None, [_in_words(chosen), others]))
        return Lanes(self.title, max(round(end, 6), 1e-6), drawn, others, text)


def plan(
    title: str,
    results: Iterable[ResultRow],
    most: int = MOST_LANES,
    marks: int = _MOST_MARKS,
    note: str = "",
    left: Sequence[RunTally] = (),
    courses: Mapping[str, int] = NO_COURSES,
    *,
    ranked: bool = False,
    damaged: Collection[str] = (),
    by_requirement: bool = False,
) -> LanePlan:
    """Choose the runs that have a lane: all, or the worst.

    Args:
        title: title of the picture.
        results: results in the order of their runs.
        most: maximum number of lanes.
        marks: approximate maximum number of marks.
        note: a further sentence about runs without a lane.
        left: runs that get no lane; none of them is worse than the others.
        courses: run → index of the result with its signals of words.
        ranked: whether to sort by verdict even if all runs get a lane.
        damaged: the runs whose logs may have lost messages.
        by_requirement: whether each requirement has a lane, because there is one run.
    """
    grouped: dict[tuple[str, str], list[ResultRow]] = {}
    for result in results:
        requirement = result.requirement if by_requirement else ""
        grouped.setdefault((result.run, requirement), []).append(result)
    every = [
        _Lane(
            tuple(of),
            None if number and by_requirement else courses.get(run),
            requirement=requirement,
            is_damaged=run in damaged,
        )
        for number, ((run, requirement), of) in enumerate(grouped.items())
    ]
    sort = ranked or len(every) > most
    ordered = sorted(every, key=worst_first) if sort else every
    return LanePlan(title, tuple(ordered[:most]), (*ordered[most:], *left), marks, note)


def with_marks(results: Sequence[ResultRow]) -> list[ResultRow]:
    """The results that have marks."""
    return [result for result in results if any(result.count)]


def worst_first(lane: RunTally | _Lane) -> tuple[tuple[int, bool], tuple[int, ...]]:
    """Sort key of runs, worst first."""
    return lane.mark.severity, tuple(-count for count in lane.count)


def _drawn(chosen: Sequence[_Lane], end: float, most: int) -> tuple[RunLane, ...]:
    """The lanes, with marks merged until there are at most `most`."""
    detail = _DETAIL
    while True:
        drawn = tuple(_lane(lane, end / detail) for lane in chosen)
        if detail <= _COARSEST or sum(len(lane.marks) for lane in drawn) <= most:
            return drawn
        detail //= 2


def _lane(lane: _Lane, nearest: float) -> RunLane:
    of = sorted(
        (
            mark
            for result in with_marks(lane.results)
            for mark in _marks(result, lane.known[result.place][0])
        ),
        key=lambda mark: (mark.start, mark.end),
    )
    kinds = ("violated", "unknown", "open")
    merged = [
        _worded(mark)
        for kind in kinds
        for mark in _merged([mark for mark in of if mark.kind == kind], nearest)
    ]
    first = lane.first
    return RunLane(
        first.anchor if lane.requirement else first.run,
        lane.requirement or first.run_label,
        first.run_file,
        lane.mark,
        lane.length,
        tuple(merged),
        lane.words,
        lane.is_damaged,
    )


def _marks(each: ResultRow, stretches: Stretches) -> Iterable[LaneMark]:
    def mark(kind: str, start: float, end: float, number: int = 0) -> LaneMark:
        of = ((each.requirement,), each.anchor, each.section)
        return LaneMark(kind, start, end, 1, *of, number, "")

    for number, (start, end) in enumerate(stretches.violations, 1):
        yield mark("violated", start, end, number)
    for start, end in stretches.unknown:
        yield mark("unknown", start, end)
    for start in stretches.open:
        yield mark("open", start, max(start, stretches.length))


def _merged(marks: Sequence[LaneMark], nearest: float) -> list[LaneMark]:
    """Sorted marks; overlapping or nearby marks are merged."""
    merged: list[LaneMark] = []
    last_end = -inf
    for mark in marks:
        if merged and mark.start - last_end < nearest:
            last_end = max(last_end, mark.end)
            before = merged[-1]
            merged[-1] = replace(
                before,
                end=last_end,
                count=before.count + 1,
                requirements=tuple(dict.fromkeys((*before.requirements, *mark.requirements))),
            )
        else:
            merged.append(mark)
            last_end = mark.end
    return merged


_WORDS = {
    "violated": ("violated", "violations"),
    "unknown": ("unknown", "unknown stretches"),
    "open": ("open", "open demands"),
}


def _worded(mark: LaneMark) -> LaneMark:
    one, many = _WORDS[mark.kind]
    named = phrases.some(mark.requirements, _NAMED)
    what = one if mark.count == 1 else f"{phrases.whole(mark.count)} {many}"
    when = f"{phrases.seconds(mark.start)} to {phrases.seconds(mark.end)}"
    return replace(
        mark, start=round(mark.start, 6), end=round(mark.end, 6), text=f"{named}: {what}, {when}"
    )


def left_out(left: Sequence[RunTally | _Lane], what: str) -> str:
    """A sentence with the number of runs without a lane or map, and their worst verdict."""
    if not left:
        return ""
    worst = min((lane.mark for lane in left), key=lambda mark: mark.severity)
    counted = _counted(left)
    verb = "has" if len(left) == 1 else "have"
    return (
        f"{phrases.times(len(left), 'run')} {verb} {what}; none of them is worse than the "
        f"runs shown: the worst is {worst.text}{f', with {counted}' if counted else ''}."
    )


def _counted(lanes: Sequence[RunTally | _Lane]) -> str:
    violations, unknown, waiting = (
        sum(each) for each in zip(*(x.count for x in lanes), strict=True)
    )
    parts = [
        phrases.times(violations, "violation") if violations else "",
        phrases.times(unknown, "unknown stretch", "unknown stretches") if unknown else "",
        phrases.times(waiting, "open demand") if waiting else "",
    ]
    return phrases.joined(list(filter(None, parts)))


def _in_words(lanes: Sequence[_Lane]) -> str:
    """A sentence with the counts of the worst runs and the number of other runs."""
    bad = sorted((lane for lane in lanes if any(lane.count)), key=worst_first)
    named = [f"{lane.name}: {_counted([lane])}" for lane in bad[:_NAMED]]
    rest = _counted(bad[_NAMED:]) if len(bad) > _NAMED else ""
    thing = "requirement" if any(lane.requirement for lane in lanes) else "run"
    more = f"{phrases.times(len(bad) - _NAMED, f'more {thing}')}: {rest}" if rest else ""
    calm = len(lanes) - len(bad)
    parts = [*named, *([more] if more else [])]
    none = f"{phrases.times(calm, thing)} without such a tick" if calm else ""
    return f"{'; '.join([*parts, *([none] if none else [])])}."
