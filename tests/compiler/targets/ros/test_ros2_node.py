"""The emitted nodes of ROS 2, in a world that stands for rclpy: what they say, whatever happens.

What the calls of rclpy promise, and what a world keeps of it, stands in `tests/ros2`.
"""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from monitors.loading import executed
from tests.effort import examples
from tests.ros2 import rclpy
from tests.ros2.emitted import FORWARD, Monitor, Robot, write
from tests.ros2.messages import message_class

ROOT = Path(__file__).parents[4]
NEAR = 0.33
"""A range straight ahead that is 2.4 cm from the robot's outline."""
OK, WARN, ERROR, STALE = (bytes([level]) for level in range(4))


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(ROOT / "requirements/r1.fret", tmp_path_factory.mktemp("ros2"))


def driving(package: Path) -> tuple[Robot, Monitor]:
    """A robot with both nodes that drives since two seconds."""
    robot = Robot(package)
    robot.obeys = True
    robot.interceptor()
    monitor = robot.monitor()
    robot.world.run(2.0)
    assert robot.stop is False
    assert robot.wheels == FORWARD
    return robot, monitor


def test_a_robot_of_which_all_is_known_drives(package: Path) -> None:
    robot, _ = driving(package)
    assert robot.diagnostics["r1_monitor: R1"].level == OK
    assert robot.diagnostics["r1_monitor: sources"].level == OK
    assert [line["obligation_pending"] for line in robot.news][-1] is False


def test_a_demand_stops_the_wheels_when_it_arrives_and_not_at_its_tick(package: Path) -> None:
    robot, _ = driving(package)
    robot.world.run(0.037)  # between two ticks, and between two beats
    before = len(robot.stops), len(robot.world.sent["/cmd_vel_filtered"])
    robot.see(NEAR)
    robot.world.run(0.0)
    assert robot.stops[before[0] :] == [True]
    assert robot.wheels == 0.0
    assert len(robot.world.sent["/cmd_vel_filtered"]) > before[1]
    robot.range, robot.obeys, robot.speed = NEAR, False, FORWARD  # it rolls on
    robot.world.run(1.0)
    assert robot.news[-1]["obligation_pending"] is True
    assert robot.diagnostics["r1_monitor: R1"].level == WARN
    robot.range = 3.0  # the obstacle has gone; the demand is still there
    robot.world.run(1.0)
    assert robot.wheels == 0.0
    robot.obeys = True
    robot.world.run(1.0)
    assert robot.news[-1]["obligation_pending"] is False
    assert robot.wheels == FORWARD


@pytest.mark.slow
@pytest.mark.parametrize("silent", ["scans", "odometry", "both"])
def test_without_any_message_the_robot_stands(package: Path, silent: str) -> None:
    robot = Robot(package)
    robot.scans, robot.odometry = silent == "odometry", silent == "scans"
    robot.interceptor()
    robot.monitor()
    robot.world.run(5.0)
    assert set(robot.stops) == {True}
    assert {message.linear.x for _, message in robot.world.sent["/cmd_vel_filtered"]} == {0.0}
    status = robot.diagnostics["r1_monitor: sources"]
    assert status.level == STALE
    assert "no message of " in status.message


def test_another_definition_of_a_type_stops_the_robot_and_is_told_once(package: Path) -> None:
    robot, monitor = driving(package)
    robot.world.hashes["/scan"] = "RIHS01_ff"
    robot.world.run(1.0)
    assert robot.stop
    assert robot.wheels == 0.0
    robot.see(3.0)
    robot.world.run(0.0)
    assert robot.stop
    what = "another definition of LaserScan, RIHS01_ff"
    assert monitor.node.log == [
        ("error", f"/scan: /robot publishes {what}: nothing is known of it meanwhile")
    ]
    assert robot.diagnostics["r1_monitor: R1"].message == (
        f"a message of /scan cannot be read: /robot publishes {what}"
    )
    robot.world.hashes["/scan"] = "INVALID"  # of a publisher that does not state it
    robot.world.run(3.0)
    assert robot.wheels == FORWARD
    odometry = message_class("nav_msgs/Odometry")
    other = robot._node.create_publisher(odometry, "/scan", 10)
    robot.world.run(1.0)
    assert robot.wheels == 0.0
    assert monitor.node.log[1:] == [
        ("error", "/scan: /robot publishes Odometry: nothing is known of it meanwhile")
    ]
    robot._node.destroy_publisher(other)
    robot.world.run(3.0)
    assert robot.wheels == FORWARD


