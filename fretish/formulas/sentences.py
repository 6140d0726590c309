"""The text of a requirement: a sentence of FRETish, or a formula."""

from __future__ import annotations

import re

from fretish import parser
from fretish import syntax as s
from fretish.checking import check_depth, check_names, check_response_kinds
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Span
from fretish.formulas.reader import read

_BEGINNING = re.compile(
    r'\s*(?P<the>the\s+)?(?P<component>"[^"\n]*"|[A-Za-z][\w.%]*)\s+shall\s+satisfy\s+formula\s*:',
    re.IGNORECASE | re.ASCII,
)
"""No sentence of FRETish has a colon."""


def parse(text: Span) -> s.Sentence | Diagnostic:
    """The tree of a requirement, or the first error.

    A formula is the tree of `immediately satisfy`: it is true at the first tick.
    """
    tree = _formula(text)
    if tree is None:
        return parser.parse(text)
    return tree if isinstance(tree, Diagnostic) else next(iter(_errors(tree)), tree)


def find_errors(text: Span) -> tuple[Diagnostic, ...]:
    """All errors of a requirement, in the order of the text; only the first one of a formula."""
    tree = _formula(text)
    if tree is None:
        return parser.find_errors(text)
    return (tree,) if isinstance(tree, Diagnostic) else _errors(tree)


def _formula(text: Span) -> s.Sentence | Diagnostic | None:
    """The tree of a formula; None: the text does not begin as one."""
    match = _BEGINNING.match(text.text)
    if match is None:
        return None
    response = read(text.part(match.end(), len(text.text)))
    if isinstance(response, Diagnostic):
        return response
    return s.Sentence(
        scope=None,
        condition=None,
        component=match["component"].strip('"'),
        probability=None,
        timing=s.Immediately(),
        response=response,
        span=text,
        component_span=text.part(*match.span("component")),
        article=match["the"] is not None,
    )


def _errors(sentence: s.Sentence) -> tuple[Diagnostic, ...]:
    deep = check_depth(sentence)
    if deep is not None:
        return (deep,)
    return (*check_names(sentence), *check_response_kinds(sentence))
