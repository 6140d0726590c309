"""Messages of any known ROS type, with given contents of some fields."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype

from fretish.bindings.declarations import Path, Signal, short_type
from fretish.classes.frozen import dataclass
from simulation.nodes.messages import TYPES

Content = float | str | Sequence[float]
"""Content of a field; for an array, of all its elements."""

_USUAL: Mapping[str, Any] = {
    "range_min": 0.05,
    "range_max": 100.0,
    "min_range": 0.05,
    "max_range": 100.0,
    "w": 1.0,
}
"""Default contents: a sensor with a long range, a pose without rotation. All other fields are zero
or empty."""


class NotRecordableError(ValueError):
    """A test cannot be recorded; the message gives the reason in lower case without a full stop."""


@dataclass(frozen=True, slots=True)
class SignalField:
    """Field from which a signal is read."""

    message: str
    """Type of the message: `sensor_msgs/msg/LaserScan`."""
    base: str
    """Base type of the field or of its elements: `float32`, `bool`, `string`."""
    array: bool

    @property
    def has_nan(self) -> bool:
        """Whether the type has NaN for an unknown number."""
        return self.base in ("float32", "float64")


def field(signal: Signal) -> SignalField:
    """Field from which a signal is read.

    Raises:
        NotRecordableError: the bindings do not name it, or its type is unknown.
    """
    if signal.type is None:
        raise NotRecordableError(f"the binding of `{signal.name}` names no message type")
    package, _, own = short_type(signal.type).partition("/")
    name = f"{package}/msg/{own}"
    if name not in TYPES.fielddefs:
        raise NotRecordableError(
            f"`{signal.type}`, which `{signal.name}` is read from, is not known"
        )
    node: Any = (Nodetype.NAME, name)
    for part in signal.path.fields:
        fields = dict(TYPES.fielddefs[node[1]][1]) if node[0] == Nodetype.NAME else {}
        if part not in fields:
            raise NotRecordableError(
                f"`{signal.type}` has no field `{'.'.join(signal.path.fields)}`"
            )
        node = fields[part]
    array = node[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE)
    if array:
        node = node[1][0]
    if node[0] != Nodetype.BASE:
        raise NotRecordableError(f"`{signal.path}` is neither a number nor a text")
    return SignalField(name, str(node[1][0]), array)


def message(name: str, time: int, contents: Mapping[Path, Content]) -> Any:
    """A message measured at `time` (nanoseconds) with given contents of some of its fields."""
    made = _blank(name, time)
    for path, content in contents.items():
        *way, last = path.fields
        inner = made
        for part in way:
            inner = getattr(inner, part)
        setattr(inner, last, _filled(getattr(inner, last), path, content))
    return made


def _filled(before: Any, path: Path, content: Content) -> Any:
    """Content of a field, converted to its type."""
    if path.index is not None:
        longer = np.zeros(max(len(before), path.index + 1), before.dtype)
        longer[: len(before)] = before
        longer[path.index] = content
        return longer
    if path.each:
        return np.asarray(content, before.dtype)
    return type(before)(content)


def _blank(name: str, time: int) -> Any:
    fields = {
        field: _USUAL[field] if _is_float(node) and field in _USUAL else _nothing(node, time)
        for field, node in TYPES.fielddefs[name][1]
    }
    return TYPES.types[name](**fields)


def _is_float(node: Any) -> bool:
    return node[0] == Nodetype.BASE and node[1][0] in ("float32", "float64")


_EMPTY: Mapping[str, Any] = {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}


def _nothing(node: Any, time: int) -> Any:
    kind, detail = node
    if kind == Nodetype.BASE:
        return _EMPTY.get(detail[0], 0)
    if kind == Nodetype.NAME and detail == "builtin_interfaces/msg/Time":
        seconds, nanoseconds = divmod(time, 10**9)
        return TYPES.types[detail](sec=seconds, nanosec=nanoseconds)
    if kind == Nodetype.NAME:
        return _blank(detail, time)
    inner, count = detail
    count = count if kind == Nodetype.ARRAY else 0
    if inner[0] == Nodetype.BASE and inner[1][0] != "string":
        base = {"octet": "uint8", "byte": "uint8", "char": "uint8"}.get(inner[1][0], inner[1][0])
        return np.zeros(count, base)
    return [_nothing(inner, time) for _ in range(count)]
