"""The table `[map]` of `bindings.toml`: the robot's coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fretish import units
from fretish.bindings.declarations import MapCoordinates, Signal, path
from fretish.bindings.tables.fields import Fields, Notes
from fretish.diagnostics.messages import diagnostic
from fretish.reading.toml_text import Tables

FIELDS = ("x", "y")


class MapTable(Fields):
    """Reader of the table `[map]`."""

    def __init__(self, tables: Tables, notes: Notes, signals: Mapping[str, Signal]) -> None:
        """`signals`: all signals with a known unit."""
        super().__init__(tables, notes)
        self._signals = signals

    def map(self) -> MapCoordinates | None:
        """The map; None if the table is absent or has errors, which become diagnostics."""
        table = self.tables.data.get("map")
        if table is None:
            return None
        if not isinstance(table, dict):
            self._say(diagnostic("map_not_table", self.tables.place("map")))
            return None
        self._check_keys(table, FIELDS, "[map]", "map")
        x, y = self._coordinate(table, "x"), self._coordinate(table, "y")
        return MapCoordinates(x, y) if x is not None and y is not None else None

    def _coordinate(self, table: Mapping[str, Any], key: str) -> Signal | None:
        """A coordinate, in the unit of the signal with the same path, else in metres."""
        text = table.get(key)
        where = path(text) if isinstance(text, str) else None
        if where is None or where.each:
            self._say(
                diagnostic(
                    "bad_map_coordinate",
                    self.tables.value("map", key) if key in table else self.tables.place("map"),
                    key=key,
                )
            )
            return None
        same = next((signal for signal in self._signals.values() if signal.path == where), None)
        own = same or Signal("", where, units.METRE, "m")
        if own.unit.dimension != units.METRE.dimension:
            self._say(
                diagnostic(
                    "map_coordinate_not_length",
                    self.tables.value("map", key),
                    key=key,
                    signal=own.name,
                    unit=own.unit_name or "plain numbers",
                )
            )
            return None
        return replace(own, name=f"[map] {key}", span=self.tables.value("map", key))