@pytest.mark.parametrize("ranges", [[math.nan] * 3, [], [0.0, math.nan]])
def test_a_sensor_that_says_nothing_stops_the_robot(package: Path, ranges: list[float]) -> None:
    robot, _ = driving(package)
    robot.scans = False
    robot.see(*ranges)
    robot.world.run(0.0)
    assert robot.stop
    assert robot.wheels == 0.0


def test_a_beam_without_a_return_is_no_obstacle_and_hides_none(package: Path) -> None:
    robot, _ = driving(package)
    robot.see(math.nan, math.inf, 3.0)
    robot.world.run(0.0)
    assert robot.stop is False
    robot.see(math.nan, math.inf, NEAR)
    robot.world.run(0.0)
    assert robot.stop


@pytest.mark.slow
@pytest.mark.parametrize("sensor", ["scans", "odometry"])
def test_a_sensor_that_falls_silent_stops_the_robot(package: Path, sensor: str) -> None:
    robot, _ = driving(package)
    setattr(robot, sensor, False)
    robot.world.run(0.6)
    assert robot.stop
    assert robot.wheels == 0.0
    robot.world.run(1.0)
    assert robot.diagnostics["r1_monitor: sources"].level == STALE
    setattr(robot, sensor, True)
    robot.world.run(0.6)
    assert robot.stop is False


def test_where_the_monitor_is_killed_the_robot_stands_until_another_one_knows(
    package: Path,
) -> None:
    robot, monitor = driving(package)
    monitor.process.kill()
    robot.world.run(1.3)
    assert robot.wheels == 0.0
    robot.world.run(5.0)
    assert robot.wheels == 0.0
    robot.scans = False
    robot.monitor()
    robot.world.run(1.0)
    assert robot.stop
    robot.scans = True
    robot.world.run(1.0)
    assert robot.wheels == FORWARD


def test_where_the_planner_is_killed_the_robot_stands(package: Path) -> None:
    robot, _ = driving(package)
    robot.plans = False
    robot.world.run(0.6)
    assert robot.stop is False
    assert robot.wheels == 0.0


def test_a_new_interceptor_stands_until_it_has_heard_of_all(package: Path) -> None:
    robot = Robot(package)
    robot.monitor()
    robot.world.run(2.0)
    robot.interceptor()
    assert robot.world.sent["/cmd_vel_filtered"] == []
    robot.world.run(0.01)
    assert all(message.linear.x == 0.0 for _, message in robot.world.sent["/cmd_vel_filtered"])
    robot.world.run(1.0)
    assert robot.wheels == FORWARD


def test_whoever_subscribes_late_gets_the_last_request(package: Path) -> None:
    robot = Robot(package)
    monitor = robot.monitor()
    robot.world.run(0.05)
    heard: list[Any] = []
    late = robot.world.node("late")
    late.create_subscription(
        message_class("std_msgs/Bool"), "/gwendolen_control", heard.append, monitor.module.KEPT
    )
    robot.world.run(0.0)
    assert [each.data for each in heard] == [True]


# Time --------------------------------------------------------------------------------------------

SIMULATED = ("-p", "use_sim_time:=true")


class Simulation:
    """Publishes /clock, 100 times a second, unless it pauses."""

    def __init__(self, robot: Robot, start: float) -> None:
        self.time, self.pauses = round(start * 1e9), False
        node = robot.world.node("simulation")
        clock = message_class("rosgraph_msgs/Clock")
        publisher = node.create_publisher(clock, "/clock", 10)

        def tick() -> None:
            robot.world.after(10**7, node, tick)
            if not self.pauses:
                self.time += 10**7
                message = clock()
                message.clock.sec, message.clock.nanosec = divmod(self.time, 10**9)
                publisher.publish(message)

        robot.world.after(0, node, tick)


def test_before_simulated_time_begins_the_robot_stands(package: Path) -> None:
    robot = Robot(package)
    robot.monitor(*SIMULATED)
    robot.world.run(5.0)
    assert set(robot.stops) == {True}
    assert {line["verdict"] for line in robot.news} == {"no data"}
    Simulation(robot, 0.0)
    robot.world.run(2.0)
    assert robot.stop is False
    assert robot.news[-1]["time_ns"] <= 2 * 10**9


