"""The tables `[action.NAME]` of `bindings.toml`: what an action of an agent publishes."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

from fretish.bindings.declarations import ActionBinding, short_type
from fretish.bindings.tables.fields import ACTION, Fields
from fretish.bindings.tables.interceptor import TOPIC
from fretish.diagnostics.messages import diagnostic

ROS_TYPE = re.compile(r"(?P<package>[a-z]\w*)/(?P<message>[A-Z]\w*)", re.ASCII)
"""A message type without `msg`, as in ROS 1."""
FIELDS = ("topic", "type", "message")
_EXAMPLES = {
    "topic": '"/gwendolen_control"',
    "type": '"std_msgs/Bool"',
    "message": "{ data = true }",
}


class ActionTables(Fields):
    """Reader of the tables `[action.NAME]`."""

    def actions(self) -> dict[str, ActionBinding]:
        """Name of the action → its message; those with errors are left out."""
        bound: dict[str, ActionBinding] = {}
        for name, table in self._tables("action").items():
            binding = self._binding(name, table)
            if binding is not None:
                bound[name] = binding
        self._check_types(bound)
        return bound

    def _binding(self, name: str, table: Mapping[str, Any]) -> ActionBinding | None:
        before, at = len(self.notes.diagnostics), ("action", name)
        self._check_keys(table, FIELDS, f"[action.{name}]", *at)
        if ACTION.fullmatch(name) is None:
            self._say(diagnostic("bad_action_name", self.tables.place(*at), name=name))
        for key in FIELDS:
            if key not in table:
                self._say(
                    diagnostic(
                        "interceptor_field_missing",
                        self.tables.place(*at),
                        table=f"action.{name}",
                        key=key,
                        example=_EXAMPLES[key],
                    )
                )
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
