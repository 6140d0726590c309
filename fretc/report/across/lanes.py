"""A timeline with a lane a run: violations, unknown stretches, open demands, and words.

Each stretch of the evidence is in exactly one mark of its run, unless its run has no lane; runs
without a lane are counted, and none of them is worse than one with a lane.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from types import MappingProxyType

from fretc.audit.evidence.result_summaries import Stretches
from fretc.report.model import phrases
from fretc.report.model.across import LaneMark, Lanes, RunLane
from fretc.report.model.marks import Mark
from fretc.report.model.pictures import WordLane

NO_COURSES: Mapping[str, int] = MappingProxyType({})
MOST_LANES = 40
"""Of the picture of all requirements."""
_DETAIL, _COARSEST = 240, 4
"""Marks nearer than this fraction of the picture are one; fewer where there are too many."""
_MOST_MARKS = 1_200
"""Of one picture, unless so many runs have one each."""
_NAMED = 3
"""The most runs that the text names."""


Known = tuple[Stretches, tuple[WordLane, ...]]
"""What there is to see of a result: its stretches, and the signals of words of its run."""


@dataclass(frozen=True, slots=True)
class RunStretches:
    """One requirement in one run."""

    run: str
    """The anchor of the run."""
    label: str
    file: str
    requirement: str
    section: str
    """The anchor of the requirement."""
    anchor: str
    """That of the result."""
    mark: Mark
    place: int
    """Of the result in the evidence."""
    is_judged: bool
    """Whether it has ticks: then it tells how long the run is."""
    count: tuple[int, int, int]
    """Violations, unknown stretches and open demands."""


@dataclass(frozen=True, slots=True)
class Tally:
    """A run before its results are looked at: the worst verdict, and what is counted."""

    mark: Mark
    count: tuple[int, int, int]

    def with_one(self, mark: Mark, count: tuple[int, int, int]) -> Tally:
        """The same with one more result."""
        worst = min(self.mark, mark, key=lambda each: each.severity)
        a, b, c = self.count
        return Tally(worst, (a + count[0], b + count[1], c + count[2]))


def worst_runs(tallies: Mapping[str, Tally], most: int = MOST_LANES) -> Sequence[str]:
    """The runs that have a lane, the worst where they are too many; else all, in their order."""
    if len(tallies) <= most:
        return [*tallies]
    return sorted(tallies, key=lambda run: worst_first(tallies[run]))[:most]


@dataclass(frozen=True, slots=True)
class _Lane:
    """A run before its marks are made."""

    results: tuple[RunStretches, ...]
    course: int | None = None
    """The place of the result that has the signals of words; None: they are not to be shown."""
    known: Mapping[int, Known] = field(default_factory=dict)
    """Of those results that are read, by their places."""

    @property
    def first(self) -> RunStretches:
        return self.results[0]

    @property
    def mark(self) -> Mark:
        """The worst of its results."""
        return min((each.mark for each in self.results), key=lambda mark: mark.severity)

    @property
    def length(self) -> float:
        return max((end for known, _ in self.known.values() for end in _ends(known)), default=0.0)

    @property
    def places(self) -> Iterator[int]:
        """The results to read: those with something to mark or words, and one that was judged."""
        judged = [each for each in self.results if each.is_judged]
        yield from (each.place for each in (*judged[:1], *with_marks(self.results)))
        if self.course is not None:
            yield self.course

    @property
    def words(self) -> tuple[WordLane, ...]:
        return self.known[self.course][1] if self.course is not None else ()

    @property
    def count(self) -> tuple[int, int, int]:
        """Violations, unknown stretches and open demands."""
        violations, unknown, waiting = zip(*(each.count for each in self.results), strict=True)
        return sum(violations), sum(unknown), sum(waiting)


def _ends(stretches: Stretches) -> Iterable[float]:
    yield stretches.length
    yield from (end for _, end in (*stretches.violations, *stretches.unknown))
    yield from stretches.open


@dataclass(frozen=True, slots=True)
class LanePlan:
    """Which runs have a lane, before it is read what there is to see of them."""

    title: str
    chosen: tuple[_Lane, ...]
    left: tuple[Tally | _Lane, ...]
    marks: int
    """About how many marks there may be."""
    note: str
    """What else to say of runs without a lane."""

    @property
    def places(self) -> Iterator[int]:
        """The results to read."""
        return (place for lane in self.chosen for place in lane.places)

    def lanes(self, known: Mapping[int, Known]) -> Lanes | None:
        """The lanes; None where there is no time to show.

        Args:
            known: what there is to see of these results, by their places.
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
    results: Iterable[RunStretches],
    most: int = MOST_LANES,
    marks: int = _MOST_MARKS,
    note: str = "",
    left: Sequence[Tally] = (),
    courses: Mapping[str, int] = NO_COURSES,
    *,
    ranked: bool = False,
) -> LanePlan:
    """Choose the runs that have a lane: all, or the worst.

    Args:
        title: of the picture.
        results: in the order of their runs.
        most: lanes.
        marks: about how many marks there may be.
        note: what else to say of runs without a lane.
        left: runs that have no lane in any case, none of them worse than the others.
        courses: run → place of the result that has its signals of words.
        ranked: whether the worst come first, though they are few.
    """
    grouped: dict[str, list[RunStretches]] = {}
    for each in results:
        grouped.setdefault(each.run, []).append(each)
    every = [_Lane(tuple(of), courses.get(run)) for run, of in grouped.items()]
    sort = ranked or len(every) > most
    ordered = sorted(every, key=worst_first) if sort else every
    return LanePlan(title, tuple(ordered[:most]), (*ordered[most:], *left), marks, note)


