"""Word-by-word difference of two texts; a number and its unit are one word."""

from __future__ import annotations

import re
from difflib import SequenceMatcher
from functools import lru_cache

from fretish import units
from fretish.clock import NANOSECONDS

SAME, BEFORE, AFTER = "same", "before", "after"
Segment = tuple[str, str]
"""`SAME`, `BEFORE` or `AFTER`, and a piece of both texts or of one of them."""
_TOKEN = re.compile(
    r"(?P<number>[+-]?[0-9][0-9.]*)[ \u00a0\u202f]"
    r"(?P<unit>%|[A-Za-z]\w{0,12}(?:/[A-Za-z]\w{0,3})?)(?!\w)"
    r"|[()\[\]{},;]|[^\s()\[\]{},;]+|\s+"
)
_MOST_TOKENS = 300
"""Longer texts are compared only at both ends, because the time grows with the square."""
_CACHED = 2**12
"""Cached, because one change is shown for several requirements and runs."""
_LEAD, _WHOLE, _LONGEST = 40, 240, 2000
"""Maximum characters: beside a difference, of a text on a line, and of a segment."""


@lru_cache(maxsize=_CACHED)
def segments(before: str, after: str) -> tuple[Segment, ...]:
    """Segments of both texts: shared pieces, pieces of `before` only, pieces of `after` only."""
    parts: list[Segment] = []
    for same, old, new, _ in _stretches(before, after):
        if same:
            parts.append((SAME, _middle(old)))
            continue
        parts.extend([(BEFORE, _start(old))] if old else [])
        parts.extend([(AFTER, _start(new))] if new else [])
    return tuple(parts)


@lru_cache(maxsize=_CACHED)
def short(before: str, after: str) -> str:
    """`x < 0.40 m/s → 0.35 m/s` if one word differs, else `before → after`."""
    different = [stretch for stretch in _stretches(before, after) if not stretch[0]]
    if len(different) == 1:
        _, old, new, (at, _) = different[0]
        if _is_word(old) and _is_word(new):
            rest = " …" if before[at + len(old) :].strip() else ""
            return f"{_lead(before[:at])}{old} → {new}{rest}"
    first = different[0][3] if different else (0, 0)
    return f"{_window(before, first[0])} → {_window(after, first[1])}"


_Stretch = tuple[bool, str, str, tuple[int, int]]
"""(whether both texts are equal here, text before, text after, offset in each)."""


def _stretches(before: str, after: str) -> list[_Stretch]:
    """Both texts as aligned pieces; white space between two differences belongs to them."""
    left, right = _tokens(before), _tokens(after)
    if max(len(left), len(right)) > _MOST_TOKENS:
        return _around(before, after)
    stretches: list[_Stretch] = []
    matcher = SequenceMatcher(None, left, right, autojunk=False)
    for op, i, j, k, m in matcher.get_opcodes():
        old, new = "".join(left[i:j]), "".join(right[k:m])
        same = op == "equal"
        if stretches and not stretches[-1][0] and (not same or (old.isspace() and j < len(left))):
            _, older, newer, place = stretches.pop()
            stretches.append((False, older + old, newer + new, place))
        else:
            places = (sum(map(len, left[:i])), sum(map(len, right[:k])))
            stretches.append((same, old, new, places))
    return stretches


def _around(before: str, after: str) -> list[_Stretch]:
    """Pieces of long texts: the common beginning, the difference, the common end."""
    if before == after:
        return [(True, before, after, (0, 0))]
    start = before.rfind(" ", 0, _shared(before, after)) + 1
    rest = min(len(before), len(after)) - start
    end = min(rest, _shared(before[::-1], after[::-1]))
    space = before.find(" ", len(before) - end)
    end = len(before) - space if space >= 0 else 0
    old, new = before[start : len(before) - end], after[start : len(after) - end]
    tail = before[len(before) - end :]
    stretches: list[_Stretch] = [(True, before[:start], before[:start], (0, 0))] if start else []
    stretches += [(False, old, new, (start, start))] if old or new else []
    stretches += [(True, tail, tail, (start + len(old), start + len(new)))] if end else []
    return stretches


def _shared(before: str, after: str) -> int:
    """The length of the common beginning."""
    pairs = enumerate(zip(before, after, strict=False))
    return next((i for i, (a, b) in pairs if a != b), min(len(before), len(after)))


def _tokens(text: str) -> list[str]:
    """Words and the white space between them; joined, they are the whole text."""
    tokens: list[str] = []
    start = 0
    while start < len(text) and len(tokens) <= _MOST_TOKENS:
        match = _TOKEN.match(text, start)
        assert match is not None, "a character is white space, a sign, or part of a word"
        known = match["number"] is None or _is_unit(match["unit"])
        end = match.end() if known else match.end("number")
        tokens.append(text[start:end])
        start = end
    return tokens


def _is_unit(word: str) -> bool:
    return units.unit(word) is not None or word.removesuffix("s") in {*NANOSECONDS, "tick"}


def _is_word(text: str) -> bool:
    """Whether the text is one word and not punctuation."""
    return len(_tokens(text)) == 1 and any(map(str.isalnum, text))


def _lead(text: str) -> str:
    """The last words before a difference."""
    if len(text) <= _LEAD:
        return text
    end = text[-_LEAD:]
    return f"… {end.partition(' ')[2] or end}"


def _window(text: str, start: int) -> str:
    """The text, or the part around `start` if the text is long."""
    if len(text) <= _WHOLE:
        return text
    begin = max(0, start - _LEAD)
    before = "… " if begin else ""
    after = " …" if begin + _WHOLE < len(text) else ""
    return f"{before}{text[begin : begin + _WHOLE]}{after}"


def _middle(text: str) -> str:
    """A shared piece, without its middle if it is long."""
    return text if len(text) <= _WHOLE else f"{text[: _WHOLE // 2]} … {text[-_WHOLE // 2 :]}"


def _start(text: str) -> str:
    """A differing piece; if it is very long, its beginning and the number of other characters."""
    left = len(text) - _LONGEST
    return text if left <= 0 else f"{text[:_LONGEST]} … (and {left} more characters)"