def test_where_time_goes_back_another_run_begins_that_knows_nothing_yet(package: Path) -> None:
    robot = Robot(package)
    simulation = Simulation(robot, 100.0)
    robot.monitor(*SIMULATED)
    robot.speed = FORWARD
    robot.world.run(5.0)
    assert robot.stop is False
    simulation.time = 0
    robot.range = NEAR
    robot.world.run(3.0)
    assert robot.stop
    values = {each.key: each.value for each in robot.diagnostics["r1_monitor: sources"].values}
    assert values["clock was set"] == "1"
    robot.range = 3.0
    robot.speed = 0.0
    robot.world.run(3.0)
    assert robot.stop is False
    assert robot.news[-1]["triggered_ns"] < 4 * 10**9


def test_where_time_leaps_forward_or_stands_still_the_robot_stops(package: Path) -> None:
    robot = Robot(package)
    simulation = Simulation(robot, 100.0)
    robot.monitor(*SIMULATED)
    robot.world.run(5.0)
    assert robot.stop is False
    simulation.time += 3600 * 10**9
    robot.scans = False
    robot.world.run(0.1)
    assert robot.stop
    robot.scans = True
    robot.world.run(2.0)
    assert robot.stop is False
    simulation.pauses = True
    robot.scans = robot.odometry = False  # so do the drivers of a simulation
    robot.world.run(1.0)
    assert robot.stop


# A managed node ----------------------------------------------------------------------------------

transitions = st.lists(
    st.sampled_from(["configure", "activate", "deactivate", "cleanup", "shutdown"]), max_size=8
)


@pytest.mark.slow
@examples(10)
@given(transitions, st.booleans())
def test_only_an_active_node_lets_the_robot_go(
    package: Path, asked: list[str], acknowledges: bool
) -> None:
    robot = Robot(package)
    robot.world.acknowledges = acknowledges
    monitor = robot.monitor(activate=False)
    for each in ["configure", "activate", *asked]:
        before = len(robot.stops)
        monitor.node.change(each)
        if monitor.node.state == "active":
            robot.world.run(0.5)
            assert robot.stop is False
        else:
            robot.world.run(0.3)
            assert robot.stops[before:] in ([], [True])
            assert all(robot.stops[-1:])
    assert not [text for level, text in monitor.node.log if level in ("error", "fatal")]


def test_a_node_that_is_not_active_says_so(package: Path) -> None:
    robot = Robot(package)
    monitor = robot.monitor(activate=False)
    monitor.change("configure")
    assert robot.diagnostics["r1_monitor: node"].level == STALE
    monitor.change("activate")
    robot.world.run(1.0)
    assert robot.diagnostics.keys() == {"r1_monitor: sources", "r1_monitor: R1"}
    monitor.change("deactivate")
    assert robot.diagnostics["r1_monitor: node"].level == STALE
    count = len(robot.world.sent["/diagnostics"])
    robot.world.run(3.0)
    assert len(robot.world.sent["/diagnostics"]) == count


