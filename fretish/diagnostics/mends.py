"""What to write in the place of a mistake, as a value: a person reads it, a program applies it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fretish.diagnostics.source import Source, Span


@dataclass(frozen=True, slots=True)
class Mend:
    """Another text in the place of a span."""

    span: Span
    """What is replaced; empty where something is put in."""
    text: str
    """Empty where the span is left out."""
    sure: bool = False
    """Whether it can say nothing but what the author means: `fretc check --fix` applies it."""

    @property
    def help(self) -> str:
        """The mend in words: an order where it is sure, a question where it is not."""
        text, replaced = _plain(self.text), _plain(self.span.text)
        if not text:
            return f"leave `{replaced}` out" if self.sure else f"should `{replaced}` be left out?"
        return f"write `{text}`" if self.sure else f"did you mean `{text}`?"

    @property
    def change(self) -> str:
        """What it does, for whoever has had it applied."""
        text, replaced = _plain(self.text), _plain(self.span.text)
        if not replaced:
            return f"put `{text}` in"
        return f"wrote `{text}` for `{replaced}`" if text else f"left `{replaced}` out"


def _plain(text: str) -> str:
    """On one line."""
    return " ".join(text.split())


@dataclass(frozen=True, slots=True)
class Mended:
    """A part of a text with mends applied, and what each of its places was before."""

    original: Span
    mends: tuple[Mend, ...] = ()
    """In the order of the text; none overlaps another one."""

    @property
    def span(self) -> Span:
        """The mended text, in a source of its own that has the same name."""
        return Source(self.original.source.name, applied(self.original, self.mends)).span()

    def place(self, span: Span) -> Span:
        """What a span of the mended text was in the original one."""
        last = max(span.start, span.end - 1)
        start, end = self._original(span.start)[0], self._original(last)[1]
        empty = span.start == span.end
        return Span(self.original.source, start, start if empty else max(start, end))

    def touches(self, span: Span) -> bool:
        """Whether a span of the original text has a part in common with a mend."""
        return any(m.span.start < span.end and span.start < m.span.end for m in self.mends)

    def with_mend(self, mend: Mend) -> Mended:
        """One more of them, at its place in the original text."""
        mends = sorted((*self.mends, mend), key=lambda m: (m.span.start, m.span.end))
        return Mended(self.original, tuple(mends))

    def _original(self, at: int) -> tuple[int, int]:
        """Where the character at a place of the mended text began and ended in the original."""
        place = self.original.start + at
        for mend in self.mends:
            if place < mend.span.start:
                break
            if place < mend.span.start + len(mend.text):
                return mend.span.start, mend.span.end
            place += mend.span.end - mend.span.start - len(mend.text)
        return place, place + 1


def left_out(span: Span, *, sure: bool = False) -> Mend:
    """Without the span and the white space behind it."""
    rest = span.source.text[span.end :]
    blank = len(rest) - len(rest.lstrip(" \t"))
    return Mend(Span(span.source, span.start, span.end + blank), "", sure)


def applied(text: Span, mends: Sequence[Mend]) -> str:
    """The text with each mend in its place.

    Args:
        text: what is mended.
        mends: within it, in its order; none overlaps another one.
    """
    return "".join(_pieces(text, mends))


def _pieces(text: Span, mends: Sequence[Mend]) -> Iterator[str]:
    at = text.start
    for mend in mends:
        yield text.source.text[at : mend.span.start]
        yield mend.text
        at = mend.span.end
    yield text.source.text[at : text.end]
