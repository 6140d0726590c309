"""`fretc check --fix`: apply the safe fixes to the sentences of `.fret` files.

A fix is safe if it cannot change what the author means (`Fix.is_safe`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from compiler.files.text_files import read
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.fixes import Fix, apply_fixes
from fretish.diagnostics.source import Source, Span
from fretish.documents import RequirementEntry, requirements
from fretish.formulas.sentences import find_errors
from fretish.reading.limits import with_budget
from fretish.reading.recursion import with_recursion_limit

_MOST_PASSES = 100
"""Passes over one file. A pass finds at most `fretish.parser.MISTAKES` mistakes in a sentence, and
a fix can uncover another mistake, so one pass is not enough. The bound ends fixes that would undo
each other for ever."""


@dataclass(frozen=True, slots=True)
class FixedFile:
    """A file with its safe fixes applied; nothing has been written yet."""

    path: str
    text: str
    fixes: tuple[Fix, ...]
    """The fixes in the order of application. Each span refers to the text at the start of its pass,
    which has the fixes of earlier passes."""


def fixed_files(paths: Sequence[str]) -> tuple[FixedFile, ...]:
    """The files that have a safe fix, with all of their safe fixes applied.

    Files without a safe fix are left out, and so are unreadable ones, which their next reader
    reports.
    """
    sources = (read(path) for path in paths)
    files = (_fixed_file(source) for source in sources if isinstance(source, Source))
    return tuple(file for file in files if file.fixes)


@with_recursion_limit
def _fixed_file(source: Source) -> FixedFile:
    """The file after as many passes as find a safe fix."""
    all_fixes: list[Fix] = []
    for _ in range(_MOST_PASSES):
        fixes = _safe_fixes(source)
        if not fixes:
            break
        all_fixes += fixes
        source = Source(source.name, apply_fixes(source.span(), fixes))
    return FixedFile(source.name, source.text, tuple(all_fixes))


def _safe_fixes(source: Source) -> list[Fix]:
    """The safe fixes of all sentences of a file, in the order that `applied` needs."""
    entries, _ = requirements(source)
    fixes = [
        fix
        for entry in entries
        if _has_a_sentence(entry)
        for fix in _safe_fixes_of_sentence(entry.wording)
    ]
    return sorted(fixes, key=lambda fix: (fix.span.start, fix.span.end))


def _has_a_sentence(requirement: RequirementEntry) -> bool:
    """Whether the wording is intended as FRETish, so that a fix cannot damage other text.

    Free text is not. The wording below a header that does not end is not either: it is the whole
    file.
    """
    unclosed = any(mistake.code is Code.UNCLOSED_HEADER for mistake in requirement.mistakes)
    return not unclosed and not requirement.is_free_text


def _safe_fixes_of_sentence(wording: Span) -> list[Fix]:
    """The safe fixes of one sentence; none if reading it costs too much."""
    diagnostics = with_budget(wording.end - wording.start, wording, partial(find_errors, wording))
    if isinstance(diagnostics, Diagnostic):
        return []
    fixes = (mistake.fix for mistake in diagnostics)
    return [fix for fix in fixes if fix is not None and fix.is_safe]
