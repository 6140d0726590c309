"""Errors in operators, numbers and characters, which other languages write differently."""

from __future__ import annotations

import re

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import Fix, removal
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.error_rules.precedence import is_unambiguous
from fretish.error_rules.unexpected import STARTS_EXPRESSION, Lexeme, Unexpected, not_fretish

COMPARISONS = ("LESS", "AT_MOST", "GREATER", "AT_LEAST", "EQUAL", "UNEQUAL")
_WORD_SPELLINGS = {"not": "!", "true": "true", "false": "false"}
_JOIN_SPELLINGS = {"and": "&", "or": "|", "implies": "->", "iff": "<->"}
_PAIR_SPELLINGS = {"&&": "&", "||": "|", "==": "=", "=<": "<=", "<>": "!="}
"""Two adjacent operator characters, with or without a space between them."""
_NEGATED_JOINS = {"nand": "!(p & q)", "nor": "!(p | q)", "xnor": "p <-> q"}
_CHARACTER_SPELLINGS = {
    "\u2264": "<=",
    "\u2265": ">=",
    "\u2260": "!=",
    "\u2192": "->",
    "\u2227": "&",
    "\u2228": "|",
    "\u00ac": "!",
}
_HELP = {
    "[": 'quote a name with brackets: `"a[3]"`',
    "_": "a name begins with a letter",
    '"': "close the quotes, or remove them",
    "\u201c": 'use straight quotes: `"`',
    "\u201d": 'use straight quotes: `"`',
    "'": 'use double quotes: `"`',
}
_QUOTES = re.compile(r"\u201c([^\"\n\u201c\u201d]+)\u201d|'([^\"\n']+)'")


def unknown_character(text: Span, at: int) -> Diagnostic:
    """F101 for a character that FRETish does not use."""
    span = text.part(at, at + 1)
    spelling = _CHARACTER_SPELLINGS.get(span.text)
    fix: Fix | str = _HELP.get(span.text, "names are letters, digits, `_`, `.` and `%`")
    quoted = _QUOTES.match(text.source.text, span.start, text.end)
    if spelling is not None:
        fix = Fix(span, spelling, is_safe=True)
    elif quoted is not None:
        name = quoted[1] or quoted[2]
        fix = Fix(Span(text.source, quoted.start(), quoted.end()), f'"{name}"', is_safe=True)
    elif span.text == ";" and not text.text[at + 1 :].strip(" \t\r\n.;"):
        fix = removal(span, is_safe=True)
    return not_fretish(f"FRETish does not use the character `{span.text}`", span, fix)


def wrong_operator(u: Unexpected) -> Diagnostic | None:
    """F101 for an operator of another language."""
    word = u.lexeme.word.lower()
    if u.previous is not None and u.previous.word + u.lexeme.word in _PAIR_SPELLINGS:
        span = u.previous.span.to(u.lexeme.span)
        pair = u.previous.word + u.lexeme.word
        return _operator_error(
            span, _PAIR_SPELLINGS[pair], is_safe=is_unambiguous(u.text, span, pair)
        )
    if u.previous is not None and not u.expects("ID", "SHALL"):
        return _join_error(u, u.lexeme)
    spelt = _WORD_SPELLINGS.get(word)
    if spelt in (None, u.lexeme.word) or not u.expects("ID") or u.expects("SHALL", "WHENEVER"):
        return None
    return _operator_error(
        u.lexeme.span, spelt, is_safe=word != "not" or not _may_negate_more(u.rest)
    )


_PART = re.compile(
    r"not\s*(?P<bracket>\()?(?P<rest>.*?)(?:\)|,|\bsatisfy\b|\bshall\b|\Z)", re.I | re.S
)
JOIN = re.compile(r"[&|]|[-=]>|\b(?:and|or|xor|implies|iff)\b", re.IGNORECASE)


def _may_negate_more(rest: Span) -> bool:
    """Whether `not` may apply to more than its first operand, as in `not p and q`."""
    part = _PART.match(rest.text)
    return part is None or (not part["bracket"] and JOIN.search(part["rest"]) is not None)


