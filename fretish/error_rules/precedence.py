"""Whether replacing an operator of another language by the FRETish one can change the meaning.

In other languages `&&` and `and` may have another precedence relative to `|`, and readers disagree
about `p and q or r`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from fretish.diagnostics.source import Span

_WORDS = {"and", "or", "implies", "iff", "xor"}
_CONFLICTS = {
    "&&": {"|", "xor"},
    "||": {"xor"},
    "and": {"|", "||", "->", "=>", "<->", "<=>"} | _WORDS - {"and"},
    "or": {"->", "=>", "<->", "<=>"} | _WORDS - {"or"},
    "implies": {"->", "=>", "<->", "<=>"} | _WORDS,
    "iff": {"<->", "<=>"} | _WORDS - {"iff"},
}
"""Operator → operators beside which its precedence is unclear without parentheses."""
_OPERATOR = re.compile(
    rf"<->|<=>|->|=>|\|\||&&|\||&|\b(?:{'|'.join(sorted(_WORDS))})\b", re.IGNORECASE
)
_PART_ENDS = re.compile(
    r"\b(?:shall|satisfy|until|before|after|whenever|when|where|if|then|upon|unless|while)\b",
    re.IGNORECASE,
)
_QUOTED = re.compile(r'"[^"\n]*"')


def is_unambiguous(text: Span, at: Span, operator: str) -> bool:
    """Whether the precedence of an operator is clear relative to the operators beside it.

    Args:
        text: the sentence.
        at: the span of the operator.
        operator: the operator in lower case, without white space.
    """
    others = {other.lower() for other in _OPERATOR.findall(_surrounding_text(text, at))}
    return others.isdisjoint(_CONFLICTS.get(operator, frozenset()))


def _surrounding_text(text: Span, at: Span) -> str:
    """The text around a span, within the same parentheses and the same part of the sentence."""
    source = text.source.text
    left = _outside_parentheses(
        reversed(_QUOTED.sub("x", source[text.start : at.start])), ")", "("
    )[::-1]
    right = _outside_parentheses(_QUOTED.sub("x", source[at.end : text.end]), "(", ")")
    return f"{_PART_ENDS.split(left)[-1]} {_PART_ENDS.split(right)[0]}"


def _outside_parentheses(characters: Iterable[str], opening: str, closing: str) -> str:
    """The characters outside of inner parentheses, up to the end of the enclosing ones."""
    depth = 0
    outside = []
    for character in characters:
        if character == closing:
            if depth == 0:
                break
            depth -= 1
        elif character == opening:
            depth += 1
        elif depth == 0:
            outside.append(character)
    return "".join(outside)
