r"""Positions of the Language Server Protocol: lines and characters, for offsets in a text.

Lines end with `\n`, `\r\n` or `\r`. A character of a line counts as often as its encoding has
units: bytes (UTF-8), 16-bit units (UTF-16) or characters (UTF-32).

Source: Language Server Protocol 3.17, Text Documents and Position.
"""

from __future__ import annotations

import re
from bisect import bisect_right

from lsprotocol import types as lsp

from fretish.diagnostics.source import Span

_LINE_END = re.compile(r"\r\n|\n|\r")
ENCODINGS = {"utf-8": "utf-8", "utf-16": "utf-16-le", "utf-32": "utf-32-le"}
"""Encoding of the protocol → codec of Python."""
_UNIT = {"utf-8": 1, "utf-16": 2, "utf-32": 4}
"""Bytes of one unit."""


class Positions:
    """Offsets of one text as positions of the protocol, and back."""

    def __init__(self, text: str, encoding: str = "utf-16") -> None:
        self._text = text
        self._codec, self._unit = ENCODINGS[encoding], _UNIT[encoding]
        ends = [match.span() for match in _LINE_END.finditer(text)]
        self._starts = [0, *(end for _, end in ends)]
        self._ends = [*(start for start, _ in ends), len(text)]

    def position(self, offset: int) -> lsp.Position:
        """The position of an offset, in characters of the text; within a line end: before it."""
        line = bisect_right(self._starts, offset) - 1
        start = self._starts[line]
        return lsp.Position(line, self._units(start, min(offset, self._ends[line])))

    def offset(self, position: lsp.Position) -> int:
        """The offset of a position; one behind a line or the text means its end."""
        if position.line >= len(self._starts):
            return len(self._text)
        start, end = self._starts[position.line], self._ends[position.line]
        line = self._text[start:end]
        if line.isascii() or self._unit == 4:
            return min(start + position.character, end)
        data = line.encode(self._codec, "surrogatepass")[: position.character * self._unit]
        return start + len(data.decode(self._codec, "ignore"))

    def range(self, start: int, end: int) -> lsp.Range:
        """The range of the characters `start..end` (half-open)."""
        return lsp.Range(self.position(start), self.position(end))

    def of(self, span: Span) -> lsp.Range:
        """The range of a span of the text."""
        return self.range(span.start, span.end)

    @property
    def whole(self) -> lsp.Range:
        """The range of the whole text."""
        return self.range(0, len(self._text))

    def line_offsets(self, line: int) -> tuple[int, int]:
        """Start and end of a line, without its line end."""
        return self._starts[line], self._ends[line]

    def _units(self, start: int, end: int) -> int:
        part = self._text[start:end]
        if part.isascii() or self._unit == 4:
            return end - start
        return len(part.encode(self._codec, "surrogatepass")) // self._unit
