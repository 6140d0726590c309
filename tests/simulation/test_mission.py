import hashlib
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader

from simulation.mission import Mission, record
from simulation.safety import SafetyFunction

SECOND = 10**9


@dataclass(frozen=True)
class Log:
    """A mission and its log, read back."""

    mission: Mission
    messages: list[tuple[str, int, Any]]

    def of(self, topic: str) -> list[tuple[int, Any]]:
        return [(time, message) for name, time, message in self.messages if name == topic]

    @cached_property
    def control(self) -> list[tuple[int, bool]]:
        return [(time, message.data) for time, message in self.of("/gwendolen_control")]

    @cached_property
    def stops(self) -> list[tuple[int, int]]:
        """From each request to stop to its release."""
        edges = [(0, False), *self.control]
        changes = [(t, now) for (_, before), (t, now) in pairwise(edges) if before != now]
        return [(start, end) for (start, stop), (end, _) in pairwise(changes) if stop]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    return read(record(tmp_path_factory.mktemp("log") / "mission.mcap", seed=1))


def read(mission: Mission) -> Log:
    with mission.path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return Log(
            mission,
            [
                (channel.topic, message.log_time, decoded)
                for _, channel, message, decoded in reader.iter_decoded_messages(
                    log_time_order=False
                )
            ],
        )


def digest(path: Path) -> str:
    sha = hashlib.sha256()
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            sha.update(f"{channel.topic} {message.log_time} ".encode() + message.data)
    return sha.hexdigest()


def test_the_same_seed_gives_the_same_messages_and_another_seed_others(tmp_path: Path) -> None:
    first, again, other = (
        digest(record(tmp_path / f"{name}.mcap", seed, max_seconds=15).path)
        for name, seed in (("first", 7), ("again", 7), ("other", 8))
    )
    assert first == again
    assert first != other


def test_the_mission_is_completed_with_stops_and_the_summary_agrees_with_the_log(
    log: Log,
) -> None:
    mission = log.mission
    assert (mission.seed, mission.goals_reached, mission.goals_total) == (1, 4, 4)
    assert mission.stops == len(log.stops) >= 2
    assert mission.messages == len(log.messages)
    last = log.messages[-1][1] - 1_700_000_000 * SECOND
    assert mission.duration == pytest.approx(last / SECOND, abs=0.021)
    assert mission.measured_clearance < 0.05
    assert mission.true_clearance < 0.05
    assert len(log.of("/goal")) == 4


def test_every_topic_has_its_type_and_rate(log: Log) -> None:
    with log.mission.path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    counts = summary.statistics.channel_message_counts
    seconds = log.mission.duration
    found = {
        channel.topic: (summary.schemas[channel.schema_id].name, counts[id] / seconds)
        for id, channel in summary.channels.items()
    }
    assert {topic: name for topic, (name, _) in found.items()} == {
        "/scan": "sensor_msgs/msg/LaserScan",
        "/odom": "nav_msgs/msg/Odometry",
        "/ground_truth": "nav_msgs/msg/Odometry",
        "/cmd_vel": "geometry_msgs/msg/Twist",
        "/cmd_vel_filtered": "geometry_msgs/msg/Twist",
        "/gwendolen_control": "std_msgs/msg/Bool",
        "/tf": "tf2_msgs/msg/TFMessage",
        "/goal": "geometry_msgs/msg/PoseStamped",
    }
    for topic in ("/scan", "/tf", "/cmd_vel"):
        assert found[topic][1] == pytest.approx(10, abs=0.1)
    for topic in ("/odom", "/ground_truth"):
        assert found[topic][1] == pytest.approx(50, abs=0.1)
    assert found["/cmd_vel_filtered"][1] * seconds == pytest.approx(
        found["/cmd_vel"][1] * seconds + len(log.stops)
    )
    assert found["/gwendolen_control"][1] == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize(
    ("topic", "period"),
    [("/scan", 100), ("/odom", 20), ("/ground_truth", 20), ("/cmd_vel", 100), ("/tf", 100)],
)
def test_periodic_topics_come_on_time(log: Log, topic: str, period: int) -> None:
    gaps = {later - time for (time, _), (later, _) in pairwise(log.of(topic))}
    assert gaps == {period * 1_000_000}


def test_stop_or_not_is_said_at_least_twice_a_second(log: Log) -> None:
    assert max(later - time for (time, _), (later, _) in pairwise(log.control)) <= SECOND // 2


def test_times_never_decrease_and_a_scan_was_measured_before_it_was_logged(log: Log) -> None:
    times = [time for _, time, _ in log.messages]
    assert times == sorted(times)
    assert times[0] == 1_700_000_000 * SECOND
    for time, scan in log.of("/scan"):
        assert time - stamp(scan) == 300_000
    for topic in ("/odom", "/ground_truth", "/goal"):
        assert all(time == stamp(message) for time, message in log.of(topic))


def stamp(message: Any) -> int:
    return int(message.header.stamp.sec * SECOND + message.header.stamp.nanosec)


def test_each_scan_below_five_centimetres_is_answered_unless_the_operator_drives(
    log: Log,
) -> None:
    for time, scan in log.of("/scan"):
        stopped = any(start <= time < end for start, end in log.stops)
        released = any(end <= time < end + 2 * SECOND for _, end in log.stops)
        if not stopped and not released and outline_distance(scan) < 0.05:
            assert time + 1_200_000 in [start for start, _ in log.stops]
    nearest = {time: outline_distance(scan) for time, scan in log.of("/scan")}
    assert all(nearest[start - 1_200_000] < 0.05 for start, _ in log.stops)


