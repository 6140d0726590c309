"""The layout of pictures of many runs, in units of a drawing 720 wide."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from math import floor, log10

from fretc.report.across.uses import percent
from fretc.report.model import phrases
from fretc.report.model.across import LaneMark, Lanes, PlaceMark, RunMap, Use, UseRow, Uses
from fretc.report.model.marks import Mark
from fretc.report.model.phrases import decimal
from fretc.report.pictures.plots import WIDTH, fitting, places

_LEFT, _RIGHT = 196, 24
_TOP, _AXIS, _ROW, _WORDS = 20, 26, 20, 15
_KINDS = {"violated": (1, 7), "unknown": (9, 4), "open": (14, 3)}
"""Kind of a mark → its offset in the lane, and its height."""
_THINNEST = 2.5
_LETTER = 5.8
_NAME = 27
"""Maximum number of characters of a name beside a lane."""
_SHARES = 470
"""The right end of the scale of shares; labels are to the right of it."""
_BEYOND = 1.5
"""The end of the scale of shares; larger shares are drawn at the end, with their number."""

_Place = Callable[[float], float]
"""Converts seconds into an x coordinate."""


@dataclass(frozen=True, slots=True)
class DrawnMark:
    """A mark of a lane with its link and its text."""

    kind: str
    x: float
    y: int
    width: float
    height: int
    link: str
    text: str


@dataclass(frozen=True, slots=True)
class DrawnWord:
    """An interval of a lane of words."""

    x: float
    width: float
    word: str
    label: str


@dataclass(frozen=True, slots=True)
class DrawnWords:
    """A lane of words."""

    name: str
    y: int
    words: tuple[DrawnWord, ...]


@dataclass(frozen=True, slots=True)
class DrawnRun:
    """The lane of a run; `name` is shortened to fit."""

    y: int
    name: str
    file: str
    mark: Mark
    link: str
    width: float
    marks: tuple[DrawnMark, ...]
    words: tuple[DrawnWords, ...]


@dataclass(frozen=True, slots=True)
class DrawnLanes:
    """The picture with one lane per run."""

    id: str
    title: str
    text: str
    width: int
    height: int
    left: int
    right: int
    top: int
    axis: int
    row: int
    is_calm: bool
    """Whether nothing was violated; such a picture is not printed."""
    runs: tuple[DrawnRun, ...]
    ticks: tuple[tuple[float, str], ...]


def drawn_lanes(content: Lanes, id: str, anchors: Collection[str]) -> DrawnLanes:
    """The layout of lanes.

    Args:
        content: the lanes.
        id: id of the picture.
        anchors: anchors on the page; other links lead to a section.
    """
    scale = (WIDTH - _LEFT - _RIGHT) / content.end

    def x(seconds: float) -> float:
        return round(_LEFT + min(max(seconds, 0.0), content.end) * scale, 1)

    names = [_short(run.label) for run in content.lanes]
    runs: list[DrawnRun] = []
    y = _TOP
    for run, name in zip(content.lanes, names, strict=True):
        words = tuple(
            DrawnWords(
                lane.signal,
                y + _ROW + _WORDS * row,
                tuple(
                    DrawnWord(
                        x(start), wide, word or "", fitting(word or "unknown", wide - 4, _LETTER)
                    )
                    for start, end, word in lane.words
                    for wide in [round(max(_THINNEST, x(end) - x(start)), 1)]
                ),
            )
            for row, lane in enumerate(run.words)
        )
        marks = tuple(_mark(mark, y, x, anchors) for mark in run.marks)
        link = run.anchor if run.anchor in anchors else "runs"
        runs.append(
            DrawnRun(
                y, name, run.file, run.mark, link, round(x(run.length) - _LEFT, 1), marks, words
            )
        )
        y += _ROW + _WORDS * len(words) + (4 if words else 0)
    return DrawnLanes(
        id=id,
        title=content.title,
        text=content.text,
        width=WIDTH,
        height=y + _AXIS,
        left=_LEFT,
        right=WIDTH - _RIGHT,
        top=_TOP,
        axis=y + 2,
        row=_ROW,
        is_calm=not any(m.kind == "violated" for run in content.lanes for m in run.marks),
        runs=tuple(runs),
        ticks=tuple((x(place), decimal(place)) for place in places(0.0, content.end)),
    )


def _mark(mark: LaneMark, y: int, x: _Place, anchors: Collection[str]) -> DrawnMark:
    below, height = _KINDS[mark.kind]
    start = min(x(mark.start), WIDTH - _RIGHT - _THINNEST)
    width = round(max(_THINNEST, x(mark.end) - start), 1)
    link = _link(mark, anchors)
    return DrawnMark(mark.kind, start, y + below, width, height, link, mark.text)


def _short(name: str) -> str:
    """The name, shortened at its beginning, because names often begin alike."""
    return name if len(name) <= _NAME else f"…{name[1 - _NAME :]}"


# Shares of bounds ------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Dot:
    """The share of one bound that a run used."""

    x: float
    letter: str
    is_crossed: bool
    text: str


@dataclass(frozen=True, slots=True)
class DrawnRow:
    """A run with its dots; the bar ends at the first one."""

    y: int
    name: str
    file: str
    mark: Mark
    link: str
    end: float
    is_crossed: bool
    dots: tuple[Dot, ...]
    label: str


@dataclass(frozen=True, slots=True)
class DrawnUses:
    """The ranking of runs."""

    id: str
    title: str
    text: str
    width: int
    height: int
    left: int
    right: int
    labels: int
    """The x coordinate of the labels of rows."""
    top: int
    axis: int
    row: int
    bound: float
    is_calm: bool
    """Whether no bound was crossed; such a picture is not printed."""
    rows: tuple[DrawnRow, ...]
    ticks: tuple[tuple[float, str], ...]


def drawn_uses(content: Uses, id: str, anchors: Collection[str]) -> DrawnUses:
    """The layout of a ranking; arguments as for `drawn_lanes`."""
    names = [_short(row.label) for row in content.rows]
    axis = _TOP + _ROW * len(content.rows) + 2
    return DrawnUses(
        id=id,
        title=content.title,
        text=content.text,
        width=WIDTH,
        height=axis + _AXIS,
        left=_LEFT,
        right=_SHARES,
        labels=_SHARES + 14,
        top=_TOP,
        axis=axis,
        row=_ROW,
        bound=_share(1.0),
        is_calm=not any(use.is_crossed for row in content.rows for use in row.uses),
        rows=tuple(
            _row(row, name, _TOP + _ROW * place, anchors)
            for place, (row, name) in enumerate(zip(content.rows, names, strict=True))
        ),
        ticks=tuple((_share(n / 4), f"{n * 25} %") for n in range(5)),
    )


def _share(share: float) -> float:
    part = min(max(share, 0.0), _BEYOND) / _BEYOND
    return round(_LEFT + part * (_SHARES - _LEFT), 1)


def _end(use: Use) -> float:
    """The end of a bar; a crossed bound always ends to the right of the bound."""
    if not use.is_crossed:
        return min(_share(use.share or 0.0), _share(1.0))
    return max(_share(_BEYOND if use.share is None else use.share), _share(1.0) + 7)


def _row(row: UseRow, name: str, y: int, anchors: Collection[str]) -> DrawnRow:
    dots = tuple(Dot(_end(use), use.measure, use.is_crossed, _words_of(use)) for use in row.uses)
    first, end = row.uses[0], dots[0].x
    return DrawnRow(
        y=y,
        name=name,
        file=row.file,
        mark=row.mark,
        link=row.anchor if row.anchor in anchors else row.section,
        end=end,
        is_crossed=first.is_crossed,
        dots=dots,
        label=fitting(first.text, (WIDTH - _SHARES - 14) * 1.05 - 4, _LETTER),
    )


def _words_of(use: Use) -> str:
    return f"{percent(use.share)}: {use.text}" if use.share is not None else use.text


# Maps ------------------------------------------------------------------------------------------

_MAP, _EDGE, _FOOT = 360, 14, 30
"""Width of a map, its margin, and the height of the scale bar."""
_TALLEST = 420
_BAR = 0.25
"""Maximum length of the scale bar, as a fraction of the width."""


@dataclass(frozen=True, slots=True)
class DrawnPlace:
    """A mark of violations, with its link."""

    x: float
    y: float
    link: str
    text: str
    label: str


@dataclass(frozen=True, slots=True)
class DrawnMap:
    """The map of a run, with equal scales on both axes."""

    id: str
    title: str
    text: str
    mark: Mark
    link: str
    is_calm: bool
    """Whether the run has no violation."""
    width: int
    height: int
    path: str
    start: tuple[float, float]
    end: tuple[float, float]
    places: tuple[DrawnPlace, ...]
    bar: float
    """The length of the scale bar."""
    bar_label: str


def drawn_map(content: RunMap, id: str, anchors: Collection[str]) -> DrawnMap:
    """The layout of a map; arguments as for `drawn_lanes`."""
    points = [point for line in content.lines for point in line]
    points += [(mark.x, mark.y) for mark in content.marks]
    xs, ys = zip(*points, strict=True)
    wide, high = max(max(xs) - min(xs), 1e-3), max(max(ys) - min(ys), 1e-3)
    if max(wide, high) < 1.0:
        wide = high = 1.0
    scale = min((_MAP - 2 * _EDGE) / wide, (_TALLEST - 2 * _EDGE) / high)
    middle = (min(xs) + max(xs)) / 2
    top = max(ys)

    def at(x: float, y: float) -> tuple[float, float]:
        right = _MAP / 2 + (x - middle) * scale
        return round(right, 1), round(_EDGE + (top - y) * scale, 1)

    height = round(2 * _EDGE + (top - min(ys)) * scale) + _FOOT
    metres = _round_below(_BAR * _MAP / scale)
    return DrawnMap(
        id=id,
        title=f"{content.label}, {content.file}",
        text=content.text,
        mark=content.mark,
        link=content.anchor if content.anchor in anchors else "runs",
        is_calm=not content.marks and not content.unplaced,
        width=_MAP,
        height=height,
        path="".join(_line(line, at) for line in content.lines),
        start=at(*content.lines[0][0]),
        end=at(*content.lines[-1][-1]),
        places=tuple(_places(content.marks, at, anchors)),
        bar=round(metres * scale, 1),
        bar_label=f"{metres:g} m",
    )


def _places(
    marks: Sequence[PlaceMark],
    at: Callable[[float, float], tuple[float, float]],
    anchors: Collection[str],
) -> Iterator[DrawnPlace]:
    """The marks of a map; a mark without room for its label only has a tooltip."""
    named: list[tuple[float, float]] = []
    for mark in marks:
        x, y = at(mark.x, mark.y)
        name = phrases.some(mark.requirements, 2)
        wide = 14 + _LETTER * len(name)
        fits = all(abs(x - a) > wide or abs(y - b) > 11 for a, b in named)
        if fits:
            named.append((x, y))
        yield DrawnPlace(x, y, _link(mark, anchors), mark.text, name if fits else "")


def _link(mark: PlaceMark | LaneMark, anchors: Collection[str]) -> str:
    """The link of a mark: to a picture, else to a result, else to a requirement."""
    links = [f"picture-{mark.anchor}.{mark.number}" if mark.number else "", mark.anchor]
    return next((link for link in links if link in anchors), mark.section)


def _line(
    line: Sequence[tuple[float, float]], at: Callable[[float, float], tuple[float, float]]
) -> str:
    places = list(dict.fromkeys(at(*point) for point in line)) if len(line) == 2 else []
    places = places or [at(*point) for point in line]
    first, *others = places
    rest = "".join(f"L{x:g} {y:g}" for x, y in others) or "h0"
    return f"M{first[0]:g} {first[1]:g}{rest}"


def _round_below(length: float) -> float:
    """1, 2 or 5 times a power of ten, not above `length`."""
    power = 10.0 ** floor(log10(length))
    return next(power * n for n in (5, 2, 1) if power * n <= length * (1 + 1e-9))
