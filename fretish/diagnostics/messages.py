"""The messages of diagnostics, from `[FNNN.messages.NAME]` in `fretish/diagnostics/codes/*.toml`.

The name of a message is unique among all codes, and gives its code, severity, text and help.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.fixes import Fix
from fretish.diagnostics.source import Span

FILES = Path(__file__).parent / "codes"
"""The files of the tables, one for each first digit."""


@dataclass(frozen=True, slots=True)
class Message:
    """The text of one message, with placeholders such as `{topic}`."""

    code: Code
    message: str
    help: str = ""
    """The help text; empty: there is none, or the check gives it."""
    severity: Severity = Severity.ERROR


@cache
def code_table(code: Code) -> dict[str, Any]:
    """The table of a code: cause, fix, messages... Only its part is parsed: all take 20 ms."""
    import tomllib  # Imported here to make the start faster.

    text = _text(code.number[1])
    starts = [match for match in _HEADING.finditer(text) if match[1] == code.number]
    following = _HEADING.search(text, starts[0].end())
    part = text[starts[0].start() : following.start() if following else len(text)]
    table: dict[str, Any] = tomllib.loads(part)[code.number]
    return table


_HEADING = re.compile(r"^\[(F[0-9]{3})\]$", re.MULTILINE)


@cache
def _text(kind: str) -> str:
    """The file of the codes that begin with this digit."""
    (file,) = FILES.glob(f"{kind}_*.toml")
    return file.read_text(encoding="utf-8")


@cache
def messages(code: Code) -> dict[str, Message]:
    """Name of a message → its text, for all messages of a code."""
    return {
        name: Message(
            code, row["message"], row.get("help", ""), Severity(row.get("severity", "error"))
        )
        for name, row in code_table(code).get("messages", {}).items()
    }


@cache
def message(name: str) -> Message:
    """The message of that name.

    Raises:
        KeyError: there is no such message.
    """
    for kind in dict.fromkeys(code.number[1] for code in Code):
        before, heading, _ = _text(kind).partition(f".messages.{name}]\n")
        if heading:
            number = before.rpartition("[")[2]
            return messages(next(code for code in Code if code.number == number))[name]
    raise KeyError(name)


def diagnostic(
    name: str,
    span: Span | None = None,
    /,
    *,
    help: str | None = None,  # noqa: A002
    paste: str = "",
    subject: str = "",
    fix: Fix | None = None,
    related: tuple[Span, ...] = (),
    **values: object,
) -> Diagnostic:
    """The diagnostic with the message of that name.

    Args:
        name: the name of the message in `fretish/diagnostics/codes/*.toml`.
        span: the place of the mistake, if it has one.
        help: the help text, if it depends on more than the values; without any, that of the fix.
        paste: lines that the help says to paste into a file.
        subject: the topic or hazard of a warning, by which it can be accepted.
        fix: the fix as a value, if it replaces a span by a text.
        related: other places that the message is about.
        values: the value of each placeholder, inserted as it is.

    Raises:
        KeyError: there is no such message, or a placeholder has no value.
    """
    found = message(name)
    if help is None:
        help = found.help.format_map(values) or (fix.help if fix else None)  # noqa: A001
    return Diagnostic(
        found.code,
        found.message.format_map(values),
        span,
        help,
        found.severity,
        paste,
        subject,
        fix=fix,
        related=related,
    )