def outline_distance(scan: Any) -> float:
    ranges: NDArray[np.float64] = np.array(scan.ranges)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    seen = np.isfinite(ranges)
    x, y = np.abs(ranges[seen] * np.cos(angles[seen])), np.abs(ranges[seen] * np.sin(angles[seen]))
    return float(np.hypot(np.maximum(x - 0.306, 0), np.maximum(y - 0.290, 0)).min())


def test_on_a_stop_the_wheels_get_zero_at_once_and_until_the_release(log: Log) -> None:
    for start, end in log.stops:
        during = [
            (time, message.linear.x, message.angular.z)
            for time, message in log.of("/cmd_vel_filtered")
            if start <= time < end
        ]
        assert during[0][0] - start == 200_000
        assert all((forward, turn) == (0.0, 0.0) for _, forward, turn in during)
        assert max(later[0] - time[0] for time, later in pairwise(during)) <= SECOND // 10


def test_without_a_stop_the_command_is_forwarded(log: Log) -> None:
    filtered = {
        time: (message.linear.x, message.angular.z) for time, message in log.of("/cmd_vel_filtered")
    }
    for time, message in log.of("/cmd_vel"):
        if not any(start <= time < end for start, end in log.stops):
            assert filtered[time + 200_000] == (message.linear.x, message.angular.z)


def test_a_stopped_robot_stands_within_half_a_second_and_for_three(log: Log) -> None:
    for start, end in log.stops:
        assert end - start >= 3 * SECOND
        for time, message in log.of("/odom"):
            if start + SECOND // 2 <= time < end:
                assert abs(message.twist.twist.linear.x) < 0.01
                assert abs(message.twist.twist.angular.z) < 0.01


def test_the_robot_is_never_faster_than_allowed(log: Log) -> None:
    assert max(message.twist.twist.linear.x for _, message in log.of("/odom")) < 0.401


def test_the_true_pose_moves_as_fast_as_the_robot_says(log: Log) -> None:
    truth = [message for _, message in log.of("/ground_truth")]
    places = [(true.pose.pose.position.x, true.pose.pose.position.y) for true in truth]
    travelled = np.hypot(*np.diff(places, axis=0).T).sum()
    said = sum(abs(true.twist.twist.linear.x) for true in truth) * 0.02
    assert travelled == pytest.approx(said, rel=0.01)


def test_odometry_drifts_from_the_truth_by_some_centimetres(log: Log) -> None:
    pairs = zip(log.of("/odom"), log.of("/ground_truth"), strict=True)
    drift = [
        odom.pose.pose.position.x - true.pose.pose.position.x for (_, odom), (_, true) in pairs
    ]
    assert 0.01 < np.std(drift) < 0.1
    assert np.abs(np.diff(drift)).max() < 0.04


def test_another_seed_drifts_another_way(tmp_path: Path) -> None:
    first, other = (
        read(record(tmp_path / f"{seed}.mcap", seed, max_seconds=1)).of("/odom")[-1][1]
        for seed in (1, 2)
    )
    apart = first.pose.pose.position.x - other.pose.pose.position.x
    assert abs(apart) > 0.001


def test_the_safety_function_is_armed_again_after_every_manoeuvre(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []

    class Told(SafetyFunction):
        def release(self) -> None:
            calls.append("release")
            super().release()

        def rearm(self) -> None:
            calls.append("rearm")
            super().rearm()

    monkeypatch.setattr("simulation.mission.SafetyFunction", Told)
    mission = record(tmp_path / "mission.mcap", seed=7)
    assert mission.stops >= 2
    assert calls == ["release", "rearm"] * mission.stops


def test_all_messages_decode_with_rosbags_from_the_definitions_in_the_file(log: Log) -> None:
    with AnyReader([log.mission.path]) as reader:
        decoded = [
            reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages()
        ]
    assert len(decoded) == log.mission.messages


def test_the_file_is_marked_as_ros_2_and_has_one_time_for_each_message(log: Log) -> None:
    with log.mission.path.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            assert channel.metadata["offered_qos_profiles"].startswith("- history: keep_last\n")
            assert message.publish_time == message.log_time


def test_the_log_names_its_seed_and_options(tmp_path: Path) -> None:
    mission = record(tmp_path / "mission.mcap", seed=3, max_seconds=1)
    with mission.path.open("rb") as stream:
        records = {entry.name: entry.metadata for entry in make_reader(stream).iter_metadata()}
    assert records["simulation"]["seed"] == "3"
    assert records["simulation"]["max_seconds"] == "1"
    assert records["simulation"]["safe_distance"] == "0.05"


def test_a_mission_that_is_cut_off_is_still_recorded(tmp_path: Path) -> None:
    mission = record(tmp_path / "mission.mcap", max_seconds=2)
    assert (mission.duration, mission.goals_reached) == (2.0, 0)
    assert mission.messages == 100 + 100 + 20 + 20 + 20 + 20 + 4 + 1


def test_progress_is_told_every_simulated_second(tmp_path: Path) -> None:
    told: list[float] = []
    record(tmp_path / "mission.mcap", max_seconds=3, progress=told.append)
    assert told == [0.0, 1.0, 2.0]


def test_an_interrupted_mission_leaves_no_file_behind(tmp_path: Path) -> None:
    def interrupt(seconds: float) -> None:
        if seconds >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(tmp_path / "mission.mcap", progress=interrupt)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("seed", [2, 3])
def test_other_seeds_complete_the_mission_too(tmp_path: Path, seed: int) -> None:
    mission = record(tmp_path / "mission.mcap", seed)
    assert mission.goals_reached == mission.goals_total
