import hashlib
import json
from dataclasses import dataclass, replace
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

from simulation.mission import Mission, possible, really
from simulation.recording import TOPICS
from simulation.world.scenario import (
    Interceptor,
    MapDifferences,
    Operator,
    Outage,
    Safety,
    Scenario,
    Sensor,
    Transport,
    load,
)
from simulation.world.scene import STORE
from tests.effort import FULL, full_only
from tests.simulation.missions import Missions, cut_off, record

pytestmark = pytest.mark.slow

SECOND = 10**9
MOVED = load("obstacle-moved")
NOMINAL = load("nominal")


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
def log(missions: Missions) -> Log:
    """A whole mission; in quick tests until one of four goals is reached."""
    return read(missions(MOVED if FULL else replace(MOVED, duration=80.0), by_hand=True))


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
        digest(record(tmp_path / f"{name}.mcap", MOVED, seed, max_seconds=15 if FULL else 5).path)
        for name, seed in (("first", 7), ("again", 7), ("other", 8))
    )
    assert first == again
    assert first != other


def test_the_mission_is_completed_with_stops_and_the_summary_agrees_with_the_log(
    log: Log,
) -> None:
    mission = log.mission
    reached = 4 if FULL else 1
    assert (mission.seed, mission.goals_reached, mission.goals_total) == (1, reached, 4)
    assert len(mission.stops) == len(log.stops) >= 1
    assert mission.messages == len(log.messages)
    last = log.messages[-1][1] - 1_700_000_000 * SECOND
    assert mission.duration == pytest.approx(last / SECOND, abs=0.021)
    assert mission.measured_clearance < 0.05
    assert 0 < mission.true_clearance < 0.06
    assert mission.contacts == 0
    assert len(log.of("/goal")) == min(4, reached + 1)
    truth = [message.data for _, message in log.of("/ground_truth/clearance")]
    assert mission.true_clearance == pytest.approx(min(truth), abs=1e-6)


def test_the_summary_says_how_long_and_how_far_a_stop_took(log: Log) -> None:
    for stop, (start, end) in zip(log.mission.stops, log.stops, strict=True):
        assert stop.latency is not None
        standing = next(
            time
            for time, message in log.of("/ground_truth")
            if start <= time < end and abs(message.twist.twist.linear.x) < 0.01
            if abs(message.twist.twist.angular.z) < 0.01
        )
        assert stop.latency == pytest.approx((standing - start) / SECOND, abs=0.021)
        assert 0 <= stop.distance < 0.02


def test_every_topic_has_its_type(log: Log) -> None:
    with log.mission.path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    found = {c.topic: summary.schemas[c.schema_id].name for c in summary.channels.values()}
    assert found == {topic.name: topic.type for topic in TOPICS}
    counts = {topic: len(log.of(topic)) for topic in found}
    assert counts["/map"] == counts["/tf_static"] == counts["/robot_description"] == 1


