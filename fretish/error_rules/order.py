"""Errors in the order of a sentence's parts: misplaced, missing or repeated parts."""

from __future__ import annotations

import re

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import Fix, removal
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.error_rules.operators import JOIN
from fretish.error_rules.unexpected import Unexpected, not_fretish

_SIMPLE_TIMINGS = frozenset(
    {"IMMEDIATELY", "INITIALLY", "FINALLY", "EVENTUALLY", "ALWAYS", "NEVER"}
)
_DURATIONS = frozenset({"WITHIN", "FOR"})
_STOPS = frozenset({"UNTIL", "BEFORE", "AFTER"})
TIMINGS = _SIMPLE_TIMINGS | _DURATIONS | _STOPS
_SCOPES = frozenset({"IN", "DURING", "WHILE", "EXCEPT", "ONLY"})
_CONDITIONS = frozenset({"UPON", "WHEN", "WHERE", "IF", "UNLESS", "WHENEVER"})
_BEGINNINGS = _SCOPES | _CONDITIONS | {"BEFORE", "AFTER", "THE", "ID", "QUOTED"}
_AMOUNT = {"WITHIN": " N seconds", "FOR": " N seconds", "AFTER": " N seconds", "UNTIL": " p"}
_SHALL = re.compile(r"\bshall\b", re.IGNORECASE)
_SATISFY = re.compile(r"\bsatisfy\b", re.IGNORECASE)


def further_sentence(u: Unexpected) -> Diagnostic | None:
    """F117 if the text before the word is a sentence, and another sentence begins with the word."""
    if not u.expects("$END") or u.lexeme.kind not in _BEGINNINGS:
        return None
    if u.follows("_DOT") and u.lexeme.kind not in ("ID", "QUOTED"):
        return diagnostic("second_sentence", u.lexeme.span)
    ended = u.follows("_DOT") or "\n" in _space_before(u)
    named = u.lexeme.kind in ("ID", "QUOTED")
    direct = named and re.match(r'("[^"\n]+"|[\w.%]+)\s+shall\b', u.rest.text, re.IGNORECASE)
    plain = ended or not (named or u.lexeme.kind in TIMINGS)
    if not direct and not (plain and _SHALL.search(u.rest.text)):
        return None
    return diagnostic("second_sentence", u.lexeme.span)


def _space_before(u: Unexpected) -> str:
    """The white space before the word."""
    read = u.text_before.text
    return read[len(read.rstrip()) :]


def part_after_response(u: Unexpected) -> Diagnostic | None:
    """F101 for a timing, condition or scope after the response."""
    if not u.expects("$END") or (satisfy := _SATISFY.search(u.text_before.text)) is None:
        return None
    if u.lexeme.kind in TIMINGS:
        return _timing_after_response(u, satisfy)
    if u.lexeme.kind not in _CONDITIONS | _SCOPES:
        return None
    part = "condition" if u.lexeme.kind in _CONDITIONS else "scope"
    words = f"move it to the front: `{_one_line(u.rest)} the COMPONENT shall ...`"
    if u.lexeme.kind == "UNLESS":
        words += "; or, for an exception, write `p | q` as the response"
    return not_fretish(f"the {part} must stand before the component", u.lexeme.span, words)


def _timing_after_response(u: Unexpected, satisfy: re.Match[str]) -> Diagnostic:
    message = "the timing must stand before `satisfy`"
    if _has_timing(u.text_before.text[: satisfy.start()]):
        return not_fretish(message, u.lexeme.span, _ONE_TIMING)
    response = u.text_before.text[satisfy.end() :].strip()
    moved = Span(u.text.source, u.text.start + satisfy.start(), u.rest.end)
    return not_fretish(message, u.lexeme.span, Fix(moved, f"{u.rest.text} satisfy {response}"))


_ONE_TIMING = "a sentence has only one timing: write a requirement for each timing"


def _has_timing(before_satisfy: str) -> bool:
    return re.search(r"\bshall\b,?\s*\Z", before_satisfy, re.IGNORECASE) is None


def _one_line(span: Span) -> str:
    return " ".join(span.text.split())


def misplaced_part(u: Unexpected) -> Diagnostic | None:
    """F101 for a misplaced timing or probability."""
    if u.lexeme.kind in _SIMPLE_TIMINGS | _DURATIONS and u.follows("SATISFY"):
        return _timing_after_satisfy(u)
    if u.lexeme.kind == "WITH" and u.expects("SHALL", "WHENEVER"):
        return diagnostic("misplaced_probability", u.lexeme.span)
    if u.lexeme.kind == "PROBABILITY":
        fix = Fix(u.lexeme.span.part(0, 0), "with ", is_safe=u.expects("WITH"))
        words = "write `with probability ...`"
        message = "`with` is missing before `probability`"
        return not_fretish(message, u.lexeme.span, fix if fix.is_safe else words, words)
    return None


_TIMING = re.compile(r"(?:within|for)\s+\d+\s+\w+|[a-z]+", re.IGNORECASE)


