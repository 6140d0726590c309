"""The tables `[interceptor]` and `[assume]` of `bindings.toml`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from fretish import units
from fretish.bindings.declarations import (
    Interception,
    InterceptorForm,
    LoopAssumptions,
    Planner,
    Requests,
)
from fretish.bindings.tables.fields import Fields
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.documents import IDENTIFIER, RequirementEntry
from fretish.reading.toml_text import Tables, as_key

TABLE = """\
[interceptor]
stop         = "/stop"              # std_msgs/Bool: true requests a stop
command      = "/cmd_vel"           # geometry_msgs/Twist: from the planner
output       = "/cmd_vel_filtered"  # geometry_msgs/Twist: to the wheels
scan         = "/scan"              # sensor_msgs/LaserScan: only its arrival counts
period       = "50 ms"              # of the interceptor's timer
hold         = "200 ms"             # zero is published for so long after a request
stop_timeout = "500 ms"             # the robot halts after this silence of the safety function
scan_timeout = "500 ms"             # and after this silence of the sensor
"""
"""An example table, as a starting point for users."""

_TOPICS = ("stop", "command", "output", "scan")
_TIMES = ("hold", "stop_timeout", "scan_timeout", "command_timeout")
_OPTIONAL = (*_TIMES, "heartbeat")
FIELDS = (*_TOPICS, "period", *_TIMES, "form", "latching", "ros")
ASSUMED_FIELDS = ("stands", "latency", "lost", "requests", "heartbeat", "planner", "braking")
_SENTENCES = "requirement"
"""The key of the tables `[[assume.requirement]]`."""
_SENTENCE = ("id", "text", "sentence")
_SENTENCE_HEADER = re.compile(
    r"^[ \t]*\[\[[ \t]*assume[ \t]*\.[ \t]*requirement[ \t]*\]\]", re.MULTILINE
)
_ANY_HEADER = re.compile(r"^[ \t]*\[", re.MULTILINE)
TOPIC = re.compile(r"(?:/?[A-Za-z_]\w*|~)(?:/[A-Za-z_]\w*)*", re.ASCII)
"""A ROS topic name; no part begins with a digit."""


class InterceptorTables(Fields):
    """Reader of the tables `[interceptor]`, `[assume]` and `[[assume.requirement]]`."""

    def interceptor(self) -> Interception | None:
        """The interceptor; None if the table is absent or has errors, which become diagnostics."""
        table = self._table("interceptor")
        if table is None:
            return None
        before = len(self.notes.diagnostics)
        self._check_keys(table, FIELDS, "[interceptor]", "interceptor")
        topics = {key: self._topic(table, key) for key in _TOPICS}
        at = ("interceptor", "form")
        form = self._choice(table, at, InterceptorForm, InterceptorForm.TIMER)
        times = {
            key: self._duration(table, ("interceptor", key)) or 0 for key in ("period", *_TIMES)
        }
        latching = self._field(table, ("interceptor", "latching"), bool, "true or false")
        ros = self._ros(table)
        self._check_topics(topics)
        self._check_times(table, form, times)
        if len(self.notes.diagnostics) > before:
            return None
        stop, command, output = (topics[key] or "" for key in ("stop", "command", "output"))
        span = self.tables.place("interceptor")
        return Interception(
            stop,
            command,
            output,
            topics["scan"],
            **times,
            form=form,
            latching=bool(latching),
            ros=ros,
            span=span,
        )

    def assumed(self, propositions: Sequence[str]) -> LoopAssumptions | None:
        """The assumptions; None if `[assume]` is absent or has errors, which become diagnostics.

        Args:
            propositions: the names of the declared propositions.
        """
        table = self._table("assume")
        if table is None or table.keys() == {_SENTENCES}:
            return None
        before = len(self.notes.diagnostics)
        self._check_keys(table, (*ASSUMED_FIELDS, _SENTENCES), "[assume]", "assume")
        stands = self._stands(table, propositions)
        latency = self._needed(table, "latency", "100 ms")
        braking = self._needed(table, "braking", "200 ms")
        requests = self._choice(table, ("assume", "requests"), Requests, Requests.LEVEL)
        heartbeat = self._heartbeat(table, requests)
        planner = self._choice(table, ("assume", "planner"), Planner, Planner.ANY)
        lost = self._lost(table)
        if len(self.notes.diagnostics) > before:
            return None
        span = self.tables.place("assume")
        return LoopAssumptions(stands, latency, braking, lost, requests, planner, heartbeat, span)

    def _table(self, name: str) -> Mapping[str, Any] | None:
        table = self.tables.data.get(name)
        if table is None or isinstance(table, dict):
            return table
        self._say(diagnostic("interceptor_not_table", self.tables.place(name), name=name))
        return None

    def _absent(self, table: str, key: str, fix: str) -> None:
        self._say(
            diagnostic(
                "interceptor_field_missing",
                self.tables.place(table),
                table=table,
                key=key,
                example=fix,
            )
        )

    def _duration(
        self, table: Mapping[str, Any], at: tuple[str, ...], *, least: int = 1
    ) -> int | None:
        """A duration in nanoseconds; None if it is absent or wrong, which is reported."""
        key = at[-1]
        if key not in table:
            return None
        text = table[key]
        duration = units.nanoseconds(text) if isinstance(text, str) else None
        if duration is not None and duration >= least:
            return duration
        limit = " above 0" if least else ""
        self._say(
            diagnostic(
                "interceptor_duration",
                self.tables.value(*at),
                key=key,
                limit=limit,
                help=f'write `{key} = "100 ms"`'
                + ("; remove it for none" if key in _OPTIONAL else ""),
            )
        )
        return None

    # [interceptor]

    def _topic(self, table: Mapping[str, Any], key: str) -> str | None:
        value = table.get(key)
        if value is None:
            if key != "scan":
                self._absent("interceptor", key, '"/TOPIC"')
            return None
        if isinstance(value, str) and TOPIC.fullmatch(value):
            return value
        self._say(diagnostic("interceptor_topic", self.tables.value("interceptor", key), key=key))
        return None

    def _check_topics(self, topics: Mapping[str, str | None]) -> None:
        """F320 for each topic that two fields share."""
        key_of: dict[str, str] = {}
        for key, topic in topics.items():
            if topic is None:
                continue
            name = topic if topic.startswith(("/", "~")) else f"/{topic}"
            if name in key_of:
                self._say(
                    diagnostic(
                        "same_topic",
                        self.tables.value("interceptor", key),
                        key=key,
                        other=key_of[name],
                    )
                )
            key_of.setdefault(name, key)

    def _check_times(
        self, table: Mapping[str, Any], form: InterceptorForm, times: Mapping[str, int]
    ) -> None:
        if form is InterceptorForm.EVENT:
            for key in ("period", *_TIMES):
                if key in table:
                    self._without_timer(key)
            return
        if "period" not in table:
            self._absent("interceptor", "period", '"50 ms"')
        for key in _TIMES:
            if 0 < times[key] < times["period"]:
                self._say(
                    diagnostic("below_period", self.tables.value("interceptor", key), key=key)
                )
        if "scan_timeout" in table and "scan" not in table:
            self._absent("interceptor", "scan", '"/scan"')

    def _without_timer(self, key: str) -> None:
        """F322: a duration with `form = "event"`."""
        self._say(diagnostic("no_timer", self.tables.value("interceptor", key), key=key))

    def _ros(self, table: Mapping[str, Any]) -> int:
        value = self._field(table, ("interceptor", "ros"), int, "1 or 2")
        if value is not None and value not in (1, 2):
            span = self.tables.value("interceptor", "ros")
            self._say(diagnostic("bad_ros_version", span, value=value))
        return 2 if value is None else value

    # [assume]

    def _needed(self, table: Mapping[str, Any], key: str, example: str) -> int:
        if key not in table:
            self._absent("assume", key, f'"{example}"')
        return self._duration(table, ("assume", key), least=0) or 0

    def _stands(self, table: Mapping[str, Any], propositions: Sequence[str]) -> str:
        name = self._field(table, ("assume", "stands"), str, "the name of a proposition in quotes")
        if "stands" not in table:
            self._absent("assume", "stands", '"PROPOSITION"')
        if name is None or name in propositions:
            return name or ""
        self._say(
            diagnostic(
                "unbound_stands", self.tables.value("assume", "stands"), name=name, key=as_key(name)
            )
        )
        return name

    def _heartbeat(self, table: Mapping[str, Any], requests: Requests) -> int:
        """The heartbeat in nanoseconds; 0: none."""
        heartbeat = self._duration(table, ("assume", "heartbeat")) or 0
        if heartbeat and requests is Requests.LEVEL and table.get("requests", "level") == "level":
            self._say(
                diagnostic("heartbeat_without_effect", self.tables.value("assume", "heartbeat"))
            )
        return heartbeat

    def _lost(self, table: Mapping[str, Any]) -> int:
        value = self._field(table, ("assume", "lost"), int, "a whole number of messages")
        if value is not None and value < 0:
            span = self.tables.value("assume", "lost")
            self._say(diagnostic("negative_lost", span))
        return value or 0

    # [[assume.requirement]]

    def sentences(self) -> tuple[RequirementEntry, ...]:
        """The sentences of `[[assume.requirement]]`: assumptions about the environment."""
        table = self.tables.data.get("assume")
        tables = table.get(_SENTENCES, []) if isinstance(table, dict) else []
        if not isinstance(tables, list) or not all(isinstance(entry, dict) for entry in tables):
            self._say(
                diagnostic(
                    "assumptions_not_tables",
                    self.tables.place("assume", _SENTENCES),
                    sentences=_SENTENCES,
                )
            )
            return ()
        requirements: dict[str, RequirementEntry] = {}
        for entry, block in zip(tables, self._blocks(len(tables)), strict=True):
            requirement = InterceptorTables(Tables(block, entry), self.notes)._sentence(entry)
            if requirement is not None and requirement.id in requirements:
                self._say(diagnostic("assumption_id_taken", block, requirement=requirement.id))
            elif requirement is not None:
                requirements[requirement.id] = requirement
        return tuple(requirements.values())

    def _blocks(self, count: int) -> list[Span]:
        """The text below each header; all bindings for each one if the headers are not found."""
        text = self.tables.text
        starts = [match.end() for match in _SENTENCE_HEADER.finditer(text.text)]
        if len(starts) != count:
            return [text] * count
        ends = [_ANY_HEADER.search(text.text, start) for start in starts]
        return [
            text.part(start, end.start() if end else len(text.text))
            for start, end in zip(starts, ends, strict=True)
        ]

    def _sentence(self, table: Mapping[str, Any]) -> RequirementEntry | None:
        before = len(self.notes.diagnostics)
        where = f"[[assume.{_SENTENCES}]]"
        self._check_keys(table, _SENTENCE, where)
        texts = {
            key: self._field(table, (key,), str, "a text in quotes") or "" for key in _SENTENCE
        }
        id, sentence = texts["id"], texts["sentence"]
        if not sentence or IDENTIFIER.fullmatch(id) is None:
            self._say(diagnostic("assumption_incomplete", self.tables.text.part(0, 0), where=where))
        if len(self.notes.diagnostics) > before:
            return None
        value = self.tables.value("sentence")
        start = value.text.find(sentence)
        wording = value.part(start, start + len(sentence))
        if start < 0:  # The text has escapes: it becomes its own source.
            wording = Source(f"{value.source.name} ({id})", sentence).span()
        return RequirementEntry(id, wording, text=texts["text"])
