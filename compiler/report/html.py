"""The report as one HTML file: every text made visible, every timeline laid out, then placed."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from compiler.report.phrases import decimal, visible
from compiler.report.scales import scale
from compiler.report.views import Lane, Report, Timeline
from compiler.templating import render

_WIDTH, _LEFT, _RIGHT = 720, 92, 30
_ROW, _BAR, _TOP, _AXIS = 22, 12, 6, 24
_TICKS = 8
"""Labels on the axis, about."""
_THINNEST = 1.5


@dataclass(frozen=True, slots=True)
class Bar:
    """A stretch of a lane, in units of the drawing."""

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
class Drawing:
    """A timeline laid out; `ticks` are places on the axis with their label in seconds."""

    id: str
    title: str
    text: str
    width: int
    height: int
    left: int
    right: int
    axis: int
    row: int
    bar: int
    lanes: tuple[DrawnLane, ...]
    ticks: tuple[tuple[float, str], ...]


def html(report: Report) -> str:
    """The whole file."""
    drawings = {
        result.anchor: [
            asdict(_drawing(timeline, f"picture-{result.anchor}.{number}"))
            for number, timeline in enumerate(result.timelines, 1)
        ]
        for section in report.requirements
        for result in section.results
    }
    scales = {
        section.anchor: asdict(scale(section.probability, f"picture-{section.anchor}"))
        for section in report.requirements
        if section.probability is not None
    }
    return render(
        "report/report.html.j2",
        report=_visible(asdict(report)),
        drawings=_visible(drawings),
        scales=_visible(scales),
    )


def _visible(value: Any) -> Any:
    """The same, with every character to be seen: no text can hide, turn or cut another one."""
    match value:
        case str():
            return visible(value)
        case dict():
            return {visible(key): _visible(item) for key, item in value.items()}
        case list() | tuple():
            return [_visible(item) for item in value]
        case _:
            return value


# Timelines -------------------------------------------------------------------------------------


def _drawing(timeline: Timeline, id: str) -> Drawing:
    axis = _TOP + _ROW * len(timeline.lanes)
    return Drawing(
        id=id,
        title=timeline.title,
        text=timeline.text,
        width=_WIDTH,
        height=axis + _AXIS,
        left=_LEFT,
        right=_WIDTH - _RIGHT,
        axis=axis,
        row=_ROW,
        bar=_BAR,
        lanes=tuple(_lane(lane, i, timeline) for i, lane in enumerate(timeline.lanes)),
        ticks=_axis(timeline),
    )


def _x(seconds: float, timeline: Timeline) -> float:
    share = (seconds - timeline.start) / (timeline.end - timeline.start)
    return round(_LEFT + share * (_WIDTH - _LEFT - _RIGHT), 2)


def _lane(lane: Lane, number: int, timeline: Timeline) -> DrawnLane:
    bars = []
    for mark in lane.marks:
        start, end = _x(mark.start, timeline), _x(mark.end, timeline)
        bars.append(Bar(start, round(max(_THINNEST, end - start), 2)))
    return DrawnLane(lane.name, lane.kind, _TOP + _ROW * number, tuple(bars))


def _axis(timeline: Timeline) -> tuple[tuple[float, str], ...]:
    """Round numbers of seconds, at most some ten of them."""
    step = _step((timeline.end - timeline.start) / _TICKS)
    first = int(-(-timeline.start // step))
    places = [(first + i) * step for i in range(2 * _TICKS)]
    inside = [place for place in places if place <= timeline.end + step * 1e-6]
    return tuple((_x(place, timeline), decimal(place)) for place in inside)


def _step(least: float) -> float:
    """1, 2 or 5 times a power of ten, not below `least`."""
    power = 10.0 ** len(str(int(least))) if least >= 1 else 1.0
    while power / 10 >= least and power > 1e-9:
        power /= 10
    return next((power / 10 * n for n in (1, 2, 5) if power / 10 * n >= least), power)
