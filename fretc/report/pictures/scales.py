"""The layout of a probability: its intervals on a scale, and the bound of the sentence."""

from __future__ import annotations

from dataclasses import dataclass

from fretc.report.model.views import ProbabilityView

_WIDTH, _LEFT, _RIGHT = 720, 112, 40
_ROW, _BAR, _TOP, _AXIS = 24, 12, 22, 24
_THINNEST = 2.0
_MARGIN = 0.15
"""The margin on either side, as a share of the scale."""
_NARROWEST = 0.004
"""Minimum length of the scale."""


@dataclass(frozen=True, slots=True)
class ScaleBar:
    """An interval, in units of the drawing."""

    name: str
    x: float
    width: float
    y: int


@dataclass(frozen=True, slots=True)
class Scale:
    """The drawing; `ticks` are coordinates with their labels."""

    id: str
    text: str
    width: int
    height: int
    left: int
    right: int
    top: int
    axis: int
    bar: int
    bars: tuple[ScaleBar, ...]
    bound: float
    bound_label: str
    estimate: float | None
    ticks: tuple[tuple[float, str], ...]


def scale(view: ProbabilityView, id: str) -> Scale:
    """The intervals, the estimate and the bound, on the part of 0 to 1 that holds them."""
    values = [view.bound, *(end for bar in view.bars for end in (bar.low, bar.high))]
    spread = max(max(values) - min(values), _NARROWEST) * _MARGIN
    first, last = max(0.0, min(values) - spread), min(1.0, max(values) + spread)

    def x(share: float) -> float:
        part = (share - first) / (last - first)
        return round(_LEFT + part * (_WIDTH - _LEFT - _RIGHT), 2)

    axis = _TOP + _ROW * len(view.bars)
    return Scale(
        id=id,
        text=view.text,
        width=_WIDTH,
        height=axis + _AXIS,
        left=_LEFT,
        right=_WIDTH - _RIGHT,
        top=_TOP,
        axis=axis,
        bar=_BAR,
        bars=tuple(
            ScaleBar(
                bar.name,
                min(x(bar.low), _WIDTH - _RIGHT - _THINNEST),
                round(max(_THINNEST, x(bar.high) - x(bar.low)), 2),
                _TOP + _ROW * row,
            )
            for row, bar in enumerate(view.bars)
        ),
        bound=x(view.bound),
        bound_label=f"{view.stated.removeprefix('with probability ')}",
        estimate=None if view.estimate is None else x(view.estimate),
        ticks=tuple((x(place), f"{place:.4f}") for place in _places(first, last)),
    )


def _places(first: float, last: float) -> list[float]:
    return [first + (last - first) * i / 4 for i in range(5)]
