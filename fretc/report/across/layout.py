"""The layout of pictures of many runs, as values for their templates.

Coordinates are in units of a drawing 720 wide.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from math import dist, floor, log10
from typing import Any

from fretc.report.across.uses import percent
from fretc.report.model import phrases
from fretc.report.model.pictures import LaneMark, Lanes, PlaceMark, RunMap, Use, UseRow, Uses
from fretc.report.pictures.scales import WIDTH, Scale, fitting, frame, words

_LEFT, _RIGHT = 196, WIDTH - 24
_TOP, _AXIS, _ROW, _WORDS = 20, 26, 20, 15
_KINDS = {"violated": (1, 7), "unknown": (9, 4), "open": (14, 3)}
"""Kind of a mark → its offset in the lane, and its height."""
_LETTER = 5.8
_NAME = 27
"""Maximum number of characters of a name beside a lane."""


def drawn_lanes(content: Lanes, id: str, anchors: Collection[str]) -> dict[str, Any]:
    """The layout of lanes; a picture without a violation is calm, and is not printed.

    Args:
        content: the lanes.
        id: id of the picture.
        anchors: anchors on the page; other links lead to a section.
    """
    x = Scale(0.0, content.end, _LEFT, _RIGHT, thinnest=2.5)
    runs: list[dict[str, Any]] = []
    y = _TOP
    for run in content.lanes:
        runs.append(
            {
                "y": y,
                "name": _short(run.label),
                "file": run.file,
                "mark": run.mark,
                "link": run.anchor if run.anchor in anchors else "runs",
                "width": round(x(run.length) - _LEFT, 1),
                "torn": f"M{x(run.length):g} {y}l3 4l-6 4l6 4l-3 4" if run.is_damaged else "",
                "marks": [_mark(mark, y, x, anchors) for mark in run.marks],
                "words": [
                    words(lane, y + _ROW + _WORDS * i, x, 4, _LETTER)
                    for i, lane in enumerate(run.words)
                ],
            }
        )
        y += _ROW + _WORDS * len(run.words) + (4 if run.words else 0)
    return frame(
        id,
        content.title,
        content.text,
        x,
        y + _AXIS,
        top=_TOP,
        axis=y + 2,
        row=_ROW,
        is_calm=not any(m.kind == "violated" for run in content.lanes for m in run.marks),
        runs=runs,
    )


def _mark(mark: LaneMark, y: int, x: Scale, anchors: Collection[str]) -> dict[str, Any]:
    below, height = _KINDS[mark.kind]
    bar = x.bar_inside(mark.start, mark.end)
    place = {"kind": mark.kind, "bar": bar, "y": y + below, "height": height}
    return {**place, "link": _link(mark, anchors), "text": mark.text}


def _short(name: str) -> str:
    """The name, shortened at its beginning, because names often begin alike."""
    return name if len(name) <= _NAME else f"…{name[1 - _NAME :]}"


# Shares of bounds ------------------------------------------------------------------------------

_SHARES = 470
"""The right end of the scale of shares; labels are to the right of it."""
_BEYOND = 1.5
"""The end of the scale of shares; larger shares are drawn at the end, with their number."""
_SHARE = Scale(0.0, _BEYOND, _LEFT, _SHARES)


def drawn_uses(content: Uses, id: str, anchors: Collection[str]) -> dict[str, Any]:
    """The layout of a ranking; arguments as for `drawn_lanes`.

    A picture without a crossed bound is calm, and is not printed.
    """
    axis = _TOP + _ROW * len(content.rows) + 2
    return frame(
        id,
        content.title,
        content.text,
        _SHARE,
        axis + _AXIS,
        labels=_SHARES + 14,
        top=_TOP,
        axis=axis,
        bound=_SHARE(1.0),
        is_calm=not any(use.is_crossed for row in content.rows for use in row.uses),
        rows=[_row(row, _TOP + _ROW * i, anchors) for i, row in enumerate(content.rows)],
        ticks=[(_SHARE(n / 4), f"{n * 25} %") for n in range(5)],
    )


def _end(use: Use) -> float:
    """The end of a bar; a crossed bound always ends to the right of the bound."""
    if not use.is_crossed:
        return min(_SHARE(use.share or 0.0), _SHARE(1.0))
    return max(_SHARE(_BEYOND if use.share is None else use.share), _SHARE(1.0) + 7)


def _row(row: UseRow, y: int, anchors: Collection[str]) -> dict[str, Any]:
    """A run with its dots; the bar ends at the first one."""
    first = row.uses[0]
    return {
        "y": y,
        "name": _short(row.label),
        "file": row.file,
        "mark": row.mark,
        "link": row.anchor if row.anchor in anchors else row.section,
        "end": _end(first),
        "is_crossed": first.is_crossed,
        "dots": [
            {
                "x": _end(use),
                "letter": use.measure,
                "is_crossed": use.is_crossed,
                "text": use.text if use.share is None else f"{percent(use.share)}: {use.text}",
            }
            for use in row.uses
        ],
        "label": fitting(first.text, (WIDTH - _SHARES - 14) * 1.05 - 4, _LETTER),
    }


# Maps ------------------------------------------------------------------------------------------

_MAP, _EDGE, _FOOT = 360, 14, 30
"""Width of a map, its margin, and the height of the scale bar."""
_TALLEST = 420
_BAR = 0.25
"""Maximum length of the scale bar, as a fraction of the width."""

_FINE = 1.2
"""Minimum distance of the points of a path, in units of the drawing."""
_Place = Callable[[float, float], tuple[float, float]]
"""Converts a position in metres into coordinates."""


def drawn_map(content: RunMap, id: str, anchors: Collection[str]) -> dict[str, Any]:
    """The layout of a map, with equal scales on both axes; arguments as for `drawn_lanes`.

    The map of a run without a violation is calm.
    """
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

    metres = _round_below(_BAR * _MAP / scale)
    return {
        "id": id,
        "title": f"{content.label}, {content.file}",
        "text": content.text,
        "mark": content.mark,
        "link": content.anchor if content.anchor in anchors else "runs",
        "is_calm": not content.marks and not content.unplaced,
        "width": _MAP,
        "height": round(2 * _EDGE + (top - min(ys)) * scale) + _FOOT,
        "path": "".join(_line(line, at) for line in content.lines),
        "start": at(*content.lines[0][0]),
        "end": at(*content.lines[-1][-1]),
        "places": [*_places(content.marks, at, anchors)],
        "bar": round(metres * scale, 1),
        "bar_label": f"{metres:g} m",
    }


def _places(
    marks: Sequence[PlaceMark], at: _Place, anchors: Collection[str]
) -> Iterator[dict[str, Any]]:
    """The marks of a map; a mark without room for its label only has a tooltip."""
    named: list[tuple[float, float]] = []
    for mark in marks:
        x, y = at(mark.x, mark.y)
        name = phrases.some(mark.requirements, 2)
        wide = 14 + _LETTER * len(name)
        fits = all(abs(x - a) > wide or abs(y - b) > 11 for a, b in named)
        if fits:
            named.append((x, y))
        link, label = _link(mark, anchors), name if fits else ""
        yield {"x": x, "y": y, "link": link, "text": mark.text, "label": label}


def _link(mark: PlaceMark | LaneMark, anchors: Collection[str]) -> str:
    """The link of a mark: to a picture, else to a result, else to a requirement."""
    links = [f"picture-{mark.anchor}.{mark.number}" if mark.number else "", mark.anchor]
    return next((link for link in links if link in anchors), mark.section)


def _line(line: Sequence[tuple[float, float]], at: _Place) -> str:
    """The path of a line, without points nearer than `_FINE` to the one before."""
    places = [at(*point) for point in line]
    first, *others = places
    kept, last = [first], len(others)
    for number, place in enumerate(others, 1):
        if dist(place, kept[-1]) >= _FINE or (number == last and place != kept[-1]):
            kept.append(place)
    rest = "L" + " ".join(f"{x:g} {y:g}" for x, y in kept[1:]) if len(kept) > 1 else "h0"
    return f"M{first[0]:g} {first[1]:g}{rest}"


def _round_below(length: float) -> float:
    """1, 2 or 5 times a power of ten, not above `length`."""
    power = 10.0 ** floor(log10(length))
    return next(power * n for n in (5, 2, 1) if power * n <= length * (1 + 1e-9))
