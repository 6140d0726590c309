"""The log: messages of the robot's topics, as of ROS 2 or of ROS 1, in one MCAP file.

The only module that writes MCAP. Times are whole nanoseconds; what is published and what is logged
carry the same time.
"""

import os
import secrets
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from mcap.writer import CompressionType, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from simulation import __version__
from simulation.nodes.messages import TYPES
from simulation.world.scenario import Recorder

if TYPE_CHECKING:
    from rosbags.typesys.store import Msg, Typestore

_SECOND = 10**9


class Encoding(StrEnum):
    """Whose messages the log holds."""

    ROS2 = "ros2"
    ROS1 = "ros1"


@dataclass(frozen=True, slots=True)
class RecordedTopic:
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
    RecordedTopic("/scan", "sensor_msgs/msg/LaserScan", depth=5, reliability="best_effort"),
    RecordedTopic("/odom", "nav_msgs/msg/Odometry"),
    RecordedTopic("/ground_truth", "nav_msgs/msg/Odometry"),
    RecordedTopic("/ground_truth/clearance", "std_msgs/msg/Float64"),
    RecordedTopic("/cmd_vel", "geometry_msgs/msg/Twist"),
    RecordedTopic("/cmd_vel_filtered", "geometry_msgs/msg/Twist"),
    RecordedTopic("/gwendolen_control", "std_msgs/msg/Bool", 1, durability="transient_local"),
    RecordedTopic("/manual_control", "std_msgs/msg/Bool", 1, durability="transient_local"),
    RecordedTopic("/goal", "geometry_msgs/msg/PoseStamped", 1, durability="transient_local"),
    RecordedTopic("/tf", "tf2_msgs/msg/TFMessage", depth=100),
    RecordedTopic("/tf_static", "tf2_msgs/msg/TFMessage", 1, durability="transient_local"),
    RecordedTopic("/map", "nav_msgs/msg/OccupancyGrid", 1, durability="transient_local"),
    RecordedTopic("/robot_description", "std_msgs/msg/String", 1, durability="transient_local"),
    RecordedTopic("/clock", "rosgraph_msgs/msg/Clock", 1, reliability="best_effort"),
)

AGENT_TRACE = RecordedTopic("/agent/trace", "std_msgs/msg/String")
"""What an agent tells of itself; only in the log of a mission with an agent."""


class MissionRecording:
    """An MCAP file that is being written."""

    def __init__(
        self,
        stream: BinaryIO,
        encoding: Encoding = Encoding.ROS2,
        faults: Recorder = Recorder(),  # noqa: B008 - frozen
        epoch: int = 0,
        topics: Sequence[RecordedTopic] = TOPICS,
    ) -> None:
        # Any: the writer's `finish` carries no annotations.
        self._writer: Any = Writer(stream, compression=CompressionType.ZSTD)
        self._ros1 = _ros1_types() if encoding is Encoding.ROS1 else None
        self._writer.start(profile=str(encoding), library=f"fretc simulation {__version__}")
        self._channels = {topic.name: self._register(topic) for topic in topics}
        self._counts = dict.fromkeys(self._channels, 0)
        self._jump = round(faults.jump_by * _SECOND)
        self._jump_at = None if faults.jump_at is None else epoch + round(faults.jump_at * _SECOND)

    @property
    def messages(self) -> int:
        """How many messages were written."""
        return sum(self._counts.values())

    def write(self, topic: str, message: "Msg", time: int) -> None:
        """Add a message of one of the topics; `time` in nanoseconds."""
        self._counts[topic] += 1
        if self._jump_at is not None and time >= self._jump_at:
            time += self._jump
        self._writer.add_message(
            channel_id=self._channels[topic],
            log_time=time,
            publish_time=time,
            sequence=self._counts[topic],
            data=self._bytes(message),
        )

    def finish(self, name: str, metadata: Mapping[str, str]) -> None:
        """Add a metadata record and complete the file."""
        self._writer.add_metadata(name, dict(metadata))
        self._writer.finish()

    def _bytes(self, message: "Msg") -> bytes:
        data = bytes(TYPES.serialize_cdr(message, message.__msgtype__, little_endian=True))
        return data if self._ros1 is None else bytes(TYPES.cdr_to_ros1(data, message.__msgtype__))

    def _register(self, topic: RecordedTopic) -> int:
        """Declare a topic and its message type; the number of its channel."""
        if self._ros1 is not None:
            return self._register_ros1(topic, self._ros1)
        text, _ = TYPES.generate_msgdef(topic.type, ros_version=2)
        schema = self._writer.register_schema(topic.type, "ros2msg", text.encode())
        qos = {"offered_qos_profiles": topic.offered_qos_profiles()}
        return int(self._writer.register_channel(topic.name, "cdr", schema, qos))

    def _register_ros1(self, topic: RecordedTopic, types: "Typestore") -> int:
        text, digest = types.generate_msgdef(topic.type, ros_version=1)
        name = topic.type.replace("/msg/", "/")
        schema = self._writer.register_schema(name, "ros1msg", text.encode())
        latching = str(int(topic.durability == "transient_local"))
        about = {"topic": topic.name, "type": name, "md5sum": digest, "latching": latching}
        return int(self._writer.register_channel(topic.name, "ros1", schema, about))


def _ros1_types() -> "Typestore":
    """Those of ROS 1, with the one that rosbags leaves out."""
    types = get_typestore(Stores.ROS1_NOETIC)
    name = "tf2_msgs/msg/TFMessage"
    types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms\n", name))
    return types


@contextmanager
def recording(
    path: Path,
    encoding: Encoding = Encoding.ROS2,
    faults: Recorder = Recorder(),  # noqa: B008 - frozen
    epoch: int = 0,
    topics: Sequence[RecordedTopic] = TOPICS,
) -> Iterator[MissionRecording]:
    """Write a log that is there complete or not at all.

    Until the end of the block the file has another name in the same folder. Whatever ends the
    block early, Ctrl-C included, that file is removed and an older one at `path` stays.
    The block has to call `MissionRecording.finish`.

    Args:
        path: of the file.
        encoding: of its messages.
        faults: of the recorder; a file that is to be cut is cut when it is complete.
        epoch: when simulated time began, nanoseconds.
        topics: what messages may be about.

    Raises:
        OSError: the folder does not exist or cannot be written.
    """
    partial = path.with_name(f".{path.name}.{secrets.token_hex(4)}.partial")
    try:
        with open(partial, "xb", opener=_private) as stream:
            yield MissionRecording(stream, encoding, faults, epoch, topics)
        if faults.keep < 1:
            os.truncate(partial, round(partial.stat().st_size * faults.keep))
        mask = os.umask(0o077)
        os.umask(mask)
        partial.chmod(0o666 & ~mask)
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


def _private(path: str, flags: int) -> int:
    """Open a new file that nobody else reads before it is complete."""
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0), 0o600)
