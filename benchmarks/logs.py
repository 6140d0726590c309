"""Recorded runs of any length to measure with, like those of a robot with a lidar and a camera.

    python -m benchmarks.logs OUT.mcap [--seconds 600] [--camera] [--compression lz4] [--ros1]

A scan of 720 beams at 10 Hz, velocity commands and odometry at 50 Hz, poses at 100 Hz; with
`--camera` an image of 1 MB at 10 Hz. Chunks of 768 KiB, written by the official library: an image
is the last message of its chunk. The same options give the same bytes.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, Writer
from rosbags.typesys import Stores, get_typestore

START = 1_700_000_000 * 10**9
"""Nanoseconds, the log time of the first message."""
KINDS = {
    "/scan": ("sensor_msgs/msg/LaserScan", 10),
    "/cmd_vel": ("geometry_msgs/msg/Twist", 50),
    "/odom": ("nav_msgs/msg/Odometry", 50),
    "/tf": ("tf2_msgs/msg/TFMessage", 100),
    "/camera/image_raw": ("sensor_msgs/msg/Image", 10),
}
"""Topic → type, and messages a second."""
_DIFFERENT = 200
"""Messages of a topic that are made; then they repeat, long after a chunk has ended."""
_BEAMS, _HEIGHT, _WIDTH = 720, 433, 770


@dataclass(frozen=True)
class Options:
    """What is recorded, and how."""

    seconds: float = 600
    camera: bool = False
    compression: str = "zstd"
    ros1: bool = False


class Robot:
    """What the topics send."""

    def __init__(self, options: Options) -> None:
        self.ros1 = options.ros1
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_JAZZY)
        self.random = np.random.default_rng(1)
        self.frame = self.random.integers(0, 4, (_HEIGHT, _WIDTH * 3), np.uint8)
        self.frame += (np.add.outer(np.arange(_HEIGHT) // 64 * 40, np.arange(_WIDTH * 3) // 600)
                       % 200).astype(np.uint8)  # fmt: skip

    def make(self, type_: str, **fields: Any) -> Any:
        return self.store.types[type_](**fields)

    def payload(self, topic: str, number: int) -> bytes:
        """The message of a topic with that number."""
        type_, rate = KINDS[topic]
        message = getattr(self, f"_{type_.rpartition('/')[2].lower()}")(number, number / rate)
        serialize = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
        return bytes(serialize(message, type_))

    def _header(self, number: int, seconds: float, frame: str) -> Any:
        time = START + round(seconds * 1e9)
        stamp = self.make("builtin_interfaces/msg/Time", sec=time // 10**9, nanosec=time % 10**9)
        extra = {"seq": number} if self.ros1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **extra)

    def _vector(self, x: float, y: float = 0.0, z: float = 0.0) -> Any:
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)

    def _twist(self, _: int, seconds: float) -> Any:
        linear = self._vector(0.22 * (0.5 + 0.5 * float(np.sin(seconds / 7))))
        angular = self._vector(0, 0, 0.5 * float(np.sin(seconds / 11)))
        return self.make("geometry_msgs/msg/Twist", linear=linear, angular=angular)

    def _laserscan(self, number: int, seconds: float) -> Any:
        angles = np.linspace(-np.pi, np.pi, _BEAMS, endpoint=False)
        walls = np.minimum(4 / (np.abs(np.cos(angles)) + 1e-9), 3 / (np.abs(np.sin(angles)) + 1e-9))
        ranges = np.round(walls + self.random.normal(0, 0.01, _BEAMS), 3).astype(np.float32)
        ranges[ranges > 12] = np.inf
        odd = self.random.random(_BEAMS)
        ranges[odd < 0.002], ranges[odd > 0.998] = np.nan, 0
        return self.make(
            "sensor_msgs/msg/LaserScan", header=self._header(number, seconds, "base_scan"),
            angle_min=-np.pi, angle_max=np.pi, angle_increment=2 * np.pi / _BEAMS,
            time_increment=0.0, scan_time=0.1, range_min=0.12, range_max=12.0, ranges=ranges,
            intensities=np.full(_BEAMS, 47, np.float32),
        )  # fmt: skip

    def _pose(self, seconds: float) -> tuple[Any, Any]:
        point = {
            "x": 3 * float(np.sin(seconds / 60)),
            "y": 2 * float(np.cos(seconds / 45)),
            "z": 0.0,
        }
        turn = seconds * 0.025
        rotation = {"x": 0.0, "y": 0.0, "z": float(np.sin(turn)), "w": float(np.cos(turn))}
        return point, self.make("geometry_msgs/msg/Quaternion", **rotation)

    def _odometry(self, number: int, seconds: float) -> Any:
        point, rotation = self._pose(seconds)
        zeros = np.zeros(36)
        pose = self.make("geometry_msgs/msg/Pose", orientation=rotation,
                         position=self.make("geometry_msgs/msg/Point", **point))  # fmt: skip
        return self.make(
            "nav_msgs/msg/Odometry", header=self._header(number, seconds, "odom"),
            child_frame_id="base_footprint",
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=zeros),
            twist=self.make("geometry_msgs/msg/TwistWithCovariance",
                            twist=self._twist(number, seconds), covariance=zeros),
        )  # fmt: skip

    def _tfmessage(self, number: int, seconds: float) -> Any:
        point, rotation = self._pose(seconds)
        transform = self.make("geometry_msgs/msg/Transform", rotation=rotation,
                              translation=self._vector(**point))  # fmt: skip
        stamped = self.make(
            "geometry_msgs/msg/TransformStamped", header=self._header(number, seconds, "odom"),
            child_frame_id="base_footprint", transform=transform,
        )  # fmt: skip
        return self.make("tf2_msgs/msg/TFMessage", transforms=[stamped])

    def _image(self, number: int, seconds: float) -> Any:
        data = np.roll(self.frame, 7 * number, axis=0).reshape(-1)
        return self.make(
            "sensor_msgs/msg/Image", header=self._header(number, seconds, "camera"),
            height=_HEIGHT, width=_WIDTH, encoding="rgb8", is_bigendian=0, step=_WIDTH * 3,
            data=data,
        )  # fmt: skip


def _sent(topics: list[str], seconds: float) -> Iterator[tuple[int, str, int]]:
    """Time, topic and number of each message, in order of time."""
    sent = []
    for phase, topic in enumerate(topics):
        rate = KINDS[topic][1]
        period, count = 10**9 // rate, int(seconds * rate)
        sent += [(START + i * period + phase * 1_000_000, topic, i) for i in range(count)]
    yield from sorted(sent)


def record(path: Path, options: Options) -> None:
    """Write a run."""
    robot = Robot(options)
    topics = [topic for topic in KINDS if options.camera or "camera" not in topic]
    with path.open("wb") as stream:
        packing = CompressionType[options.compression.upper()]
        writer: Any = Writer(stream, chunk_size=768 * 1024, compression=packing)
        writer.start("ros1" if options.ros1 else "ros2", "fretc-benchmark")
        payloads, channels = {}, {}
        for topic in topics:
            type_ = KINDS[topic][0]
            text, _ = robot.store.generate_msgdef(type_, ros_version=1 if options.ros1 else 2)
            name = type_.replace("/msg/", "/") if options.ros1 else type_
            defined = "ros1msg" if options.ros1 else "ros2msg"
            schema = writer.register_schema(name, defined, str(text).encode())
            encoding = "ros1" if options.ros1 else "cdr"
            channels[topic] = writer.register_channel(topic, encoding, schema)
            count = 20 if "camera" in topic else _DIFFERENT
            payloads[topic] = [robot.payload(topic, i) for i in range(count)]
        for time, topic, number in _sent(topics, options.seconds):
            data = payloads[topic][number % len(payloads[topic])]
            writer.add_message(channels[topic], time, data, time, number)
        writer.finish()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--camera", action="store_true")
    parser.add_argument("--compression", choices=("zstd", "lz4", "none"), default="zstd")
    parser.add_argument("--ros1", action="store_true")
    chosen = parser.parse_args()
    record(chosen.out, Options(chosen.seconds, chosen.camera, chosen.compression, chosen.ros1))


if __name__ == "__main__":
    main()
