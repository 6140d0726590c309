"""The layout of timelines and histograms, in units of a drawing 720 wide."""

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
"""Height of a lane of words."""
_FLAGS = 30
"""Room above the panels for the names of trigger and deadline."""
_HEAD, _HIGH = 18, 72
"""The heights of a panel: its name, and the signal."""
_TICKS = 8
"""Approximate number of labels on an axis."""
_THINNEST = 1.5
"""Minimum width of a bar, so that every event is visible."""
_LETTER = 6
"""Approximate width of a character of a label."""

_Place = Callable[[float], float]
"""Converts a number into a coordinate on an axis."""


@dataclass(frozen=True, slots=True)
class Bar:
    """An interval of a lane."""

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
    """A lane of words: intervals with their word, which is "" if unknown."""

    name: str
    y: int
    bars: tuple[tuple[Bar, str, str], ...]
    """(bar, word, label): the label is the word, shortened to fit."""


@dataclass(frozen=True, slots=True)
class DrawnLevel:
    """A threshold: the coordinates of its line and label."""

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
    """(coordinate, label) of the axis of the panel."""


@dataclass(frozen=True, slots=True)
class DrawnFlag:
    """An instant with its label; `anchor` is the side on which the label begins."""

    kind: str
    x: float
    y: int
    label: str
    anchor: str
    label_x: float


@dataclass(frozen=True, slots=True)
class Drawing:
    """The layout of a timeline; `ticks` are coordinates with labels in seconds."""

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
    """Converts seconds into x coordinates."""

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
    """About `most` round numbers from `start` to `end`."""
    width = step((end - start) / most)
    first = int(-(-start // width))
    numbers = [(first + i) * width for i in range(2 * most)]
    return [place for place in numbers if place <= end + width * 1e-6]


def _lane(lane: Lane, y: int, scale: _Scale) -> DrawnLane:
    bars = tuple(scale.bar(mark.start, mark.end) for mark in lane.marks)
    return DrawnLane(lane.name, lane.kind, y, bars)


def _words(lane: WordLane, y: int, scale: _Scale) -> DrawnWords:
    bars = tuple(
        (bar, word or "", fitting(word or "unknown", bar.width - 6))
        for start, end, word in lane.words
        for bar in [scale.bar(start, end)]
    )
    return DrawnWords(lane.signal, y, bars)


def fitting(word: str, width: float, letter: float = _LETTER) -> str:
    """The word, shortened to fit; "" if too little of it would remain."""
    most = int(width / letter)
    return word if len(word) <= most else f"{word[: most - 1]}…" if most > 3 else ""


def _flags(flags: Sequence[Flag], scale: _Scale) -> Iterator[DrawnFlag]:
    """Each flag has a row of its own, so that labels never overlap."""
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
    """The path of a step line."""
    path: list[str] = []
    for seconds, least, greatest in piece.points:
        x, y = scale.x(seconds), at(greatest)
        path.append(f"H{x:g}V{y:g}" if path else f"M{x:g} {y:g}")
        if least != greatest:
            path.append(f"V{at(least):g}")
    return "".join([*path, f"H{scale.x(piece.end):g}"])


def _bands(piece: Piece, scale: _Scale, at: _Place) -> Iterator[str]:
    """Boxes from the least to the greatest value, where several values share a coordinate."""
    ends = [*(point[0] for point in piece.points[1:]), piece.end]
    for (seconds, least, greatest), end in zip(piece.points, ends, strict=True):
        if least != greatest:
            x, after, high, low = scale.x(seconds), scale.x(end), at(greatest), at(least)
            yield f"M{x:g} {high:g}H{after:g}V{low:g}H{x:g}Z"


# Histograms ------------------------------------------------------------------------------------

_TALL, _BASE, _APART = 90, 116, 46
"""Height of the bars, their foot, and the width of a separate bar."""


@dataclass(frozen=True, slots=True)
class Column:
    """A bar of a histogram with its count; `name` is the label of a separate bar."""

    x: float
    y: float
    width: float
    height: float
    label: str
    kind: str
    name: str = ""


@dataclass(frozen=True, slots=True)
class DrawnHistogram:
    """The layout of a histogram."""

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


def histogram(content: Histogram, id: str) -> DrawnHistogram:
    """The layout of a histogram, with separate bars for runs and triggers without a value.

    Runs that crossed the bound are on the left, triggers without an answer on the right.
    """
    late = [
        (count, kind, name)
        for count, kind, name in (
            (content.unanswered, "unanswered", "none"),
            (content.open, "open", "open"),
        )
        if count
    ]
    left = 20 + (_APART if content.crossed else 0)
    right = WIDTH - 30 - _APART * len(late)
    low, high = content.bins[0].low, content.bins[-1].high
    most = max([*(bin_.count for bin_ in content.bins), content.crossed, *(n for n, _, _ in late)])
    scale = (right - left) / (high - low)

    def x(number: float) -> float:
        return round(left + (number - low) * scale, 1)

    columns = [
        _column(x(bin_.low), x(bin_.high), bin_.count, most) for bin_ in content.bins if bin_.count
    ]
    if content.crossed:
        columns.append(_column(4, _APART - 6, content.crossed, most, "crossed", "crossed"))
    columns += [
        _column(right + 14 + _APART * i, right + 6 + _APART * (i + 1), count, most, kind, name)
        for i, (count, kind, name) in enumerate(late)
    ]
    bound = None if content.bound is None else x(content.bound)
    return DrawnHistogram(
        id=id,
        title=content.title,
        text=content.text,
        width=WIDTH,
        height=_BASE + 34,
        left=left,
        right=right,
        base=_BASE,
        columns=tuple(columns),
        ticks=tuple((x(place), decimal(place)) for place in places(low, high)),
        bound=bound,
        bound_label=content.bound_label,
        bound_anchor="start" if bound is None or bound < WIDTH / 2 else "end",
        unit=content.unit,
    )


def _column(
    start: float, end: float, count: int, most: int, kind: str = "column", name: str = ""
) -> Column:
    height = round(max(_THINNEST, _TALL * count / most), 1)
    width = round(max(_THINNEST, end - start - 1), 1)
    return Column(start, round(_BASE - height, 1), width, height, whole(count), kind, name)
