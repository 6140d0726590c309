"""The tables `[signal.NAME]` of `bindings.toml`."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

from fretish import expressions as e
from fretish import units
from fretish.bindings import expressions as binding
from fretish.bindings.declarations import (
    REP_117,
    Aggregate,
    Default,
    InvalidReadings,
    Path,
    Reading,
    Reduce,
    Role,
    Signal,
    path,
)
from fretish.bindings.tables.fields import Fields, Notes
from fretish.bindings.tables.vocabulary import ValuesField
from fretish.diagnostics.messages import diagnostic
from fretish.reading.toml_text import Tables

FIELDS = (
    "path", "value", "type", "reduce", "unit", "valid", "invalid", "max_age", "footprint", "sensor",
    "values", "role", "agg",
)  # fmt: skip
_OF_NUMBERS = ("unit", "valid", "invalid", "reduce", "footprint", "sensor")
"""Fields of a signal that cannot be combined with `values`."""
_NOWHERE = Path("", ())
_INVALID = {
    "nan": "nan",
    "+inf": "positive_infinity",
    "-inf": "negative_infinity",
    "other": "other",
}


class SignalTables(Fields):
    """Reader of the tables `[signal.NAME]`."""

    def __init__(
        self, tables: Tables, notes: Notes, known: dict[str, Signal] | None = None
    ) -> None:
        """`known`: the signals that other readers have read, to which this one adds its own."""
        super().__init__(tables, notes)
        self.known: dict[str, Signal] = {} if known is None else known
        """All signals with a known unit or with words, even if they have other errors."""

    def signal(self, name: str, table: Mapping[str, Any]) -> Signal | None:
        """The signal; None if it has errors that make it unusable."""
        at = ("signal", name)
        self._check_keys(table, FIELDS, f"[signal.{name}]", *at)
        where = self._path(table, (*at, "path"))
        if "values" in table:
            return self._enumerated(name, table, where)
        unit_name = self._field(table, (*at, "unit"), str, "a unit in quotes")
        if unit_name is None and "unit" not in table:
            unit_name = "1"
        unit = units.unit(unit_name) if unit_name is not None else None
        if unit is None and unit_name is not None:
            self.notes.diagnostics.append(
                units.unknown_unit(unit_name, self.tables.value(*at, "unit"))
            )
        reduce = self._reduce(table, at, where)
        valid = self._valid(table, (*at, "valid"))
        footprint = self._footprint(table, at, reduce)
        type_ = self._field(table, (*at, "type"), str, "a message type in quotes")
        if unit is None or unit_name is None:
            return None
        signal = Signal(
            name,
            where or _NOWHERE,
            unit,
            "" if unit_name == "1" else unit_name,
            type=type_,
            reduce=reduce,
            valid=valid,
            invalid=self._invalid(table, at, type_),
            max_age=self._max_age(table, at),
            footprint=footprint,
            sensor=self._sensor(table, at),
            role=self._role(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            span=self.tables.value(*at, "path"),
        )
        self.known[name] = signal
        return signal if where is not None else None

    def _enumerated(self, name: str, table: Mapping[str, Any], where: Path | None) -> Signal | None:
        """An enumerated signal."""
        at = ("signal", name)
        for key in _OF_NUMBERS:
            if key in table:
                self._say(diagnostic("word_signal_field", self.tables.place(*at, key), key=key))
        if where is not None and where.each:
            self._say(diagnostic("word_signal_of_many", self.tables.value(*at, "path")))
        values, numbers = ValuesField(self.tables, self.notes).words(
            table["values"], (*at, "values")
        )
        signal = Signal(
            name,
            where or _NOWHERE,
            units.ONE,
            "",
            type=self._field(table, (*at, "type"), str, "a message type in quotes"),
            max_age=self._max_age(table, at),
            values=values,
            numbers=numbers,
            role=self._role(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            span=self.tables.value(*at, "path"),
        )
        if values:
            self.known[name] = signal
        return signal if where is not None and values else None

    def _role(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Role | None:
        """The declared role; None if there is none."""
        if "role" not in table:
            return None
        return self._choice(table, (*at, "role"), Role, Role.INTERNAL)

    def _valid(self, table: Mapping[str, Any], at: tuple[str, ...]) -> e.Expression | None:
        valid = self._expression(table, at)
        if valid is None:
            return None
        if binding.ticks_back(valid):
            self._say(diagnostic("pre_in_valid", self.tables.value(*at)))
            return None
        if self._calls_function_of_values(valid, self.tables.value(*at)):
            return None
        if any(isinstance(part, e.Word) for part in e.parts(valid)):
            self._say(diagnostic("word_in_valid", self.tables.value(*at)))
            return None
        if binding.is_truth(valid):
            return valid
        self._say(diagnostic("valid_is_number", self.tables.value(*at)))
        return None

    def _path(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Path | None:
        text = table.get("path")
        read = path(text) if isinstance(text, str) else None
        if read is None:
            self._say(diagnostic("bad_path" if text else "path_missing", self.tables.value(*at)))
        return read

    def _reduce(
        self, table: Mapping[str, Any], at: tuple[str, ...], where: Path | None
    ) -> Reduce | None:
        each = where is not None and where.each
        if "reduce" in table and not each and where is not None:
            self._say(diagnostic("reduce_without_many", self.tables.value(*at, "reduce")))
        if "reduce" not in table and each:
            self._say(diagnostic("many_without_reduce", self.tables.value(*at, "path")))
        if "reduce" not in table:
            return None
        return self._choice(table, (*at, "reduce"), Reduce, Reduce.MIN)

    def _invalid(
        self, table: Mapping[str, Any], at: tuple[str, ...], type_: str | None
    ) -> InvalidReadings:
        scan = type_ is not None and type_.endswith("/LaserScan")
        default = REP_117 if scan else InvalidReadings()
        fields = self._field(table, (*at, "invalid"), dict, "a table of readings")
        words = "as REP 117 says" if scan else "unknown"
        text = f"signal {at[1]}: readings that are no measurement are {words}"
        if fields is None:
            self.notes.defaults.append(Default((at[0], at[1]), text, is_explicit=False))
            return default
        self._check_keys(fields, (*_INVALID, "empty"), "`invalid`", *at, "invalid")
        place = (*at, "invalid")
        if fields.get("empty", "unknown") != "unknown":
            self._say(diagnostic("bad_empty", self.tables.value(*place, "empty")))
        values = {
            attribute: self._choice(fields, (*place, key), Reading, getattr(default, attribute))
            for key, attribute in _INVALID.items()
        }
        invalid = InvalidReadings(**values)
        if invalid == default:
            self.notes.defaults.append(Default((at[0], at[1]), text, is_explicit=True))
        return invalid

    def _max_age(self, table: Mapping[str, Any], at: tuple[str, ...]) -> int | None:
        text = self._field(table, (*at, "max_age"), str, 'a duration: `"300 ms"`')
        if "max_age" not in table:
            old = f"signal {at[1]}: a sample never grows too old (no max_age)"
            self.notes.defaults.append(Default((at[0], at[1]), old))
        age = units.nanoseconds(text) if text is not None else None
        if text is not None and not age:
            self._say(diagnostic("bad_max_age", self.tables.value(*at, "max_age")))
        return age

    def _footprint(
        self, table: Mapping[str, Any], at: tuple[str, ...], reduce: Reduce | None
    ) -> tuple[tuple[float, float], ...]:
        corners = table.get("footprint", [])
        good = isinstance(corners, list) and all(_is_numbers(c, 2) for c in corners)
        if reduce is Reduce.OUTLINE and (not good or len(corners) < 3):
            self._say(diagnostic("outline_without_footprint", self.tables.value(*at, "footprint")))
            return ()
        return tuple((float(x), float(y)) for x, y in corners) if good else ()

    def _sensor(self, table: Mapping[str, Any], at: tuple[str, ...]) -> tuple[float, float, float]:
        pose = table.get("sensor", [0.0, 0.0, 0.0])
        if not _is_numbers(pose, 3):
            self._say(diagnostic("bad_sensor_pose", self.tables.value(*at, "sensor")))
            return 0.0, 0.0, 0.0
        return float(pose[0]), float(pose[1]), float(pose[2])


def _is_numbers(value: object, count: int) -> bool:
    return (
        isinstance(value, list)
        and len(value) == count
        and all(isinstance(n, int | float) and isfinite(n) for n in value)
    )
