"""The first unexpected word of a text: the input of the error rules."""

from __future__ import annotations

from fretish.classes.frozen import dataclass
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
        """The text of the word."""
        return self.span.text

    @property
    def at_end(self) -> bool:
        """Whether this is the end of the text."""
        return self.kind == "$END"


@dataclass(frozen=True, slots=True)
class Unexpected:
    """The first unexpected word, with its context."""

    lexeme: Lexeme
    previous: Lexeme | None
    accepts: frozenset[str]
    """The kinds of word that the grammar expects."""
    text: Span
    """The whole sentence."""

    def expects(self, *kinds: str) -> bool:
        """Whether the grammar expects a word of one of the kinds."""
        return not self.accepts.isdisjoint(kinds)

    def follows(self, *kinds: str) -> bool:
        """Whether the previous word is of one of the kinds."""
        return self.previous is not None and self.previous.kind in kinds

    @property
    def text_before(self) -> Span:
        """The text before the unexpected word, which is correct."""
        return Span(self.text.source, self.text.start, self.lexeme.span.start)

    @property
    def rest(self) -> Span:
        """The text from the unexpected word on, without the final full stop and white space."""
        start = self.lexeme.span.start
        kept = self.text.source.text[start : self.text.end].rstrip().rstrip(".").rstrip()
        return Span(self.text.source, start, max(start + len(kept), self.lexeme.span.end))


def not_fretish(message: str, span: Span, fix: Fix | str, words: str | None = None) -> Diagnostic:
    """F101 with a help text, or with a fix; `words` replaces the help text of the fix."""
    if isinstance(fix, str):
        return Diagnostic(Code.NOT_FRETISH, message, span, help=fix)
    return Diagnostic(Code.NOT_FRETISH, message, span, help=words or fix.help, fix=fix)