def test_a_node_that_fails_while_it_is_activated_stops_the_robot(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = Robot(package)
    monitor = robot.monitor(activate=False)
    monitor.change("configure")

    def fail(*_: object) -> None:
        raise RuntimeError("the middleware is gone")

    monkeypatch.setattr(monitor.node, "create_subscription", fail)
    assert monitor.change("activate") == [False]
    assert monitor.node.state == "unconfigured"
    assert not robot.stops or robot.stop
    monkeypatch.undo()
    assert monitor.change("configure", "activate") == [True, True]
    robot.world.run(1.0)
    assert robot.stop is False


# Parameters --------------------------------------------------------------------------------------


def test_a_threshold_cannot_be_set_and_what_can_be_has_bounds(package: Path) -> None:
    robot = Robot(package)
    fixed = ("-p", "tick:=9.0", "-p", "lateness:=9.0")
    node = robot.monitor("-p", "source_timeout:=2.5", *fixed).node
    assert node.parameters["source_timeout"] == 2.5
    assert node.parameters["tick"] == 0.1
    assert node.parameters["lateness"] == 0.0
    assert node.parameters["requirements"] == ["R1"]
    own = {name: each for name, each in node.descriptors.items() if name != "use_sim_time"}
    assert all(each.read_only for each in own.values())
    assert own["heartbeat"].floating_point_range[0].to_value == 10.0
    with pytest.raises(rclpy.InvalidParameterValueException):
        robot.monitor("-p", "heartbeat:=0.0")


def test_a_requirement_that_there_is_not_is_refused_with_a_reason(package: Path) -> None:
    robot = Robot(package)
    monitor = robot.monitor(activate=False)
    monitor.node.parameters["stop_for"] = ["R1", "R7"]
    assert monitor.change("configure") == [False]
    assert monitor.node.state == "unconfigured"
    assert monitor.node.log == [("error", "unknown requirement R7: there are R1")]


def test_the_parameters_decide(package: Path) -> None:
    robot = Robot(package)
    robot.monitor("-p", "source_timeout:=0.15", "-p", "heartbeat:=0.02")
    robot.world.run(2.0)
    before = len(robot.stops)
    robot.world.run(1.0)
    assert 45 <= len(robot.stops) - before <= 55
    robot.scans = False
    robot.world.run(0.3)
    assert robot.stop  # the age alone would allow 0.3 s


def test_topics_are_remapped(package: Path) -> None:
    robot = Robot(package)
    robot.interceptor("-r", "/cmd_vel_filtered:=/wheels", "-r", "/gwendolen_control:=/halt")
    robot.monitor("-r", "/gwendolen_control:=/halt", "-r", "__node:=other")
    robot.world.run(2.0)
    assert robot.world.sent["/cmd_vel_filtered"] == []
    assert robot.world.values("/wheels", "linear.x")[-1] == FORWARD
    assert robot.world.values("/halt")[-1] is False
    assert "other: R1" in robot.diagnostics


def test_its_own_test_of_the_node_passes_where_rclpy_is(package: Path) -> None:
    process = Robot(package).world.process()
    with process.importing(package):
        module = executed((package / "test/test_node.py").read_text(), "test_node")
        module.test_a_node_to_which_nothing_has_come_requests_a_stop()
    assert not process.is_running


# The process -------------------------------------------------------------------------------------


@pytest.fixture
def own_signals() -> Any:
    kept = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in kept.items():
        signal.signal(number, handler)


def started(robot: Robot, seconds: float, action: Any) -> tuple[int, Any]:
    """`main` in a process of the world, which is activated, and to which something happens."""
    process = robot.world.process()

    def activate() -> None:
        (node,) = process.nodes
        assert isinstance(node, rclpy.LifecycleNode)
        assert node.change("configure")
        assert node.change("activate")

    robot.world.after(10**8, None, activate)
    robot.world.after(round(seconds * 1e9), None, lambda: action(process))
    with process.importing(robot.package):
        node: Any = import_module(f"{robot.package.name}.node")
        node.FLUSH = 0.0
        status: int = import_module(f"{robot.package.name}.__main__").main()
    return status, process


@pytest.mark.usefixtures("own_signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_node_with_a_request_to_stop(package: Path, number: int) -> None:
    robot = Robot(package)
    status, process = started(robot, 2.0, lambda _: os.kill(os.getpid(), number))
    assert status == 0
    assert robot.stops[-2:] == [False, True]
    assert not process.is_running


@pytest.mark.slow
def test_without_ros_it_prints_what_it_needs(package: Path) -> None:
    ran = subprocess.run(
        [sys.executable, "-S", "-m", package.name],
        env={"PYTHONPATH": str(package)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 2
    assert ran.stderr.startswith("r1_monitor: it needs ROS 2 and its Python packages: No module")


LOADING = """
import sys
print("loading", flush=True)
sys.stdin.readline()
raise ImportError("of the test")
"""


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_ros_is_loaded_is_only_noted(
    package: Path, tmp_path: Path, number: int
) -> None:
    (tmp_path / "diagnostic_msgs.py").write_text(LOADING)  # the first that is imported
    pipes: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    words, path = (sys.executable, "-m", package.name), {"PYTHONPATH": f"{tmp_path}:{package}"}
    with subprocess.Popen(words, env=path, text=True, **pipes) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "loading\n"
        process.send_signal(number)
        said = process.communicate("\n")[1]
    assert process.returncode == 2
    assert said == "r1_monitor: it needs ROS 2 and its Python packages: of the test\n"


@pytest.mark.usefixtures("own_signals")
def test_an_end_from_outside_and_a_fault_have_statuses_of_their_own(
    package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = Robot(package)
    status, _ = started(robot, 2.0, lambda process: process.shutdown())
    assert status == 4
    assert capsys.readouterr().err == "r1_monitor: ROS has ended it: it was shut down\n"

    def fail(_: object) -> None:
        raise OSError("no buffer")

    robot = Robot(package)
    status, process = started(robot, 2.0, fail)
    assert status == 1
    assert capsys.readouterr().err == "r1_monitor: OSError: no buffer\n"
    assert robot.stops[-2:] == [False, True]
    assert not process.is_running
