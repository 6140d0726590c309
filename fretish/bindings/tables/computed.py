"""The tables `[signal.NAME]` with a `value`: signals that are computed from others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from fractions import Fraction
from typing import Any

from fretish import expressions as e
from fretish import units
from fretish.bindings import expressions as binding
from fretish.bindings.calculations import (
    MOST_LEVELS,
    MOST_PARTS,
    with_calculations,
    with_clamps_as_ends,
)
from fretish.bindings.declarations import Aggregate, ComputedSignal, MeasuredSignal, Role, Signal
from fretish.bindings.definitions import cycle_from
from fretish.bindings.functions import MEMORY, ROUNDED, has_memory
from fretish.bindings.tables.fields import Fields, Notes
from fretish.bindings.tables.signals import FIELDS as SIGNAL_FIELDS
from fretish.bindings.words import resolve_number
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import Tables

_FIELDS = ("value", "unit", "role", "agg")
_ONLY_RECORDED = frozenset(SIGNAL_FIELDS) - {*_FIELDS}
_NamedUnit = tuple[str, units.Unit]


class ComputedTables(Fields):
    """Reader of the tables `[signal.NAME]` with a `value`."""

    def __init__(self, tables: Tables, notes: Notes, signals: Mapping[str, Signal]) -> None:
        """`signals`: all recorded signals with a known unit or with words."""
        super().__init__(tables, notes)
        self._measured: dict[str, MeasuredSignal] = dict(signals)
        """All signals that a value can name; computed ones are added."""
        self._kinds: dict[str, binding.Kind] = {
            name: signal.unit.dimension for name, signal in signals.items()
        }
        self._written = dict(self._expressions())
        self._circular: Set[str] = frozenset()
        """The signals with a circular value, and those that need one."""
        self._sizes: dict[str, int] = {}
        self._levels: dict[str, int] = {}
        self.known: dict[str, ComputedSignal] = {}
        """The signals that were read without errors."""

    def _expressions(self) -> Iterator[tuple[str, e.Expression]]:
        """The values that can be parsed, but those with memory, which `MemoryTables` reads.

        The others get their errors when they are read.
        """
        for name, table in self._tables("signal").items():
            text = table.get("value")
            if isinstance(text, str):
                parsed = binding.parse(self._inside(("signal", name, "value"), text))
                if not isinstance(parsed, Diagnostic) and not has_memory(parsed):
                    yield name, parsed

    def ordered(self, tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
        """The tables, each after the tables of the signals in its value, as far as possible."""
        needed = {
            name: {part.id for part in e.names(value)} & self._written.keys()
            for name, value in self._written.items()
        }
        users: dict[str, list[str]] = {}
        for name, names in needed.items():
            for each in names:
                users.setdefault(each, []).append(name)
        missing = {name: len(names) for name, names in needed.items()}
        unread = [name for name in tables if name not in missing]
        ready = [*unread, *(name for name in tables if missing.get(name) == 0)]
        for name in ready:
            for user in users.get(name, ()):
                missing[user] -= 1
                if not missing[user]:
                    ready.append(user)
        self._circular = tables.keys() - {*ready}
        return {name: tables[name] for name in (*ready, *tables)}

    def signal(self, name: str, table: Mapping[str, Any]) -> ComputedSignal | None:
        """The signal; None if it has errors."""
        at = ("signal", name)
        self._check_fields(table, *at)
        before = len(self.notes.diagnostics)
        stated = self._unit(table, (*at, "unit"))
        written = self._expression(table, (*at, "value"))
        value = None if written is None else self._value(name, written)
        if written is None or value is None or len(self.notes.diagnostics) > before:
            return None
        unit = self._fitting_unit(value, stated, at)
        if unit is None:
            return None
        signal = ComputedSignal(
            name,
            value,
            unit[1],
            "" if unit[0] == "1" else unit[0],
            " ".join(str(table["value"]).split()),
            any(isinstance(part, e.Call) and part.name in ROUNDED for part in e.parts(written)),
            self._choice(table, (*at, "role"), Role, Role.INTERNAL) if "role" in table else None,
            self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            self.tables.value(*at, "value"),
        )
        self.known[name] = self._measured[name] = signal
        self._kinds[name] = signal.unit.dimension
        return signal

    def _check_fields(self, table: Mapping[str, Any], *at: str) -> None:
        for key in table:
            if key in _ONLY_RECORDED:
                self._say(diagnostic("computed_signal_field", self.tables.place(*at, key), key=key))
        others = {key: table[key] for key in table if key not in _ONLY_RECORDED}
        self._check_keys(others, _FIELDS, f"[signal.{at[1]}]", *at)

    def _fitting_unit(
        self, value: e.Expression, stated: _NamedUnit | None, at: tuple[str, ...]
    ) -> _NamedUnit | None:
        """The stated unit, or the base unit of the value; None if the stated one does not fit."""
        kind = binding.dimension(value, self._kinds, self.tables.value(*at, "value"))
        assert isinstance(kind, tuple), "it is a number"
        if stated is None:
            return units.base_name(kind), units.Unit(kind, Fraction(1))
        if stated[1].dimension == kind:
            return stated
        self._say(
            diagnostic(
                "value_of_other_unit",
                self.tables.value(*at, "unit"),
                what=binding.in_words(kind),
                unit=stated[0],
            )
        )
        return None

    def _unit(self, table: Mapping[str, Any], at: tuple[str, ...]) -> _NamedUnit | None:
        """The declared unit; None if there is none, or it has an error."""
        name = self._field(table, at, str, "a unit in quotes")
        if name is None:
            return None
        unit = units.unit(name)
        if unit is None:
            self._say(units.unknown_unit(name, self.tables.value(*at)))
            return None
        return name, unit

    def _value(self, name: str, written: e.Expression) -> e.Expression | None:
        """The checked value, with computed signals as calculations; None if it has errors."""
        at, span = ("signal", name), self.tables.value("signal", name, "value")
        names = dict.fromkeys(part.id for part in e.names(written))
        if name in self._circular:
            circle = cycle_from(name, self._written)
            self._say(diagnostic("circular_signals", span, names=", ".join(circle)))
            return None
        self.notes.keep(
            at, [m for id in names for m in self.notes.mistakes.get(("signal", id), ())]
        )
        self._sizes[name] = sum(
            self._sizes.get(part.id, 1) if isinstance(part, e.Name) else 1
            for part in e.parts(written)
        )
        inner = max((self._levels.get(id, 0) for id in names), default=0)
        self._levels[name] = e.depth(written) + inner
        if self._sizes[name] > MOST_PARTS or self._levels[name] > MOST_LEVELS:
            self._say(diagnostic("value_too_large", span, parts=MOST_PARTS, levels=MOST_LEVELS))
            return None
        tables = self._tables("signal")
        if any(id in tables and id not in self._measured for id in names):
            return None  # The signal already has a diagnostic.
        refused = self._refusal(written, self._inside((*at, "value"), span.text.strip("\"'")))
        if refused is not None:
            self._say(refused)
            return None
        return with_calculations(with_clamps_as_ends(written), self.known)

    def _refusal(self, written: e.Expression, span: Span) -> Diagnostic | None:
        """Why the expression is no value of a signal."""
        if binding.ticks_back(written) or any(
            isinstance(part, e.Persistence) for part in e.parts(written)
        ):
            return diagnostic("value_with_memory", span)
        inner = next((part for part in e.parts(written) if has_memory(part)), None)
        if isinstance(inner, e.Call):
            form = MEMORY[inner.name]
            return diagnostic("memory_within", inner.span or span, name=inner.name, form=form)
        if not any(e.names(written)):
            return diagnostic("value_without_signal", span)
        resolved = resolve_number(written, self._measured, span)
        if isinstance(resolved, Diagnostic):
            return resolved
        kind = binding.dimension(resolved, self._kinds, span)
        if isinstance(kind, Diagnostic):
            return kind
        return diagnostic("value_is_truth", span) if kind is None else None
