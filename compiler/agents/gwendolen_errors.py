"""Diagnostics of texts that are not Gwendolen, or use Gwendolen beyond the model."""

from __future__ import annotations

import re

from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from fretish.diagnostics.diagnostic import Diagnostic, DiagnosticError, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span

HEADINGS = (":Initial Beliefs:", ":Initial Goals:", ":Plans:")
"""The required sections, in order."""
_ALL_HEADINGS = (":name:", ":Reasoning Rules:", *HEADINGS)


class TrapError(DiagnosticError):
    """The text contains something invalid; the exception carries the diagnostic."""


def beyond(feature: str, span: Span) -> TrapError:
    """The exception for F611."""
    return TrapError(diagnostic("beyond_model", span, feature=feature))


_COMMENTS = "comments are `// ...` and `/* ... */` only"


def unexpected(error: UnexpectedInput, source: Source) -> Diagnostic:
    """F610 or F611 for a text that the grammar rejects."""
    token = error.token if isinstance(error, UnexpectedToken) else None
    if token is not None and token.type == "$END":
        length = len(source.text.rstrip())
        end = source.span(length, length)
        return diagnostic("agent_file_ends", end, help=_wanted(error))
    at = error.pos_in_stream or 0
    span = source.span(at, at + (len(token) if token is not None else 1))
    if isinstance(error, UnexpectedToken) and _follows_rules(error):
        return diagnostic("beyond_model", span, feature="a reasoning rule")
    return (
        _sign_of_more(source, at)
        or _mistake(source, at)
        or diagnostic("unexpected_in_agent", span, place=span.text, help=_wanted(error))
    )


_MORE = re.compile(
    r"""(?P<a_comparison> (?:[A-Z_]\w* | [0-9]+(?:\.[0-9]+)?) \s* (?:< (?!-) | == | [-+*/]) )
    | (?P<a_list> \[)
    | (?P<a_word_for_messages_or_locks> \.(?:send|received|sent|lock|plan|constraint|n|x)\b)""",
    re.VERBOSE,
)
"""Features of MCAPL's grammar that `gwendolen.lark` lacks."""


def _sign_of_more(source: Source, at: int) -> Diagnostic | None:
    match = _MORE.match(source.text, at)
    if match is None:
        return None
    feature = str(match.lastgroup).replace("_", " ")
    return diagnostic("beyond_model", source.span(at, match.end()), feature=feature)


_NAME_SECTION = re.compile(r":name:\s*\w+\Z")
_HEADING = re.compile(r":[A-Za-z][A-Za-z ]*:")


def _mistake(source: Source, at: int) -> Diagnostic | None:
    """F610 for a common mistake of users, if one stands at this position."""
    rest = source.text[at:]
    span = source.span(at, at + 1)
    if rest.startswith(("#", "%")):
        return diagnostic("bad_comment", span, character=rest[0], help=_COMMENTS)
    if rest.startswith("/*"):
        return diagnostic("unclosed_comment", span)
    if rest.startswith("-") and _NAME_SECTION.search(source.text[:at]):
        fix = "an agent's name has letters, digits and `_` only"
        return diagnostic("hyphen_in_agent_name", span, help=fix)
    heading = _HEADING.match(rest)
    if heading is None or heading[0] in _ALL_HEADINGS:
        return None
    return diagnostic(
        "unknown_heading",
        source.span(at, at + heading.end()),
        heading=heading[0],
        help=did_you_mean(heading[0], _ALL_HEADINGS, f"headings are {', '.join(HEADINGS)}"),
    )


def _follows_rules(error: UnexpectedToken) -> bool:
    before = (error.token_history or [None])[-1]
    return before is not None and before.type == "RULES"


def _wanted(error: UnexpectedInput) -> str:
    """The symbols that the grammar expects at the error, in the words of the language."""
    accepted: set[str] = set()
    if isinstance(error, UnexpectedToken):
        accepted = set(error.accepts or error.expected)
    elif isinstance(error, UnexpectedCharacters):
        accepted = set(error.allowed or ())
    words = [word for name, word in _SPOKEN.items() if name in accepted]
    return f"write {' or '.join(words)}" if words else "MCAPL would leave it out in silence"


_SPOKEN = {
    "GWENDOLEN": "`GWENDOLEN`",
    "NAME": "`:name:`",
    "BELIEFS": "`:Initial Beliefs:`",
    "GOALS": "`:Initial Goals:`",
    "PLANS": "`:Plans:`",
    "PLUS": "`+`",
    "MINUS": "`-`",
    "CONST": "a name that begins with a small letter",
    "TRUE": "`True`",
    "BELIEVES": "`B b`",
    "_COLON": "`:`",
    "_LEFT_CURLY": "`{`",
    "_RIGHT_CURLY": "`}`",
    "ARROW": "`<-`",
    "_SEMICOLON": "`;`",
    "COMMA": "`,`",
    "_RIGHT": "`)`",
}
