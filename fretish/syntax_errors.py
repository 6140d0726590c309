"""What keeps a text from being FRETish, and what to write instead, in the words of FRETish.

Each rule looks at the first word that does not fit, the word before it, and what would have fitted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fretish.diagnostics.diagnostic import Code, Diagnostic, suggestion
from fretish.diagnostics.source import Span
from fretish.keywords import KEYWORDS
from fretish.units import unknown_unit


@dataclass(frozen=True, slots=True)
class Lexeme:
    """A word of the text, and its kind in the grammar: `ID`, `NUMBER`, `SATISFY`, ..."""

    kind: str
    span: Span

    @property
    def word(self) -> str:
        """As written."""
        return self.span.text

    @property
    def at_end(self) -> bool:
        """Whether it is not a word but the end of the text."""
        return self.kind == "$END"


@dataclass(frozen=True, slots=True)
class Unexpected:
    """The first word that does not fit."""

    lexeme: Lexeme
    before: Lexeme | None
    accepts: frozenset[str]
    """The kinds of word that would have fitted."""
    text: Span
    """The whole sentence."""

    def wants(self, *kinds: str) -> bool:
        """Whether a word of any of the kinds would have fitted."""
        return not self.accepts.isdisjoint(kinds)


_GROUPS: tuple[tuple[str, frozenset[str]], ...] = (
    ("a scope (`in m`, `before m`, ...)", frozenset({"DURING", "EXCEPT", "ONLY", "WHILE"})),
    ("a condition (`whenever p`, `when p`, ...)", frozenset({"WHENEVER", "UPON"})),
    ("`shall`", frozenset({"SHALL"})),
    ("a timing (`eventually`, `within 3 seconds`, ...)", frozenset({"EVENTUALLY", "WITHIN"})),
    ("`satisfy`", frozenset({"SATISFY"})),
    ("a name", frozenset({"ID"})),
    ("a number", frozenset({"NUMBER"})),
    ("a comparison (`<`, `>=`, ...)", frozenset({"LESS"})),
    ("an operator (`&`, `|`, `->`, ...)", frozenset({"_AMPERSAND", "_IMPLIES"})),
    ("`then`", frozenset({"THEN"})),
    ("`true` or `false`", frozenset({"IS_TRUE"})),
    ("`timepoint`", frozenset({"TIMEPOINT"})),
    ("`mode`", frozenset({"MODE"})),
    ("`probability`", frozenset({"PROBABILITY"})),
    ("`occurrence of`", frozenset({"OCCURRENCE"})),
    ("`,`", frozenset({"_COMMA"})),
    ("`)`", frozenset({"RPAR"})),
    ("the end of the sentence", frozenset({"$END"})),
)
"""What the grammar may expect, in the words of a reader, in the order of a sentence."""

_UNITS = ("TICK", "MICROSECOND", "MILLISECOND", "SECOND", "MINUTE", "HOUR")
_UNIT_NAMES = {
    "ms": "milliseconds", "msec": "milliseconds", "us": "microseconds", "usec": "microseconds",
    "s": "seconds", "min": "minutes", "mins": "minutes", "h": "hours", "hr": "hours",
    "step": "ticks", "steps": "ticks", "cycle": "ticks", "cycles": "ticks",
    "timepoint": "ticks", "timepoints": "ticks",
}  # fmt: skip
_STARTS_EXPRESSION = frozenset(
    {"ID", "QUOTED", "NUMBER", "TRUE", "FALSE", "_BANG", "LPAR", "MINUS"}
)
_OPERATORS = {"not": "!", "true": "true", "false": "false"}
_TIMINGS = frozenset(
    {"IMMEDIATELY", "INITIALLY", "FINALLY", "EVENTUALLY", "ALWAYS", "NEVER", "WITHIN", "FOR"}
)
_COMPARISONS = ("LESS", "AT_MOST", "GREATER", "AT_LEAST", "EQUAL", "UNEQUAL")
_AMOUNT = {"WITHIN": " N seconds", "FOR": " N seconds"}
_SHALL = ("should", "must", "will", "shal", "has", "needs")


def explain(unexpected: Unexpected) -> Diagnostic:
    """The diagnostic of the first rule that applies; the last rule always does."""
    for rule in _RULES:
        diagnostic = rule(unexpected)
        if diagnostic is not None:
            return diagnostic
    return _does_not_fit(unexpected)


def no_sentence(text: Span) -> Diagnostic:
    """F106."""
    return Diagnostic(
        Code.NO_SENTENCE,
        "there is no sentence here",
        text.part(0, 0),
        help="write `the COMPONENT shall eventually satisfy RESPONSE`",
    )


def unknown_character(text: Span, at: int) -> Diagnostic:
    """F101 for a character that no word of FRETish has."""
    span = text.part(at, at + 1)
    mends = {
        "[": 'quote a name with brackets: `"a[3]"`',
        "_": "a name begins with a letter",
        '"': "close the quotes, or leave them out",
        "\u201c": 'use straight quotes: `"`',
        "\u201d": 'use straight quotes: `"`',
        "'": 'use double quotes: `"`',
        "\u2264": "write `<=`",
        "\u2265": "write `>=`",
        "\u2260": "write `!=`",
        "\u2192": "write `->`",
        "\u2227": "write `&`",
        "\u2228": "write `|`",
        "\u00ac": "write `!`",
    }
    return Diagnostic(
        Code.NOT_FRETISH,
        f"`{span.text}` is no character of FRETish",
        span,
        help=mends.get(span.text, "names are letters, digits, `_`, `.` and `%`"),
    )


def bad_duration(span: Span) -> Diagnostic:
    """F108 for a number that is negative, broken or in scientific notation."""
    if span.text.startswith("-"):
        return Diagnostic(
            Code.BAD_DURATION,
            "a duration cannot be negative",
            span,
            help="count from the trigger on: 0 is the trigger itself",
        )
    if span.text.isdigit():
        return Diagnostic(
            Code.BAD_DURATION,
            "a duration has at most 15 digits",
            span,
            help="count a larger unit",
        )
    return Diagnostic(
        Code.BAD_DURATION,
        f"a duration counts whole units, and `{span.text}` is no whole number",
        span,
        help="count a smaller unit, in whole numbers: 500 milliseconds, not 0.5 seconds",
    )


def bad_probability(span: Span) -> Diagnostic:
    """F110."""
    return Diagnostic(
        Code.BAD_PROBABILITY,
        f"no run can have the probability `{span.text}`",
        span,
        help="a probability lies between 0 and 1; `> 1` and `< 0` can never hold",
    )


# Rules, the most specific first ----------------------------------------------------------------


def _unit(u: Unexpected) -> Diagnostic | None:
    if not u.wants(*_UNITS):
        return None
    mend = "write ticks, microseconds, milliseconds, seconds, minutes or hours: `within 3 seconds`"
    if u.lexeme.kind != "ID":
        return Diagnostic(Code.BAD_DURATION, "a duration needs a unit", u.lexeme.span, help=mend)
    near = _UNIT_NAMES.get(u.lexeme.word.lower()) or suggestion(
        u.lexeme.word, [word for word in KEYWORDS if word.endswith("s")], cutoff=0.72
    )
    return Diagnostic(
        Code.BAD_DURATION,
        f"a duration needs a unit, and `{u.lexeme.word}` is none",
        u.lexeme.span,
        help=f"did you mean `{near}`?" if near else mend,
    )


def _measured(u: Unexpected) -> Diagnostic | None:
    """A name behind a number stands where a unit may stand."""
    if u.before is None or u.before.kind != "NUMBER" or u.lexeme.kind != "ID":
        return None
    return unknown_unit(u.lexeme.word, u.lexeme.span)


def _number(u: Unexpected) -> Diagnostic | None:
    """A duration is a literal."""
    if u.before is None or u.before.kind not in ("WITHIN", "FOR", "AFTER"):
        return None
    if not u.accepts <= {"NUMBER", "MINUS"}:
        return None
    return Diagnostic(
        Code.BAD_DURATION,
        "a duration begins with a number in digits",
        u.lexeme.span,
        help=f"write such as `{u.before.word} N seconds`",
    )


def _other_language(u: Unexpected) -> Diagnostic | None:
    """Operators as other languages spell them."""
    before = u.before.word if u.before is not None else ""
    doubled = {"&": "&", "|": "|", "=": "="}.get(u.lexeme.word) if before == u.lexeme.word else None
    if doubled is not None and u.before is not None:
        span = u.before.span.to(u.lexeme.span)
        return _instead(span, doubled)
    if u.lexeme.kind in ("AND", "OR"):
        return _word_for_operator(u)
    spelt = _OPERATORS.get(u.lexeme.word.lower())
    if spelt is None or not u.wants("ID", "_AMPERSAND") or u.wants("SHALL", "WHENEVER"):
        return None
    return _instead(u.lexeme.span, spelt)


def _word_for_operator(u: Unexpected) -> Diagnostic | None:
    """`p and q`: the words join conditions only, each with a word of its own."""
    if u.before is None or u.wants("ID"):
        return None
    return _instead(u.lexeme.span, "&" if u.lexeme.kind == "AND" else "|")


def _instead(span: Span, spelt: str) -> Diagnostic:
    return Diagnostic(
        Code.NOT_FRETISH,
        f"`{span.text}` is no operator of FRETish",
        span,
        help=f"write `{spelt}`",
    )


def _chain(u: Unexpected) -> Diagnostic | None:
    """`3 < x < 5`."""
    if u.lexeme.kind not in _COMPARISONS or not u.wants("_AMPERSAND"):
        return None
    return Diagnostic(
        Code.NOT_FRETISH,
        "comparisons do not chain",
        u.lexeme.span,
        help="write each by itself, and join them by `&`",
    )


def _number_form(u: Unexpected) -> Diagnostic | None:
    """`.5` and `007`."""
    if u.lexeme.kind == "_DOT" and u.wants("NUMBER"):
        return Diagnostic(
            Code.NOT_FRETISH,
            "a number begins with a digit",
            u.lexeme.span,
            help="write a 0 before the point",
        )
    if u.lexeme.kind != "NUMBER" or u.before is None or u.before.kind != "NUMBER":
        return None
    return Diagnostic(
        Code.NOT_FRETISH,
        "a number does not begin with 0",
        u.before.span.to(u.lexeme.span),
        help="leave the leading zeros out",
    )


def _superfluous(u: Unexpected) -> Diagnostic | None:
    """Words that English has here and FRETish has not."""
    reasons = {
        "THEN": "FRETish has no `then` after the condition",
        "THE": "a mode has no article",
        "MODE": "after `while` stands an expression, not a mode",
    }
    fits = {
        "THEN": u.wants("SHALL", "WHENEVER"),
        "THE": u.wants("MODE", "ID"),
        "MODE": u.wants("SHALL", "_AMPERSAND"),
    }
    if not fits.get(u.lexeme.kind, False) or (u.lexeme.kind == "THE" and u.wants("SHALL")):
        return None
    if u.lexeme.kind == "THE" and (
        u.before is None or u.before.kind not in ("IN", "DURING", "MODE")
    ):
        return None
    return Diagnostic(
        Code.NOT_FRETISH, reasons[u.lexeme.kind], u.lexeme.span, help=f"leave `{u.lexeme.word}` out"
    )


def _globally(u: Unexpected) -> Diagnostic | None:
    if u.before is None or u.before.word.lower() not in ("globally", "global", "everywhere"):
        return None
    if not u.wants("SHALL"):
        return None
    return Diagnostic(
        Code.NOT_FRETISH,
        f"FRETish has no word for the scope `{u.before.word}`",
        u.before.span,
        help="leave it out: without a scope a requirement is enforced everywhere",
    )


def _mode(u: Unexpected) -> Diagnostic | None:
    """`in p & q`."""
    if u.lexeme.kind not in ("_AMPERSAND", "_BAR", *_COMPARISONS):
        return None
    if not u.wants("MODE") or u.wants("NUMBER"):
        return None
    return Diagnostic(
        Code.NOT_FRETISH,
        "a mode is one name",
        u.lexeme.span,
        help="for an expression write `while p & q` in place of `in`",
    )


def _shall(u: Unexpected) -> Diagnostic | None:
    if not u.wants("SHALL") or u.lexeme.word.lower() not in _SHALL:
        return None
    return Diagnostic(
        Code.MISSPELT,
        f"a requirement says `shall`, not `{u.lexeme.word}`",
        u.lexeme.span,
        help="write `shall`",
    )


def _misspelt(u: Unexpected) -> Diagnostic | None:
    """A name stands where only a key word fits, and one key word is near."""
    suspects = [u.lexeme] if not u.wants("ID") else []
    if u.before is not None and u.wants("SHALL"):
        suspects.append(u.before)
    for suspect in suspects:
        near = suggestion(suspect.word, KEYWORDS, cutoff=0.72)
        if suspect.kind == "ID" and near is not None:
            return Diagnostic(
                Code.MISSPELT,
                f"`{suspect.word}` is no word of FRETish here",
                suspect.span,
                help=f"did you mean `{near}`?",
            )
    return None


def _order(u: Unexpected) -> Diagnostic | None:
    """The parts of a sentence have a fixed order."""
    if u.lexeme.kind in _TIMINGS and u.before is not None and u.before.kind == "SATISFY":
        return Diagnostic(
            Code.NOT_FRETISH,
            "the timing stands before `satisfy`",
            u.lexeme.span,
            help=f"write `{u.lexeme.word}{_AMOUNT.get(u.lexeme.kind, '')} satisfy ...`",
        )
    if u.lexeme.kind == "WITH" and u.wants("SHALL", "WHENEVER"):
        return Diagnostic(
            Code.NOT_FRETISH,
            "the probability stands after `shall`",
            u.lexeme.span,
            help="write it there: `shall with probability ... satisfy ...`",
        )
    if u.lexeme.kind == "PROBABILITY":
        return Diagnostic(
            Code.NOT_FRETISH,
            "`with` is missing before `probability`",
            u.lexeme.span,
            help="write `with probability ...`",
        )
    return None


def _missing_satisfy(u: Unexpected) -> Diagnostic | None:
    if not u.wants("SATISFY") or u.lexeme.kind not in _STARTS_EXPRESSION:
        return None
    end = len(u.text.text.rstrip().rstrip("."))
    response = u.text.source.span(u.lexeme.span.start, max(u.lexeme.span.end, u.text.start + end))
    return Diagnostic(
        Code.MISSING_SATISFY,
        f"missing `satisfy` before `{response.text}`",
        response,
        help=f"write `satisfy {response.text}`",
    )


def _missing_component(u: Unexpected) -> Diagnostic | None:
    starts = u.lexeme.kind == "SHALL" and u.wants("ID")
    ends = u.before is not None and u.before.kind == "SHALL" and u.wants("ID")
    if not starts and not (ends and u.lexeme.word.lower() in KEYWORDS):
        return None
    return Diagnostic(
        Code.MISSING_COMPONENT,
        "there is no component before `shall`",
        u.lexeme.span if starts or u.before is None else u.before.span,
        help="name what must satisfy the requirement: `the rover shall ...`",
    )


def _key_word_as_name(u: Unexpected) -> Diagnostic | None:
    if not u.wants("ID") or u.lexeme.word.lower() not in KEYWORDS:
        return None
    return Diagnostic(
        Code.RESERVED,
        f"`{u.lexeme.word}` is a key word of FRETish and cannot be a name",
        u.lexeme.span,
        help=f'choose another name, or quote it: `"{u.lexeme.word}"`',
    )


def _does_not_fit(u: Unexpected) -> Diagnostic:
    own = frozenset({"MODE"}) if u.wants("ID") else frozenset()  # there `mode` is a name, too
    expected = [words for words, kinds in _GROUPS if u.wants(*kinds - own)]
    message = (
        "the sentence ends too early" if u.lexeme.at_end else f"`{u.lexeme.word}` does not fit here"
    )
    return Diagnostic(
        Code.NOT_FRETISH,
        message,
        u.lexeme.span,
        help=f"expected {_alternatives(expected)}" if expected else None,
    )


def _alternatives(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"


_RULES: tuple[Callable[[Unexpected], Diagnostic | None], ...] = (
    _unit,
    _measured,
    _number,
    _globally,
    _mode,
    _shall,
    _superfluous,
    _order,
    _other_language,
    _chain,
    _number_form,
    _misspelt,
    _missing_satisfy,
    _missing_component,
    _key_word_as_name,
)
