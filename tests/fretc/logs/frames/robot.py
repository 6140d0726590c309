"""Messages of transforms, as a robot sends them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

from tests.fretc.logs.logs import MS, S, Sent, payload, store

Pose = tuple[int, str, str, tuple[float, ...], tuple[float, ...]]
"""Stamp, parent, child, translation and rotation."""
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
TYPE = "tf2_msgs/msg/TFMessage"


def turned(yaw: float) -> tuple[float, float, float, float]:
    """The quaternion of a rotation about z."""
    return 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)


def transforms(topic: str, time: int, *poses: Pose, encoding: str = "cdr") -> Sent:
    """A message of type tf2_msgs/TFMessage."""
    if encoding == "json":
        text = json.dumps({"transforms": [_named(*pose) for pose in poses]})
        return Sent(topic, TYPE, text.encode(), time, encoding="json")
    made = [_stamped(store(encoding).types, *pose) for pose in poses]
    return Sent(topic, TYPE, payload(TYPE, encoding, transforms=made), time)


def _named(
    stamp: int, parent: str, child: str, translation: Sequence[float], rotation: Sequence[float]
) -> dict[str, object]:
    time = dict(zip(("sec", "nanosec"), divmod(stamp, S), strict=True))
    pose = {
        "translation": dict(zip("xyz", translation, strict=True)),
        "rotation": dict(zip("xyzw", rotation, strict=True)),
    }
    header = {"stamp": time, "frame_id": parent}
    return {"header": header, "child_frame_id": child, "transform": pose}


def _stamped(
    types: dict[str, type],
    stamp: int,
    parent: str,
    child: str,
    translation: Sequence[float],
    rotation: Sequence[float],
) -> object:
    time = types["builtin_interfaces/msg/Time"](*divmod(stamp, S))
    header = types["std_msgs/msg/Header"](time, parent)
    vector = types["geometry_msgs/msg/Vector3"](*translation)
    quaternion = types["geometry_msgs/msg/Quaternion"](*rotation)
    pose = types["geometry_msgs/msg/Transform"](vector, quaternion)
    return types["geometry_msgs/msg/TransformStamped"](header, child, pose)


def drive(count: int, encoding: str = "cdr") -> list[Sent]:
    """A robot that drives along x at 1 m/s and turns at 0.5 rad/s, for `count` times 20 ms.

    Its laser is 20 cm in front of it, and its localization, 1 m along x, is dated a second ahead
    every 100 ms, as that of AMCL. A message arrives 3 ms after its stamp.
    """
    laser = (S, "base_link", "laser", (0.2, 0, 0), UPRIGHT)
    sent = [transforms("/tf_static", S, laser, encoding=encoding)]
    for i in range(count):
        stamp = S + i * 20 * MS
        pose = (stamp, "odom", "base_link", (i * 0.02, 0.0, 0.0), turned(i * 0.01))
        sent.append(transforms("/tf", stamp + 3 * MS, pose, encoding=encoding))
        if i % 5 == 0:
            ahead = (stamp + S, "map", "odom", (1.0, 0.0, 0.0), UPRIGHT)
            sent.append(transforms("/tf", stamp + 4 * MS, ahead, encoding=encoding))
    return sent
