"""The log: ROS 2 messages of the robot's topics, in one MCAP file.

The only module that imports rosbags and the MCAP writer. Times are whole nanoseconds; what is
published and what is logged carry the same time.
"""

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from simulation.lidar import Lidar
from simulation.motion import Pose, Velocity

if TYPE_CHECKING:
    from rosbags.typesys.store import Msg, Msgarg

_TYPES = get_typestore(Stores.ROS2_JAZZY)

MAP, ODOM, BASE, LIDAR = "map", "odom", "base_link", "velodyne"
"""Frames, each at the child end of the one before."""


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic's message type and the quality of service that its publisher offers."""

    name: str
    type: str
    depth: int = 10
    reliability: str = "reliable"
    durability: str = "volatile"

    def offered_qos_profiles(self) -> str:
        """As rosbag2 writes it into a channel's metadata: a YAML list of one profile."""
        forever = "\n    sec: 9223372036\n    nsec: 854775807\n"
        return (
            f"- history: keep_last\n  depth: {self.depth}\n"
            f"  reliability: {self.reliability}\n  durability: {self.durability}\n"
            f"  deadline:{forever}  lifespan:{forever}  liveliness: automatic\n"
            f"  liveliness_lease_duration:{forever}"
            "  avoid_ros_namespace_conventions: false\n"
        )


TOPICS = (
    Topic("/scan", "sensor_msgs/msg/LaserScan", depth=5, reliability="best_effort"),
    Topic("/odom", "nav_msgs/msg/Odometry"),
    Topic("/ground_truth", "nav_msgs/msg/Odometry"),
    Topic("/cmd_vel", "geometry_msgs/msg/Twist"),
    Topic("/cmd_vel_filtered", "geometry_msgs/msg/Twist"),
    Topic("/gwendolen_control", "std_msgs/msg/Bool", depth=1, durability="transient_local"),
    Topic("/tf", "tf2_msgs/msg/TFMessage", depth=100),
    Topic("/goal", "geometry_msgs/msg/PoseStamped", depth=1, durability="transient_local"),
)


class Recording:
    """An MCAP file that is being written."""

    def __init__(self, stream: BinaryIO) -> None:
        # Any: the writer's `finish` carries no annotations.
        self._writer: Any = Writer(stream, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="fretc simulation")
        self._channels = {topic.name: self._register(topic) for topic in TOPICS}
        self._counts = dict.fromkeys(self._channels, 0)

    @property
    def messages(self) -> int:
        """How many messages were written."""
        return sum(self._counts.values())

    def write(self, topic: str, message: "Msg", time: int) -> None:
        """Add a message; `topic` is one of `TOPICS`, `time` in nanoseconds."""
        self._counts[topic] += 1
        self._writer.add_message(
            channel_id=self._channels[topic],
            log_time=time,
            publish_time=time,
            sequence=self._counts[topic],
            data=bytes(_TYPES.serialize_cdr(message, message.__msgtype__, little_endian=True)),
        )

    def finish(self, name: str, metadata: Mapping[str, str]) -> None:
        """Add a metadata record and complete the file."""
        self._writer.add_metadata(name, dict(metadata))
        self._writer.finish()

    def _register(self, topic: Topic) -> int:
        """Declare a topic and its message type; the number of its channel."""
        text, _ = _TYPES.generate_msgdef(topic.type, ros_version=2)
        schema = self._writer.register_schema(topic.type, "ros2msg", text.encode())
        qos = {"offered_qos_profiles": topic.offered_qos_profiles()}
        return int(self._writer.register_channel(topic.name, "cdr", schema, qos))


@contextmanager
def recording(path: Path) -> Iterator[Recording]:
    """Write a log that is there complete or not at all.

    Until the end of the block the file has another name in the same folder. Whatever ends the
    block early, Ctrl-C included, that file is removed and an older one at `path` stays.
    The block has to call `Recording.finish`.

    Raises:
        OSError: the folder does not exist or cannot be written.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as stream:
            yield Recording(stream)
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def laser_scan(time: int, ranges: NDArray[np.float32], lidar: Lidar) -> "Msg":
    """A full turn measured at `time`; all beams at once, as the simulator measures them."""
    return _new(
        "sensor_msgs/msg/LaserScan",
        header=_header(time, LIDAR),
        angle_min=float(lidar.angles[0]),
        angle_max=float(lidar.angles[-1]),
        angle_increment=lidar.increment,
        time_increment=0.0,
        scan_time=lidar.period,
        range_min=lidar.range_min,
        range_max=lidar.range_max,
        ranges=ranges,
        intensities=np.zeros(0, np.float32),
    )


def odometry(time: int, frame: str, pose: Pose, velocity: Velocity) -> "Msg":
    """A pose in `frame` and a velocity in the body's frame; covariances are left at 0, unknown."""
    return _new(
        "nav_msgs/msg/Odometry",
        header=_header(time, frame),
        child_frame_id=BASE,
        pose=_new("geometry_msgs/msg/PoseWithCovariance", pose=_pose(pose), covariance=_unknown()),
        twist=_new(
            "geometry_msgs/msg/TwistWithCovariance", twist=twist(velocity), covariance=_unknown()
        ),
    )


def twist(velocity: Velocity) -> "Msg":
    """`linear.x` and `angular.z`."""
    return _new(
        "geometry_msgs/msg/Twist",
        linear=_vector(velocity.forward, 0.0),
        angular=_new("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=velocity.turn),
    )


def boolean(value: bool) -> "Msg":
    """A bare truth value."""
    return _new("std_msgs/msg/Bool", data=value)


def goal_pose(time: int, pose: Pose) -> "Msg":
    """A goal in the room's frame."""
    return _new("geometry_msgs/msg/PoseStamped", header=_header(time, MAP), pose=_pose(pose))


def transforms(time: int, estimate: Pose) -> "Msg":
    """The whole chain from the map to the lidar; the map and the odometry's frame coincide."""
    origin = Pose(0.0, 0.0)
    links = ((MAP, ODOM, origin), (ODOM, BASE, estimate), (BASE, LIDAR, origin))
    return _new(
        "tf2_msgs/msg/TFMessage",
        transforms=[
            _new(
                "geometry_msgs/msg/TransformStamped",
                header=_header(time, parent),
                child_frame_id=child,
                transform=_new(
                    "geometry_msgs/msg/Transform",
                    translation=_vector(pose.x, pose.y),
                    rotation=_quaternion(pose.yaw),
                ),
            )
            for parent, child, pose in links
        ],
    )


def _new(type_name: str, **fields: "Msgarg") -> "Msg":
    return _TYPES.types[type_name](**fields)


def _header(time: int, frame: str) -> "Msg":
    seconds, nanoseconds = divmod(time, 10**9)
    stamp = _new("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
    return _new("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def _pose(pose: Pose) -> "Msg":
    position = _new("geometry_msgs/msg/Point", x=pose.x, y=pose.y, z=0.0)
    return _new("geometry_msgs/msg/Pose", position=position, orientation=_quaternion(pose.yaw))


def _vector(x: float, y: float) -> "Msg":
    return _new("geometry_msgs/msg/Vector3", x=x, y=y, z=0.0)


def _quaternion(yaw: float) -> "Msg":
    z, w = math.sin(yaw / 2), math.cos(yaw / 2)
    return _new("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=z, w=w)


def _unknown() -> NDArray[np.float64]:
    return np.zeros(36)
