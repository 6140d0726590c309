"""`fretc fmt`: the sentences of `.fret` files in their canonical wording."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from compiler.files.text_files import read
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import requirements
from fretish.parser import mistakes as of_sentence
from fretish.parser import parse
from fretish.printer import sentence

_WIDTH = 100


@dataclass(frozen=True, slots=True)
class Formatted:
    """One file: its text as it is, and as it should be."""

    path: str
    before: str
    after: str

    @property
    def name(self) -> PurePosixPath:
        """The path, for writing."""
        return PurePosixPath(self.path)


def formatted(paths: Sequence[str]) -> tuple[tuple[Formatted, ...], tuple[Diagnostic, ...]]:
    """Every file with its sentences canonical; headers and what stands around stay as they are."""
    files: list[Formatted] = []
    diagnostics: list[Diagnostic] = []
    for path in paths:
        source = read(path)
        if isinstance(source, Diagnostic):
            diagnostics.append(source)
            continue
        entries, mistakes = requirements(source)
        diagnostics.extend(mistakes)
        text = source.text
        for requirement in sorted(entries, key=lambda r: -r.wording.start):
            if requirement.is_free_text:
                continue
            tree = parse(requirement.wording)
            if isinstance(tree, Diagnostic):
                diagnostics.extend(of_sentence(requirement.wording))
                continue
            span = requirement.wording
            text = text[: span.start] + _wrapped(sentence(tree)) + text[span.end :]
        files.append(Formatted(path, source.text, text if text.endswith("\n") else f"{text}\n"))
    return tuple(files), tuple(diagnostics)


def _wrapped(text: str) -> str:
    """Lines of at most 100 characters, broken at spaces; a quoted name is never broken."""
    lines = textwrap.wrap(
        text,
        _WIDTH,
        expand_tabs=False,
        replace_whitespace=False,
        break_long_words=False,
        break_on_hyphens=False,
    )
    wrapped = "\n".join(lines)
    return wrapped if all(line.count('"') % 2 == 0 for line in lines) else text
