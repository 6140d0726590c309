"""`[tool.fretc]` of `pyproject.toml`: settings of a whole project, wherever a command runs.

The search goes up to the root of the repository (`.git`) and no further: a folder above it may
belong to somebody else. Outside of a repository it ends at the present folder.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from compiler.files.text_files import read as read_text
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.reading.toml_text import Tables, unknown_key
from fretish.reading.toml_text import read as read_tables

NAME = "pyproject.toml"
_FIELDS = ("parents",)
OUTSIDE: ContextVar[tuple[str, ...]] = ContextVar("OUTSIDE", default=())
"""Folders outside of the project in which parents may be, as the command line names them."""


@dataclass(frozen=True, slots=True)
class Settings:
    """The settings of one project."""

    folder: Path
    """Where `pyproject.toml` is; paths in it start there."""
    parents: tuple[str, ...] = ()
    """Documents of other tools in which parents of requirements live."""
    tables: Tables | None = None
    root: Path | None = None
    """The project's outermost folder, which parents do not leave; None: `folder` is."""

    def holds(self, path: Path) -> bool:
        """Whether a document is the project's, or in a folder that the command line names."""
        allowed = (self.root or self.folder, *map(Path, OUTSIDE.get()))
        real = path.resolve()
        return any(real.is_relative_to(folder.resolve()) for folder in allowed)


def settings(folder: str) -> Settings | Diagnostic:
    """The settings that hold for a folder of requirements: the nearest upwards that there are.

    Returns:
        Empty settings where no `pyproject.toml` speaks of fretc; or what is wrong with them.
    """
    start = Path(folder).resolve()
    places = list(_project(start))
    for place in places:
        path = place / NAME
        if path.is_file():
            result = _read(path, places[-1])
            if result is not None:
                return result
    return Settings(start)


def _project(start: Path) -> Iterator[Path]:
    """The folder and those above it, as far as they are one project."""
    around = (start, *start.parents)
    root = next((place for place in around if (place / ".git").exists()), None)
    if root is None:
        here = Path.cwd().resolve()
        root = here if start.is_relative_to(here) else start
    yield from around[: around.index(root) + 1]


def _read(path: Path, root: Path) -> Settings | Diagnostic | None:
    """None where the file has no `[tool.fretc]`."""
    source = read_text(_display_path(path))
    if isinstance(source, Diagnostic):
        return source
    if "tool.fretc" not in source.text:
        return None
    tables = read_tables(source.span(), Code.BAD_SETTINGS, NAME)
    if isinstance(tables, Diagnostic):
        return tables
    table = tables.data.get("tool", {}).get("fretc")
    return None if table is None else _settings(path.parent, root, tables, table)


def _display_path(path: Path) -> str:
    """The path as a user would write it."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def _settings(folder: Path, root: Path, tables: Tables, table: Any) -> Settings | Diagnostic:
    if not isinstance(table, dict):
        return _bad_settings(
            tables, "`fretc` must be a table", "write `[tool.fretc]`", "tool", "fretc"
        )
    for key in table:
        if key not in _FIELDS:
            span = tables.place("tool", "fretc", key)
            return unknown_key(Code.BAD_SETTINGS, key, _FIELDS, span, "[tool.fretc]")
    parents = table.get("parents", [])
    if not isinstance(parents, list) or not all(isinstance(path, str) for path in parents):
        mend = 'write `parents = ["build/hazards/json/index.json"]`'
        return _bad_settings(
            tables, "`parents` must be a list of paths", mend, "tool", "fretc", "parents"
        )
    return Settings(folder, tuple(parents), tables, root)


def _bad_settings(tables: Tables, message: str, mend: str, *path: str) -> Diagnostic:
    return Diagnostic(Code.BAD_SETTINGS, message, tables.place(*path), help=mend)
