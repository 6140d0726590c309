"""Paths of a project: the requirement files, and the files beside them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from compiler.files.text_files import is_file, unreadable, unsaved_names
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.natural_order import natural

BINDINGS = "bindings.toml"
HAZARDS = "hazards.toml"


def requirement_files(folder: str) -> list[str] | Diagnostic:
    """The `.fret` files of a folder in natural order (`r2` before `r10`); or the given file."""
    try:
        if not _is_folder(folder):
            return [folder] if is_file(folder) else _absent("there is no folder", folder)
        names = dict.fromkeys((*os.listdir(folder), *unsaved_names(folder)))
        listed = sorted((name for name in names if name.endswith(".fret")), key=natural)
    except OSError as error:
        return unreadable(folder, error)
    paths = [str(Path(folder) / name) for name in listed]
    return [path for path in paths if not _is_folder(path)] or _absent(
        "no requirement (`*.fret`) is in", folder
    )


def _absent(what: str, folder: str) -> Diagnostic:
    return diagnostic("no_project_folder", Source(folder, "").span(), what=what, folder=folder)


def _is_folder(path: str) -> bool:
    """Whether the path is a folder; the empty path is not, though Python accepts it."""
    return bool(path) and path != "-" and os.path.isdir(path)


def expanded_paths(paths: Sequence[str]) -> list[str] | Diagnostic:
    """The files, with folders replaced by their files; each once, however it is spelt.

    The order is that of `paths`, or the natural one if `paths` has the order of a shell's `*.fret`.
    """
    by_identity: dict[str, str] = {}
    for path in sorted(paths, key=natural) if [*paths] == sorted(paths) else paths:
        files = requirement_files(path) if _is_folder(path) else [path]
        if isinstance(files, Diagnostic):
            return replace(files, help="name `.fret` files, or a folder with `.fret` files")
        for file in files:
            by_identity.setdefault(os.path.realpath(file) if file != "-" else file, file)
    return list(by_identity.values())


def sibling_path(folder: str, name: str) -> str | None:
    """The path of a file in the requirements folder; None if it is missing."""
    return first_sibling_path([folder if is_file(folder) else str(Path(folder) / "any")], name)


def companions(paths: Sequence[str]) -> tuple[str, ...]:
    """The files beside the first requirement that are read with it; no output may replace them."""
    names = (BINDINGS, HAZARDS, "fretc.toml", "fretc.lock", "waivers.toml", "allowed_signers")
    return tuple(
        path for path in (first_sibling_path(paths, name) for name in names) if path is not None
    )


def first_sibling_path(paths: Sequence[str], name: str) -> str | None:
    """The path of a file in the folder of the first path; None if it is missing."""
    first = next((path for path in paths if path != "-"), None)
    path = str(Path(first).parent / name) if first else None
    exists = path is not None and (is_file(path) or os.path.exists(path))
    return path if exists else None
