"""Errors in operators, numbers and characters, which other languages write differently."""

from __future__ import annotations

import re

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import Fix, removal
from fretish.diagnostics.source import Span
from fretish.error_rules.precedence import one_way
from fretish.error_rules.unexpected import STARTS_EXPRESSION, Lexeme, Unexpected, not_fretish

COMPARISONS = ("LESS", "AT_MOST", "GREATER", "AT_LEAST", "EQUAL", "UNEQUAL")
_WORDS = {"not": "!", "true": "true", "false": "false"}
_JOINS = {"and": "&", "or": "|", "implies": "->", "iff": "<->"}
_PAIRS = {"&&": "&", "||": "|", "==": "=", "=<": "<=", "<>": "!="}
"""Two adjacent operator characters, with or without a space between them."""
_NEGATED = {"nand": "!(p & q)", "nor": "!(p | q)", "xnor": "p <-> q"}
_SIGNS = {
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
    sign = _SIGNS.get(span.text)
    fix: Fix | str = _HELP.get(span.text, "names are letters, digits, `_`, `.` and `%`")
    quoted = _QUOTES.match(text.source.text, span.start, text.end)
    if sign is not None:
        fix = Fix(span, sign, is_safe=True)
    elif quoted is not None:
        name = quoted[1] or quoted[2]
        fix = Fix(Span(text.source, quoted.start(), quoted.end()), f'"{name}"', is_safe=True)
    elif span.text == ";" and not text.text[at + 1 :].strip(" \t\r\n.;"):
        fix = removal(span, is_safe=True)
    return not_fretish(f"FRETish does not use the character `{span.text}`", span, fix)


def other_language(u: Unexpected) -> Diagnostic | None:
    """F101 for an operator of another language."""
    word = u.lexeme.word.lower()
    if u.before is not None and u.before.word + u.lexeme.word in _PAIRS:
        span = u.before.span.to(u.lexeme.span)
        pair = u.before.word + u.lexeme.word
        return _instead(span, _PAIRS[pair], is_safe=one_way(u.text, span, pair))
    if u.before is not None and not u.wants("ID", "SHALL"):
        return _join(u, u.lexeme)
    spelt = _WORDS.get(word)
    if spelt in (None, u.lexeme.word) or not u.wants("ID") or u.wants("SHALL", "WHENEVER"):
        return None
    return _instead(u.lexeme.span, spelt, is_safe=word != "not" or not _more(u.rest))


_PART = re.compile(
    r"not\s*(?P<bracket>\()?(?P<rest>.*?)(?:\)|,|\bsatisfy\b|\bshall\b|\Z)", re.I | re.S
)
JOIN = re.compile(r"[&|]|[-=]>|\b(?:and|or|xor|implies|iff)\b", re.IGNORECASE)


def _more(rest: Span) -> bool:
    """Whether `not` may apply to more than its first operand, as in `not p and q`."""
    part = _PART.match(rest.text)
    return part is None or (not part["bracket"] and JOIN.search(part["rest"]) is not None)


def join_of_expressions(u: Unexpected) -> Diagnostic | None:
    """F101 for `and` between expressions: `whenever p and q`.

    FRETish reads `and` as a join of conditions that each have a key word. In `whenever p implies q`
    it reads `implies` as the component.
    """
    joined = u.follows("AND", "OR") and u.wants("WHENEVER")
    named = u.follows("ID") and u.wants("SHALL")
    if u.before is None or u.lexeme.kind not in STARTS_EXPRESSION or not (joined or named):
        return None
    return _join(u, u.before)


def _join(u: Unexpected, lexeme: Lexeme) -> Diagnostic | None:
    """F101 for a word that joins two expressions in other languages or in English."""
    word = lexeme.word.lower()
    if word in _JOINS:
        return _instead(lexeme.span, _JOINS[word], is_safe=one_way(u.text, lexeme.span, word))
    if word in _NEGATED:
        words = f"use the operators of FRETish: `{_NEGATED[word]}`"
        return not_fretish(f"FRETish has no `{lexeme.word}`", lexeme.span, words)
    if lexeme.kind == "_COMMA":
        return not_fretish(
            "`,` cannot join expressions", lexeme.span, "join the parts by `&` or by `|`"
        )
    if lexeme.kind == "IS":
        return not_fretish(
            "`is` cannot compare here", lexeme.span, "use a comparison operator: `p < 3`"
        )
    return None


def _instead(span: Span, spelt: str, *, is_safe: bool = True) -> Diagnostic:
    return not_fretish(
        f"`{span.text}` is not an operator of FRETish", span, Fix(span, spelt, is_safe)
    )


_UPWARD, _DOWNWARD = ("<", "<="), (">", ">=")
_MIDDLE = re.compile(r"(?P<op><=|>=|<|>)\s*(?P<middle>[A-Za-z][\w.%]*|\"[^\"\n]+\"|\d[\d.]*)\s*\Z")


def chain(u: Unexpected) -> Diagnostic | None:
    """F101 for chained comparisons: `3 < x < 5`."""
    if u.lexeme.kind not in COMPARISONS or not u.wants("_AMPERSAND"):
        return None
    message, words = "comparisons cannot be chained", "write two comparisons, and join them by `&`"
    middle = _MIDDLE.search(u.read.text)
    same = middle is not None and any(
        {middle["op"], u.lexeme.word} <= {*way} for way in (_UPWARD, _DOWNWARD)
    )
    if middle is None or not same:
        return not_fretish(message, u.lexeme.span, words)
    here = u.lexeme.span.part(0, 0)
    fix = Fix(here, f"& {middle['middle']} ")  # Not safe: a `!` before it negates only one part.
    shown = f"{middle['op']} {middle['middle']} & {middle['middle']} {u.lexeme.word}"
    return not_fretish(message, u.lexeme.span, fix, f"{words}: `... {shown} ...`")


def number_form(u: Unexpected) -> Diagnostic | None:
    """F101 for numbers such as `.5` and `007`."""
    if u.lexeme.kind == "_DOT" and u.wants("NUMBER"):
        words = "write a 0 before the point"
        fix = Fix(u.lexeme.span.part(0, 0), "0", is_safe=True)
        number = u.rest.text[1:2].isdigit()
        message = "a number must begin with a digit"
        return not_fretish(message, u.lexeme.span, fix if number else words, words)
    if u.lexeme.kind != "NUMBER" or u.before is None or u.before.kind != "NUMBER":
        return None
    return not_fretish(
        "a number must not begin with 0",
        u.before.span.to(u.lexeme.span),
        "remove the leading zeros",
    )


def parenthesis(u: Unexpected) -> Diagnostic | None:
    """F101 for a missing or superfluous parenthesis; no fix is safe."""
    if u.lexeme.kind == "RPAR" and u.wants("$END", "SATISFY", "SHALL"):
        fix = removal(u.lexeme.span)
        words = "remove it, or write the `(` that it closes"
        return not_fretish("there is no `(` for this `)`", u.lexeme.span, fix, words)
    if not u.lexeme.at_end or not u.wants("RPAR"):
        return None
    signs = re.sub(r'"[^"\n]*"', "", u.read.text)
    missing = signs.count("(") - signs.count(")")
    fix = Fix(u.lexeme.span, ")" * missing)
    message = f"{missing} `(` {'is' if missing == 1 else 'are'} not closed"
    words = f"write `{fix.text}` here, or where the part in parentheses must end"
    return not_fretish(message, u.lexeme.span, fix, words)
