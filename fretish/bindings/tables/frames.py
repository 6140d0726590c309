"""The tables `[signal.NAME]` with a `frame`: numbers of the pose of one frame in another."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from fretish import units
from fretish.bindings.declarations import Aggregate, FramePose, Path, PoseNumber, Signal
from fretish.bindings.tables.signals import SignalTables
from fretish.clock import TimeSource
from fretish.diagnostics.messages import diagnostic

_FIELDS = ("frame", "in", "path", "topic", "unit", "max_age", "role", "agg")
_TYPE = "tf2_msgs/TFMessage"
_TOPIC = re.compile(r"/?[A-Za-z_~][\w/~-]*")
_FRAME = re.compile(r"/?[^\s/][^\s]*")


class FrameTables(SignalTables):
    """Reader of the tables `[signal.NAME]` with a `frame`."""

    def signal(self, name: str, table: Mapping[str, Any]) -> Signal | None:
        """The signal; None if it has errors that make it unusable."""
        at, before = ("signal", name), len(self.notes.diagnostics)
        self._check_keys(table, _FIELDS, f"[signal.{name}] with `frame`", *at)
        pose = self._pose(table, at)
        base = "rad" if pose is not None and pose.number.is_angle else "m"
        unit_name = self._field(table, (*at, "unit"), str, "a unit in quotes") or base
        unit = units.unit(unit_name)
        if unit is None:
            self._say(units.unknown_unit(unit_name, self.tables.value(*at, "unit")))
        elif pose is not None:
            self._check_unit(unit, unit_name, pose, at)
        self._check_clock(at)
        topic = self._topic(table, (*at, "topic"))
        max_age = self._max_age(table, at)
        if pose is None or unit is None or len(self.notes.diagnostics) > before:
            return None
        signal = Signal(
            name,
            Path(topic, ("transforms",)),
            unit,
            unit_name,
            type=_TYPE,
            max_age=max_age,
            role=self._role(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            pose=pose,
            span=self.tables.value(*at, "frame"),
        )
        self.known[name] = signal
        return signal

    def _pose(self, table: Mapping[str, Any], at: tuple[str, ...]) -> FramePose | None:
        names = [self._frame(table, (*at, key)) for key in ("frame", "in")]
        number = table.get("path")
        if number not in list(PoseNumber):
            numbers = ", ".join(PoseNumber)
            self._say(diagnostic("no_pose_number", self.tables.value(*at, "path"), numbers=numbers))
            return None
        frame, reference = names
        if frame is None or reference is None:
            return None
        if frame == reference:
            self._say(diagnostic("frame_in_itself", self.tables.value(*at, "in"), frame=frame))
            return None
        return FramePose(frame, reference, PoseNumber(number))

    def _frame(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str | None:
        """The name of a frame, as tf2 has it: without a slash in front."""
        name = table.get(at[-1])
        if isinstance(name, str) and _FRAME.fullmatch(name):
            return name.removeprefix("/")
        self._say(diagnostic("no_frame", self.tables.value(*at), key=at[-1]))
        return None

    def _check_unit(
        self, unit: units.Unit, name: str, pose: FramePose, at: tuple[str, ...]
    ) -> None:
        base, what = ("rad", "an angle") if pose.number.is_angle else ("m", "a length")
        wanted = units.unit(base)
        assert wanted is not None
        if unit.dimension != wanted.dimension:
            span = self.tables.value(*at, "unit")
            self._say(
                diagnostic("pose_of_other_unit", span, number=pose.number, what=what, unit=name)
            )

    def _check_clock(self, at: tuple[str, ...]) -> None:
        clock = self.tables.data.get("clock")
        if isinstance(clock, dict) and clock.get("time") == TimeSource.HEADER_STAMP:
            self._say(diagnostic("frames_by_stamps", self.tables.value(*at, "frame")))

    def _topic(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        topic = table.get("topic", "/tf")
        if isinstance(topic, str) and _TOPIC.fullmatch(topic):
            return topic
        self._say(diagnostic("no_transform_topic", self.tables.value(*at)))
        return "/tf"
