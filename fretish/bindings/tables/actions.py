"""The tables of an agent: `[action.NAME]` and `[call.NAME]`, what its actions do; `[agent]`."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

from fretish import units
from fretish.bindings.declarations import ActionBinding, ServiceCall, short_type
from fretish.bindings.tables.fields import ACTION, Fields
from fretish.bindings.tables.interceptor import TOPIC
from fretish.diagnostics.messages import diagnostic

ROS_TYPE = re.compile(r"(?P<package>[a-z]\w*)/(?P<message>[A-Z]\w*)", re.ASCII)
"""A message type without `msg`, as in ROS 1."""
FIELDS = ("topic", "type", "message")
CALL_FIELDS = ("service", "type", "request", "limit")
AGENT_FIELDS = ("trace",)
_LIMIT, _LONGEST = 400_000_000, 60_000_000_000
"""Nanoseconds, the default and the most; a stop is requested after 500 ms without perception."""
_EXAMPLES = {
    "topic": '"/gwendolen_control"',
    "type": '"std_msgs/Bool"',
    "message": "{ data = true }",
}
_CALL_EXAMPLES = {"service": '"/gripper/close"', "type": '"std_srvs/Trigger"'}


class ActionTables(Fields):
    """Reader of the tables `[action.NAME]`, `[call.NAME]` and `[agent]`."""

    def actions(self) -> dict[str, ActionBinding]:
        """Name of the action → its message; those with errors are left out."""
        bound: dict[str, ActionBinding] = {}
        for name, table in self._tables("action").items():
            binding = self._binding(name, table)
            if binding is not None:
                bound[name] = binding
        self._check_types(bound)
        return bound

    def trace(self) -> str | None:
        """The topic of the trace; None if the table is absent or has errors."""
        table = self.tables.data.get("agent")
        if table is None:
            return None
        if not isinstance(table, dict):
            self._say(diagnostic("agent_not_table", self.tables.place("agent")))
            return None
        self._check_keys(table, AGENT_FIELDS, "[agent]", "agent")
        topic = table.get("trace")
        if isinstance(topic, str) and TOPIC.fullmatch(topic) and topic.startswith("/"):
            return topic
        where = self.tables.value("agent", "trace") if "trace" in table else None
        self._say(diagnostic("bad_agent_trace", where or self.tables.place("agent")))
        return None

    def _binding(self, name: str, table: Mapping[str, Any]) -> ActionBinding | None:
        before, at = len(self.notes.diagnostics), ("action", name)
        self._check_action(table, at, FIELDS, _EXAMPLES)
        topic, kind, message = (
            self._field(table, (*at, "topic"), str, "a topic in quotes") or "/topic",
            self._field(table, (*at, "type"), str, "a ROS type in quotes") or "std_msgs/Bool",
            self._field(table, (*at, "message"), dict, "a table: `{ data = true }`") or {},
        )
        if TOPIC.fullmatch(topic) is None or topic.startswith("~"):
            self._say(diagnostic("interceptor_topic", self.tables.value(*at, "topic"), key="topic"))
        if ROS_TYPE.fullmatch(short_type(kind)) is None:
            self._say(diagnostic("bad_action_type", self.tables.value(*at, "type"), type=kind))
        if not _is_message(message):
            self._say(diagnostic("bad_action_message", self.tables.value(*at, "message")))
        if len(self.notes.diagnostics) > before:
            return None
        text = json.dumps(message, separators=(",", ":"))
        return ActionBinding(name, topic, short_type(kind), text, self.tables.place(*at))

    def _check_action(
        self,
        table: Mapping[str, Any],
        at: tuple[str, str],
        fields: tuple[str, ...],
        required: Mapping[str, str],
    ) -> None:
        """Report a name that is none, fields that are unknown, and fields that are missing.

        Args:
            table: of one action.
            at: its place.
            fields: those that it may have.
            required: field → an example.
        """
        where = ".".join(at)
        self._check_keys(table, fields, f"[{where}]", *at)
        if ACTION.fullmatch(at[1]) is None:
            self._say(diagnostic("bad_action_name", self.tables.place(*at), kind=at[0], name=at[1]))
        for key, example in required.items():
            if key not in table:
                self._say(
                    diagnostic(
                        "interceptor_field_missing",
                        self.tables.place(*at),
                        table=where,
                        key=key,
                        example=example,
                    )
                )

    def calls(self) -> dict[str, ServiceCall]:
        """Name of the action → its service; those with errors are left out."""
        bound = {name: self._call(name, table) for name, table in self._tables("call").items()}
        return {name: call for name, call in bound.items() if call is not None}

    def _call(self, name: str, table: Mapping[str, Any]) -> ServiceCall | None:
        before, at = len(self.notes.diagnostics), ("call", name)
        self._check_action(table, at, CALL_FIELDS, _CALL_EXAMPLES)
        if name in self._tables("action"):
            self._say(diagnostic("action_publishes_and_calls", self.tables.place(*at), action=name))
        service, kind, request = (
            self._field(table, (*at, "service"), str, "a service in quotes") or "/service",
            self._field(table, (*at, "type"), str, "a ROS type in quotes") or "std_srvs/Empty",
            self._field(table, (*at, "request"), dict, "a table: `{ data = true }`") or {},
        )
        if TOPIC.fullmatch(service) is None or service.startswith("~"):
            where = self.tables.value(*at, "service")
            self._say(diagnostic("interceptor_topic", where, key="service"))
        kind = kind.replace("/srv/", "/")
        if ROS_TYPE.fullmatch(kind) is None:
            self._say(diagnostic("bad_action_type", self.tables.value(*at, "type"), type=kind))
        if not _is_message(request):
            self._say(diagnostic("bad_action_message", self.tables.value(*at, "request")))
        limit = self._limit(table, at)
        if len(self.notes.diagnostics) > before:
            return None
        text = json.dumps(request, separators=(",", ":"))
        return ServiceCall(name, service, kind, text, limit, self.tables.place(*at))

    def _limit(self, table: Mapping[str, Any], at: tuple[str, str]) -> int:
        text = table.get("limit", "400 ms")
        duration = units.nanoseconds(text) if isinstance(text, str) else None
        if duration is None or not 0 < duration <= _LONGEST:
            self._say(diagnostic("bad_call_limit", self.tables.value(*at, "limit")))
            return _LIMIT
        return duration

    def _check_types(self, bound: Mapping[str, ActionBinding]) -> None:
        """Report each topic with two types."""
        first: dict[str, ActionBinding] = {}
        for binding in bound.values():
            other = first.setdefault(binding.topic, binding)
            if other.type != binding.type:
                self._say(
                    diagnostic(
                        "action_topic_of_other_type",
                        self.tables.value("action", binding.action, "type"),
                        topic=binding.topic,
                        type=binding.type,
                        other=other.type,
                        reader=f"`{other.action}`",
                    )
                )


def _is_message(value: object) -> bool:
    """Whether JSON can hold the value: no date, and no number that is not finite."""
    match value:
        case dict():
            return all(map(_is_message, value.values()))
        case list():
            return all(map(_is_message, value))
        case float():
            return math.isfinite(value)
        case _:
            return isinstance(value, str | bool | int)
