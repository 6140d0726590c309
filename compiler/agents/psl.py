"""Strict reader of AJPF property files (`.psl`): a text that AJPF would repair is an error.

AJPF's own reader splits a file line by line, and its parser recovers from every error, so a wrong
property looks verified. This reader reads a property exactly as AJPF does, or F603 reports where
and how AJPF would misread it. Source: the file reader and the property grammar of MCAPL; Dennis et
al., Model checking agent programming languages, ASE 19 (2012), section 4 (the property
specification language).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import field

from compiler.agents.psl_grammar import AjpfDivergenceError, JoinedText, formula
from compiler.logic.formula import Formula
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget
from fretish.reading.recursion import with_recursion_limit

KEY = re.compile(r"[A-Za-z0-9_.-]+")
"""A key that `target.args` can carry."""
_LINES = re.compile(r"[^\r\n]*(?:\r\n|\n|\r|$)")


@dataclass(frozen=True, slots=True)
class Property:
    """`KEY: formula`. Atoms are spelt as AJPF has them, without white space: `B(ag,too_close)`.

    A number within an atom is spelt by its value, as AJPF compares it: `p(1.0)` is `p(1)`. Strings
    are spelt in single quotes.
    """

    key: str
    formula: Formula
    span: Span = field(compare=False, repr=False)
    """From the key to the end of the formula."""
    remarks: tuple[Diagnostic, ...] = field(default=(), compare=False, repr=False)
    """Warnings about a property that its author probably did not intend."""


@with_recursion_limit
def read(source: Source) -> tuple[Property, ...] | Diagnostic:
    """All properties of a file, in order; or F603 for the first text that AJPF would misread.

    A file with only comments has no properties.
    """
    return with_budget(len(source.text), source.span(0, 0), lambda: _read(source))


def _read(source: Source) -> tuple[Property, ...] | Diagnostic:
    try:
        keyed = list(_keyed(source))
        first: dict[str, Span] = {}
        for key, _ in keyed:
            if first.setdefault(key.text, key) is not key:
                raise AjpfDivergenceError(
                    diagnostic("key_twice", key, key=key.text, line=first[key.text].line)
                )
        return tuple(_property(key, text) for key, text in keyed)
    except AjpfDivergenceError as error:
        return error.diagnostic


def _property(key: Span, text: JoinedText) -> Property:
    tree, strings = formula(text)
    remarks = tuple(
        diagnostic("string_matches_no_belief", string, string=string.text) for string in strings
    )
    return Property(key.text, tree, key.to(text.span(0, len(text.text))), remarks)


def _keyed(source: Source) -> Iterator[tuple[Span, JoinedText]]:
    """Each key with the text of its formula, joined as AJPF's file reader joins it.

    A line is split at its colons; one without a colon belongs to the line before it, with nothing
    between them.
    """
    key: Span | None = None
    pieces: list[Span] = []
    for line in _lines(source):
        if line.text.startswith("#"):
            continue
        _refuse_beyond_ascii(line)
        if ":" in line.text:
            if key is not None:
                yield key, JoinedText(source, pieces)
            key, pieces = _key(line), [_formula_text(line)]
        elif key is not None:
            pieces.append(line)
        elif line.text.strip():
            raise AjpfDivergenceError(diagnostic("text_before_key", line))
    if key is not None:
        yield key, JoinedText(source, pieces)


def _lines(source: Source) -> Iterator[Span]:
    for match in _LINES.finditer(source.text):
        yield source.span(match.start(), match.start() + len(match[0].rstrip("\r\n")))


def _key(line: Span) -> Span:
    """The text before the first colon; AJPF compares keys character by character."""
    key = line.part(0, line.text.index(":"))
    if KEY.fullmatch(key.text):
        return key
    if key.text.lstrip().startswith("#"):
        raise AjpfDivergenceError(diagnostic("misplaced_property_comment", key))
    raise AjpfDivergenceError(
        diagnostic("bad_property_key", key if key.text else line, key=key.text)
    )


def _formula_text(line: Span) -> Span:
    """The text behind the first colon."""
    start = line.text.index(":") + 1
    second = line.text.find(":", start)
    if second >= 0:
        raise AjpfDivergenceError(diagnostic("second_colon", line.part(second, len(line.text))))
    if start == len(line.text):
        raise AjpfDivergenceError(diagnostic("formula_missing_behind_colon", line))
    return line.part(start, len(line.text))


def _refuse_beyond_ascii(line: Span) -> None:
    for i, character in enumerate(line.text):
        if not character.isascii():
            raise AjpfDivergenceError(
                diagnostic("not_ascii", line.part(i, i + 1), character=character)
            )
