"""The scale of a picture: numbers as coordinates, bars and labelled ticks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fretc.report.model.phrases import decimal
from fretc.report.model.pictures import WordLane
from fretish.classes.frozen import dataclass

WIDTH, RIGHT = 720, 30
"""The width of a picture, and the margin to the right of its axis."""
_TICKS = 8
"""Approximate number of labels on an axis."""


@dataclass(frozen=True, slots=True)
class Bar:
    """An interval on an axis, as coordinates."""

    x: float
    width: float


@dataclass(frozen=True, slots=True)
class Scale:
    """Converts the numbers from `first` to `last` into the coordinates from `start` to `end`.

    Numbers beyond an end have the coordinate of that end.
    """

    first: float
    last: float
    start: float
    end: float
    thinnest: float = 1.5
    """Minimum width of a bar, so that every event is visible."""
    digits: int = 1

    def __call__(self, number: float) -> float:
        """The coordinate of a number."""
        inside = min(max(number, self.first), self.last)
        share = (inside - self.first) / (self.last - self.first)
        return round(self.start + share * (self.end - self.start), self.digits)

    def bar(self, first: float, last: float) -> Bar:
        """The bar from one number to another."""
        x = self(first)
        return Bar(x, round(max(self.thinnest, self(last) - x), self.digits))

    def bar_inside(self, first: float, last: float) -> Bar:
        """The bar; one that begins at the end of the scale stands before it."""
        x = min(self(first), self.end - self.thinnest)
        return Bar(x, round(max(self.thinnest, self(last) - x), self.digits))

    def ticks(self, most: int = _TICKS) -> list[tuple[float, str]]:
        """Coordinate and label of about `most` round numbers."""
        positions = places(self.first, self.last, most)
        return [(self(place), _label(place, positions)) for place in positions]


def _label(place: float, among: Sequence[float]) -> str:
    """The number with enough digits to tell it from its neighbours."""
    width = among[1] - among[0] if len(among) > 1 else 1.0
    return decimal(place) if width >= 1e-3 or place == 0 else f"{round(place / width) * width:.3g}"


def places(start: float, end: float, most: int) -> list[float]:
    """About `most` round numbers from `start` to `end`."""
    width = step((end - start) / most)
    first = int(-(-start // width))
    numbers = [(first + i) * width for i in range(2 * most)]
    return [place for place in numbers if place <= end + width * 1e-6]


def step(least: float) -> float:
    """1, 2 or 5 times a power of ten, not below `least` nor below a thousand-millionth."""
    if least <= 0:
        return 1.0
    power = 10.0 ** len(str(int(least))) if least >= 1 else 1.0
    while power / 10 >= least and power > 1.5e-8:
        power /= 10
    return next((power / 10 * n for n in (1, 2, 5) if power / 10 * n >= least), power)


def frame(id: str, title: str, text: str, x: Scale, height: int, **rest: Any) -> dict[str, Any]:
    """The values of a picture for its template: its texts, its frame, and the ticks of its axis.

    Args:
        id: the id of the picture.
        title: the title of the picture.
        text: a description of the picture.
        x: the horizontal axis.
        height: the height of the picture.
        rest: the further values of this kind of picture; `ticks` replace those of the axis.
    """
    texts = {"id": id, "title": title, "text": text}
    sizes = {"width": WIDTH, "height": height, "left": x.start, "right": x.end}
    return {**texts, **sizes, "ticks": x.ticks(), **rest}


def words(lane: WordLane, y: int, x: Scale, margin: int, letter: float) -> dict[str, Any]:
    """A lane of words: bar, word ("" if unknown), and label, which is shortened to fit."""
    bars = [(x.bar(start, end), word) for start, end, word in lane.words]
    labelled = [(b, w or "", fitting(w or "unknown", b.width - margin, letter)) for b, w in bars]
    return {"name": lane.signal, "y": y, "bars": labelled}


def fitting(word: str, width: float, letter: float) -> str:
    """The word, shortened to fit; "" if too little of it would remain.

    Args:
        word: the word.
        width: the room for the word.
        letter: the approximate width of a character.
    """
    most = int(width / letter)
    return word if len(word) <= most else f"{word[: most - 1]}…" if most > 3 else ""
