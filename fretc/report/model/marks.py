"""The mark of a verdict: a word and a sign, for every form of a report."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from fretc.audit.evidence.verdicts import SUSPECT, VERDICTS, severity, shows
from fretish.diagnostics.status_symbols import StatusSymbol


@dataclass(frozen=True, slots=True)
class Mark:
    """A verdict for a reader: a word, a sign, and `kind`, the class of its colour."""

    word: str
    glyph: str
    kind: str
    suspect: bool = False
    """The currency of the verdict: whether something that it rests on has changed."""

    @property
    def text(self) -> str:
        """`violated`, or `violated, suspect`: verdict and currency."""
        return f"{self.word}, {SUSPECT}" if self.suspect else self.word

    @property
    def shows(self) -> bool:
        """Whether the verdict shows its requirement; a suspect verdict never does."""
        return shows(self.word, suspect=self.suspect)

    @property
    def severity(self) -> tuple[int, bool]:
        """The key that sorts verdicts, the worst first."""
        return severity(self.word, suspect=self.suspect)


@lru_cache(maxsize=64)
def verdict_mark(word: str, *, suspect: bool = False) -> Mark:
    """The mark of a verdict."""
    return sign_mark(word, VERDICTS[word].sign, suspect=suspect)


def sign_mark(word: str, sign: StatusSymbol, *, suspect: bool = False) -> Mark:
    """The mark of any other outcome."""
    return Mark(word, sign.glyph, sign.kind, suspect)
