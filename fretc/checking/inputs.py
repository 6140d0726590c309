"""The files that a check reads, and whether they have changed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from compiler.files.settings import NAME as SETTINGS
from compiler.files.settings import SHARED, Settings, settings

Stamp = tuple[str, int, int, int]
"""Path, identity, size, and time of the last change in ns; zeros for a file that is missing."""


def stamps(requirements: str, beside: Iterable[str | None]) -> frozenset[Stamp]:
    """The present state of all files that a check reads; it differs after each change of one.

    Args:
        requirements: the folder of the requirements, or one file.
        beside: other files that the check reads; None is skipped.
    """
    return frozenset(map(_stamp, {*_of_folder(requirements), *filter(None, beside)}))


def _of_folder(requirements: str) -> Iterator[str]:
    """The files of a folder, the settings above it, and the parents that the settings name."""
    folder = Path(requirements) if os.path.isdir(requirements) else Path(requirements).parent
    yield str(folder)
    try:
        yield from (entry.path for entry in os.scandir(folder) if not entry.is_dir())
    except OSError:
        return  # its own stamp differs when it can be read
    around = folder.resolve()
    for place in (around, *around.parents):
        yield from (str(place / name) for name in (SETTINGS, SHARED))
    chosen = settings(str(folder))
    if isinstance(chosen, Settings):
        yield from (str(chosen.folder / parent) for parent in chosen.parents)


def _stamp(path: str) -> Stamp:
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return path, 0, 0, 0
    return path, status.st_ino, status.st_size, status.st_mtime_ns
