"""The table `[clock]` of `bindings.toml`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from fretish import units
from fretish.bindings.declarations import Default
from fretish.bindings.tables.fields import Fields
from fretish.clock import Clock, End, Rounding, TimeSource, in_words
from fretish.diagnostics.messages import diagnostic

_TOPIC = re.compile(r"[A-Za-z_~/]\S*")
"""A topic; a duration would begin with a digit."""
_MOST_LATENESS = 60 * 10**9
"""Nanoseconds; a watch must give its verdicts within this time."""
FIELDS = ("time", "tick", "phase", "lateness", "end", "rounding")


class ClockTable(Fields):
    """Reader of the table `[clock]`."""

    def clock(self) -> Clock:
        """The declared clock; one with a tick of 1 s if the declaration has an error."""
        table = self.tables.data.get("clock")
        if table is None and not self.tables.data.keys() & {"signal", "proposition"}:
            return Clock(None)
        if not isinstance(table, dict):
            self._say(diagnostic("clock_missing", self.tables.text.part(0, 0)))
            return Clock(10**9)
        self._check_keys(table, FIELDS, "[clock]", "clock")
        for name, default in (("time", TimeSource.LOG_TIME), ("end", End.INCONCLUSIVE)):
            if table.get(name, default) == default:
                text = f"clock: {name} is {default}, the default"
                self.notes.defaults.append(Default(("clock", ""), text, name in table))
        period, topic = self._tick(table)
        return Clock(
            period,
            topic,
            self._choice(table, ("clock", "time"), TimeSource, TimeSource.LOG_TIME),
            self._choice(table, ("clock", "end"), End, End.INCONCLUSIVE),
            self._choice(table, ("clock", "rounding"), Rounding, Rounding.EXACT),
            self._phase(table, period),
            self._lateness(table),
        )

    def _tick(self, table: Mapping[str, Any]) -> tuple[int | None, str | None]:
        tick = table.get("tick")
        if isinstance(tick, str) and _TOPIC.fullmatch(tick):
            return None, tick
        period = units.nanoseconds(tick) if isinstance(tick, str) else None
        if not period:
            self._say(diagnostic("bad_tick", self.tables.value("clock", "tick")))
            return 10**9, None
        return period, None

    def _phase(self, table: Mapping[str, Any], period: int | None) -> int:
        text = table.get("phase", "0 ns")
        phase = units.nanoseconds(text) if isinstance(text, str) else None
        if period is None and "phase" in table:
            self._say(diagnostic("phase_without_period", self.tables.value("clock", "phase")))
        elif phase is None or (period is not None and not 0 <= phase < period):
            self._say(diagnostic("bad_phase", self.tables.value("clock", "phase")))
        else:
            return phase
        return 0

    def _lateness(self, table: Mapping[str, Any]) -> int | None:
        if "lateness" not in table:
            return None
        text = table["lateness"]
        lateness = units.nanoseconds(text) if isinstance(text, str) else None
        if lateness is not None and 0 <= lateness <= _MOST_LATENESS:
            return lateness
        self._say(
            diagnostic(
                "bad_lateness",
                self.tables.value("clock", "lateness"),
                most=in_words(_MOST_LATENESS),
            )
        )
        return None
