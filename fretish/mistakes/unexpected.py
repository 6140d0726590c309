"""The first word of a text that does not fit, as the rules about mistakes look at it."""

from __future__ import annotations

from dataclasses import dataclass

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.fixes import Fix
from fretish.diagnostics.source import Span

STARTS_EXPRESSION = frozenset({"ID", "QUOTED", "NUMBER", "TRUE", "FALSE", "_BANG", "LPAR", "MINUS"})


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

    def follows(self, *kinds: str) -> bool:
        """Whether the word before it is of one of the kinds."""
        return self.before is not None and self.before.kind in kinds

    @property
    def read(self) -> Span:
        """The text before it, all of which fits."""
        return Span(self.text.source, self.text.start, self.lexeme.span.start)

    @property
    def rest(self) -> Span:
        """The text from it on, without the full stop and the white space at the end."""
        start = self.lexeme.span.start
        kept = self.text.source.text[start : self.text.end].rstrip().rstrip(".").rstrip()
        return Span(self.text.source, start, max(start + len(kept), self.lexeme.span.end))


def not_fretish(message: str, span: Span, fix: Fix | str, words: str | None = None) -> Diagnostic:
    """F101, with words that say what to do, or with a fix: the words are its own if not given."""
    if isinstance(fix, str):
        return Diagnostic(Code.NOT_FRETISH, message, span, help=fix)
    return Diagnostic(Code.NOT_FRETISH, message, span, help=words or fix.help, fix=fix)
