"""Timelines and histograms laid out: where each stroke goes, in units of a drawing 720 wide."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from fretc.report.model.phrases import decimal, whole
from fretc.report.model.pictures import (
    Flag,
    Histogram,
    Lane,
    Panel,
    Piece,
    Timeline,
    WordLane,
)
from fretc.report.pictures.histograms import step

WIDTH, _LEFT, _RIGHT = 720, 92, 30
_ROW, _BAR, _TOP, _AXIS = 22, 12, 6, 26
_WORDS = 36
"""Of a lane of words: its name, and the words."""
_FLAGS = 30
"""Room above the panels for the names of trigger and deadline."""
_HEAD, _HIGH = 18, 72
"""Of a panel: its name, and the signal."""
_TICKS = 8
"""Labels on the axis, about."""
_THINNEST = 1.5
_LETTER = 6
"""Width of a letter of a label, about."""

_Place = Callable[[float], float]
"""Where a number stands."""


@dataclass(frozen=True, slots=True)
class Bar:
    """A stretch of a lane."""

    x: float
    width: float


@dataclass(frozen=True, slots=True)
class DrawnLane:
    """A lane of a timeline."""

    name: str
    kind: str
    y: int
    bars: tuple[Bar, ...]


@dataclass(frozen=True, slots=True)
class DrawnWords:
    """A lane of words: each stretch with its word, which is empty where it is unknown."""

    name: str
    y: int
    bars: tuple[tuple[Bar, str, str], ...]
    """With the word, and as much of it as fits."""


@dataclass(frozen=True, slots=True)
class DrawnLevel:
    """A threshold: its line, and where its name stands."""

    y: float
    label: str
    label_y: float


@dataclass(frozen=True, slots=True)
class DrawnPanel:
    """A signal over the timeline: `bands` are outlines of envelopes, `lines` are lines."""

    name: str
    y: int
    top: int
    height: int
    lines: tuple[str, ...]
    bands: tuple[str, ...]
    levels: tuple[DrawnLevel, ...]
    unknown: tuple[Bar, ...]
    infinite: tuple[tuple[Bar, float, str], ...]
    marks: tuple[tuple[float, str], ...]
    """Places on its own axis with their labels."""


@dataclass(frozen=True, slots=True)
class DrawnFlag:
    """A named instant; `anchor` says on which side of it its name stands."""

    kind: str
    x: float
    y: int
    label: str
    anchor: str
    label_x: float


@dataclass(frozen=True, slots=True)
class Drawing:
    """A timeline laid out; `ticks` are places on the axis with their label in seconds."""

    id: str
    title: str
    text: str
    cause: str
    width: int
    height: int
    left: int
    right: int
    top: int
    axis: int
    row: int
    bar: int
    panels: tuple[DrawnPanel, ...]
    words: tuple[DrawnWords, ...]
    lanes: tuple[DrawnLane, ...]
    flags: tuple[DrawnFlag, ...]
    broken: Bar | None
    ticks: tuple[tuple[float, str], ...]


def drawing(timeline: Timeline, id: str) -> Drawing:
    """The layout of a timeline; the panels stand above the lanes, on the same axis."""
    scale = _Scale(timeline.start, timeline.end)
    top = (_FLAGS if timeline.flags else 0) + _TOP
    words_from = top + (_HEAD + _HIGH) * len(timeline.panels) + (10 if timeline.panels else 0)
    lanes_from = words_from + _WORDS * len(timeline.words)
    axis = lanes_from + _ROW * len(timeline.lanes)
    broken = timeline.broken if timeline.panels or timeline.words else None
    return Drawing(
        id=id,
        title=timeline.title,
        text=timeline.text,
        cause=timeline.cause,
        width=WIDTH,
        height=axis + _AXIS,
        left=_LEFT,
        right=WIDTH - _RIGHT,
        top=top,
        axis=axis,
        row=_ROW,
        bar=_BAR,
        panels=tuple(
            _panel(panel, top + (_HEAD + _HIGH) * i, scale)
            for i, panel in enumerate(timeline.panels)
        ),
        words=tuple(
            _words(lane, words_from + _WORDS * i, scale) for i, lane in enumerate(timeline.words)
        ),
        lanes=tuple(
            _lane(lane, lanes_from + _ROW * i, scale) for i, lane in enumerate(timeline.lanes)
        ),
        flags=tuple(_flags(timeline.flags, scale)),
        broken=scale.bar(broken.start, broken.end) if broken else None,
        ticks=tuple(
            (scale.x(place), decimal(place)) for place in places(timeline.start, timeline.end)
        ),
    )


@dataclass(frozen=True, slots=True)
class _Scale:
    """Seconds as places from left to right."""

    start: float
    end: float

    def x(self, seconds: float) -> float:
        inside = min(max(seconds, self.start), self.end)
        share = (inside - self.start) / (self.end - self.start)
        return round(_LEFT + share * (WIDTH - _LEFT - _RIGHT), 1)

    def bar(self, start: float, end: float) -> Bar:
        x = self.x(start)
        return Bar(x, round(max(_THINNEST, self.x(end) - x), 1))


def places(start: float, end: float, most: int = _TICKS) -> list[float]:
    """Round numbers from `start` to `end`, at most some two more than `most` of them."""
    width = step((end - start) / most)
    first = int(-(-start // width))
    found = [(first + i) * width for i in range(2 * most)]
    return [place for place in found if place <= end + width * 1e-6]


def _lane(lane: Lane, y: int, scale: _Scale) -> DrawnLane:
    bars = tuple(scale.bar(mark.start, mark.end) for mark in lane.marks)
    return DrawnLane(lane.name, lane.kind, y, bars)


def _words(lane: WordLane, y: int, scale: _Scale) -> DrawnWords:
    bars = tuple(
        (bar, word or "", _fitting(word or "unknown", bar.width))
        for start, end, word in lane.words
        for bar in [scale.bar(start, end)]
    )
    return DrawnWords(lane.signal, y, bars)


def _fitting(word: str, width: float) -> str:
    """As much of a word as fits into a bar; nothing, where that says nothing."""
    most = int((width - 6) / _LETTER)
    return word if len(word) <= most else f"{word[: most - 1]}…" if most > 3 else ""


def _flags(flags: Sequence[Flag], scale: _Scale) -> Iterator[DrawnFlag]:
    """Trigger above, deadline below it: their names never meet."""
    for row, flag in enumerate(flags):
        x = scale.x(flag.at)
        label = f"{flag.kind} {decimal(flag.at)} s"
        fits = x + 8 + _LETTER * len(label) < WIDTH - _RIGHT
        anchor = "start" if fits else "end"
        yield DrawnFlag(
            flag.kind, x, 4 + 14 * row, label, anchor, round(x + (8 if fits else -8), 1)
        )


# Signals ---------------------------------------------------------------------------------------


def _panel(panel: Panel, y: int, scale: _Scale) -> DrawnPanel:
    top = y + _HEAD
    rise = _HIGH / (panel.high - panel.low)

    def at(number: float) -> float:
        return round(top + _HIGH - (number - panel.low) * rise, 1)

    lines = tuple(_line(piece, scale, at) for piece in panel.pieces)
    return DrawnPanel(
        name=f"{panel.signal}{f' ({panel.unit})' if panel.unit else ''}",
        y=y + 12,
        top=top,
        height=_HIGH,
        lines=lines,
        bands=tuple(band for piece in panel.pieces for band in _bands(piece, scale, at)),
        levels=tuple(_level(level.label, at(level.value), top) for level in panel.levels),
        unknown=tuple(scale.bar(mark.start, mark.end) for mark in panel.unknown),
        infinite=tuple(
            (scale.bar(begin, end), top + 2 if sign == "+inf" else top + _HIGH - 2, sign)
            for begin, end, sign in panel.infinite
        ),
        marks=tuple((at(place), decimal(place)) for place in places(panel.low, panel.high, 4)),
    )


def _level(label: str, y: float, top: int) -> DrawnLevel:
    return DrawnLevel(y, label, y + 11 if y - top < 14 else y - 4)


def _line(piece: Piece, scale: _Scale, at: _Place) -> str:
    """A value is held up to the next one: a line of steps."""
    path: list[str] = []
    for seconds, least, greatest in piece.points:
        x, y = scale.x(seconds), at(greatest)
        path.append(f"H{x:g}V{y:g}" if path else f"M{x:g} {y:g}")
        if least != greatest:
            path.append(f"V{at(least):g}")
    return "".join([*path, f"H{scale.x(piece.end):g}"])


def _bands(piece: Piece, scale: _Scale, at: _Place) -> Iterator[str]:
    """Where several values fall together: a box from the least to the greatest."""
    ends = [*(point[0] for point in piece.points[1:]), piece.end]
    for (seconds, least, greatest), end in zip(piece.points, ends, strict=True):
        if least != greatest:
            x, after, high, low = scale.x(seconds), scale.x(end), at(greatest), at(least)
            yield f"M{x:g} {high:g}H{after:g}V{low:g}H{x:g}Z"


# Histograms ------------------------------------------------------------------------------------

_TALL, _BASE, _APART = 90, 116, 46
"""Room for the bars, their foot, and the width of one that stands apart."""


@dataclass(frozen=True, slots=True)
class Column:
    """One bar of a histogram, with its count above it; one that stands apart has a name below."""

    x: float
    y: float
    width: float
    height: float
    label: str
    kind: str
    name: str = ""


@dataclass(frozen=True, slots=True)
class DrawnHistogram:
    """A histogram laid out."""

    id: str
    title: str
    text: str
    width: int
    height: int
    left: int
    right: int
    base: int
    columns: tuple[Column, ...]
    ticks: tuple[tuple[float, str], ...]
    bound: float | None
    bound_label: str
    bound_anchor: str
    unit: str


def histogram(found: Histogram, id: str) -> DrawnHistogram:
    """The layout of a histogram; what has no value stands apart.

    Runs beyond the bound stand on the left of it, triggers without an answer on the right of all.
    """
    late = [
        (count, kind, name)
        for count, kind, name in (
            (found.unanswered, "unanswered", "none"),
            (found.open, "open", "open"),
        )
        if count
    ]
    left = 20 + (_APART if found.crossed else 0)
    right = WIDTH - 30 - _APART * len(late)
    low, high = found.bins[0].low, found.bins[-1].high
    most = max([*(each.count for each in found.bins), found.crossed, *(n for n, _, _ in late)])
    scale = (right - left) / (high - low)

    def x(number: float) -> float:
        return round(left + (number - low) * scale, 1)

    columns = [
        _column(x(each.low), x(each.high), each.count, most) for each in found.bins if each.count
    ]
    if found.crossed:
        columns.append(_column(4, _APART - 6, found.crossed, most, "crossed", "crossed"))
    columns += [
        _column(right + 14 + _APART * i, right + 6 + _APART * (i + 1), count, most, kind, name)
        for i, (count, kind, name) in enumerate(late)
    ]
    bound = None if found.bound is None else x(found.bound)
    return DrawnHistogram(
        id=id,
        title=found.title,
        text=found.text,
        width=WIDTH,
        height=_BASE + 34,
        left=left,
        right=right,
        base=_BASE,
        columns=tuple(columns),
        ticks=tuple((x(place), decimal(place)) for place in places(low, high)),
        bound=bound,
        bound_label=found.bound_label,
        bound_anchor="start" if bound is None or bound < WIDTH / 2 else "end",
        unit=found.unit,
    )


def _column(
    start: float, end: float, count: int, most: int, kind: str = "column", name: str = ""
) -> Column:
    height = round(max(_THINNEST, _TALL * count / most), 1)
    width = round(max(_THINNEST, end - start - 1), 1)
    return Column(start, round(_BASE - height, 1), width, height, whole(count), kind, name)
