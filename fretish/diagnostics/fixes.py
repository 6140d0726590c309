"""Fixes: replacements of spans that are displayed as help, or applied by `check --fix`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source, Span


@dataclass(frozen=True, slots=True)
class Fix:
    """The replacement of a span by a text."""

    span: Span
    """The replaced span; empty for an insertion."""
    text: str
    """The new text; empty for a removal."""
    is_safe: bool = False
    """Whether the author can only mean this text; `fretc check --fix` applies safe fixes."""

    @property
    def help(self) -> str:
        """The fix as help text: an instruction if it is safe, otherwise a question."""
        text, replaced = _plain(self.text), _plain(self.span.text)
        if not text:
            return f"remove `{replaced}`" if self.is_safe else f"should `{replaced}` be removed?"
        return f"write `{text}`" if self.is_safe else f"did you mean `{text}`?"

    @property
    def change(self) -> str:
        """The applied fix as text: ``replaced `a` by `b` ``."""
        text, replaced = _plain(self.text), _plain(self.span.text)
        if not replaced:
            return f"inserted `{text}`"
        return f"replaced `{replaced}` by `{text}`" if text else f"removed `{replaced}`"


def _plain(text: str) -> str:
    """The text on one line."""
    return " ".join(text.split())


@dataclass(frozen=True, slots=True)
class FixedText:
    """A span with fixes applied, which maps positions back to the original text."""

    original: Span
    fixes: tuple[Fix, ...] = ()
    """In the order of the text; they do not overlap."""

    @property
    def span(self) -> Span:
        """The fixed text as a new source with the same name."""
        return Source(self.original.source.name, apply_fixes(self.original, self.fixes)).span()

    def place(self, span: Span) -> Span:
        """The span in the original text of a span in the fixed text."""
        last = max(span.start, span.end - 1)
        start, end = self._original(span.start)[0], self._original(last)[1]
        empty = span.start == span.end
        return Span(self.original.source, start, start if empty else max(start, end))

    def touches(self, span: Span) -> bool:
        """Whether a span of the original text overlaps a fix."""
        return any(m.span.start < span.end and span.start < m.span.end for m in self.fixes)

    def with_fix(self, fix: Fix) -> FixedText:
        """The text with one more fix, whose span is in the original text."""
        fixes = sorted((*self.fixes, fix), key=lambda m: (m.span.start, m.span.end))
        return FixedText(self.original, tuple(fixes))

    def _original(self, at: int) -> tuple[int, int]:
        """The start and end in the original text of a character of the fixed text."""
        start = self.original.start + at
        for fix in self.fixes:
            if start < fix.span.start:
                break
            if start < fix.span.start + len(fix.text):
                return fix.span.start, fix.span.end
            start += fix.span.end - fix.span.start - len(fix.text)
        return start, start + 1


def removal(span: Span, *, is_safe: bool = False) -> Fix:
    """The fix that removes a span and the white space after it."""
    rest = span.source.text[span.end :]
    blank = len(rest) - len(rest.lstrip(" \t"))
    return Fix(Span(span.source, span.start, span.end + blank), "", is_safe)


def apply_fixes(text: Span, fixes: Sequence[Fix]) -> str:
    """The text with all fixes applied.

    Args:
        text: the span to fix.
        fixes: fixes within the span, in order, without overlaps.
    """
    return "".join(_pieces(text, fixes))


def _pieces(text: Span, fixes: Sequence[Fix]) -> Iterator[str]:
    at = text.start
    for fix in fixes:
        yield text.source.text[at : fix.span.start]
        yield fix.text
        at = fix.span.end
    yield text.source.text[at : text.end]
