"""Fields of a table of `bindings.toml`, each checked; a mistake is kept with its place."""

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
    """What every reader of tables does."""

    def __init__(self, tables: Tables, wrong: list[Diagnostic] | None = None) -> None:
        self.tables = tables
        self.wrong: list[Diagnostic] = [] if wrong is None else wrong

    def _say(self, code: Code, message: str, span: Span, mend: str | None = None) -> None:
        self.wrong.append(Diagnostic(code, message, span, mend))

    def _known(
        self, table: Mapping[str, Any], known: tuple[str, ...], where: str, *at: str
    ) -> None:
        for key in table:
            if key not in known:
                span = self.tables.place(*at, key)
                self.wrong.append(unknown_key(Code.UNKNOWN_BINDING_FIELD, key, known, span, where))

    def _field(
        self, table: Mapping[str, Any], at: tuple[str, ...], kind: type[T], what: str
    ) -> T | None:
        """The field at the path, if it is there and of that type."""
        value = table.get(at[-1])
        if value is None or (
            isinstance(value, kind) and not (kind is int and isinstance(value, bool))
        ):
            return value
        place = self.tables.value(*at)
        self._say(Code.BAD_BINDING_FIELD, f"`{at[-1]}` must be {what}", place, f"write {what}")
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
