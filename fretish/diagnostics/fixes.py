"""What to write in the place of a mistake, as a value: a person reads it, a program applies it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fretish.diagnostics.source import Source, Span


@dataclass(frozen=True, slots=True)
class Fix:
    """Another text in the place of a span."""

    span: Span
    """What is replaced; empty where something is put in."""
    text: str
    """Empty where the span is left out."""
    is_safe: bool = False
    """Whether it can say nothing but what the author means: `fretc check --fix` applies it."""

    @property
    def help(self) -> str:
        """The fix in words: an order where it is safe, a question where it is not."""
        text, replaced = _plain(self.text), _plain(self.span.text)
        if not text:
            return f"remove `{replaced}`" if self.is_safe else f"should `{replaced}` be removed?"
        return f"write `{text}`" if self.is_safe else f"did you mean `{text}`?"

    @property
    def change(self) -> str:
        """What it does, for the user who applied it."""
        text, replaced = _plain(self.text), _plain(self.span.text)
        if not replaced:
            return f"inserted `{text}`"
        return f"replaced `{replaced}` by `{text}`" if text else f"removed `{replaced}`"


def _plain(text: str) -> str:
    """On one line."""
    return " ".join(text.split())


@dataclass(frozen=True, slots=True)
class FixedText:
    """A part of a text with fixes applied, and what each of its places was before."""

    original: Span
    fixes: tuple[Fix, ...] = ()
    """In the order of the text; none overlaps another one."""

    @property
    def span(self) -> Span:
        """The fixed text, in a source of its own that has the same name."""
        return Source(self.original.source.name, applied(self.original, self.fixes)).span()

    def place(self, span: Span) -> Span:
        """What a span of the fixed text was in the original one."""
        last = max(span.start, span.end - 1)
        start, end = self._original(span.start)[0], self._original(last)[1]
        empty = span.start == span.end
        return Span(self.original.source, start, start if empty else max(start, end))

    def touches(self, span: Span) -> bool:
        """Whether a span of the original text has a part in common with a fix."""
        return any(m.span.start < span.end and span.start < m.span.end for m in self.fixes)

    def with_fix(self, fix: Fix) -> FixedText:
        """One more of them, at its place in the original text."""
        fixes = sorted((*self.fixes, fix), key=lambda m: (m.span.start, m.span.end))
        return FixedText(self.original, tuple(fixes))

    def _original(self, at: int) -> tuple[int, int]:
        """Where the character at a place of the fixed text began and ended in the original."""
        place = self.original.start + at
        for fix in self.fixes:
            if place < fix.span.start:
                break
            if place < fix.span.start + len(fix.text):
                return fix.span.start, fix.span.end
            place += fix.span.end - fix.span.start - len(fix.text)
        return place, place + 1


def left_out(span: Span, *, is_safe: bool = False) -> Fix:
    """Without the span and the white space behind it."""
    rest = span.source.text[span.end :]
    blank = len(rest) - len(rest.lstrip(" \t"))
    return Fix(Span(span.source, span.start, span.end + blank), "", is_safe)


def applied(text: Span, fixes: Sequence[Fix]) -> str:
    """The text with each fix in its place.

    Args:
        text: what is fixed.
        fixes: within it, in its order; none overlaps another one.
    """
    return "".join(_pieces(text, fixes))


def _pieces(text: Span, fixes: Sequence[Fix]) -> Iterator[str]:
    at = text.start
    for fix in fixes:
        yield text.source.text[at : fix.span.start]
        yield fix.text
        at = fix.span.end
    yield text.source.text[at : text.end]
