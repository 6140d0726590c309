"""The tables `[signal.NAME]` whose `value` is a function with memory: `rate(speed)`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from fretish import expressions as e
from fretish import units
from fretish.bindings import expressions as binding
from fretish.bindings.declarations import Aggregate, Memory, Role, Signal
from fretish.bindings.functions import MEMORY, has_memory, window
from fretish.bindings.tables.fields import Fields, Notes
from fretish.bindings.tables.signals import FIELDS as SIGNAL_FIELDS
from fretish.diagnostics.diagnostic import Diagnostic, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import Tables

_FIELDS = ("value", "unit", "role", "agg")
_ONLY_RECORDED = frozenset(SIGNAL_FIELDS) - {*_FIELDS}


class MemoryTables(Fields):
    """Reader of the tables `[signal.NAME]` with memory."""

    def __init__(self, tables: Tables, notes: Notes, known: dict[str, Signal]) -> None:
        """`known`: all recorded signals with a known unit or with words; those read are added."""
        super().__init__(tables, notes)
        self._known = known
        self._recorded = dict(known)
        self._calls = dict(self._written())

    def _written(self) -> Iterator[tuple[str, e.Call]]:
        for name, table in self._tables("signal").items():
            text = table.get("value")
            if isinstance(text, str):
                parsed = binding.parse(self._inside(("signal", name, "value"), text))
                if isinstance(parsed, e.Call) and has_memory(parsed):
                    yield name, parsed

    def tables_with_memory(self) -> dict[str, Mapping[str, Any]]:
        """The tables whose value is a call of a function with memory."""
        return {name: self._tables("signal")[name] for name in self._calls}

    def signal(self, name: str, table: Mapping[str, Any]) -> Signal | None:
        """The signal; None if it has errors."""
        at, call = ("signal", name), self._calls[name]
        before = len(self.notes.diagnostics)
        for key in table:
            if key in _ONLY_RECORDED:
                self._say(diagnostic("computed_signal_field", self.tables.place(*at, key), key=key))
        others = {key: table[key] for key in table if key not in _ONLY_RECORDED}
        self._check_keys(others, _FIELDS, f"[signal.{name}]", *at)
        span = call.span or self.tables.value(*at, "value")
        over = self._over(call, span)
        source = self._source(call, span)
        if isinstance(source, Diagnostic):
            self._say(source)
            return None
        self.notes.keep(at, self.notes.mistakes.get(("signal", source.name), ()))
        unit = self._unit(call, source, table, at)
        if unit is None or len(self.notes.diagnostics) > before:
            return None
        text = " ".join(str(table["value"]).split())
        signal = replace(
            source,
            name=name,
            unit=unit[1],
            unit_name=unit[0],
            max_age=None,
            role=self._choice(table, (*at, "role"), Role, Role.INTERNAL)
            if "role" in table
            else None,
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            memory=Memory(call.name, source.name, over, source.max_age, source.unit, text),
            span=self.tables.value(*at, "value"),
        )
        self._known[name] = signal
        return signal

    def _over(self, call: e.Call, span: Span) -> int | None:
        """The length of the window in nanoseconds; None: there is none, or it has an error."""
        windows = [value for arg in call.args if (value := window(arg)) is not None]
        numbers = len(call.args) - len(windows)
        if numbers != 1 or len(windows) > 1 or (not windows and call.name != "rate"):
            form = MEMORY[call.name]
            self._say(diagnostic("memory_arguments", span, name=call.name, form=form))
            return None
        if not windows:
            return None
        match windows[0]:
            case e.Quantity(digits, unit, place):
                over, place = units.nanoseconds(f"{digits} {unit}"), place or span
            case e.Word(text, place):
                over, place = units.nanoseconds(text), place or span
            case _:
                over, place = None, span
        if not over:
            self._say(diagnostic("memory_window", place))
        return over or None

    def _source(self, call: e.Call, span: Span) -> Signal | Diagnostic:
        """The signal whose samples the function reads, or why there is none."""
        arg = next((arg for arg in call.args if window(arg) is None), None)
        if not isinstance(arg, e.Name):
            return diagnostic("memory_of", span, name=call.name, what="an expression")
        place, written = arg.span or span, self._tables("signal")
        if arg.id not in written:
            fix = did_you_mean(arg.id, self._recorded, "declare it as `[signal.NAME]`")
            return diagnostic("memory_unknown_signal", place, signal=arg.id, help=fix)
        if "value" in written[arg.id]:
            return diagnostic("memory_of", place, name=call.name, what="a computed signal")
        source = self._recorded.get(arg.id)
        if source is None:
            return diagnostic("memory_of", place, name=call.name, what="one with an error")
        if source.pose is not None or source.goals is not None:
            what = "a pose" if source.pose is not None else "an action"
            return diagnostic("memory_of", place, name=call.name, what=what)
        if source.values:
            return diagnostic("memory_of", place, name=call.name, what="one of words")
        if call.name == "count" and source.unit_name:
            return diagnostic("count_with_unit", place, signal=source.name, unit=source.unit_name)
        return source

    def _unit(
        self, call: e.Call, source: Signal, table: Mapping[str, Any], at: tuple[str, ...]
    ) -> tuple[str, units.Unit] | None:
        """Name and unit of the values; None if another one is stated."""
        name = source.unit_name
        if call.name == "rate":
            name = units.unit_quotient(name, "s") if name else "Hz"
        unit = units.unit(name or "1")
        assert unit is not None, "it is made of known units"
        stated = self._field(table, (*at, "unit"), str, "a unit in quotes")
        if stated is None:
            return name, unit
        span = self.tables.value(*at, "unit")
        read = units.unit(stated)
        if read is None:
            self._say(units.unknown_unit(stated, span))
        elif read != unit:
            self._say(diagnostic("memory_unit", span, natural=name or "numbers", unit=stated))
        else:
            return "" if stated == "1" else stated, unit
        return None
