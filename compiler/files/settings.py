"""`fretc.toml`, or `[tool.fretc]` of `pyproject.toml`: settings of a whole project.

Only the nearest file upwards counts; within one folder it is `fretc.toml`. The search ends at the
root of the repository (`.git`), because a folder above it may belong to somebody else. Outside of a
repository it ends at the current folder.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from compiler.files import log_viewer
from compiler.files.attribution import FIELDS, NOBODY, Attribution, InvalidField, attribution
from compiler.files.text_files import is_file
from compiler.files.text_files import read as read_text
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import Tables, unknown_key
from fretish.reading.toml_text import read as read_tables

NAME, SHARED = "fretc.toml", "pyproject.toml"
_TABLE = ("tool", "fretc")
"""The table of the settings in `pyproject.toml`, which other tools share."""
SETTINGS_FIELDS = ("parents", "accept", "project", "viewer")
OUTSIDE: ContextVar[tuple[str, ...]] = ContextVar("OUTSIDE", default=())
"""Folders outside of the project that may contain parents, named on the command line."""


@dataclass(frozen=True, slots=True)
class Settings:
    """The settings of one project."""

    folder: Path
    """The folder of the file; paths in it are relative to that."""
    parents: tuple[str, ...] = ()
    """Documents of other tools that contain parents of requirements."""
    accept: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    """Code of a warning → the reason for accepting it, for all of them or by subject."""
    project: Attribution = NOBODY
    """Maintainer and license of the project."""
    viewer: str = ""
    """The address at which another program shows a log at a time; "" if there is none."""
    tables: Tables | None = None
    table: tuple[str, ...] = ()
    """The table of the file that contains the settings."""
    root: Path | None = None
    """The outermost folder of the project, within which parents must lie; None: `folder`."""

    def place(self, *path: str) -> Span:
        """The span of the value of a setting."""
        assert self.tables is not None
        return self.tables.value(*self.table, *path)

    def holds(self, path: Path) -> bool:
        """Whether a document is in the project, or in a folder that the command line names."""
        allowed = (self.root or self.folder, *map(Path, OUTSIDE.get()))
        real = path.resolve()
        return any(real.is_relative_to(folder.resolve()) for folder in allowed)


def settings(folder: str) -> Settings | Diagnostic:
    """The settings of a folder of requirements: the nearest upwards.

    Returns:
        Empty settings if there is no file; or a diagnostic of the settings.
    """
    start = Path(folder).resolve()
    places = list(_project(start))
    for place in places:
        for name, table in ((NAME, ()), (SHARED, _TABLE)):
            path = place / name
            result = _read(path, places[-1], table) if is_file(path) else None
            if result is not None:
                return result
    return Settings(start)


def repository(folder: Path) -> Path | None:
    """The root of the repository that contains a folder; None if there is none."""
    around = (folder, *folder.parents)
    return next((place for place in around if (place / ".git").exists()), None)


def _project(start: Path) -> Iterator[Path]:
    """The folder and the folders above it that belong to the same project."""
    around = (start, *start.parents)
    root = repository(start)
    if root is None:
        here = Path.cwd().resolve()
        root = here if start.is_relative_to(here) else start
    yield from around[: around.index(root) + 1]


def _read(path: Path, root: Path, table: tuple[str, ...]) -> Settings | Diagnostic | None:
    """The settings in a file; None if it has no such table."""
    source = read_text(_display_path(path))
    if isinstance(source, Diagnostic):
        return source
    if ".".join(table) not in source.text:
        return None
    tables = read_tables(source.span(), Code.BAD_SETTINGS, path.name)
    if isinstance(tables, Diagnostic):
        return tables
    table_value: Any = tables.data
    for key in table:
        table_value = table_value.get(key)
        if table_value is None:
            return None
    return _settings(Settings(path.parent, tables=tables, table=table, root=root), table_value)


def _display_path(path: Path) -> str:
    """The path as shown to users."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def _settings(empty: Settings, table: Any) -> Settings | Diagnostic:
    """The settings of the table.

    Args:
        empty: empty settings of the file that the table is in.
        table: the value of the table.
    """
    if not isinstance(table, dict):
        return _bad_settings(empty, "`fretc` must be a table", "write `[tool.fretc]`")
    assert empty.tables is not None
    for key in table:
        if key not in SETTINGS_FIELDS:
            span = empty.tables.place(*empty.table, key)
            where = f"[{'.'.join(empty.table)}]" if empty.table else NAME
            return unknown_key(Code.BAD_SETTINGS, key, SETTINGS_FIELDS, span, where)
    parents, accept = table.get("parents", []), table.get("accept", {})
    if not isinstance(parents, list) or not all(isinstance(path, str) for path in parents):
        fix = 'write `parents = ["build/hazards/json/index.json"]`'
        return _bad_settings(empty, "`parents` must be a list of paths", fix, "parents")
    if not isinstance(accept, dict):
        return _bad_settings(empty, "`accept` must be a table", f"write {_ACCEPT}", "accept")
    for code, reason in accept.items():
        reasons = reason.values() if isinstance(reason, dict) else [reason]
        if not all(isinstance(text, str) for text in reasons):
            message = f"`{code}` must have a reason, or a table of reasons"
            return _bad_settings(empty, message, f"write {_ACCEPT}", "accept", code)
    project = _project_table(empty, table.get("project", {}))
    if isinstance(project, Diagnostic):
        return project
    viewer = table.get("viewer", "")
    mistake = log_viewer.mistake(viewer) if "viewer" in table else ""
    if mistake:
        fix = f"write one such as `{log_viewer.EXAMPLE}`"
        return _bad_settings(empty, f"`viewer` {mistake}", fix, "viewer")
    return replace(empty, parents=tuple(parents), accept=accept, project=project, viewer=viewer)


def _project_table(empty: Settings, table: Any) -> Attribution | Diagnostic:
    """The attribution in `[project]`."""
    assert empty.tables is not None
    if not isinstance(table, dict):
        return _bad_settings(empty, "`project` must be a table", "write `[project]`", "project")
    for key in table:
        if key not in FIELDS:
            span = empty.tables.place(*empty.table, "project", key)
            where = f"[{'.'.join((*empty.table, 'project'))}]"
            return unknown_key(Code.BAD_SETTINGS, key, FIELDS, span, where)
    project = attribution(table)
    if isinstance(project, InvalidField):
        message = f"`{project.field}` {project.what}"
        return _bad_settings(empty, message, project.fix, "project", project.field)
    return project


_ACCEPT = '`F631 = "the reason"`, or `F315 = { "/battery" = "the reason" }`, under `[accept]`'


def _bad_settings(settings: Settings, message: str, fix: str, *path: str) -> Diagnostic:
    assert settings.tables is not None
    span = settings.tables.place(*settings.table, *path)
    return Diagnostic(Code.BAD_SETTINGS, message, span, help=fix)
