"""Source texts, and spans in them."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import field
from functools import lru_cache

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """A text with its name: a file's path, or `<stdin>`."""

    name: str
    text: str = field(repr=False)

    def span(self, start: int = 0, end: int | None = None) -> Span:
        """The characters `start..end` (half-open); without `end`, up to the end of the text."""
        return Span(self, start, len(self.text) if end is None else end)


@dataclass(frozen=True, slots=True)
class Span:
    """A half-open range of characters, `start <= i < end`, of one source."""

    source: Source
    start: int
    end: int

    @property
    def text(self) -> str:
        """The characters of the span."""
        return self.source.text[self.start : self.end]

    @property
    def line(self) -> int:
        """Line of the first character, counted from 1."""
        return bisect_right(_line_starts(self.source.text), self.start)

    @property
    def column(self) -> int:
        """Column of the first character, counted from 1, in characters."""
        return self.start - _line_starts(self.source.text)[self.line - 1] + 1

    @property
    def line_text(self) -> str:
        """The whole first line, without the line end."""
        starts = _line_starts(self.source.text)
        end = starts[self.line] if self.line < len(starts) else len(self.source.text)
        return self.source.text[starts[self.line - 1] : end].rstrip("\r\n")

    def part(self, start: int, end: int) -> Span:
        """The characters `start..end` of this span, counted from its own start."""
        return Span(self.source, self.start + start, self.start + end)

    def to(self, other: Span) -> Span:
        """From the start of this span to the end of `other`."""
        return Span(self.source, self.start, max(self.end, other.end))


@lru_cache(8)
def _line_starts(text: str) -> list[int]:
    """The index of the first character of each line; cached for `line` and `column`."""
    return [0, *(i + 1 for i, character in enumerate(text) if character == "\n")]
