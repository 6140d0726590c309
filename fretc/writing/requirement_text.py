"""The chosen sentence as a requirement of a `.fret` file, with the English text in its header."""

from __future__ import annotations

from pathlib import PurePath

import tomli_w

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import IDENTIFIER, RequirementEntry, requirements


def free_id(path: str, file: Source | None) -> str:
    """An id that the file does not have: its name, or the name and a number.

    Args:
        path: the path of the `.fret` file.
        file: its present content; None: there is none.
    """
    stem = "".join(c if c.isascii() and (c.isalnum() or c in "_.-") else "-" for c in _stem(path))
    name = stem if IDENTIFIER.fullmatch(stem) else "requirement"
    taken = {entry.id.lower() for entry in requirements(file)[0]} if file else set()
    number = 1
    while (id := name if number == 1 else f"{name}-{number}").lower() in taken:
        number += 1
    return id


def _stem(path: str) -> str:
    return PurePath(path).stem


def appended(
    file: Source, id: str, english: str, sentence: str
) -> tuple[str, RequirementEntry] | Diagnostic:
    """The text of a `.fret` file with a requirement at its end, and that requirement.

    Args:
        file: the present content, or an empty one.
        id: the id of the requirement.
        english: the text that it was chosen for.
        sentence: FRETish.

    Returns:
        F979 if the id cannot be used or is taken, or an error of the present file.
    """
    if IDENTIFIER.fullmatch(id) is None:
        return diagnostic("bad_id_to_write", id=id)
    before = file.text if not file.text or file.text.endswith("\n") else f"{file.text}\n"
    if file.text.strip():
        entries, mistakes = requirements(file)
        if mistakes:
            return mistakes[0]
        if id.lower() in {entry.id.lower() for entry in entries}:
            return diagnostic("id_to_write_is_taken", id=id, path=file.name)
    header = tomli_w.dumps({"id": id, "text": " ".join(english.split())})
    text = f"{before}+++\n{header}+++\n{sentence}\n"
    entries, mistakes = requirements(Source(file.name, text))
    if mistakes:
        return mistakes[0]
    return text, entries[-1]
