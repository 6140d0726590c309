"""Render diagnostics as text and as JSON."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import StrEnum
from typing import Any

from fretish.diagnostics.diagnostic import Diagnostic, Severity
from fretish.diagnostics.source import Span

_TAB = " " * 4
_WIDTH = 160
"""The largest width of a source line; of a longer line the part around the caret is shown."""


class RenderedPart(StrEnum):
    """A part of a diagnostic that a terminal may display in its own colour."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"
    MESSAGE = "message"
    FRAME = "frame"
    HELP = "help"


Paint = Callable[[str, RenderedPart], str]
"""Function that adds the colour of a part to a text."""


def plain(text: str, part: RenderedPart) -> str:
    """The text without colour."""
    return text


def render(diagnostic: Diagnostic, paint: Paint = plain) -> str:
    """A diagnostic as several lines: code and message, position, source line with caret, help."""
    if diagnostic.accepted:
        return _accepted(diagnostic, paint)
    part = RenderedPart(diagnostic.severity.value)
    kind = "" if diagnostic.severity is Severity.ERROR else f" {diagnostic.severity.value}:"
    head = paint(f"{diagnostic.code.number}{kind}", part)
    lines = [f"{head} {paint(visible(diagnostic.message), RenderedPart.MESSAGE)}"]
    if diagnostic.span is not None:
        lines.extend(_place(diagnostic.span, paint, part))
    if diagnostic.help:
        lines.append(f"{paint('help:', RenderedPart.HELP)} {visible(diagnostic.help)}")
    if diagnostic.paste:
        lines += ["", *map(visible, diagnostic.paste.rstrip("\n").split("\n"))]
    return "\n".join(lines)


def _accepted(diagnostic: Diagnostic, paint: Paint) -> str:
    """An accepted warning: with the reason instead of the help, and without the source line."""
    head = paint(f"{diagnostic.code.number} accepted:", RenderedPart.NOTE)
    lines = [f"{head} {visible(diagnostic.message)}"]
    if diagnostic.span is not None:
        lines.append(_place(diagnostic.span, paint, RenderedPart.NOTE)[0])
    return "\n".join([*lines, f"reason: {visible(diagnostic.accepted)}"])


def render_all(diagnostics: Iterable[Diagnostic], paint: Paint = plain) -> str:
    """All diagnostics, separated by empty lines."""
    return "\n\n".join(render(diagnostic, paint) for diagnostic in diagnostics)


def as_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """The JSON `{code, severity, message, file, line, column, help}`; absent values are null.

    `help` ends with the lines to paste.
    """
    span = diagnostic.span
    help_ = "\n\n".join(text for text in (diagnostic.help, diagnostic.paste) if text)
    return {
        "code": diagnostic.code.number,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "file": span.source.name if span else None,
        "line": span.line if span else None,
        "column": span.column if span else None,
        "help": help_ or None,
    }


def _place(span: Span, paint: Paint, part: RenderedPart) -> list[str]:
    name = visible(span.source.name)
    arrow, bar = paint("  -->", RenderedPart.FRAME), paint("   |", RenderedPart.FRAME)
    if not span.source.text:
        return [f"{arrow} {name}"]
    line, column = span.line_text, span.column
    width = max(1, min(span.end, span.start + len(line) - column + 1) - span.start)
    start = 0 if column <= _WIDTH - 40 else column - 60
    window = line[start : start + _WIDTH]
    before = visible(window[: column - 1 - start])
    under = visible(window[column - 1 - start : column - 1 - start + width])
    after = visible(window[column - 1 - start + width :])
    return [
        f"{arrow} {name}:{span.line}:{column}",
        f"{bar} {before}{under}{after}".rstrip(),
        f"{bar} {' ' * len(before)}{paint('^' * max(1, len(under)), part)}",
    ]


def visible(text: str) -> str:
    """The text with control characters as escapes, so that they cannot affect the terminal."""
    return "".join(
        _TAB if character == "\t" else character if character.isprintable() else _escape(character)
        for character in text
    )


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")
