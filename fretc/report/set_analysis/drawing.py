"""The picture of a run: a lane for each variable, a column for each group of equal ticks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from fretc.report.model.sets import Play, PlayLane
from fretc.report.pictures.scales import Scale

_RIGHT, _TOP, _LANE, _HIGH, _FOOT = 10, 20, 26, 16, 8
_LETTER = 7
"""Width of a letter of a name."""
_COLUMN, _NARROWEST = 64, 34
_WIDTH = 960
_MOST = 18
"""Maximum number of columns; of more, the first and the last ones are drawn, with a gap."""
_LONGEST = 34
"""Maximum number of characters of a name."""


def drawing(play: Play, id: str, title: str, *, breaks: bool) -> dict[str, Any] | None:
    """The layout of a run, as values for its template; None if it has no tick or no variable.

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
    x = Scale(0, len(shown), left, left + column * len(shown))
    bottom = _TOP + _LANE * len(play.lanes)
    begin = count - 1 if play.loop is None else max(play.loop, shown[0])
    first = next((index for index, each in enumerate(shown) if each >= begin), len(shown) - 1)
    return {
        "id": id,
        "title": title,
        "text": _in_words(play, breaks=breaks),
        "width": max(_WIDTH, round(x.end + _RIGHT)),
        "height": bottom + _FOOT,
        "lanes": [
            _lane(lane, [lane.values[i] for i in shown], x, _TOP + _LANE * index)
            for index, lane in enumerate(play.lanes)
        ],
        "heads": [(x(index + 0.5), play.ticks[i]) for index, i in enumerate(shown)],
        # The columns of the violation, or of the loop.
        "last": (x(first), round(column * (len(shown) - first), 1)) if breaks else None,
        "top": _TOP,
        "bottom": bottom,
        "gap": None if count <= _MOST else x(_MOST // 2),
    }


def _label(lane: PlayLane) -> str:
    role = f" ({lane.role})" if lane.role else ""
    name = lane.name if len(lane.name) <= _LONGEST else f"{lane.name[: _LONGEST - 1]}…"
    return f"{name}{role}"


def _lane(lane: PlayLane, values: Sequence[str], x: Scale, y: int) -> dict[str, Any]:
    """A lane: truth values as a line above a thin one at the level of `0`, others as texts."""
    drawn = {"name": _label(lane), "title": lane.name, "y": y + _HIGH, "path": "", "texts": []}
    if all(value in ("0", "1") for value in lane.values):
        base = f"M{x.start} {y + _HIGH + 4}h{x.end - x.start:.1f}"
        return {**drawn, "path": " ".join(_steps(values, x, y)), "base": base}
    return {**drawn, "texts": [(x(index + 0.5), value) for index, value in enumerate(values)]}


def _steps(values: Sequence[str], x: Scale, y: int) -> Iterator[str]:
    """The path of a step line of 0 and 1."""
    for index, value in enumerate(values):
        level = y + 4 if value == "1" else y + _HIGH + 4
        yield f"{'L' if index else 'M'}{x(index)} {level}"
        yield f"L{x(index + 1)} {level}"


def _in_words(play: Play, *, breaks: bool) -> str:
    """The text alternative of the picture."""
    end = "a requirement is violated at the last tick" if breaks else "no requirement is violated"
    end = end if play.loop is None else "the marked ticks repeat for ever"
    return f"Ticks {play.ticks[0]} to {play.ticks[-1]}; {end}. The table below has all values."
