"""Where the names of a project are declared and used.

A name of sentences is one name, whether the bindings declare it as a proposition, a signal, a
variable, or several of these. Requirements, hazards and components have names of their own.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from enum import StrEnum
from typing import Any

from compiler.files.settings import NAME as SETTINGS
from compiler.files.text_files import read
from compiler.project.paths import BINDINGS, HAZARDS
from compiler.project.project import Project
from fretish.bindings import expressions as bindings
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry
from fretish.parser import words
from fretish.reading import toml_text
from fretish.reading.lalr import Token
from fretish.reading.memory import remembered
from fretish.reading.toml_text import Tables


class NameKind(StrEnum):
    """What a name stands for; the values are shown to users."""

    VARIABLE = "name"
    """A proposition, signal, variable or mode of sentences."""
    COMPONENT = "component"
    REQUIREMENT = "requirement"
    HAZARD = "hazard"
    CODE = "code"
    """The code of an accepted warning."""


class Notation(StrEnum):
    """How a name is written at a place."""

    SENTENCE = "sentence"
    """A word of FRETish."""
    QUOTED = "quoted"
    """A word of FRETish in quotes, which the span is between."""
    EXPRESSION = "expression"
    """A word of an expression of the bindings."""
    KEY = "key"
    """A key of TOML, in quotes if it has to be."""
    TEXT = "text"
    """Between the quotes of a text of TOML."""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name at a place."""

    kind: NameKind
    name: str
    span: Span
    notation: Notation
    is_declaration: bool = False
    owner: str = ""
    """The id of the requirement that it is in; "" in other files."""

    @property
    def key(self) -> tuple[NameKind, str]:
        """Equal for all occurrences of the same name."""
        return self.kind, self.name


def occurrences(project: Project, folder: str) -> list[Occurrence]:
    """All occurrences of names in the files of a project.

    Args:
        project: the project.
        folder: its folder; the files beside the requirements are read.
    """
    every: list[Occurrence] = []
    for entry in project.requirements:
        every.extend(of_requirement(entry))
    for entry in project.declarations.environment if project.declarations else ():
        every.extend(of_sentence(entry.wording))
    for name, reader in _SIDE_FILES.items():
        tables = side_tables(os.path.join(folder, name))
        if tables is not None:
            every.extend(reader(tables))
    ids = {entry.id for entry in project.requirements}
    return [_resolved(each, ids) for each in every]


def _resolved(occurrence: Occurrence, ids: set[str]) -> Occurrence:
    """A parent as the requirement or the hazard that it is."""
    if occurrence.kind is NameKind.HAZARD and occurrence.name in ids:
        return replace(occurrence, kind=NameKind.REQUIREMENT)
    return occurrence


def side_tables(path: str) -> Tables | None:
    """The tables of a TOML file beside the requirements; None if it is no TOML, or missing."""
    source = read(path)
    if isinstance(source, Diagnostic):
        return None
    tables = toml_text.read(source.span(), Code.BAD_BINDINGS, "the file")
    return None if isinstance(tables, Diagnostic) else tables


# Requirements -------------------------------------------------------------------------------------


@remembered
def of_requirement(entry: RequirementEntry) -> tuple[Occurrence, ...]:
    """The occurrences in the header and the sentence of a requirement."""
    header = () if entry.header is None else tuple(_of_header(entry, entry.header))
    sentence = () if entry.is_free_text else tuple(of_sentence(entry.wording))
    return tuple(replace(each, owner=entry.id) for each in (*header, *sentence))


def _of_header(entry: RequirementEntry, header: Tables) -> Iterator[Occurrence]:
    data = header.data
    if isinstance(data.get("id"), str):
        place = header.value("id")
        if place.text == f'"{entry.id}"':
            inner = place.part(1, len(place.text) - 1)
            yield Occurrence(NameKind.REQUIREMENT, entry.id, inner, Notation.TEXT, True)
    if isinstance(data.get("parents"), list):
        yield from _texts(header.value("parents"), NameKind.HAZARD)
    yield from _keys(header, ("params",), NameKind.VARIABLE)
    yield from _keys(header, ("accept",), NameKind.CODE)


_TEXT = re.compile(r'"([^"\\\n]*)"')


def _texts(place: Span, kind: NameKind) -> Iterator[Occurrence]:
    """The texts of a list."""
    for match in _TEXT.finditer(place.text):
        yield Occurrence(kind, match[1], place.part(*match.span(1)), Notation.TEXT)


def _keys(tables: Tables, path: tuple[str, ...], kind: NameKind) -> Iterator[Occurrence]:
    """The keys of a table within TOML."""
    table: Any = tables.data
    for key in path:
        table = table.get(key, {}) if isinstance(table, Mapping) else {}
    for name in table if isinstance(table, Mapping) else ():
        place = _key(tables, *path, name)
        if place is not None:
            yield Occurrence(kind, name, place, Notation.KEY)


