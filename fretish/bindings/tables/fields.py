"""Fields of a table of `bindings.toml`, each checked; a mistake becomes a diagnostic."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, TypeVar

from fretish import expressions as e
from fretish.bindings import expressions as binding
from fretish.bindings.declarations import Default, Modality, Part
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.toml_text import Tables, unknown_key

_ACTION = re.compile(r"[a-z][A-Za-z0-9_]*")
T = TypeVar("T")
Choice = TypeVar("Choice", bound=StrEnum)


@dataclass(slots=True)
class Notes:
    """What one walk over the tables collects."""

    diagnostics: list[Diagnostic] = field(default_factory=list)
    defaults: list[Default] = field(default_factory=list)
    mistakes: dict[Part, tuple[Diagnostic, ...]] = field(default_factory=dict)
    """Of each signal, proposition and shared table that has any."""
    malformed: set[str] = field(default_factory=set)
    """Kinds of tables that are none, and have a diagnostic."""

    def keep(self, part: Part, mistakes: Iterable[Diagnostic]) -> None:
        """Note that a part has mistakes, if it has any, beside those it has already."""
        all_mistakes = tuple(dict.fromkeys((*self.mistakes.get(part, ()), *mistakes)))
        if all_mistakes:
            self.mistakes[part] = all_mistakes


class Fields:
    """The checks that every reader of tables shares."""

    def __init__(self, tables: Tables, notes: Notes) -> None:
        self.tables = tables
        self.notes = notes

    def _say(self, code: Code, message: str, span: Span, fix: str | None = None) -> None:
        self.notes.diagnostics.append(Diagnostic(code, message, span, fix))

    def _check_keys(
        self, table: Mapping[str, Any], keys: tuple[str, ...], where: str, *at: str
    ) -> None:
        for key in table:
            if key not in keys:
                span = self.tables.place(*at, key)
                self.notes.diagnostics.append(
                    unknown_key(Code.UNKNOWN_BINDING_FIELD, key, keys, span, where)
                )

    def _field(
        self, table: Mapping[str, Any], at: tuple[str, ...], kind: type[T], form: str
    ) -> T | None:
        """The field at the path, if it is there and of that type."""
        value = table.get(at[-1])
        if value is None or (
            isinstance(value, kind) and not (kind is int and isinstance(value, bool))
        ):
            return value
        place = self.tables.value(*at)
        self._say(Code.BAD_BINDING_FIELD, f"`{at[-1]}` must be {form}", place, f"write {form}")
        return None

    def _choice(
        self, table: Mapping[str, Any], at: tuple[str, ...], kind: type[Choice], default: Choice
    ) -> Choice:
        value = table.get(at[-1])
        if value is None:
            return default
        values = [str(choice) for choice in kind]
        if value in values:
            return kind(value)
        self._say(
            Code.BAD_BINDING_FIELD,
            f"`{at[-1]}` cannot be `{value}`",
            self.tables.value(*at),
            f"it may be {', '.join(values)}",
        )
        return default

    def _tables(self, kind: str) -> dict[str, Mapping[str, Any]]:
        tables = self.tables.data.get(kind, {})
        if not isinstance(tables, dict) or not all(isinstance(t, dict) for t in tables.values()):
            if kind in self.notes.malformed:
                return {}
            self.notes.malformed.add(kind)
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`{kind}` must hold tables",
                self.tables.place(kind),
                f"write `[{kind}.NAME]`",
            )
            return {}
        return tables

    def _expression(self, table: Mapping[str, Any], at: tuple[str, ...]) -> e.Expression | None:
        text = self._field(table, at, str, 'an expression in quotes: `"min_range < 5 cm"`')
        if text is None:
            return None
        parsed = binding.parse(self._inside(at, text))
        if isinstance(parsed, Diagnostic):
            self.notes.diagnostics.append(parsed)
            return None
        return parsed

    def _inside(self, at: tuple[str, ...], text: str) -> Span:
        """The characters between the quotes, so that mistakes point into the file."""
        value = self.tables.value(*at)
        start = value.text.find(text)
        if start < 0:  # written with escapes: the text stands for itself
            return Source(f"{value.source.name} ({'.'.join(at)})", text).span()
        return value.part(start, start + len(text))

    def _modality(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Modality:
        if table.get("modality") != "P":
            return self._choice(table, (*at, "modality"), Modality, Modality.BELIEF)
        self._say(
            Code.BAD_MODALITY,
            f"`{at[1]}` cannot be a percept (`P`): AJPF takes a percept for absent once the agent "
            "has read it",
            self.tables.value(*at, "modality"),
            'say what the agent believes: `modality = "B"`',
        )
        return Modality.BELIEF

    def _action(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        action = table.get("action", "")
        if action == "" or (isinstance(action, str) and _ACTION.fullmatch(action)):
            return str(action)
        self._say(
            Code.BAD_BINDING_FIELD,
            "`action` must be a name of Gwendolen: a small letter, then letters, digits and `_`",
            self.tables.value(*at, "action"),
            'write `action = "stop_moving"`',
        )
        return ""
