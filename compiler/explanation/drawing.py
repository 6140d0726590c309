"""The layout of a diagram, as SVG and as text for a terminal; long equal stretches are folded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import pairwise

from compiler.explanation.diagram import Diagram, DiagramLane, LaneInterval, LaneKind, words
from compiler.explanation.windows import Expectation
from compiler.files.templating import render
from fretish.classes.frozen import dataclass
from fretish.clock import in_words
from fretish.diagnostics.rendering import visible


@dataclass(frozen=True, slots=True)
class Slot:
    """A column of the picture: one tick, or several that are alike in all lanes."""

    first: int
    last: int


_PLAIN = 22
"""Number of ticks up to which each tick is drawn."""
_ALIKE = 4
"""Number of equal ticks that are drawn one by one in a longer picture."""


def slots(drawn: Diagram) -> tuple[Slot, ...]:
    """The columns, few for any bound: a long stretch keeps its first and its last tick."""
    cuts = {0, drawn.ticks}
    for lane in drawn.lanes:
        for stretch in lane.stretches:
            cuts.update((stretch.first, stretch.last + 1))
    edges = sorted(cut for cut in cuts if 0 <= cut <= drawn.ticks)
    columns: list[Slot] = []
    for first, after in pairwise(edges):
        if drawn.ticks <= _PLAIN or after - first <= _ALIKE:
            columns.extend(Slot(t, t) for t in range(first, after))
        else:
            columns.extend(
                (Slot(first, first), Slot(first + 1, after - 2), Slot(after - 1, after - 1))
            )
    return tuple(columns)


def _places(columns: Sequence[Slot], stretch: LaneInterval) -> tuple[int, int] | None:
    """The first and the last column of a stretch; None if it contains no tick."""
    inside = [
        i
        for i, slot in enumerate(columns)
        if stretch.first <= slot.first and slot.last <= stretch.last
    ]
    return (inside[0], inside[-1]) if inside else None


def shortened(text: str, most: int) -> str:
    """The text, with an ellipsis in the middle if it is longer than `most` characters."""
    if len(text) <= most:
        return text
    head = (most - 1) // 2
    return f"{text[:head]}…{text[len(text) - (most - 1 - head) :]}"


# Characters -------------------------------------------------------------------------------------

_FILLS = {
    LaneKind.MODE: "─",
    LaneKind.SCOPE: "━",
    LaneKind.CONDITION: "─",
    LaneKind.STOP: "─",
    LaneKind.BOUND: "╌",
}
_NEEDS = {Expectation.ALL: "█", Expectation.SOME: "▒", Expectation.NONE: "/", Expectation.MISS: "░"}
_NAMES = 26
_EMPTY = "·"


def text(drawn: Diagram, indent: str = "") -> str:
    """The diagram as text, a line for each lane."""
    columns = slots(drawn)
    labels = [str(slot.first) if slot.first == slot.last else "…" for slot in columns]
    width = max(map(len, labels)) + 1
    left = [_named(lane, _NAMES) for lane in drawn.lanes]
    margin = max(map(len, [*left, "tick"])) + 2
    axis = "".join(label.ljust(width) for label in labels)
    lines = [f"{'tick':<{margin}}{axis}{'' if drawn.ends else '…'}"]
    for name, lane in zip(left, drawn.lanes, strict=True):
        lines.append(f"{name:<{margin}}{_cells(lane, columns, width)}")
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)


def _named(lane: DiagramLane, most: int) -> str:
    name = shortened(visible(lane.name), most)
    return f"{name}: {lane.remark}" if name else lane.remark


def _cells(lane: DiagramLane, columns: Sequence[Slot], width: int) -> str:
    row = list(_EMPTY.ljust(width) * len(columns))
    more = ""
    for stretch in lane.stretches:
        places = _places(columns, stretch)
        if places is None:
            continue
        first, last = places[0] * width, places[1] * width
        if lane.kind is LaneKind.TRIGGER:
            row[first] = "▲"
            continue
        fill = _NEEDS[lane.need] if lane.need else _FILLS[lane.kind]
        end = last + width - 1 if width > 2 else last + 1
        row[first:end] = fill * (end - first)
        if lane.kind is LaneKind.BOUND:
            row[first : last + 1] = ["├", *row[first + 1 : last], "┤"][: last - first + 1]
            row[last + 1 : end] = " " * (end - last - 1)
        if stretch.goes_on:
            row[end:] = fill * (len(row) - end)
            more = "→"
    return "".join(row) + more


# SVG --------------------------------------------------------------------------------------------

_WIDTH, _LEFT, _RIGHT = 800, 280, 46
_TOP, _ROW, _BAR, _AXIS = 14, 34, 14, 40
_WIDEST = 44
_NAME_LETTERS = 34
_TITLE_LETTERS = 500
_DIGIT = 7
"""Width of a digit on the axis."""


@dataclass(frozen=True, slots=True)
class DiagramBar:
    """A stretch of a lane, in units of the drawing."""

    x: float
    width: float
    kind: str
    goes_on: bool
    title: str


@dataclass(frozen=True, slots=True)
class DiagramRow:
    """A lane in units of the drawing."""

    y: int
    name: str
    full: str
    note: str
    kind: str
    bars: tuple[DiagramBar, ...]


@dataclass(frozen=True, slots=True)
class Fold:
    """Ticks that are not drawn one by one."""

    x: float
    width: float
    title: str


@dataclass(frozen=True, slots=True)
class DiagramDrawing:
    """A diagram in units of the drawing; the template only places it."""

    id: str
    title: str
    text: str
    width: int
    height: int
    left: int
    right: float
    axis: int
    bar: int
    rows: tuple[DiagramRow, ...]
    folds: tuple[Fold, ...]
    edges: tuple[float, ...]
    """The positions at which the scope begins and ends."""
    labels: tuple[tuple[float, str], ...]
    ends: bool
    unit: str
    """The length of a tick in words."""


def drawing(drawn: Diagram, id: str = "diagram") -> DiagramDrawing:
    """The layout of a diagram.

    Args:
        drawn: the diagram.
        id: prefix of the names of its patterns; unique within a page.
    """
    columns = slots(drawn)
    axis = _TOP + _ROW * len(drawn.lanes)
    step = _step(columns)
    return DiagramDrawing(
        id=id,
        title=visible(drawn.title),
        text=visible(words(drawn)),
        width=_WIDTH,
        height=axis + _AXIS,
        left=_LEFT,
        right=round(_LEFT + step * len(columns), 2),
        axis=axis,
        bar=_BAR,
        rows=tuple(_row(lane, i, columns) for i, lane in enumerate(drawn.lanes)),
        folds=tuple(_folds(columns)),
        edges=tuple(_edges(drawn, columns)),
        labels=tuple(_labels(drawn, columns)),
        ends=drawn.ends,
        unit=f"ticks of {in_words(drawn.period)}" if drawn.period else "ticks",
    )


def svg(drawn: Diagram) -> str:
    """The diagram as a self-contained SVG file."""
    return render("diagram/diagram.svg.j2", drawing=asdict(drawing(drawn)))


def _step(columns: Sequence[Slot]) -> float:
    return min(_WIDEST, (_WIDTH - _LEFT - _RIGHT) / len(columns))


def _x(index: int, columns: Sequence[Slot]) -> float:
    return round(_LEFT + index * _step(columns), 2)


def _row(lane: DiagramLane, number: int, columns: Sequence[Slot]) -> DiagramRow:
    full = visible(lane.name)
    return DiagramRow(
        y=_TOP + _ROW * number,
        name=shortened(full, _NAME_LETTERS),
        full=full,
        note=lane.remark,
        kind=lane.kind.value,
        bars=tuple(_bars(lane, columns)),
    )


def _bars(lane: DiagramLane, columns: Sequence[Slot]) -> Iterator[DiagramBar]:
    kind = lane.need.name.lower() if lane.need else lane.kind.value
    for stretch in lane.stretches:
        places = _places(columns, stretch)
        if places is not None:
            x, after = _x(places[0], columns), _x(places[1] + 1, columns)
            if lane.kind is LaneKind.BOUND:  # from tick to tick, which are n steps apart
                x, after = x + _step(columns) / 2, after - _step(columns) / 2
            width = round(after - x, 2)
            yield DiagramBar(x, width, kind, stretch.goes_on, _title(lane, stretch))


def _title(lane: DiagramLane, stretch: LaneInterval) -> str:
    several = stretch.first != stretch.last
    ticks = f"ticks {stretch.first} to {stretch.last}" if several else f"tick {stretch.first}"
    return f"{_named(lane, _TITLE_LETTERS)} ({ticks}{' and later' if stretch.goes_on else ''})"


def _folds(columns: Sequence[Slot]) -> Iterator[Fold]:
    for i, slot in enumerate(columns):
        if slot.first != slot.last:
            title = f"ticks {slot.first} to {slot.last}"
            yield Fold(_x(i, columns), round(_step(columns), 2), title)


def _edges(drawn: Diagram, columns: Sequence[Slot]) -> Iterator[float]:
    for lane in drawn.lanes:
        if lane.kind is not LaneKind.SCOPE:
            continue
        for stretch in lane.stretches:
            places = _places(columns, stretch)
            assert places is not None
            yield _x(places[0], columns)
            if not stretch.goes_on:
                yield _x(places[1] + 1, columns)


def _labels(drawn: Diagram, columns: Sequence[Slot]) -> Iterator[tuple[float, str]]:
    """Labels of ticks; if space is short, those at which a bar begins or ends are preferred."""
    changes = {0, drawn.ticks - 1}
    for lane in drawn.lanes:
        for stretch in lane.stretches:
            changes.update((stretch.first, stretch.last))
    plain = [(i, slot.first) for i, slot in enumerate(columns) if slot.first == slot.last]
    taken: list[tuple[float, float]] = []
    for i, tick in sorted(plain, key=lambda label: label[1] not in changes):
        middle = _x(i, columns) + _step(columns) / 2
        half = len(str(tick)) * _DIGIT / 2 + 2
        if all(middle + half <= start or middle - half >= end for start, end in taken):
            taken.append((middle - half, middle + half))
            yield round(middle, 2), str(tick)
