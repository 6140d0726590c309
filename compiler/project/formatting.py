"""`fretc fmt`: the sentences of `.fret` files in their canonical wording."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePosixPath

from compiler.files.text_files import read
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.formulas.sentences import find_errors as of_sentence
from fretish.formulas.sentences import parse
from fretish.printer import sentence
from fretish.syntax import Sentence

_WIDTH = 100
_PIECE = re.compile(r'(?:"[^"\n]*"|(?<![\w.])[0-9][\w.+-]* (?=[A-Za-z%])|\S)+')
"""A piece that is not broken over lines: a word, a quoted name, or a number with its unit."""


@dataclass(frozen=True, slots=True)
class Formatted:
    """One file: its present text, and the formatted text."""

    path: str
    before: str
    after: str

    @property
    def name(self) -> PurePosixPath:
        """The path, for writing."""
        return PurePosixPath(self.path)


def formatted_files(paths: Sequence[str]) -> tuple[tuple[Formatted, ...], tuple[Diagnostic, ...]]:
    """Every file with canonical sentences; headers and all other text stay unchanged."""
    files: list[Formatted] = []
    diagnostics: list[Diagnostic] = []
    for path in paths:
        source = read(path)
        if isinstance(source, Diagnostic):
            diagnostics.append(source)
            continue
        entries, mistakes = requirements(source)
        diagnostics.extend(mistakes)
        text, trees = source.text, []
        for requirement in sorted(entries, key=lambda r: -r.wording.start):
            if requirement.is_free_text:
                continue
            tree = parse(requirement.wording)
            if isinstance(tree, Diagnostic):
                diagnostics.extend(of_sentence(requirement.wording))
                continue
            span = requirement.wording
            trees.append(tree)
            text = text[: span.start] + _wrapped(sentence(tree), text) + text[span.end :]
        after = text if text.endswith("\n") else f"{text}\n"
        assert _trees(after) == trees[::-1] or diagnostics, "it is read back as it was"
        files.append(Formatted(path, source.text, after))
    return tuple(files), tuple(diagnostics)


def _trees(text: str) -> list[Sentence | Diagnostic]:
    """The parsed sentences of a file."""
    entries, _ = requirements(Source("", text))
    return [parse(entry.wording) for entry in entries if not entry.is_free_text]


def _wrapped(text: str, file: str) -> str:
    """The text in lines of at most 100 characters, with the line ends of the file."""
    lines = [""]
    for piece in _PIECE.findall(text):
        if lines[-1] and len(lines[-1]) + 1 + len(piece) > _WIDTH:
            lines.append("")
        lines[-1] += f" {piece}" if lines[-1] else piece
    return ("\r\n" if "\r\n" in file else "\n").join(lines)