def _timing_after_satisfy(u: Unexpected) -> Diagnostic:
    """F101 for a timing after `satisfy`: `satisfy eventually p`."""
    assert u.previous is not None
    word = f"{u.lexeme.word}{_AMOUNT.get(u.lexeme.kind, '')}"
    message, words = "the timing must stand before `satisfy`", f"write `{word} satisfy ...`"
    start = u.previous.span.start
    match = _TIMING.match(u.rest.text)
    if match is None or (match[0] == u.lexeme.word) != (u.lexeme.kind in _SIMPLE_TIMINGS):
        return not_fretish(message, u.lexeme.span, words)
    if _has_timing(u.text.source.text[u.text.start : start]):
        return not_fretish(message, u.lexeme.span, _ONE_TIMING)
    end = u.lexeme.span.start + match.end()
    is_safe = JOIN.search(u.rest.text) is None  # Else it may apply to one part.
    fix = Fix(Span(u.text.source, start, end), f"{match[0]} {u.previous.word}", is_safe)
    return not_fretish(message, u.lexeme.span, fix, f"write `{match[0]} satisfy ...`")


def wrong_timing(u: Unexpected) -> Diagnostic | None:
    """F101 for a second timing, or for `not` in the position of the timing."""
    if not u.expects("SATISFY"):
        return None
    if u.lexeme.kind == "NOT":
        return _not(u)
    if u.lexeme.kind not in TIMINGS or u.expects(u.lexeme.kind):
        return None
    return diagnostic("second_timing", u.lexeme.span)


def _not(u: Unexpected) -> Diagnostic:
    """F101 for `shall not satisfy p` or `shall never not satisfy p`."""
    message = "`not` cannot stand before `satisfy`"
    if u.previous is not None and u.follows("ALWAYS", "NEVER"):
        fix = Fix(u.previous.span.to(u.lexeme.span), "never" if u.follows("ALWAYS") else "always")
        return not_fretish(message, u.lexeme.span, fix)
    words = "negate the response: `satisfy !(p)`"
    if u.follows("SHALL"):
        words = "write `shall never satisfy p`, or negate the response: `satisfy !(p)`"
    return not_fretish(message, u.lexeme.span, words)


_PARTS = {
    "stop condition": frozenset({"UNTIL", "BEFORE", "AFTER"}),
    "response": frozenset({"SATISFY"}),
    "condition": _CONDITIONS,
    "mode": frozenset({"IN", "DURING"}),
    "expression": frozenset({"WHILE"}),
}


def missing_part(u: Unexpected) -> Diagnostic | None:
    """F101 for a key word without the part that must follow it, or written twice."""
    if u.previous is None or not u.expects("ID"):
        return None
    word, kind = u.previous.word, u.previous.kind
    if u.lexeme.word.lower() == word.lower() and word.isalpha():
        leave = removal(u.lexeme.span, is_safe=True)
        return diagnostic("word_written_twice", u.lexeme.span, word=word, fix=leave)
    part = next((part for part, kinds in _PARTS.items() if kind in kinds), "")
    begins = u.lexeme.kind in ("SATISFY", "SHALL") or _is_component(u.rest.text)
    if not part or not (u.lexeme.at_end or begins):
        return None
    if part == "stop condition" and not _SHALL.search(u.text_before.text):
        part = "mode"  # `before` without `shall` before it begins a scope.
    return diagnostic("part_missing", u.lexeme.span, part=part, word=word)


def _is_component(rest: str) -> bool:
    return re.match(r"the\s+[\w.%]+\s+shall\b", rest, re.IGNORECASE) is not None


_PROSE = re.compile(r"the\s+(?P<words>[a-z]\w*(?:\s+[a-z]\w*)*)\s*(?P<end>,|\Z|[^\w\s])", re.I)
_JOINED = re.compile(r"\b(?:and|or)\b", re.IGNORECASE)
_SMALL = frozenset({"the", "a", "an", "is", "are", "of", "has", "have", "been"})


def superfluous_article(u: Unexpected) -> Diagnostic | None:
    """F101 for `the` before a name that is not the component."""
    if u.lexeme.kind != "THE" or not u.expects("ID") or u.expects("SHALL"):
        return None
    message, words = "an expression cannot contain `the`", _words(u)
    if len(words) == 1:
        return not_fretish(message, u.lexeme.span, removal(u.lexeme.span, is_safe=True))
    name = "_".join(word for word in words if word.lower() not in _SMALL)
    example = f"such as `{name}` for these words, " if name else ""
    return not_fretish(
        message, u.lexeme.span, f"write a name, {example}or a comparison: `battery < 20`"
    )


def _words(u: Unexpected) -> list[str]:
    """The plain words after the article, up to the next part of the sentence."""
    prose = _PROSE.match(u.rest.text)
    words = _JOINED.split(prose["words"])[0].split() if prose is not None else []
    lower = [word.lower() for word in words]
    if "shall" in lower:  # The words before it are the component and its article.
        at = max(lower.index("shall") - 1, 0)
        words = words[: at - 1 if at and lower[at - 1] == "the" else at]
    elif "satisfy" in lower:
        words = words[: lower.index("satisfy")]
    return words
