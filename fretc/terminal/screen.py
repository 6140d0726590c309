"""Properties of standard output: width and encoding; and the width of a text.

The only module that imports wcwidth.
"""

from __future__ import annotations

import codecs
import os
import sys
from collections.abc import Iterable

from fretish.classes.frozen import dataclass
from fretish.diagnostics.rendering import visible
from fretish.diagnostics.status_symbols import STATUS_SYMBOLS

_WIDTH = 80
"""Width if standard output is not a terminal."""
NARROWEST = 40
"""Minimum width; a narrower terminal is treated as this wide."""
_SHORTEST = 8
"""Minimum number of columns of a useful title."""
_LETTERS = {"\N{MULTIPLICATION SIGN}": "x", "\N{HORIZONTAL ELLIPSIS}": "."} | {
    sign.glyph: sign.letter for sign in STATUS_SYMBOLS
}
_IN_ASCII = _LETTERS | {
    "\N{RIGHTWARDS ARROW}": "->",
    "\N{LEFTWARDS ARROW}": "<-",
    "\N{NOT EQUAL TO}": "!=",
    "\N{EN DASH}": "-",
    "\N{BOX DRAWINGS LIGHT HORIZONTAL}": "-",
    "\N{LEFT DOUBLE QUOTATION MARK}": '"',
    "\N{RIGHT DOUBLE QUOTATION MARK}": '"',
    "\N{RIGHT SINGLE QUOTATION MARK}": "'",
    "\N{MIDDLE DOT}": "*",
}
IN_ASCII = "fretc-ascii"
"""Name of the error handler for streams whose encoding lacks symbols, as of consoles of Windows."""


def _in_ascii(error: UnicodeError) -> tuple[str | bytes, int]:
    """Letters for symbols of fretc, and escapes for all other characters."""
    assert isinstance(error, UnicodeEncodeError)
    character = error.object[error.start]
    if character not in _IN_ASCII:
        error.end = error.start + 1
        return codecs.backslashreplace_errors(error)
    return _IN_ASCII[character], error.start + 1


codecs.register_error(IN_ASCII, _in_ascii)


@dataclass(frozen=True, slots=True)
class Screen:
    """Width and encoding of the output."""

    width: int = _WIDTH
    encoding: str = "utf-8"

    def text(self, text: str) -> str:
        """The text with escapes for control characters and characters outside the encoding."""
        return visible(text).encode(self.encoding, "backslashreplace").decode(self.encoding)

    def signs(self, text: str) -> str:
        """Text of fretc with letters in place of symbols outside the encoding."""
        return "".join(
            character if self._has(character) else _LETTERS.get(character, character)
            for character in text
        )

    def _has(self, character: str) -> bool:
        try:
            character.encode(self.encoding)
        except UnicodeEncodeError:
            return False
        return True


def screen() -> Screen:
    """The screen of standard output."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    try:
        columns = os.get_terminal_size(sys.stdout.fileno()).columns
    except (OSError, ValueError):
        columns = 0
    return Screen(max(NARROWEST, columns or _WIDTH), encoding)


def width(text: str) -> int:
    """Number of columns of a text without control characters."""
    if text.isascii() and text.isprintable():
        return len(text)
    from wcwidth import wcswidth

    return max(0, wcswidth(text))


def fitted(text: str, columns: int) -> str:
    """The text shortened to `columns`: its beginning and a longer part of its end.

    Args:
        text: text without control characters.
        columns: 3 or more.
    """
    if len(text) <= 4 * columns and width(text) <= columns:
        return text
    head = _longest(text, (columns - 1) // 3)
    tail = _longest(reversed(text), columns - 1 - width(head))[::-1]
    return f"{head}\N{HORIZONTAL ELLIPSIS}{tail}"


def titled(id: str, title: str, columns: int) -> str:
    """Title and id in `columns`: the title is shortened, or left out if there is no room.

    Args:
        id: text without control characters.
        title: text without control characters; empty: no title.
        columns: total width; a longer id is shortened.
    """
    room = columns - width(id) - len(" ()")
    if not title or room < _SHORTEST:
        return fitted(id, columns)
    if len(title) > 4 * room or width(title) > room:
        title = f"{_longest(title, room - 1).rstrip()}\N{HORIZONTAL ELLIPSIS}"
    return f"{title} ({id})"


def _longest(characters: Iterable[str], columns: int) -> str:
    """The longest prefix that fits; combining marks are limited."""
    taken = ""
    for character in characters:
        if len(taken) >= 2 * columns or width(taken + character) > columns:
            break
        taken += character
    return taken


def padded(text: str, columns: int) -> str:
    """The text padded with blanks to `columns`."""
    return f"{text}{' ' * (columns - width(text))}"
