"""Fields of a table of `bindings.toml`, each checked; a mistake becomes a diagnostic."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Any, TypeVar

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import Tables, unknown_key

T = TypeVar("T")
Choice = TypeVar("Choice", bound=StrEnum)


class Fields:
    """The checks that every reader of tables shares."""

    def __init__(self, tables: Tables, diagnostics: list[Diagnostic] | None = None) -> None:
        self.tables = tables
        self.diagnostics: list[Diagnostic] = [] if diagnostics is None else diagnostics

    def _say(self, code: Code, message: str, span: Span, mend: str | None = None) -> None:
        self.diagnostics.append(Diagnostic(code, message, span, mend))

    def _check_keys(
        self, table: Mapping[str, Any], keys: tuple[str, ...], where: str, *at: str
    ) -> None:
        for key in table:
            if key not in keys:
                span = self.tables.place(*at, key)
                self.diagnostics.append(
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
