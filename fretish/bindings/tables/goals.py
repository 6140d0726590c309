"""The tables `[signal.NAME]` with an `action` or a `service` of ROS 2."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from fretish import units
from fretish.bindings.declarations import Aggregate, GoalChoice, GoalStatus, Path, Signal
from fretish.bindings.tables.signals import SignalTables
from fretish.diagnostics.messages import diagnostic

STATUSES = ("none", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted")
"""The values of an action: no goal, and the names of 1 to 6 in action_msgs/GoalStatus."""
EVENTS = ("request_sent", "request_received", "response_sent", "response_received")
"""The values of a service: the names of the numbers 0 to 3 in service_msgs/ServiceEventInfo."""
_OF_ACTION = ("action", "goal", "status", "max_age", "role", "agg")
_OF_SERVICE = ("service", "max_age", "role", "agg")
_NAME = re.compile(r"/?[A-Za-z_~][\w/~-]*[\w]|/?[A-Za-z]")


class GoalTables(SignalTables):
    """Reader of the tables `[signal.NAME]` with an `action` or a `service`."""

    def signal(self, name: str, table: Mapping[str, Any]) -> Signal | None:
        """The signal; None if it has errors that make it unusable."""
        at, before = ("signal", name), len(self.notes.diagnostics)
        of_action = "action" in table
        key = "action" if of_action else "service"
        fields = _OF_ACTION if of_action else _OF_SERVICE
        self._check_keys(table, fields, f"[signal.{name}] with `{key}`", *at)
        source = self._source(table, (*at, key))
        goals = self._goals(table, at, source) if of_action else None
        is_word = goals is None or goals.choice is GoalChoice.LATEST
        values = STATUSES if of_action else EVENTS
        signal = Signal(
            name,
            Path(f"{source}/_action/status", ("status_list",))
            if of_action
            else Path(f"{source}/_service_event", ("info", "event_type")),
            units.ONE,
            "",
            type="action_msgs/GoalStatusArray" if of_action else None,
            max_age=self._max_age(table, at),
            role=self._role(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            values=values if is_word else (),
            numbers=tuple(range(len(values))) if is_word else (),
            goals=goals,
            span=self.tables.value(*at, key),
        )
        if any(each.is_error for each in self.notes.diagnostics[before:]):
            return None
        self.known[name] = signal
        return signal

    def _source(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        name = table.get(at[-1])
        if isinstance(name, str) and _NAME.fullmatch(name):
            return name
        self._say(diagnostic("no_action_name", self.tables.value(*at), kind=at[-1]))
        return "/"

    def _goals(self, table: Mapping[str, Any], at: tuple[str, ...], action: str) -> GoalStatus:
        choice = self._choice(table, (*at, "goal"), GoalChoice, GoalChoice.LATEST)
        written = table.get("status", [])
        statuses = [written] if isinstance(written, str) else written
        if choice is GoalChoice.LATEST:
            if "status" in table:
                self._say(diagnostic("status_of_latest", self.tables.place(*at, "status")))
            return GoalStatus(action)
        known = STATUSES[1:]
        if not isinstance(statuses, list) or not statuses or not {*statuses} <= {*known}:
            span = self.tables.value(*at, "status")
            self._say(diagnostic("no_status", span, goal=choice, statuses=", ".join(known)))
            return GoalStatus(action)
        return GoalStatus(action, choice, tuple(statuses))