def with_marks(results: Sequence[RunStretches]) -> list[RunStretches]:
    """Those that have something to mark."""
    return [each for each in results if any(each.count)]


def worst_first(lane: Tally | _Lane) -> tuple[tuple[int, bool], tuple[int, ...]]:
    """The key that sorts runs."""
    return lane.mark.severity, tuple(-count for count in lane.count)


def _drawn(chosen: Sequence[_Lane], end: float, most: int) -> tuple[RunLane, ...]:
    """The lanes, as coarse as it takes to have few marks."""
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
            for each in with_marks(lane.results)
            for mark in _marks(each, lane.known[each.place][0])
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
        first.run, first.label, first.file, lane.mark, lane.length, tuple(merged), lane.words
    )


def _marks(each: RunStretches, stretches: Stretches) -> Iterable[LaneMark]:
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
    """Marks in their order; those that overlap, or nearly, are one."""
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


def left_out(left: Sequence[Tally | _Lane], what: str) -> str:
    """How many runs have no lane or no map, and the worst verdict among them."""
    if not left:
        return ""
    worst = min((lane.mark for lane in left), key=lambda mark: mark.severity)
    counted = _counted(left)
    verb = "has" if len(left) == 1 else "have"
    return (
        f"{phrases.times(len(left), 'run')} {verb} {what}, and none is worse than those with one: "
        f"the worst is {worst.text}{f', with {counted}' if counted else ''}."
    )


def _counted(lanes: Sequence[Tally | _Lane]) -> str:
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
    """Each of the worst runs with what it has, the others by their number."""
    bad = sorted((lane for lane in lanes if any(lane.count)), key=worst_first)
    named = [f"{lane.first.label} ({lane.first.file}): {_counted([lane])}" for lane in bad[:_NAMED]]
    rest = _counted(bad[_NAMED:]) if len(bad) > _NAMED else ""
    more = f"{phrases.times(len(bad) - _NAMED, 'more run')}: {rest}" if rest else ""
    calm = len(lanes) - len(bad)
    parts = [*named, *([more] if more else [])]
    none = f"{phrases.times(calm, 'run')}: none of it" if calm else ""
    return f"{'; '.join([*parts, *([none] if none else [])])}."
