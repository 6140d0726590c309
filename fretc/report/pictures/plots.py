"""The layout of timelines, histograms and probabilities, as values for their templates.

Coordinates are in units of a drawing 720 wide.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fretc.report.model.phrases import decimal, instant, whole
from fretc.report.model.pictures import Histogram, NamedInstant, Panel, SignalPiece, Timeline
from fretc.report.model.results import ProbabilityView
from fretc.report.pictures.scales import RIGHT, WIDTH, Scale, fitting, frame, words

_LEFT, _LETTER = 92, 6
_ROW, _BAR, _TOP, _AXIS = 22, 12, 6, 26
_WORDS = 36
"""Height of a lane of words."""
_FLAGS = 30
"""Room above the panels for the names of trigger and deadline."""
_HEAD, _HIGH = 18, 72
"""The heights of a panel: its name, and the signal."""


def drawing(timeline: Timeline, id: str) -> dict[str, Any]:
    """The layout of a timeline; the panels stand above the lanes, on the same axis."""
    x = Scale(timeline.start, timeline.end, _LEFT, WIDTH - RIGHT)
    rows = len(timeline.flags) + (timeline.continues is not None)
    top = (_FLAGS + 14 * max(0, rows - 2) if rows else 0) + _TOP
    words_from = top + (_HEAD + _HIGH) * len(timeline.panels) + (10 if timeline.panels else 0)
    lanes_from = words_from + _WORDS * len(timeline.words)
    axis = lanes_from + _ROW * len(timeline.lanes)
    broken = timeline.broken if timeline.panels or timeline.words else None
    return frame(
        id,
        timeline.title,
        timeline.text,
        x,
        axis + _AXIS,
        cause=timeline.cause,
        at=_instant(timeline),
        first=round(timeline.start, 6),
        last=round(timeline.end, 6),
        **{"from": timeline.broken.start if timeline.broken else None},
        epoch="" if timeline.epoch_ns is None else f"{timeline.epoch_ns}",
        goes_on=None
        if timeline.continues is None
        else (f"goes on to {decimal(timeline.continues)} s", 12 + 14 * len(timeline.flags)),
        edge=_torn(x.end, top, axis),
        top=top,
        axis=axis,
        bar=_BAR,
        panels=[
            _panel(panel, top + (_HEAD + _HIGH) * i, x) for i, panel in enumerate(timeline.panels)
        ],
        words=[
            words(lane, words_from + _WORDS * i, x, 6, _LETTER)
            for i, lane in enumerate(timeline.words)
        ],
        lanes=[
            {
                "name": fitting(lane.name, _LEFT - 8, _LETTER),
                "kind": lane.kind,
                "y": lanes_from + _ROW * i,
                "bars": [x.bar(mark.start, mark.end) for mark in lane.marks],
            }
            for i, lane in enumerate(timeline.lanes)
        ],
        flags=[_flag(flag, 4 + 14 * row, x) for row, flag in enumerate(timeline.flags)],
        broken=x.bar(broken.start, broken.end) if broken else None,
    )


_DATED = 946_684_800 * 10**9
"""The year 2000; a clock before it counts from another time, such as the start of a simulation."""


def _instant(timeline: Timeline) -> str:
    """The date and time of the first violated tick; "" without a violation or a date."""
    if timeline.broken is None or timeline.epoch_ns is None or timeline.epoch_ns < _DATED:
        return ""
    return instant(timeline.epoch_ns + round(timeline.broken.start * 1e9))


def _torn(x: float, top: int, base: int) -> str:
    """The path of a zigzag line, where a picture ends before its violation."""
    steps = "".join(f"l{4 if i % 2 == 0 else -4} 6" for i in range((base - top) // 6))
    return f"M{x - 2:g} {top}{steps}"


def _flag(flag: NamedInstant, y: int, scale: Scale) -> dict[str, Any]:
    """A flag in a row of its own, so that labels never overlap."""
    x = scale(flag.at)
    label = f"{flag.kind} {decimal(flag.at)} s"
    fits = x + 8 + _LETTER * len(label) < scale.end
    at = {"anchor": "start" if fits else "end", "label_x": round(x + (8 if fits else -8), 1)}
    return {"kind": flag.kind, "x": x, "y": y, "label": label, **at}


# Signals ---------------------------------------------------------------------------------------


def _panel(panel: Panel, y: int, x: Scale) -> dict[str, Any]:
    """A signal over the timeline: `bands` are outlines of envelopes, `lines` are lines."""
    top, base = y + _HEAD, y + _HEAD + _HIGH
    at = Scale(panel.low, panel.high, base, top, digits=2)
    levels = [(at(level.value), level.label) for level in panel.levels]
    return {
        "name": f"{panel.signal}{f' ({panel.unit})' if panel.unit else ''}"
        + (", enlarged at the bound" if panel.is_enlarged else ""),
        "signal": "" if panel.is_enlarged else panel.signal,
        "unit": panel.unit,
        "low": f"{panel.low:.6g}",
        "high": f"{panel.high:.6g}",
        "y": y + 12,
        "top": top,
        "height": _HIGH,
        "lines": [_line(piece, x, at) for piece in panel.pieces],
        "bands": [band for piece in panel.pieces for band in _bands(piece, x, at)],
        "levels": [
            {"y": y, "label": label, "label_y": y + 11 if y - top < 14 else y - 4}
            for y, label in levels
        ],
        "unknown": [x.bar(mark.start, mark.end) for mark in panel.unknown],
        "infinite": [
            (x.bar(begin, end), top + 2 if sign == "+inf" else base - 2, sign)
            for begin, end, sign in panel.infinite
        ],
        "marks": at.ticks(4),
    }


def _line(piece: SignalPiece, scale: Scale, at: Scale) -> str:
    """The path of a step line; equal values one after the other are one step."""
    path: list[str] = []
    last = None
    for seconds, least, greatest in piece.points:
        x, y, low = scale(seconds), at(greatest), at(least)
        if (y, low) == (last, last):
            continue
        path.append(f"H{x:g}V{y:g}" if path else f"M{x:g} {y:g}")
        if low != y:
            path.append(f"V{low:g}")
        last = low
    return "".join([*path, f"H{scale(piece.end):g}"])


def _bands(piece: SignalPiece, scale: Scale, at: Scale) -> Iterator[str]:
    """Boxes from the least to the greatest value, where several values share a coordinate."""
    ends = [*(point[0] for point in piece.points[1:]), piece.end]
    for (seconds, least, greatest), end in zip(piece.points, ends, strict=True):
        if least != greatest:
            x, after, high, low = scale(seconds), scale(end), at(greatest), at(least)
            yield f"M{x:g} {high:g}H{after:g}V{low:g}H{x:g}Z"


# Histograms ------------------------------------------------------------------------------------

_TALL, _BASE, _APART = 90, 116, 46
"""Height of the bars, their foot, and the width of a separate bar."""


def histogram(content: Histogram, id: str) -> dict[str, Any]:
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
    right = WIDTH - RIGHT - _APART * len(late)
    x = Scale(content.bins[0].low, content.bins[-1].high, left, right)
    most = max([*(bin_.count for bin_ in content.bins), content.crossed, *(n for n, _, _ in late)])
    heights = Scale(0, most, 0, _TALL)
    columns = [
        _column(x(bin_.low), x(bin_.high), bin_.count, heights)
        for bin_ in content.bins
        if bin_.count
    ]
    if content.crossed:
        columns.append(_column(4, _APART - 6, content.crossed, heights, "crossed", "crossed"))
    columns += [
        _column(right + 14 + _APART * i, right + 6 + _APART * (i + 1), count, heights, kind, name)
        for i, (count, kind, name) in enumerate(late)
    ]
    bound = None if content.bound is None else x(content.bound)
    return frame(
        id,
        content.title,
        content.text,
        x,
        _BASE + 34,
        base=_BASE,
        columns=columns,
        bound=bound,
        bound_label=content.bound_label,
        bound_anchor="start" if bound is None or bound < WIDTH / 2 else "end",
        unit=content.unit,
    )


def _column(
    start: float, end: float, count: int, heights: Scale, kind: str = "column", name: str = ""
) -> dict[str, Any]:
    """A bar with its count; `name` is the label of a separate bar."""
    height = max(heights.thinnest, heights(count))
    width = round(max(heights.thinnest, end - start - 1), 1)
    size = {"x": start, "y": round(_BASE - height, 1), "width": width, "height": height}
    return {**size, "label": whole(count), "kind": kind, "name": name}


# Probabilities ---------------------------------------------------------------------------------

_MARGIN = 0.15
"""The margin on either side, as a share of the scale."""
_NARROWEST = 0.004
"""Minimum length of the scale."""


def probability(view: ProbabilityView, title: str, id: str) -> dict[str, Any]:
    """The intervals, the estimate and the bound, on the part of 0 to 1 that holds them."""
    values = [view.bound, *(end for bar in view.bars for end in (bar.low, bar.high))]
    spread = max(max(values) - min(values), _NARROWEST) * _MARGIN
    first, last = max(0.0, min(values) - spread), min(1.0, max(values) + spread)
    x = Scale(first, last, 112, WIDTH - 40, thinnest=2.0, digits=2)
    quarters = [first + (last - first) * i / 4 for i in range(5)]
    top, row = 22, 24
    axis = top + row * len(view.bars)
    return frame(
        id,
        title,
        view.text,
        x,
        axis + 24,
        top=top,
        axis=axis,
        bar=_BAR,
        bars=[
            (bar.name, top + row * i, x.bar_inside(bar.low, bar.high))
            for i, bar in enumerate(view.bars)
        ],
        bound=x(view.bound),
        bound_label=view.stated.removeprefix("with probability "),
        estimate=None if view.estimate is None else x(view.estimate),
        ticks=[(x(place), f"{place:.4f}") for place in quarters],
    )
