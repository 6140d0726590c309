"""`fretc check --fix`: apply the sure mends to the sentences of `.fret` files.

A mend is sure where it can say nothing but what the author means (`Mend.sure`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from compiler.files.text_files import read
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.mends import Mend, applied
from fretish.diagnostics.source import Source, Span
from fretish.documents import Requirement, requirements
from fretish.parser import mistakes
from fretish.reading.limits import within
from fretish.reading.recursion import deep

_MOST_PASSES = 100
"""Passes over one file. A pass finds at most `fretish.parser.MISTAKES` mistakes in a sentence, and
a mend can uncover another mistake, so one pass is not enough. The bound ends mends that would undo
each other for ever."""


@dataclass(frozen=True, slots=True)
class MendedFile:
    """A file with its sure mends applied; nothing has been written yet."""

    path: str
    text: str
    mends: tuple[Mend, ...]
    """In the order of their application. The span of each is in the text that its pass began with,
    which has the mends of earlier passes in it."""


def mended(paths: Sequence[str]) -> tuple[MendedFile, ...]:
    """The files that have a sure mend, with all of their sure mends applied.

    Files without a sure mend are left out, and so are those that cannot be read: whoever reads
    them next reports that.
    """
    sources = (read(path) for path in paths)
    files = (_mended_file(source) for source in sources if isinstance(source, Source))
    return tuple(file for file in files if file.mends)


@deep
def _mended_file(source: Source) -> MendedFile:
    """The file after as many passes as find a sure mend."""
    all_mends: list[Mend] = []
    for _ in range(_MOST_PASSES):
        mends = _sure_mends(source)
        if not mends:
            break
        all_mends += mends
        source = Source(source.name, applied(source.span(), mends))
    return MendedFile(source.name, source.text, tuple(all_mends))


def _sure_mends(source: Source) -> list[Mend]:
    """The sure mends of all sentences of a file, in the order that `applied` needs."""
    entries, _ = requirements(source)
    mends = [
        mend
        for entry in entries
        if _has_a_sentence(entry)
        for mend in _sure_mends_of_sentence(entry.wording)
    ]
    return sorted(mends, key=lambda mend: (mend.span.start, mend.span.end))


def _has_a_sentence(requirement: Requirement) -> bool:
    """Whether its wording is meant as FRETish, so that a mend cannot spoil another text.

    Free text is not. Nor is the wording below a header that does not end: it is the whole file.
    """
    unclosed = any(mistake.code is Code.UNCLOSED_HEADER for mistake in requirement.mistakes)
    return not unclosed and not requirement.is_free_text


def _sure_mends_of_sentence(wording: Span) -> list[Mend]:
    """Those of one sentence; none where reading it would cost too much."""
    found = within(wording.end - wording.start, wording, partial(mistakes, wording))
    if isinstance(found, Diagnostic):
        return []
    mends = (mistake.mend for mistake in found)
    return [mend for mend in mends if mend is not None and mend.sure]