def _key(tables: Tables, *path: str) -> Span | None:
    """The last key of a path, without quotes; None if it is written with escapes."""
    place, name = tables.place(*path), path[-1]
    for spelt in (f'"{name}"', f"'{name}'", name):
        if place.text.endswith(spelt):
            start = len(place.text) - len(spelt) + spelt.index(name)
            return place.part(start, start + len(name))
    return None


def of_sentence(wording: Span) -> Iterator[Occurrence]:
    """The names of a sentence, right or wrong: functions and words of FRETish are none."""
    tokens = words(wording.text)
    for at, token in enumerate(tokens):
        if token.type not in ("ID", "QUOTED") or _is_call(tokens, at):
            continue
        quoted = token.type == "QUOTED"
        span = wording.part(token.start_pos + quoted, token.end_pos - quoted)
        kind = NameKind.COMPONENT if _is_component(tokens, at) else NameKind.VARIABLE
        notation = Notation.QUOTED if quoted else Notation.SENTENCE
        yield Occurrence(kind, span.text, span, notation, kind is NameKind.COMPONENT)


def _is_call(tokens: tuple[Token, ...], at: int) -> bool:
    return at + 1 < len(tokens) and tokens[at + 1] == "("


def _is_component(tokens: tuple[Token, ...], at: int) -> bool:
    """Whether the name is beside `shall`, as in `the Rover shall` and `shall the Rover`."""
    if at + 1 < len(tokens) and tokens[at + 1].type == "SHALL":
        return True
    before = [token.type for token in tokens[max(0, at - 2) : at]]
    return before[-1:] == ["SHALL"] or before == ["SHALL", "THE"]


# Files beside the requirements --------------------------------------------------------------------


def _of_bindings(tables: Tables) -> Iterator[Occurrence]:
    for kind in ("signal", "proposition", "variable"):
        named = tables.data.get(kind)
        for name, table in named.items() if isinstance(named, dict) else ():
            place = _key(tables, kind, name)
            if place is not None:
                yield Occurrence(NameKind.VARIABLE, name, place, Notation.KEY, True)
            if isinstance(table, dict):
                yield from _of_table(tables, (kind, name), table)
    for axis in ("x", "y"):
        place = tables.data.get("map")
        if isinstance(place, dict) and isinstance(place.get(axis), str) and "/" not in place[axis]:
            yield from _texts(tables.value("map", axis), NameKind.VARIABLE)
    assumed = tables.data.get("assume")
    if isinstance(assumed, dict) and isinstance(assumed.get("stands"), str):
        yield from _texts(tables.value("assume", "stands"), NameKind.VARIABLE)


def _of_table(
    tables: Tables, path: tuple[str, str], table: Mapping[str, Any]
) -> Iterator[Occurrence]:
    """The names in the expressions of a table."""
    if isinstance(table.get("component"), str):
        yield from _texts(tables.value(*path, "component"), NameKind.COMPONENT)
    if isinstance(table.get("value"), str):
        place = _inner(tables.value(*path, "value"), table["value"])
        yield from of_sentence(place) if place is not None else ()
    if isinstance(table.get("expr"), str):
        place = _inner(tables.value(*path, "expr"), table["expr"])
        yield from _of_expression(place) if place is not None else ()


def _inner(value: Span, text: str) -> Span | None:
    """The span between the quotes; None if the text has escapes."""
    inner = value.part(1, len(value.text) - 1) if len(value.text) > 1 else value
    return inner if inner.text == text else None


def _of_expression(place: Span) -> Iterator[Occurrence]:
    tokens = bindings.words(place.text)
    for at, token in enumerate(tokens):
        if token.type == "ID" and not _is_call(tokens, at):
            span = place.part(token.start_pos, token.end_pos)
            yield Occurrence(NameKind.VARIABLE, str(token), span, Notation.EXPRESSION)


def _of_hazards(tables: Tables) -> Iterator[Occurrence]:
    yield from _declared(tables, NameKind.HAZARD)


def _of_waivers(tables: Tables) -> Iterator[Occurrence]:
    for each in _declared(tables, NameKind.REQUIREMENT):
        yield replace(each, is_declaration=False)


def _declared(tables: Tables, kind: NameKind) -> Iterator[Occurrence]:
    for name in tables.data:
        place = _key(tables, name)
        if place is not None:
            yield Occurrence(kind, name, place, Notation.KEY, True)


def _of_settings(tables: Tables) -> Iterator[Occurrence]:
    accepted = tables.data.get("accept")
    yield from _keys(tables, ("accept",), NameKind.CODE)
    for code, reasons in accepted.items() if isinstance(accepted, dict) else ():
        if isinstance(reasons, dict):
            yield from _keys(tables, ("accept", code), NameKind.HAZARD)


_SIDE_FILES = {
    BINDINGS: _of_bindings,
    HAZARDS: _of_hazards,
    "waivers.toml": _of_waivers,
    SETTINGS: _of_settings,
    os.path.join("..", SETTINGS): _of_settings,
}
"""File beside the requirements, or the settings above them → its occurrences."""
