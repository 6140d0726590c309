"""The mark of a verdict: a word and a symbol, for all formats of a report."""

from __future__ import annotations

from functools import lru_cache

from fretc.audit.evidence.verdicts import SUSPECT, VERDICTS, severity, shows
from fretish.classes.frozen import dataclass
from fretish.diagnostics.status_symbols import StatusSymbol


@dataclass(frozen=True, slots=True)
class Mark:
    """A verdict for a reader: a word, a symbol, and `kind`, the class of its colour."""

    word: str
    glyph: str
    kind: str
    suspect: bool = False
    """Whether an input of the verdict has changed."""

    @property
    def text(self) -> str:
        """`violated`, or `violated, suspect`."""
        return f"{self.word}, {SUSPECT}" if self.suspect else self.word

    @property
    def shows(self) -> bool:
        """Whether the verdict shows that the requirement holds; a suspect verdict never does."""
        return shows(self.word, suspect=self.suspect)

    @property
    def severity(self) -> tuple[int, bool]:
        """Sort key of verdicts, worst first."""
        return severity(self.word, suspect=self.suspect)


@lru_cache(maxsize=64)
def verdict_mark(word: str, *, suspect: bool = False) -> Mark:
    """The mark of a verdict."""
    return sign_mark(word, VERDICTS[word].sign, suspect=suspect)


def sign_mark(word: str, sign: StatusSymbol, *, suspect: bool = False) -> Mark:
    """The mark of any other outcome."""
    return Mark(word, sign.glyph, sign.kind, suspect)
