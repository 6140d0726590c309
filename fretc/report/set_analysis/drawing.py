"""The picture of a run: a lane for each variable, a column for each group of equal ticks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fretc.report.model.views import Play, PlayLane

_RIGHT, _TOP, _LANE, _HIGH, _FOOT = 10, 20, 26, 16, 8
_LETTER = 7
"""Width of a letter of a name."""
_COLUMN, _NARROWEST = 64, 34
_WIDTH = 960
_MOST = 18
"""Maximum number of columns; of more, the first and the last ones are drawn, with a gap."""
_LONGEST = 34
"""Maximum number of characters of a name."""


@dataclass(frozen=True, slots=True)
class DrawnLane:
    """A lane: truth values as a line, other values as texts."""

    name: str
    title: str
    y: int
    base: str
    """A thin line at the level of `0`."""
    path: str
    texts: tuple[tuple[float, str], ...]


@dataclass(frozen=True, slots=True)
class DrawnPlay:
    """The layout; `last` are the columns of the violation, or of the loop."""

    id: str
    title: str
    text: str
    width: int
    height: int
    lanes: tuple[DrawnLane, ...]
    heads: tuple[tuple[float, str], ...]
    last: tuple[float, float] | None
    """Left edge and width of these columns; None if the run violates nothing."""
    top: int
    bottom: int
    gap: float | None
    """The x coordinate of the gap, or None."""


def drawing(play: Play, id: str, title: str, *, breaks: bool) -> DrawnPlay | None:
    """The layout of a run; None if it has no tick or no variable.

    Args:
        play: the run.
        id: id of the picture.
        title: title of the picture.
        breaks: whether the run violates a requirement.
    """
    count = len(play.ticks)
    if not count or not play.lanes:
        return None
    left = 16 + _LETTER * max(len(_label(lane)) for lane in play.lanes)
    shown = (
        [*range(count)]
        if count <= _MOST
        else [*range(_MOST // 2), *range(count - _MOST // 2, count)]
    )
    column = min(_COLUMN, max(_NARROWEST, (_WIDTH - left - _RIGHT) / len(shown)))
    bottom = _TOP + _LANE * len(play.lanes)
    begin = count - 1 if play.loop is None else max(play.loop, shown[0])
    first = next((place for place, each in enumerate(shown) if each >= begin), len(shown) - 1)
    return DrawnPlay(
        id=id,
        title=title,
        text=_in_words(play, breaks=breaks),
        width=max(_WIDTH, round(left + column * len(shown) + _RIGHT)),
        height=bottom + _FOOT,
        lanes=tuple(
            _lane(lane, [lane.values[i] for i in shown], left, column, _TOP + _LANE * place)
            for place, lane in enumerate(play.lanes)
        ),
        heads=tuple((_middle(place, left, column), play.ticks[i]) for place, i in enumerate(shown)),
        last=(
            (round(left + column * first, 1), round(column * (len(shown) - first), 1))
            if breaks
            else None
        ),
        top=_TOP,
        bottom=bottom,
        gap=None if count <= _MOST else round(left + column * (_MOST // 2), 1),
    )


def _label(lane: PlayLane) -> str:
    role = f" ({lane.role})" if lane.role else ""
    name = lane.name if len(lane.name) <= _LONGEST else f"{lane.name[: _LONGEST - 1]}…"
    return f"{name}{role}"


def _lane(lane: PlayLane, values: Sequence[str], left: float, column: float, y: int) -> DrawnLane:
    texts: tuple[tuple[float, str], ...] = ()
    path = base = ""
    if all(value in ("0", "1") for value in lane.values):
        path = " ".join(_steps(values, left, column, y))
        base = f"M{left} {y + _HIGH + 4}h{column * len(values):.1f}"
    else:
        texts = tuple((_middle(place, left, column), value) for place, value in enumerate(values))
    return DrawnLane(_label(lane), lane.name, y + _HIGH, base, path, texts)


def _steps(values: Sequence[str], left: float, column: float, y: int) -> Iterator[str]:
    """The path of a step line of 0 and 1."""
    for place, value in enumerate(values):
        level = y + 4 if value == "1" else y + _HIGH + 4
        yield f"{'L' if place else 'M'}{left + column * place:.1f} {level}"
        yield f"L{left + column * (place + 1):.1f} {level}"


def _middle(place: int, left: float, column: float) -> float:
    return round(left + column * (place + 0.5), 1)


def _in_words(play: Play, *, breaks: bool) -> str:
    """The text alternative of the picture."""
    end = "a requirement is violated at the last tick" if breaks else "no requirement is violated"
    end = end if play.loop is None else "the marked ticks repeat for ever"
    return f"Ticks {play.ticks[0]} to {play.ticks[-1]}; {end}. The table below has all values."
