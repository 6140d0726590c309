"""Explain syntax errors of FRETish, and propose a fix.

Each rule looks at the first unexpected word, the word before it, and the words that the grammar
expects.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from fretish.diagnostics.diagnostic import Diagnostic, suggestion
from fretish.diagnostics.fixes import Fix, removal
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.error_rules.operators import (
    COMPARISONS,
    chained_comparison,
    malformed_number,
    unmatched_parenthesis,
    wrong_join,
    wrong_operator,
)
from fretish.error_rules.order import (
    TIMINGS,
    further_sentence,
    misplaced_part,
    missing_part,
    part_after_response,
    superfluous_article,
    wrong_timing,
)
from fretish.error_rules.unexpected import STARTS_EXPRESSION, Lexeme, Unexpected, not_fretish
from fretish.keywords import KEYWORDS
from fretish.reading.lalr import END, Token, UnexpectedTokenError
from fretish.units import unit, unknown_unit

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
"""Description of what the grammar may expect → its terminals, in the order of a sentence."""

_UNITS = ("TICK", "MICROSECOND", "MILLISECOND", "SECOND", "MINUTE", "HOUR")
_UNIT_NAMES = {
    "ms": "milliseconds", "msec": "milliseconds", "us": "microseconds", "usec": "microseconds",
    "s": "seconds", "min": "minutes", "mins": "minutes", "h": "hours", "hr": "hours",
}  # fmt: skip
_TICK_NAMES = frozenset({"step", "steps", "cycle", "cycles", "timepoint", "timepoints"})
"""Words of other tools for a step; fretc cannot decide whether it is a tick."""
_SHALL = ("should", "must", "will", "shal")
_WEAKER = ("can", "may", "might", "could", "would", "has", "needs")
"""Words in the position of `shall` that may have another meaning."""
_TWO_WORDS = re.compile(
    r"(?!(?:if|not|at)\b)[a-z]\w*\s+(?!(?:and|or|xor|mod|implies|iff|is)\b)[a-z]", re.IGNORECASE
)


def unexpected_word(error: UnexpectedTokenError, text: Span) -> Diagnostic:
    """The diagnostic of the first word that the grammar does not allow at its place."""
    token, before = error.token, error.previous
    if token.type == "QUANTITY" and "NUMBER" in error.accepts:
        return bad_probability(_lexeme(token, text).span)
    return explain(
        Unexpected(
            _lexeme(token, text),
            _lexeme(before, text) if before is not None else None,
            error.accepts,
            text,
        )
    )


def _lexeme(token: Token, text: Span) -> Lexeme:
    if token.type == END:
        end = len(text.text.rstrip())
        return Lexeme(token.type, text.part(end, end))
    return Lexeme(token.type, text.part(token.start_pos, token.end_pos))


def explain(unexpected: Unexpected) -> Diagnostic:
    """The diagnostic of the first rule that applies; the last rule always does."""
    for rule in _RULES:
        diagnostic = rule(unexpected)
        if diagnostic is not None:
            return diagnostic
    return _does_not_fit(unexpected)


def bad_duration(digits: str, whole: Span) -> Diagnostic:
    """F108 for a duration that is negative, too long, or not whole in any unit of FRETish."""
    if whole.text.startswith("-"):
        return diagnostic("negative_duration", whole)
    if digits.isdigit() or len(digits) > 60:
        return diagnostic("duration_too_long", whole)
    return diagnostic("duration_not_whole", whole, text=whole.text)


def bad_unit(span: Span) -> Diagnostic:
    """F108 for a word that is not a unit of time."""
    fix = _unit_fix(span)
    if fix is not None:
        return diagnostic("misspelt_unit", span, word=span.text, fix=fix)
    return diagnostic("duration_of_unknown_unit", span, word=span.text)


def bad_probability(span: Span) -> Diagnostic:
    """F110 for a probability out of range."""
    return diagnostic("impossible_probability", span, text=span.text)


# Rules, the most specific first ----------------------------------------------------------------


def _unit(u: Unexpected) -> Diagnostic | None:
    if not u.expects(*_UNITS):
        return None
    if not u.expects("TICK") and (u.lexeme.kind != "ID" or _unit_fix(u.lexeme.span) is None):
        return None  # the first number in a call, which need not be a duration
    if u.lexeme.kind != "ID":
        return diagnostic("duration_without_unit", u.lexeme.span)
    return bad_unit(u.lexeme.span)


def _measured(u: Unexpected) -> Diagnostic | None:
    """A name after a number, in the position of a unit."""
    if u.previous is None or u.previous.kind != "NUMBER" or u.lexeme.kind != "ID":
        return None
    if unit(u.lexeme.word) is not None:
        return diagnostic("number_too_long", u.previous.span)
    return unknown_unit(u.lexeme.word, u.lexeme.span)


def _unit_fix(span: Span) -> Fix | None:
    word = span.text.lower()
    if word in _UNIT_NAMES:
        return Fix(span, _UNIT_NAMES[word], is_safe=True)
    plurals = [known for known in KEYWORDS if known.endswith("s")]
    near = "ticks" if word in _TICK_NAMES else suggestion(word, plurals, cutoff=0.72)
    return Fix(span, near) if near is not None else None


def _number(u: Unexpected) -> Diagnostic | None:
    """F108 for a duration that does not begin with a number."""
    if u.previous is None or u.previous.kind not in ("WITHIN", "FOR", "AFTER"):
        return None
    if not u.accepts <= {"NUMBER", "MINUS", "QUANTITY"}:
        return None
    return diagnostic("duration_without_number", u.lexeme.span, previous=u.previous.word)


def _superfluous(u: Unexpected) -> Diagnostic | None:
    """Superfluous English words: `then`, `the`, `mode`."""
    reasons = {
        "THEN": "FRETish has no `then` after the condition",
        "THE": "a mode cannot contain `the`",
        "MODE": "`while` needs an expression, not a mode",
    }
    fits = {
        "THEN": u.expects("SHALL", "WHENEVER"),
        "THE": u.expects("MODE", "ID")
        and not u.expects("SHALL")
        and u.follows("IN", "DURING", "MODE"),
        "MODE": u.expects("SHALL", "_AMPERSAND"),
    }
    if not fits.get(u.lexeme.kind, False):
        return None
    if u.lexeme.kind == "MODE" and not re.search(r"\bwhile\b", u.text_before.text, re.IGNORECASE):
        return None
    return not_fretish(reasons[u.lexeme.kind], u.lexeme.span, removal(u.lexeme.span, is_safe=True))


def _globally(u: Unexpected) -> Diagnostic | None:
    if u.previous is None or u.previous.word.lower() not in ("globally", "global", "everywhere"):
        return None
    if not u.expects("SHALL"):
        return None
    comma = u.lexeme.kind == "_COMMA"
    removed = u.previous.span.to(u.lexeme.span) if comma else u.previous.span
    fix = removal(removed, is_safe=True)
    return diagnostic("word_for_no_scope", u.previous.span, word=u.previous.word, fix=fix)


def _mode(u: Unexpected) -> Diagnostic | None:
    """`in p & q`."""
    if u.lexeme.kind not in ("_AMPERSAND", "_BAR", *COMPARISONS):
        return None
    if not u.expects("MODE") or u.expects("NUMBER"):
        return None
    return diagnostic("mode_of_several_names", u.lexeme.span)


def _shall(u: Unexpected) -> Diagnostic | None:
    word = u.lexeme.word.lower()
    if not u.expects("SHALL") or word not in (*_SHALL, *_WEAKER):
        return None
    fix = Fix(u.lexeme.span, "shall", is_safe=word in _SHALL)
    return diagnostic("misspelt_shall", u.lexeme.span, word=u.lexeme.word, fix=fix)


def _missing_shall(u: Unexpected) -> Diagnostic | None:
    """`the sw satisfy p`, `the sw always satisfy p`."""
    if not u.expects("SHALL") or u.expects("$END") or not u.follows("ID", "QUOTED"):
        return None
    if u.lexeme.kind not in ("SATISFY", *TIMINGS) or re.search(r"\bshall\b", u.rest.text, re.I):
        return None
    fix = Fix(u.lexeme.span.part(0, 0), "shall ", is_safe=u.lexeme.kind == "SATISFY")
    return diagnostic("missing_shall", u.lexeme.span, word=u.lexeme.word, fix=fix)


def _component(u: Unexpected) -> Diagnostic | None:
    """`the big robot shall`."""
    if u.previous is None or not (u.follows("ID") and u.lexeme.kind == "ID" and u.expects("SHALL")):
        return None
    if not re.match(r"[\w.%]+\s+shall\b", u.rest.text, re.IGNORECASE):
        return None
    both = u.previous.span.to(u.lexeme.span)
    fix = Fix(both, f"{u.previous.word}_{u.lexeme.word}")
    return diagnostic("component_of_several_names", both, fix=fix)


def _misspelt(u: Unexpected) -> Diagnostic | None:
    """F107 for a name that is similar to a key word, where only a key word is allowed."""
    suspects = [u.lexeme] if not u.expects("ID") else []
    if u.previous is not None and u.expects("SHALL"):
        suspects.append(u.previous)
    for suspect in suspects:
        near = suggestion(suspect.word, KEYWORDS, cutoff=0.72)
        if suspect.kind == "ID" and near is not None:
            fix = Fix(suspect.span, near)
            return diagnostic("misspelt_word", suspect.span, word=suspect.word, fix=fix)
    return None


def _missing_satisfy(u: Unexpected) -> Diagnostic | None:
    if not u.expects("SATISFY") or u.lexeme.kind not in STARTS_EXPRESSION:
        return None
    response = u.rest
    two_words = _TWO_WORDS.match(response.text) is not None
    return diagnostic(
        "missing_satisfy",
        response,
        response=response.text,
        fix=Fix(response.part(0, 0), "satisfy ", is_safe=not two_words),
    )


def _missing_component(u: Unexpected) -> Diagnostic | None:
    if re.search(r"\bsatisfy\b", u.text_before.text, re.IGNORECASE):
        return None
    starts = u.lexeme.kind == "SHALL" and u.expects("ID")
    ends = u.follows("SHALL") and u.expects("ID")
    if not starts and not (ends and u.lexeme.word.lower() in KEYWORDS):
        return None
    return diagnostic(
        "missing_component", u.lexeme.span if starts or u.previous is None else u.previous.span
    )


def _key_word_as_name(u: Unexpected) -> Diagnostic | None:
    if not u.expects("ID") or u.lexeme.word.lower() not in KEYWORDS:
        return None
    return diagnostic("key_word_as_name", u.lexeme.span, word=u.lexeme.span.text)


def _does_not_fit(u: Unexpected) -> Diagnostic:
    own = frozenset({"MODE"}) if u.expects("ID") else frozenset()  # there `mode` is a name, too
    expected = [words for words, kinds in _GROUPS if u.expects(*kinds - own)]
    fix = f"expected {_alternatives(expected)}" if expected else None
    if u.lexeme.at_end:
        return diagnostic("sentence_ends", u.lexeme.span, help=fix)
    return diagnostic("misplaced_word", u.lexeme.span, word=u.lexeme.word, help=fix)


def _alternatives(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"


_RULES: tuple[Callable[[Unexpected], Diagnostic | None], ...] = (
    further_sentence,
    _unit,
    _measured,
    _number,
    _globally,
    _mode,
    _shall,
    missing_part,
    _superfluous,
    misplaced_part,
    part_after_response,
    wrong_timing,
    wrong_operator,
    wrong_join,
    chained_comparison,
    malformed_number,
    unmatched_parenthesis,
    superfluous_article,
    _missing_shall,
    _component,
    _misspelt,
    _missing_satisfy,
    _missing_component,
    _key_word_as_name,
)
