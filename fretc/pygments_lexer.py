"""A Pygments lexer of `.fret` files, by the lexer of the language itself.

The entry point `pygments.lexers` names it, so that Pygments, and what renders with it (Sphinx,
MkDocs, StrictDoc), knows the language `fretish`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import ClassVar

from pygments import token as t
from pygments.lexer import Lexer
from pygments.lexers.configs import TOMLLexer

from fretish.diagnostics.source import Source, Span
from fretish.documents import requirements
from fretish.keywords import RESERVED
from fretish.parser import words
from fretish.reading.lalr import Token

_Piece = tuple[int, t._TokenType, str]
_FENCE = re.compile(r"^(\ufeff?\+\+\+[ \t]*\r?)$", re.MULTILINE)
_SPACE = re.compile(r"[\s\ufeff]+")
_OBLIGATION = {"SHALL", "SATISFY"}
_WORD_OPERATORS = {"AND", "OR", "NOT", "XOR", "MOD"}
_TRUTHS = {"TRUE", "FALSE", "IS_TRUE", "IS_FALSE"}
_UNITS = {"TICK", "MICROSECOND", "MILLISECOND", "SECOND", "MINUTE", "HOUR"}
_NUMBERS = {"NUMBER", "QUANTITY"}
_NAMES = {"ID", "QUOTED"}
_PUNCTUATION = frozenset("(),.")


class FretishLexer(Lexer):
    """FRETish requirements: TOML headers between lines of `+++`, and sentences."""

    name = "FRETish"
    aliases: ClassVar[Sequence[str]] = ["fretish", "fret"]
    filenames: ClassVar[Sequence[str]] = ["*.fret"]
    url = "https://github.com/NASA-SW-VnV/fret"

    def get_tokens_unprocessed(self, text: str) -> Iterator[_Piece]:
        """Yield offset, kind and text of each piece; the pieces join to the whole text."""
        end = 0
        for entry in requirements(Source("", text))[0]:
            yield from _header(text, end, entry.wording.start)
            yield from _free_text(entry.wording) if entry.is_free_text else _sentence(entry.wording)
            end = entry.wording.end
        yield from _header(text, end, len(text))


def _header(text: str, start: int, end: int) -> Iterator[_Piece]:
    """The pieces between two sentences: white space, fences and TOML."""
    for part in _FENCE.split(text[start:end]):
        if _FENCE.fullmatch(part):
            yield start, t.Punctuation.Marker, part
        elif part.strip():
            for at, kind, piece in TOMLLexer().get_tokens_unprocessed(part):
                yield start + at, kind, piece
        elif part:
            yield start, t.Whitespace, part
        start += len(part)


def _free_text(wording: Span) -> Iterator[_Piece]:
    yield wording.start, t.String.Double, wording.text


def _sentence(wording: Span) -> Iterator[_Piece]:
    """The words of a sentence, and what is between them: white space, or an error."""
    text, end = wording.text, 0
    tokens = words(text)
    components = _components(tokens)
    for at, token in enumerate(tokens):
        yield from _gap(wording.start + end, text[end : token.start_pos])
        end = token.end_pos
        kind = t.Name.Class if at in components else _kind(tokens, at)
        yield wording.start + token.start_pos, kind, text[token.start_pos : end]
    yield from _gap(wording.start + end, text[end:])


def _gap(start: int, text: str) -> Iterator[_Piece]:
    end = 0
    for space in _SPACE.finditer(text):
        if space.start() > end:
            yield start + end, t.Error, text[end : space.start()]
        yield start + space.start(), t.Whitespace, space[0]
        end = space.end()
    if end < len(text):
        yield start + end, t.Error, text[end:]


def _components(tokens: Sequence[Token]) -> set[int]:
    """The places of names beside `shall`: `the robot shall`, or `shall the robot`."""
    places = set()
    for at, token in enumerate(tokens):
        if token.type == "SHALL":
            article = at + 1 < len(tokens) and tokens[at + 1].type == "THE"
            before, after = at - 1, at + 1 + article
            place = before if before >= 0 and tokens[before].type in _NAMES else after
            if place < len(tokens) and tokens[place].type in _NAMES:
                places.add(place)
    return places


def _kind(tokens: Sequence[Token], at: int) -> t._TokenType:
    token = tokens[at]
    if token.type in _NAMES and token.lower() not in RESERVED:
        is_call = at + 1 < len(tokens) and tokens[at + 1] == "("
        return t.Name.Function if is_call else t.Name.Variable
    if token.type in _NUMBERS:
        return t.Number
    if token in _PUNCTUATION:
        return t.Punctuation
    if token.type in _OBLIGATION:
        return t.Keyword.Declaration
    if token.type in _WORD_OPERATORS:
        return t.Operator.Word
    if token.type in _TRUTHS:
        return t.Keyword.Constant
    if token.type in _UNITS:
        return t.Keyword.Type
    return t.Keyword if token[0].isalpha() else t.Operator