def wrong_join(u: Unexpected) -> Diagnostic | None:
    """F101 for `and` between expressions: `whenever p and q`.

    FRETish reads `and` as a join of conditions that each have a key word. In `whenever p implies q`
    it reads `implies` as the component.
    """
    joined = u.follows("AND", "OR") and u.expects("WHENEVER")
    named = u.follows("ID") and u.expects("SHALL")
    if u.previous is None or u.lexeme.kind not in STARTS_EXPRESSION or not (joined or named):
        return None
    return _join_error(u, u.previous)


def _join_error(u: Unexpected, lexeme: Lexeme) -> Diagnostic | None:
    """F101 for a word that joins two expressions in other languages or in English."""
    word = lexeme.word.lower()
    if word in _JOIN_SPELLINGS:
        return _operator_error(
            lexeme.span, _JOIN_SPELLINGS[word], is_safe=is_unambiguous(u.text, lexeme.span, word)
        )
    if word in _NEGATED_JOINS:
        operators = _NEGATED_JOINS[word]
        return diagnostic("negated_join", lexeme.span, word=lexeme.word, operators=operators)
    if lexeme.kind == "_COMMA":
        return diagnostic("comma_as_join", lexeme.span)
    if lexeme.kind == "IS":
        return diagnostic("is_as_comparison", lexeme.span)
    return None


def _operator_error(span: Span, spelt: str, *, is_safe: bool = True) -> Diagnostic:
    return diagnostic("foreign_operator", span, operator=span.text, fix=Fix(span, spelt, is_safe))


_UPWARD, _DOWNWARD = ("<", "<="), (">", ">=")
_MIDDLE = re.compile(r"(?P<op><=|>=|<|>)\s*(?P<middle>[A-Za-z][\w.%]*|\"[^\"\n]+\"|\d[\d.]*)\s*\Z")


def chained_comparison(u: Unexpected) -> Diagnostic | None:
    """F101 for chained comparisons: `3 < x < 5`."""
    if u.lexeme.kind not in COMPARISONS or not u.expects("_AMPERSAND"):
        return None
    message, words = "comparisons cannot be chained", "write two comparisons, and join them by `&`"
    middle = _MIDDLE.search(u.text_before.text)
    is_range = middle is not None and any(
        {middle["op"], u.lexeme.word} <= {*way} for way in (_UPWARD, _DOWNWARD)
    )
    if middle is None or not is_range:
        return not_fretish(message, u.lexeme.span, words)
    here = u.lexeme.span.part(0, 0)
    fix = Fix(here, f"& {middle['middle']} ")  # Not safe: a `!` before it negates only one part.
    shown = f"{middle['op']} {middle['middle']} & {middle['middle']} {u.lexeme.word}"
    return not_fretish(message, u.lexeme.span, fix, f"{words}: `... {shown} ...`")


def malformed_number(u: Unexpected) -> Diagnostic | None:
    """F101 for numbers such as `.5` and `007`."""
    if u.lexeme.kind == "_DOT" and u.expects("NUMBER"):
        words = "write a 0 before the point"
        fix = Fix(u.lexeme.span.part(0, 0), "0", is_safe=True)
        number = u.rest.text[1:2].isdigit()
        message = "a number must begin with a digit"
        return not_fretish(message, u.lexeme.span, fix if number else words, words)
    if u.lexeme.kind != "NUMBER" or u.previous is None or u.previous.kind != "NUMBER":
        return None
    return diagnostic("leading_zeros", u.previous.span.to(u.lexeme.span))


def unmatched_parenthesis(u: Unexpected) -> Diagnostic | None:
    """F101 for a missing or superfluous parenthesis; no fix is safe."""
    if u.lexeme.kind == "RPAR" and u.expects("$END", "SATISFY", "SHALL"):
        return diagnostic("unopened_parenthesis", u.lexeme.span, fix=removal(u.lexeme.span))
    if not u.lexeme.at_end or not u.expects("RPAR"):
        return None
    unquoted = re.sub(r'"[^"\n]*"', "", u.text_before.text)
    missing = unquoted.count("(") - unquoted.count(")")
    fix = Fix(u.lexeme.span, ")" * missing)
    count = f"{missing} `(` {'is' if missing == 1 else 'are'}"
    return diagnostic("unclosed_parenthesis", u.lexeme.span, count=count, end=fix.text, fix=fix)
