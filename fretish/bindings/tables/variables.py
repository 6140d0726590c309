"""The tables `[variable.NAME]` of `bindings.toml`: FRET's fields and values of variables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite
from typing import Any

from fretish import expressions as e
from fretish.bindings.declarations import Role, Variable
from fretish.bindings.definitions import find_cycle
from fretish.bindings.tables.fields import Fields
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.parser import parse_value
from fretish.reading.toml_text import as_key

FIELDS = ("component", "type", "role", "text", "value", "fret", "of", "modality", "action")
_OF_COMPONENT = ("type", "role", "text", "value", "fret")
_FRET = ("variable",)
_MOST_NAMES = 12
"""The largest number of names of a cycle in a message."""


class VariableTables(Fields):
    """Reader of the tables `[variable.NAME]` and `[[fret.variable]]`."""

    def variables(self) -> dict[str, Variable]:
        """All variables, including those with errors."""
        variables = {name: self._variable(name, f) for name, f in self._tables("variable").items()}
        components = dict.fromkeys(name for variable in variables.values() for name in variable.of)
        self._check_definitions(variables, "")
        for component in components:
            own = {
                name: variable.of.get(component, variable) for name, variable in variables.items()
            }
            self._check_definitions(own, component)
        return variables

    def kept(self) -> tuple[Mapping[str, Any], ...]:
        """The records of `[[fret.variable]]`, which only FRET uses."""
        table = self._field(self.tables.data, ("fret",), dict, "a table") or {}
        self._check_keys(table, _FRET, "[fret]", "fret")
        records = self._field(table, ("fret", "variable"), list, "tables of FRET's fields") or []
        if not all(isinstance(record, dict) for record in records):
            self._say(diagnostic("variables_not_tables", self.tables.value("fret", "variable")))
            return ()
        self._check_fret(records, ("fret", "variable"))
        return tuple(records)

    def _check_fret(self, value: object, at: tuple[str, ...]) -> None:
        """F303 for a value that JSON, FRET's file format, cannot store: a date or a NaN."""
        waiting = [value]
        while waiting:
            part = waiting.pop()
            if isinstance(part, dict):
                waiting.extend(part.values())
            elif isinstance(part, list):
                waiting.extend(part)
            elif not (isinstance(part, str | int) or (isinstance(part, float) and isfinite(part))):
                self._say(diagnostic("not_stored_by_fret", self.tables.value(*at), part=part))
                return

    def _variable(self, name: str, table: Mapping[str, Any]) -> Variable:
        at = ("variable", name)
        self._check_keys(table, FIELDS, f"[variable.{name}]", *at)
        of = self._field(table, (*at, "of"), dict, "tables of components") or {}
        if not all(isinstance(own_table, dict) for own_table in of.values()):
            self._say(
                diagnostic("components_not_tables", self.tables.value(*at, "of"), key=as_key(name))
            )
            of = {}
        whole = self._fields_of_variable(name, table, at)
        own = {
            component: replace(
                self._fields_of_variable(name, own_table, (*at, "of", component)),
                component=component,
                modality=whole.modality,
                action=whole.action,
            )
            for component, own_table in of.items()
        }
        return replace(whole, of=own)

    def _fields_of_variable(
        self, name: str, table: Mapping[str, Any], at: tuple[str, ...]
    ) -> Variable:
        if len(at) > 2:
            self._check_keys(table, _OF_COMPONENT, f"[{'.'.join(at)}]", *at)
        texts = {
            key: self._field(table, (*at, key), str, "a text in quotes") or ""
            for key in ("component", "type", "role", "text")
        }
        fret = self._field(table, (*at, "fret"), dict, "a table of texts") or {}
        self._check_fret(fret, (*at, "fret"))
        value, place = self._value(table, (*at, "value"))
        if value is not None and texts["role"] not in ("", Role.INTERNAL, Role.MODE):
            self._say(
                diagnostic(
                    "role_of_definition",
                    self.tables.value(*at, "role"),
                    name=name,
                    role=texts["role"],
                )
            )
        return Variable(
            name,
            component=texts["component"],
            type=texts["type"],
            role=texts["role"],
            text=texts["text"],
            fret=fret,
            modality=self._modality(table, at),
            action=self._action(table, at),
            value=value,
            span=place,
        )

    def _value(
        self, table: Mapping[str, Any], at: tuple[str, ...]
    ) -> tuple[e.Expression | None, Span | None]:
        """The value of a variable, and its span."""
        text = self._field(table, at, str, 'an expression in quotes: `"1.5 m/s"`')
        if text is None:
            return None, None
        span = self._inside(at, text)
        value = parse_value(span)
        if isinstance(value, Diagnostic):
            self.notes.diagnostics.append(value)
            return None, span
        return value, span

    def _check_definitions(self, variables: Mapping[str, Variable], component: str) -> None:
        """F342 for a cyclic definition, F343 for a name that is also a signal or a proposition.

        Args:
            variables: the variables that apply to the component.
            component: the name of a component; empty: any component without its own values.
        """
        values = {name: v.value for name, v in variables.items() if v.value is not None}
        for name in values:
            kinds = [kind for kind in ("signal", "proposition") if name in self._tables(kind)]
            other = f"by `[{kinds[0]}.{name}]`" if kinds else "by FRETish, as the first tick"
            if kinds or name == "FTP":
                self._say(
                    diagnostic(
                        "defined_twice", self._of_value(name, component), name=name, other=other
                    )
                )
        chain = find_cycle(values)
        if chain:
            self._say(
                diagnostic(
                    "circular_definitions",
                    self._of_value(chain[0], component),
                    names=" -> ".join(chain[:_MOST_NAMES]),
                    more=" ..." if len(chain) > _MOST_NAMES else "",
                )
            )

    def _of_value(self, name: str, component: str) -> Span:
        """The span of the value of a variable."""
        own = component in self._tables("variable")[name].get("of", {})
        return self.tables.value("variable", name, *(("of", component) if own else ()), "value")
