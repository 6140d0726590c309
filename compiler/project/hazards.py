"""The hazards that a project is there to prevent, as `hazards.toml` declares them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from compiler.files.text_files import read
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.reading.toml_text import Tables
from fretish.reading.toml_text import read as read_tables

_FIELDS = ("title", "text", "severity", "source")


@dataclass(frozen=True, slots=True)
class Hazard:
    """What a requirement is there to prevent."""

    id: str
    title: str
    text: str = ""
    severity: str = ""
    source: str = ""


def hazards(path: str) -> tuple[dict[str, Hazard], tuple[Diagnostic, ...]]:
    """`[HAZ-001]` tables with `title`, and perhaps `text`, `severity`, `source`."""
    source = read(path)
    if isinstance(source, Diagnostic):
        return {}, (source,)
    tables = read_tables(source.span(), Code.BAD_HAZARDS, "the hazards file")
    if isinstance(tables, Diagnostic):
        return {}, (tables,)
    wrong = [d for id, fields in tables.data.items() for d in _mistakes(tables, id, fields)]
    if has_errors(wrong):
        return {}, tuple(wrong)
    return {id: Hazard(id, **fields) for id, fields in tables.data.items()}, ()


def _mistakes(tables: Tables, id: str, fields: Any) -> list[Diagnostic]:
    def wrong(message: str, fix: str, *path: str) -> Diagnostic:
        return Diagnostic(Code.BAD_HAZARDS, message, tables.place(*path), help=fix)

    if not isinstance(fields, dict):
        return [wrong(f"`{id}` is not a hazard table", f'write `[{id}]`, then `title = "..."`', id)]
    found = []
    for key, value in fields.items():
        if key not in _FIELDS:
            known = ", ".join(_FIELDS)
            found.append(
                wrong(f"`{key}` is not a field of a hazard", f"it may have {known}", id, key)
            )
        elif not isinstance(value, str):
            found.append(wrong(f"`{key}` must be a text", "write it in quotes", id, key))
    if "title" not in fields:
        found.append(wrong(f"the hazard {id} has no title", 'add `title = "..."`', id))
    return found
