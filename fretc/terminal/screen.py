"""Where standard output is shown: how wide it is, what it can write, how wide a text is there.

The only module that imports wcwidth.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from dataclasses import dataclass

from fretish.diagnostics.rendering import visible
from fretish.diagnostics.status_symbols import STATUS_SYMBOLS

_WIDTH = 80
"""Where standard output is no terminal."""
NARROWEST = 40
"""A narrower terminal is taken for one of this width."""
_SHORTEST = 8
"""Columns of a title that still says something."""
_LETTERS = {"\N{MULTIPLICATION SIGN}": "x", "\N{HORIZONTAL ELLIPSIS}": "."} | {
    sign.glyph: sign.letter for sign in STATUS_SYMBOLS
}


@dataclass(frozen=True, slots=True)
class Screen:
    """The place where a person reads."""

    width: int = _WIDTH
    encoding: str = "utf-8"

    def text(self, text: str) -> str:
        """The text, with escapes for what cannot be written here, and for what moves the cursor."""
        return visible(text).encode(self.encoding, "backslashreplace").decode(self.encoding)

    def signs(self, text: str) -> str:
        """The text of fretc itself, with letters for the signs that cannot be written here."""
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
    """That of standard output."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    try:
        columns = os.get_terminal_size(sys.stdout.fileno()).columns
    except (OSError, ValueError):
        columns = 0
    return Screen(max(NARROWEST, columns or _WIDTH), encoding)


def width(text: str) -> int:
    """The columns that a text without control characters takes."""
    if text.isascii() and text.isprintable():
        return len(text)
    from wcwidth import wcswidth

    return max(0, wcswidth(text))


def fitted(text: str, columns: int) -> str:
    """The text in so many columns at most: of a longer one the beginning and, more of it, the end.

    Args:
        text: without control characters.
        columns: 3 or more.
    """
    if len(text) <= 4 * columns and width(text) <= columns:
        return text
    head = _longest(text, (columns - 1) // 3)
    tail = _longest(reversed(text), columns - 1 - width(head))[::-1]
    return f"{head}\N{HORIZONTAL ELLIPSIS}{tail}"


def titled(id: str, title: str, columns: int) -> str:
    """A title, cut off where it is too long, and the id; the id alone where no title has room.

    Args:
        id: without control characters, as the title.
        title: empty: there is none.
        columns: of all; an id that is longer is fitted.
    """
    room = columns - width(id) - len(" ()")
    if not title or room < _SHORTEST:
        return fitted(id, columns)
    if len(title) > 4 * room or width(title) > room:
        title = f"{_longest(title, room - 1).rstrip()}\N{HORIZONTAL ELLIPSIS}"
    return f"{title} ({id})"


def _longest(characters: Iterable[str], columns: int) -> str:
    """As many of the characters as fit, and not a hundred marks upon one of them."""
    taken = ""
    for character in characters:
        if len(taken) >= 2 * columns or width(taken + character) > columns:
            break
        taken += character
    return taken


def padded(text: str, columns: int) -> str:
    """The text with blanks up to so many columns."""
    return f"{text}{' ' * (columns - width(text))}"