@pytest.mark.parametrize(
    ("topic", "period"),
    [
        ("/scan", 100),
        ("/odom", 20),
        ("/ground_truth", 20),
        ("/ground_truth/clearance", 20),
        ("/cmd_vel", 100),
        ("/tf", 100),
        ("/clock", 100),
    ],
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
    manual = [(time, message.data) for time, message in log.of("/manual_control")]
    for time, scan in log.of("/scan"):
        stopped = any(start <= time < end for start, end in log.stops)
        driven = [hand for at, hand in manual if at <= time][-1]
        if not stopped and not driven and outline_distance(scan) < 0.05:
            assert time + 1_200_000 in [start for start, _ in log.stops]
    nearest = {time + 1_200_000: outline_distance(scan) for time, scan in log.of("/scan")}
    for start, _ in log.stops:
        assert nearest.get(start, 0.0) < 0.05


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
        assert max(later[0] - time[0] for time, later in pairwise(during)) <= SECOND // 20


def test_a_stopped_robot_stands_within_half_a_second_and_for_three(log: Log) -> None:
    for start, end in log.stops:
        assert end - start >= 3 * SECOND
        for time, message in log.of("/odom"):
            if start + SECOND // 2 <= time < end:
                assert abs(message.twist.twist.linear.x) < 0.01
                assert abs(message.twist.twist.angular.z) < 0.01


def test_the_robot_is_never_faster_than_allowed(log: Log) -> None:
    assert max(abs(message.linear.x) for _, message in log.of("/cmd_vel_filtered")) <= 0.4
    assert max(abs(message.angular.z) for _, message in log.of("/cmd_vel_filtered")) <= 0.2
    assert max(message.twist.twist.linear.x for _, message in log.of("/odom")) < 0.401


def test_the_true_pose_moves_as_fast_as_the_robot_says(log: Log) -> None:
    truth = [message for _, message in log.of("/ground_truth")]
    places = [(true.pose.pose.position.x, true.pose.pose.position.y) for true in truth]
    travelled = np.hypot(*np.diff(places, axis=0).T).sum()
    odometer = sum(abs(true.twist.twist.linear.x) for true in truth) * 0.02
    assert travelled == pytest.approx(odometer, rel=0.01)


def test_odometry_drifts_from_the_truth_by_some_centimetres(log: Log) -> None:
    pairs = zip(log.of("/odom"), log.of("/ground_truth"), strict=True)
    drift = [
        odom.pose.pose.position.x - true.pose.pose.position.x for (_, odom), (_, true) in pairs
    ]
    assert 0.01 < np.std(drift) < 0.1
    assert np.abs(np.diff(drift)).max() < 0.04


def test_another_seed_drifts_another_way(tmp_path: Path) -> None:
    first, other = (
        read(record(tmp_path / f"{seed}.mcap", NOMINAL, seed, max_seconds=1)).of("/odom")[-1][1]
        for seed in (1, 2)
    )
    apart = first.pose.pose.position.x - other.pose.pose.position.x
    assert abs(apart) > 0.001


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


def test_the_log_names_what_made_it(tmp_path: Path) -> None:
    out = tmp_path / "mission.mcap"
    record(out, MOVED, seed=3, max_seconds=1, versions={"fretc": "1.2"})
    with out.open("rb") as stream:
        (about,) = (entry.metadata for entry in make_reader(stream).iter_metadata())
    assert (about["scenario"], about["seed"]) == ("obstacle-moved", "3")
    assert (about["max_seconds"], about["fretc"]) == ("1", "1.2")
    options = json.loads(about["options"])
    assert options["store"]["moved"] == {"barrel_9": [1.5, 2.6]}
    assert options["planner"]["speed"] == 0.4


def test_a_mission_that_is_cut_off_is_still_recorded(tmp_path: Path) -> None:
    mission = record(tmp_path / "mission.mcap", NOMINAL, max_seconds=2)
    assert (mission.duration, mission.goals_reached) == (2.0, 0)
    periodic = 3 * 100 + 3 * 20 + 20 + 20 + 40
    once = 3 + 1 + 1  # map, fixed transforms, description; goal; nobody drives by hand
    heartbeats = 4
    assert mission.messages == periodic + once + heartbeats


def test_progress_is_told_every_simulated_second(tmp_path: Path) -> None:
    seconds: list[float] = []
    record(tmp_path / "mission.mcap", NOMINAL, max_seconds=3, progress=seconds.append)
    assert seconds == [0.0, 1.0, 2.0]


def test_an_interrupted_mission_leaves_no_file_behind(tmp_path: Path) -> None:
    def interrupt(seconds: float) -> None:
        if seconds >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        record(tmp_path / "mission.mcap", NOMINAL, progress=interrupt)
    assert list(tmp_path.iterdir()) == []


@full_only("a whole mission more")
def test_a_nominal_mission_is_completed_without_a_stop(tmp_path: Path) -> None:
    mission = record(tmp_path / "mission.mcap", NOMINAL, seed=2)
    assert mission.goals_reached == mission.goals_total
    assert mission.stops == ()
    assert mission.true_clearance > 0.1


def test_without_a_safety_function_nobody_speaks_and_the_robot_hits_the_obstacle(
    tmp_path: Path,
) -> None:
    paper = Interceptor(at_once=False, period=0, hold=0, command_timeout=0, safety_timeout=0)
    off = Scenario("off", store=MOVED.store, safety=Safety(on=False), interceptor=paper)
    log = read(record(tmp_path / "mission.mcap", off, max_seconds=30))
    assert log.control == []
    assert log.mission.contacts >= 1


def test_without_a_release_the_robot_stands_for_ever(tmp_path: Path) -> None:
    alone = Scenario("alone", store=MOVED.store, operator=Operator(present=False))
    log = read(record(tmp_path / "mission.mcap", alone, max_seconds=40))
    assert [stop for _, stop in log.control][-1] is True
    (stop,) = log.mission.stops
    assert log.mission.track[-1].x == pytest.approx(stop.at.x, abs=0.02)


def test_the_walker_comes_when_the_robot_does_and_goes_again(missions: Missions) -> None:
    mission = missions(load("walker") if FULL else cut_off("walker"))
    assert mission.goals_reached == (4 if FULL else 1)
    assert len(mission.stops) >= 1
    assert mission.contacts == 0


def test_faults_of_the_lidar_are_in_the_log(tmp_path: Path) -> None:
    sensor = Sensor(nan_first=True, outages=(Outage(1.0, 0.5), Outage(2.0, 0.5, "nan")))
    log = read(record(tmp_path / "m.mcap", Scenario("faults", lidar=sensor), max_seconds=3))
    scans = {(stamp(scan) - 1_700_000_000 * SECOND) // 10**8: scan for _, scan in log.of("/scan")}
    assert sorted(scans) == [*range(10), *range(15, 30)]
    assert all(np.isnan(scan.ranges[0]) for scan in scans.values())
    blind = [tenth for tenth, scan in scans.items() if np.isnan(scan.ranges).all()]
    assert blind == [20, 21, 22, 23, 24]


def test_only_what_the_scenario_moves_stands_somewhere_else() -> None:
    real = {obstacle.name: obstacle for obstacle in really(STORE, MOVED).obstacles}
    for mapped in STORE.obstacles:
        place = (real[mapped.name].x, real[mapped.name].y)
        assert place == ((1.5, 2.6) if mapped.name == "barrel_9" else (mapped.x, mapped.y))
    with pytest.raises(ValueError, match="the store has no obstacle `barrel_11`"):
        really(STORE, Scenario("bad", store=MapDifferences(moved={"barrel_11": (1.0, 1.0)})))


def test_a_fault_of_a_topic_that_is_not_there_is_refused() -> None:
    possible(MOVED)
    with pytest.raises(ValueError, match="the robot has no topic `/scam`"):
        possible(Scenario("bad", transport={"/scam": Transport(loss=0.1)}))
