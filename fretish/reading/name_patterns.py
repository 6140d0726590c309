"""Match the end of a path with a pattern such as `{scenario}-{seed}.mcap`.

`{name}` matches one or more characters, `*` any number, neither a slash. From left to right, each
matches as much as possible. The time is proportional to the length of the pattern times the path.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

from fretish.classes.frozen import dataclass

_TOKEN = re.compile(r"\{(?P<name>[A-Za-z][A-Za-z0-9_-]*)\}|(?P<star>\*)|(?P<text>[^{}*]+)")
_LONGEST, _LONGEST_PART = 200, 1000
"""The largest number of characters of a pattern, and of a part of a path."""


@dataclass(frozen=True, slots=True)
class _Token:
    text: str
    """The literal text; the name of a `{name}`; empty for `*`."""
    least: int | None = None
    """The least number of matched characters; None for a literal text."""


_Part = tuple[_Token, ...]


def names(pattern: str) -> tuple[str, ...] | str:
    """The names in a pattern, or the reason why it is wrong."""
    parts = _parts(pattern)
    if isinstance(parts, str):
        return parts
    return tuple(token.text for part in parts for token in part if token.least == 1)


def match(pattern: str, path: str) -> Mapping[str, str] | None:
    """Name in the pattern → the text it matches in a path; None if the path does not match.

    Args:
        pattern: a correct pattern; it is matched with as many last parts of the path as it has.
        path: a path with slashes.
    """
    parts = _parts(pattern)
    assert not isinstance(parts, str), parts
    texts = path.split("/")[-len(parts) :]
    if len(texts) < len(parts) or any(len(text) > _LONGEST_PART for text in texts):
        return None
    values: dict[str, str] = {}
    for part, text in zip(parts, texts, strict=True):
        part_values = _match(part, text)
        if part_values is None:
            return None
        values |= part_values
    return values


@lru_cache(maxsize=64)
def _parts(pattern: str) -> tuple[_Part, ...] | str:
    """The parts between slashes, or the reason why the pattern is wrong."""
    if not 0 < len(pattern) <= _LONGEST:
        return f"a pattern has 1 to {_LONGEST} characters"
    parts = []
    for written in pattern.split("/"):
        tokens = [_token(token_match) for token_match in _TOKEN.finditer(written)]
        if not tokens or sum(len(token_match[0]) for token_match in _TOKEN.finditer(written)) < len(
            written
        ):
            return "between slashes only text, `*` and `{name}` are allowed"
        parts.append(tuple(tokens))
    named = [token.text for part in parts for token in part if token.least == 1]
    twice = next((name for name in named if named.count(name) > 1), None)
    return f"`{{{twice}}}` is there twice" if twice else tuple(parts)


def _token(token_match: re.Match[str]) -> _Token:
    if token_match["text"] is not None:
        return _Token(token_match["text"])
    return _Token(token_match["name"] or "", 0 if token_match["star"] else 1)


def _match(part: _Part, text: str) -> dict[str, str] | None:
    fits = _fits(part, text)
    if not fits[0][0]:
        return None
    values, at = {}, 0
    for token, after in zip(part, fits[1:], strict=True):
        if token.least is None:
            at += len(token.text)
            continue
        end = max(end for end in range(at + token.least, len(text) + 1) if after[end])
        if token.least:
            values[token.text] = text[at:end]
        at = end
    return values


def _fits(part: _Part, text: str) -> list[list[bool]]:
    """Row i, column k: whether the tokens from i on match the whole text from k on."""
    size = len(text)
    rows = [[False] * size + [True]]
    for token in reversed(part):
        after, row = rows[0], [False] * (size + 1)
        if token.least is None:
            for k in range(size - len(token.text) + 1):
                row[k] = after[k + len(token.text)] and text.startswith(token.text, k)
        else:
            later = False
            for k in range(size - token.least, -1, -1):
                later = later or after[k + token.least]
                row[k] = later
        rows.insert(0, row)
    return rows
