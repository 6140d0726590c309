"""Base class of the readers of `bindings.toml`: checked fields, errors as diagnostics."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import field
from enum import StrEnum
from typing import Any, TypeVar

from fretish import expressions as e
from fretish.bindings import expressions as binding
from fretish.bindings.declarations import Default, Modality, Part
from fretish.bindings.functions import MEMORY, OF_VALUES, has_memory
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.toml_text import Tables, unknown_key

ACTION = re.compile(r"[a-z][A-Za-z0-9_]*")
"""A name of Gwendolen."""
T = TypeVar("T")
Choice = TypeVar("Choice", bound=StrEnum)


@dataclass(slots=True)
class Notes:
    """Diagnostics and defaults that the readers of the tables collect."""

    diagnostics: list[Diagnostic] = field(default_factory=list)
    defaults: list[Default] = field(default_factory=list)
    mistakes: dict[Part, tuple[Diagnostic, ...]] = field(default_factory=dict)
    """Signal, proposition or shared table with errors → these errors."""
    malformed: set[str] = field(default_factory=set)
    """Names such as `signal` whose value is not a table; each has a diagnostic."""

    def keep(self, part: Part, mistakes: Iterable[Diagnostic]) -> None:
        """Add errors to those of a part."""
        all_mistakes = tuple(dict.fromkeys((*self.mistakes.get(part, ()), *mistakes)))
        if all_mistakes:
            self.mistakes[part] = all_mistakes


class Fields:
    """Checks that all readers of tables share."""

    def __init__(self, tables: Tables, notes: Notes) -> None:
        self.tables = tables
        self.notes = notes

    def _say(self, mistake: Diagnostic) -> None:
        self.notes.diagnostics.append(mistake)

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
        """The field at the path; None if it is absent or has another type, which is reported."""
        value = table.get(at[-1])
        if value is None or (
            isinstance(value, kind) and not (kind is int and isinstance(value, bool))
        ):
            return value
        span = self.tables.value(*at)
        self._say(diagnostic("field_of_wrong_kind", span, field=at[-1], form=form))
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
            diagnostic(
                "choice_not_known",
                self.tables.value(*at),
                field=at[-1],
                value=value,
                values=", ".join(values),
            )
        )
        return default

    def _tables(self, kind: str) -> dict[str, Mapping[str, Any]]:
        tables = self.tables.data.get(kind, {})
        if not isinstance(tables, dict) or not all(isinstance(t, dict) for t in tables.values()):
            if kind in self.notes.malformed:
                return {}
            self.notes.malformed.add(kind)
            self._say(diagnostic("not_tables", self.tables.place(kind), kind=kind))
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

    def _calls_function_of_values(self, expression: e.Expression, place: Span) -> bool:
        """Whether an expression that is no value of a signal calls such a function: F308."""
        for part in e.parts(expression):
            if isinstance(part, e.Call) and (has_memory(part) or part.name in OF_VALUES):
                form = MEMORY[part.name] if has_memory(part) else OF_VALUES[part.name].form
                span = part.span or place
                self._say(diagnostic("function_of_values", span, name=part.name, form=form))
                return True
        return False

    def _inside(self, at: tuple[str, ...], text: str) -> Span:
        """The span between the quotes, so that diagnostics refer to the file."""
        value = self.tables.value(*at)
        start = value.text.find(text)
        if start < 0:  # The text has escapes: it becomes its own source.
            return Source(f"{value.source.name} ({'.'.join(at)})", text).span()
        return value.part(start, start + len(text))

    def _modality(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Modality:
        if table.get("modality") != "P":
            return self._choice(table, (*at, "modality"), Modality, Modality.BELIEF)
        self._say(
            diagnostic("no_percept_in_bindings", self.tables.value(*at, "modality"), name=at[1])
        )
        return Modality.BELIEF

    def _action(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        action = table.get("action", "")
        if action == "" or (isinstance(action, str) and ACTION.fullmatch(action)):
            return str(action)
        self._say(diagnostic("bad_action", self.tables.value(*at, "action")))
        return ""
