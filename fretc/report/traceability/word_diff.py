"""The difference of two texts, by words; a number and its unit are one word."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import Literal

from fretish import units
from fretish.clock import NANOSECONDS

SAME, BEFORE, AFTER = "same", "before", "after"
Kind = Literal["same", "before", "after"]
Segment = tuple[Kind, str]
"""A stretch of both texts, of the one before, or of the one after."""
_WORD = re.compile(
    r"(?P<number>[+-]?[0-9][0-9.]*)[ \u00a0\u202f](?P<unit>%|[A-Za-z]\w*(?:/[A-Za-z]\w*)*)"
    r"|[()\[\]{},;]|[^\s()\[\]{},;]+"
)
_MOST_WORDS = 300
"""Longer texts are compared as wholes: the time grows with the square."""
_LEAD, _WHOLE, _LONGEST = 40, 240, 2000
"""Characters: beside a difference, of a text on a line, and of a stretch of segments."""


def segments(before: str, after: str) -> tuple[Segment, ...]:
    """Both texts as one: what they share, what one has, what the other has."""
    found: list[Segment] = []
    for same, i, j, k, m in _differences(before, after):
        if same:
            found.append((SAME, _middle(before[i:j])))
            continue
        found.extend([(BEFORE, _start(before[i:j]))] if j > i else [])
        found.extend([(AFTER, _start(after[k:m]))] if m > k else [])
    return tuple(found)


def short(before: str, after: str) -> str:
    """`x < 0.40 m/s → 0.35 m/s` where one word differs, else `the one → the other`."""
    parts = _differences(before, after)
    different = [part for part in parts if not part[0]]
    if len(different) == 1:
        _, i, j, k, m = different[0]
        old, new = before[i:j].strip(), after[k:m].strip()
        if _is_word(old) and _is_word(new):
            rest = " …" if before[j:].strip() else ""
            return f"{_lead(before[:i])}{old} → {new}{rest}"
    first = different[0][1] if different else 0
    at = different[0][3] if different else 0
    return f"{_window(before, first)} → {_window(after, at)}"


def _differences(before: str, after: str) -> list[tuple[bool, int, int, int, int]]:
    """Stretches of characters of both texts, in their order, with whether they are the same."""
    left, right = _words(before), _words(after)
    if max(len(left), len(right)) > _MOST_WORDS:
        return [(before == after, 0, len(before), 0, len(after))]
    matcher = SequenceMatcher(None, [w for w, _ in left], [w for w, _ in right], autojunk=False)
    return [
        (
            op == "equal",
            _offset(left, i, before),
            _offset(left, j, before),
            _offset(right, k, after),
            _offset(right, m, after),
        )
        for op, i, j, k, m in matcher.get_opcodes()
    ]


def _offset(words: Sequence[tuple[str, int]], index: int, text: str) -> int:
    """Where a word begins; white space goes with the word before it."""
    return 0 if index == 0 else words[index][1] if index < len(words) else len(text)


def _words(text: str) -> list[tuple[str, int]]:
    """Each word, and where it begins."""
    found: list[tuple[str, int]] = []
    place = 0
    while len(found) <= _MOST_WORDS and (match := _WORD.search(text, place)):
        whole = match["number"] is None or _is_unit(match["unit"])
        place = match.end() if whole else match.end("number")
        found.append((text[match.start() : place], match.start()))
    return found


def _is_unit(word: str) -> bool:
    return units.unit(word) is not None or word.removesuffix("s") in {*NANOSECONDS, "tick"}


def _is_word(text: str) -> bool:
    words = _words(text)
    return len(words) == 1 and words[0][0] == text


def _lead(text: str) -> str:
    """The last words before a difference."""
    if len(text) <= _LEAD:
        return text
    end = text[-_LEAD:]
    return f"… {end.partition(' ')[2] or end}"


def _window(text: str, start: int) -> str:
    """The text, or what stands around a place in it where it is long; `none` for no text."""
    if len(text) <= _WHOLE:
        return text or "none"
    begin = max(0, start - _LEAD)
    before = "… " if begin else ""
    after = " …" if begin + _WHOLE < len(text) else ""
    return f"{before}{text[begin : begin + _WHOLE]}{after}"


def _middle(text: str) -> str:
    """What two texts share, without its middle where it is long."""
    return text if len(text) <= _WHOLE else f"{text[: _WHOLE // 2]} … {text[-_WHOLE // 2 :]}"


def _start(text: str) -> str:
    """What one of two texts has; of what is very long the beginning, and how much more there is."""
    left = len(text) - _LONGEST
    return text if left <= 0 else f"{text[:_LONGEST]} … (and {left} more characters)"
