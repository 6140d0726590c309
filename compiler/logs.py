"""Which logs are meant: files, and folders of them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from compiler.files import unreadable
from fretish.diagnostic import Code, Diagnostic
from fretish.source import Source

ANNOTATIONS = ".fretc.mcap"
"""How the names of annotations end: below a folder of logs, they are no logs."""
_BAG = "metadata.yaml"
"""What a folder of rosbag2 holds beside its files."""


def logs(paths: Sequence[str]) -> list[str] | Diagnostic:
    """The files, with those below a folder in its place; each once, folders in order of names.

    Args:
        paths: as the user names them; what is no folder is taken for a file.
    """
    found: dict[str, str] = {}
    for path in paths:
        try:
            files = list(_below(Path(path))) if path and os.path.isdir(path) else [path]
        except OSError as error:
            return unreadable(error.filename or path, error)
        if not files:
            return _empty(path)
        for file in files:
            if isinstance(file, Diagnostic):
                return file
            found.setdefault(os.path.realpath(file), file)
    return list(found.values())


def _below(folder: Path) -> Iterator[str | Diagnostic]:
    entries = sorted(folder.iterdir())
    logs = [entry for entry in entries if not entry.name.endswith(ANNOTATIONS)]
    files = [entry for entry in logs if entry.suffix == ".mcap" and entry.is_file()]
    if len(files) > 1 and folder / _BAG in entries:
        yield _split(folder, len(files))
        return
    for entry in entries:
        if entry in files:
            yield str(entry)
        elif entry.is_dir() and not entry.is_symlink():
            yield from _below(entry)


def _empty(path: str) -> Diagnostic:
    return Diagnostic(
        Code.NO_SUCH_FILE,
        f"no log (`*.mcap`) is in `{path}`",
        Source(path, "").span(),
        help="name the folder that your logs are in",
    )


def _split(folder: Path, count: int) -> Diagnostic:
    return Diagnostic(
        Code.SPLIT_LOG,
        f"`{folder}` is one run in {count} files",
        Source(str(folder), "").span(),
        help="merge them: `mcap merge *.mcap -o run.mcap`, and audit that",
    )
