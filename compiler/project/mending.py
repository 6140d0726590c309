"""`fretc check --fix`: the mends that are sure, put into the sentences of `.fret` files."""

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

_ROUNDS = 100
"""Of mending a file: each has at most `fretish.parser.MISTAKES` mends for a sentence."""


@dataclass(frozen=True, slots=True)
class MendedFile:
    """A file with all mends in place."""

    path: str
    text: str
    mends: tuple[Mend, ...]
    """Those that were applied, each at its place before it was."""


def mended(paths: Sequence[str]) -> tuple[MendedFile, ...]:
    """Every file that has a sure mend, with it; the others, and those without a text, are left out.

    What is no mistake, or has a mend that is not sure, stays as it is.
    """
    sources = (read(path) for path in paths)
    files = (_file(source) for source in sources if isinstance(source, Source))
    return tuple(file for file in files if file.mends)


@deep
def _file(source: Source) -> MendedFile:
    found: list[Mend] = []
    for _ in range(_ROUNDS):
        mends = sure_mends(source)
        if not mends:
            break
        found += mends
        source = Source(source.name, applied(source.span(), mends))
    return MendedFile(source.name, source.text, tuple(found))


def sure_mends(source: Source) -> list[Mend]:
    """Those of all sentences of a text, in its order."""
    entries, _ = requirements(source)
    found = [mend for entry in entries if _is_sentence(entry) for mend in _mends(entry.wording)]
    return sorted(found, key=lambda mend: (mend.span.start, mend.span.end))


def _is_sentence(requirement: Requirement) -> bool:
    """Not where it is free text, or where the header does not end and nothing is known of it."""
    unclosed = any(each.code is Code.UNCLOSED_HEADER for each in requirement.mistakes)
    return not unclosed and not requirement.is_free_text


def _mends(wording: Span) -> list[Mend]:
    found = within(wording.end - wording.start, wording, partial(mistakes, wording))
    known = () if isinstance(found, Diagnostic) else found
    return [each.mend for each in known if each.mend is not None and each.mend.sure]
