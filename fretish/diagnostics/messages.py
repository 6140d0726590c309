"""The messages of diagnostics, from `[FNNN.messages.NAME]` in `fretish/diagnostics/codes/*.toml`.

The name of a message is unique among all codes, and gives its code, severity, text and help.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.fixes import Fix
from fretish.diagnostics.source import Span

_FILES = Path(__file__).parent / "codes"


@dataclass(frozen=True, slots=True)
class Message:
    """The text of one message, with placeholders such as `{topic}`."""

    code: Code
    message: str
    help: str = ""
    """The help text; empty: there is none, or the check gives it."""
    severity: Severity = Severity.ERROR


@cache
def code_tables(kind: str) -> dict[str, dict[str, Any]]:
    """Number of each code that begins with this digit → its table: cause, fix, messages..."""
    import tomllib  # Imported here to make the start faster.

    return tomllib.loads(_text(kind))


@cache
def _text(kind: str) -> str:
    (file,) = _FILES.glob(f"{kind}_*.toml")
    return file.read_text(encoding="utf-8")


@cache
def messages(kind: str) -> dict[str, Message]:
    """Name of a message → its text, for the codes that begin with this digit."""
    return {
        name: Message(
            code, row["message"], row.get("help", ""), Severity(row.get("severity", "error"))
        )
        for code in Code
        if code.number[1] == kind
        for name, row in code_tables(kind)[code.number].get("messages", {}).items()
    }


KINDS = tuple(dict.fromkeys(code.number[1] for code in Code))
"""The first digits of the codes; each has a file."""


def message(name: str) -> Message:
    """The message of that name. Only its file is parsed, because all of them take 20 ms.

    Raises:
        KeyError: there is no such message.
    """
    kind = next((kind for kind in KINDS if f".messages.{name}]" in _text(kind)), KINDS[0])
    return messages(kind)[name]


def diagnostic(
    name: str,
    span: Span | None = None,
    /,
    *,
    help: str | None = None,  # noqa: A002
    paste: str = "",
    subject: str = "",
    fix: Fix | None = None,
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
    )
