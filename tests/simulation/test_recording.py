import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros1.decoder import DecoderFactory as Ros1DecoderFactory
from mcap_ros2.decoder import DecoderFactory

from simulation import recording as log
from simulation.nodes import messages as say
from simulation.world.lidar import Lidar
from simulation.world.motion import BodyVelocity, Pose
from simulation.world.scenario import Recorder

TIME = 1_700_000_000_250_000_000


def decoded(path: Path) -> dict[str, Any]:
    """The only message of each topic."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return {channel.topic: message for _, channel, _, message in reader.iter_decoded_messages()}


def write(path: Path, topic: str, message: Any) -> Any:
    """What a reader gets."""
    with log.recording(path) as recording:
        recording.write(topic, message, TIME)
        recording.finish("simulation", {})
    return decoded(path)[topic]


def test_a_scan_says_when_where_and_how_it_was_measured(tmp_path: Path) -> None:
    ranges = np.array([1.0, np.inf, -np.inf, 2.5], np.float32)
    message = write(tmp_path / "a.mcap", "/scan", say.laser_scan(TIME, ranges, Lidar(beams=4)))
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1_700_000_000, 250_000_000)
    assert message.header.frame_id == "velodyne"
    assert message.angle_min == pytest.approx(-math.pi)
    assert message.angle_max == pytest.approx(math.pi / 2)
    assert message.angle_increment == pytest.approx(math.pi / 2)
    assert message.range_min == pytest.approx(0.12)
    assert message.range_max == 12.0
    assert message.scan_time == pytest.approx(0.1)
    assert list(message.ranges) == [1.0, math.inf, -math.inf, 2.5]


def test_odometry_has_its_pose_in_the_room_and_its_twist_in_the_body(tmp_path: Path) -> None:
    sent = say.odometry(TIME, "odom", Pose(1.0, 2.0, math.pi / 2), BodyVelocity(0.3, -0.2))
    message = write(tmp_path / "a.mcap", "/odom", sent)
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")
    pose, twist = message.pose.pose, message.twist.twist
    assert (pose.position.x, pose.position.y, pose.position.z) == (1.0, 2.0, 0.0)
    assert pose.orientation.z == pytest.approx(math.sqrt(0.5))
    assert pose.orientation.w == pytest.approx(math.sqrt(0.5))
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (0.3, 0.0, -0.2)


def test_the_transforms_lead_from_the_map_to_the_lidar(tmp_path: Path) -> None:
    message = write(tmp_path / "a.mcap", "/tf", say.transforms(TIME, Pose(3.0, 4.0)))
    fixed = write(tmp_path / "b.mcap", "/tf_static", say.fixed_transforms(TIME))
    moving, still = (
        [(link.header.frame_id, link.child_frame_id) for link in transform.transforms]
        for transform in (message, fixed)
    )
    assert moving == [("odom", "base_link")]
    assert still == [("map", "odom"), ("base_link", "velodyne")]
    assert message.transforms[0].transform.translation.x == 3.0
    assert message.transforms[0].transform.translation.y == 4.0


def test_a_goal_and_a_stop_arrive_as_sent(tmp_path: Path) -> None:
    goal = write(tmp_path / "a.mcap", "/goal", say.goal_pose(TIME, Pose(5.0, 6.0)))
    assert (goal.header.frame_id, goal.pose.position.x, goal.pose.position.y) == ("map", 5.0, 6.0)
    assert write(tmp_path / "b.mcap", "/gwendolen_control", say.boolean(True)).data is True
    assert write(tmp_path / "c.mcap", "/gwendolen_control", say.boolean(False)).data is False


def test_the_quality_of_service_is_a_yaml_list_of_one_profile() -> None:
    topic = log.RecordedTopic(
        "/scan", "sensor_msgs/msg/LaserScan", depth=5, reliability="best_effort"
    )
    assert topic.offered_qos_profiles() == (
        "- history: keep_last\n"
        "  depth: 5\n"
        "  reliability: best_effort\n"
        "  durability: volatile\n"
        "  deadline:\n"
        "    sec: 9223372036\n"
        "    nsec: 854775807\n"
        "  lifespan:\n"
        "    sec: 9223372036\n"
        "    nsec: 854775807\n"
        "  liveliness: automatic\n"
        "  liveliness_lease_duration:\n"
        "    sec: 9223372036\n"
        "    nsec: 854775807\n"
        "  avoid_ros_namespace_conventions: false\n"
    )


def test_until_the_end_the_log_is_not_there_under_its_name(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with log.recording(path) as recording:
        assert not path.exists()
        assert len(list(tmp_path.iterdir())) == 1
        recording.finish("simulation", {})
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, SystemExit, ValueError])
def test_an_interrupted_recording_leaves_nothing_behind_and_an_older_log_as_it_was(
    tmp_path: Path, stop: type[BaseException]
) -> None:
    old = tmp_path / "old.mcap"
    old.write_bytes(b"older")
    for path in (old, tmp_path / "new.mcap"):
        with pytest.raises(stop):
            write_and_raise(path, stop)
    assert list(tmp_path.iterdir()) == [old]
    assert old.read_bytes() == b"older"


def write_and_raise(path: Path, stop: type[BaseException]) -> None:
    with log.recording(path) as recording:
        recording.write("/gwendolen_control", say.boolean(True), TIME)
        raise stop


def test_a_folder_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), log.recording(tmp_path / "no" / "a.mcap"):
        pass


def test_the_map_has_its_rows_along_x_and_says_what_is_occupied(tmp_path: Path) -> None:
    clearance = np.array([[0.0, 1.0, 2.0], [1.0, 1.0, 0.0]])  # two cells along x, three along y
    grid = write(tmp_path / "a.mcap", "/map", say.occupancy(TIME, clearance, 0.05))
    assert (grid.info.width, grid.info.height) == (2, 3)
    assert grid.info.resolution == pytest.approx(0.05)
    assert list(grid.data) == [100, 0, 0, 0, 0, 100]


def test_what_a_twist_and_an_odometry_say_is_what_was_sent() -> None:
    sent = BodyVelocity(0.3, -0.2)
    assert say.velocity(say.twist(sent)) == sent
    pose, velocity = say.motion(say.odometry(TIME, "odom", Pose(1.0, 2.0, -2.5), sent))
    assert (pose.x, pose.y, velocity) == (1.0, 2.0, sent)
    assert pose.yaw == pytest.approx(-2.5)


def test_a_log_of_ros_1_is_read_by_its_official_decoder(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with log.recording(path, log.Encoding.ROS1) as recording:
        scan = say.laser_scan(TIME, np.array([1.0, np.inf], np.float32), Lidar(beams=2))
        recording.write("/scan", scan, TIME)
        recording.write("/tf", say.transforms(TIME, Pose(3.0, 4.0)), TIME)
        recording.write("/gwendolen_control", say.boolean(True), TIME)
        recording.finish("simulation", {})
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[Ros1DecoderFactory()])
        assert reader.get_header().profile == "ros1"
        found = {
            channel.topic: message for _, channel, _, message in reader.iter_decoded_messages()
        }
    assert list(found["/scan"].ranges) == [1.0, math.inf]
    assert found["/scan"].header.stamp.secs == 1_700_000_000
    assert found["/tf"].transforms[0].transform.translation.x == 3.0
    assert found["/gwendolen_control"].data is True


def test_a_clock_that_jumps_changes_the_times_from_then_on(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    faults = Recorder(jump_at=1.0, jump_by=5.0)
    with log.recording(path, faults=faults, epoch=TIME) as recording:
        for time in (TIME, TIME + 999_999_999, TIME + 10**9):
            recording.write("/gwendolen_control", say.boolean(True), time)
        recording.finish("simulation", {})
    with path.open("rb") as stream:
        times = [message.log_time - TIME for _, _, message in make_reader(stream).iter_messages()]
    assert times == [0, 999_999_999, 6 * 10**9]


def test_a_log_that_is_cut_is_the_beginning_of_the_whole_one(tmp_path: Path) -> None:
    whole, part = tmp_path / "whole.mcap", tmp_path / "part.mcap"
    for path, keep in ((whole, 1.0), (part, 0.5)):
        with log.recording(path, faults=Recorder(keep=keep)) as recording:
            recording.write("/gwendolen_control", say.boolean(True), TIME)
            recording.finish("simulation", {})
    assert part.read_bytes() == whole.read_bytes()[: round(whole.stat().st_size / 2)]
