"""Parse TOML, and find the spans of keys and values."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import tomli_w

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, did_you_mean
from fretish.diagnostics.source import Span
from fretish.reading.limits import with_budget

_VALUE = re.compile(
    r"""["']?[ \t]*=[ \t]*(?P<value>
        "(?:[^"\\\n]|\\.)*"            # a text
      | '[^'\n]*'
      | \{[^}\n]*\}                    # an inline table
      | \[[^\]\n]*\][^#\n]*          # a list, perhaps of lists
      | [^#\n]*                       # anything else on the line
    )""",
    re.VERBOSE | re.MULTILINE,
)

_HEADER = re.compile(r"^[ \t]*\[", re.MULTILINE)
_PART = re.compile(
    r"""[ \t]*(?P<name>"(?P<text>[^"\n]*)"|'(?P<literal>[^'\n]*)'|(?P<bare>[\w-]+))
        [ \t]*(?P<then>[\].])""",
    re.VERBOSE,
)
"""A part of the name in a header, and whether another part follows."""
_MOST_PARTS = 16
"""The largest number of parts of a header that are used."""


@dataclass(frozen=True, slots=True)
class _Header:
    """A header `[a.b]`, or a prefix of its name."""

    name: tuple[int, int]
    """Start and end of the name."""
    table: tuple[int, int]
    """Start and end of the table: from the header to the next one."""


@dataclass(frozen=True, slots=True)
class Tables:
    """A TOML text and its values, with the spans of keys and values."""

    text: Span
    data: Mapping[str, Any]

    def place(self, *path: str) -> Span:
        """The span of the last key of the path; the start of the text if it is not found."""
        header = _headers(self.text.text).get(path)
        if header is not None:
            return self.text.part(*header.name)
        *tables, key = path
        start, end = self._table(tables) or self._inline(tables)
        match = _key(key).search(self.text.text, start, end)
        if match is None and tables:
            return self.place(*tables)
        return self.text.part(*match.span("key")) if match else self.text.part(0, 0)

    def value(self, *path: str) -> Span:
        """The span of the value of the last key of the path, up to the end of its line."""
        key = self.place(*path)
        match = _VALUE.match(key.source.text, key.end, self.text.end)
        if match is None:
            return key
        start = match.start("value")
        return Span(key.source, start, start + len(match["value"].rstrip()))

    def _inline(self, tables: list[str]) -> tuple[int, int]:
        """Start and end of an inline table."""
        span = self.value(*tables)
        if not span.text.startswith("{"):
            return 0, 0
        return span.start - self.text.start, span.end - self.text.start

    def _table(self, tables: Iterable[str]) -> tuple[int, int] | None:
        header = _headers(self.text.text).get(tuple(tables))
        return None if header is None else header.table


@lru_cache(8)
def _headers(text: str) -> Mapping[tuple[str, ...], _Header]:
    """Path → the first header that has or begins with this path; the empty path is the root."""
    openings = [match.span() for match in _HEADER.finditer(text)]
    ends = [start for start, _ in openings[1:]] + [len(text)]
    headers: dict[tuple[str, ...], _Header] = {}
    headers[()] = _Header((0, 0), (0, openings[0][0] if openings else len(text)))
    for (_, begin), end in zip(openings, ends, strict=False):
        path: tuple[str, ...] = ()
        part = first = _PART.match(text, begin)
        while part is not None and first is not None and len(path) < _MOST_PARTS:
            path = (*path, part["text"] or part["literal"] or part["bare"] or "")
            name = first.start("name"), part.end("name")
            headers.setdefault(path, _Header(name, (part.end(), end)))
            part = _PART.match(text, part.end()) if part["then"] == "." else None
    return headers


def header_places(text: str) -> Mapping[tuple[str, ...], tuple[int, int]]:
    """Path of a table → start and end of its name in the first header that begins with it."""
    return {path: header.name for path, header in _headers(text).items()}


def _key(key: str) -> re.Pattern[str]:
    return re.compile(
        rf"(?:^|[{{,])[ \t]*[\"']?(?P<key>{re.escape(key)})[\"']?[ \t]*=", re.MULTILINE
    )


def read(text: Span, code: Code, name: str) -> Tables | Diagnostic:
    """Parse TOML.

    Args:
        text: the span of the TOML.
        code: the code of the diagnostic if it is not TOML.
        name: the name of the text in the message: `the header`.
    """
    return with_budget(len(text.text), text.part(0, 0), lambda: _read(text, code, name))


def _read(text: Span, code: Code, name: str) -> Tables | Diagnostic:
    try:
        return Tables(text, tomllib.loads(text.text.replace("\r\n", "\n")))
    except (ValueError, RecursionError) as error:  # Or beyond Python's limits.
        match = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        at = _offset(text.text, int(match[1]), int(match[2])) if match else len(text.text)
        reason = re.sub(r" \(at [^)]*\)", "", str(error))
        return Diagnostic(
            code,
            f"{name} is not TOML: {reason[:1].lower()}{reason[1:]}",
            text.part(at, min(at + 1, len(text.text))),
            help='write `key = "value"`, one per line',
        )


def _offset(text: str, line: int, column: int) -> int:
    lines = text.split("\n")
    before = sum(len(part) + 1 for part in lines[: line - 1])
    return min(before + column - 1, len(text))


def as_key(name: str) -> str:
    """The name as a TOML key, in quotes if necessary."""
    return tomli_w.dumps({name: 0}).removesuffix(" = 0\n")


def unknown_key(code: Code, key: str, allowed: Iterable[str], span: Span, where: str) -> Diagnostic:
    """The diagnostic of an unknown key; it suggests a similar one, or lists all."""
    names = tuple(allowed)
    return Diagnostic(
        code,
        f"unknown field `{key}` in {where}",
        span,
        help=did_you_mean(key, names, f"the fields are {', '.join(names)}"),
    )
