"""The table `[clock]` of `bindings.toml`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from fretish import units
from fretish.bindings.declarations import Default
from fretish.bindings.tables.fields import Fields
from fretish.clock import Clock, End, Rounding, TimeSource, in_words
from fretish.diagnostics.diagnostic import Code

_TOPIC = re.compile(r"[A-Za-z_~/]\S*")
"""A topic; a duration would begin with a digit."""
_MOST_LATENESS = 60 * 10**9
"""Nanoseconds; a watch must give its verdicts within this time."""
_CLOCK = ("time", "tick", "phase", "lateness", "end", "rounding")


class ClockTable(Fields):
    """Reader of the table `[clock]`."""

    def clock(self) -> Clock:
        """The declared clock; one with a tick of 1 s if the declaration has an error."""
        table = self.tables.data.get("clock")
        if table is None and not self.tables.data.keys() & {"signal", "proposition"}:
            return Clock(None)
        if not isinstance(table, dict):
            self._bad_field(
                "the bindings declare no clock",
                self.tables.text.part(0, 0),
                'add `[clock]` with `tick = "100 ms"`',
            )
            return Clock(10**9)
        self._check_keys(table, _CLOCK, "[clock]", "clock")
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
            self._bad_field(
                "`tick` must be a duration above 0, or a topic",
                self.tables.value("clock", "tick"),
                'write `tick = "100 ms"`, or `tick = "/scan"` for one tick per message',
            )
            return 10**9, None
        return period, None

    def _phase(self, table: Mapping[str, Any], period: int | None) -> int:
        text = table.get("phase", "0 ns")
        phase = units.nanoseconds(text) if isinstance(text, str) else None
        if period is None and "phase" in table:
            message, fix = "a clock that ticks by message has no `phase`", "remove it"
        elif phase is None or (period is not None and not 0 <= phase < period):
            message = "`phase` must be a duration of at least 0 and less than a tick"
            fix = 'for half a tick of 100 ms, write `phase = "50 ms"`'
        else:
            return phase
        self._say(Code.BAD_PHASE, message, self.tables.value("clock", "phase"), fix)
        return 0

    def _lateness(self, table: Mapping[str, Any]) -> int | None:
        if "lateness" not in table:
            return None
        text = table["lateness"]
        lateness = units.nanoseconds(text) if isinstance(text, str) else None
        if lateness is not None and 0 <= lateness <= _MOST_LATENESS:
            return lateness
        self._say(
            Code.BAD_LATENESS,
            f"`lateness` must be a duration from 0 to {in_words(_MOST_LATENESS)}",
            self.tables.value("clock", "lateness"),
            'if messages take less than 50 ms, write `lateness = "50 ms"`',
        )
        return None
