"""The emitted package on real ROS 2: robot, monitor and interceptor are processes with Fast DDS.

What the node says while it runs, what `fretc watch dds` says beside it, and what `fretc audit`
says of the recording afterwards are one. `test_ros2_scenarios.py` shows it without lost messages.
"""

from __future__ import annotations

import itertools
import json
import random
import re
import signal
import subprocess
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from compiler.files.text_files import write as deliver
from tests.command import Fretc
from tests.effort import FULL, full_only
from tests.fretc.logs.logs import Sent
from tests.fretc.logs.logs import write as write_log
from tests.fretc.watch.watched import Watched
from tests.programs import needs_package
from tests.ros1 import until
from tests.ros2.emitted import write
from tests.ros2.real.network import NODE, PATIENCE, Network, Program, Robot, network, shared

ROOT = Path(__file__).parents[4]
NEAR, WALL = 0.05, 0.01
"""The clearance of R1, and the least that the robot has, m."""
EDGE = "upon too_close agilex_agent shall within 1 second satisfy stopped"

pytestmark = pytest.mark.slow


@pytest.fixture(params=["jazzy", pytest.param("kilted", marks=full_only("a second release"))])
def here(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Network]:
    with network(tmp_path, request.param) as place:
        yield place


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """That of R1, unchanged."""
    return write(ROOT / "requirements/r1.fret", tmp_path_factory.mktemp("ros2"))


def test_the_tests_of_the_package_pass_in_ros_2(here: Network, package: Path) -> None:
    words = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "ignore")
    files = [str(package / "test" / f"test_{name}.py") for name in ("node", "monitor")]
    run = here.start(*words, *files, package=package, stdout=subprocess.PIPE)
    said = run.communicate(timeout=PATIENCE)[0]
    assert run.returncode == 0, said
    assert "6 passed" in said
    assert "skipped" not in said


def by_stamps(folder: Path) -> None:
    """R1 and a requirement that can be violated, by the clock of the robot's stamps."""
    text = (ROOT / "requirements/bindings.toml").read_text()
    text = text.replace('time = "log_time"', 'time = "header.stamp"\nlateness = "2 s"', 1)
    for age in ("300 ms", "100 ms"):  # the robot may wait for the machine
        text = text.replace(f'max_age   = "{age}"', 'max_age = "2 s"')
        text = text.replace(f'max_age = "{age}"', 'max_age = "2 s"')
    files = {"bindings.toml": text, "r1.fret": (ROOT / "requirements/r1.fret").read_text()}
    assert deliver({folder / each: text for each, text in files.items()}) is None
    assert deliver({folder / "EDGE.fret": EDGE}) is None


def last(lines: Sequence[dict[str, Any]], id: str) -> dict[str, Any]:
    """What was said last of a requirement."""
    return [line for line in lines if line.get("requirement") == id][-1]


def triggers(lines: Sequence[dict[str, Any]], id: str) -> set[int]:
    """All that were told, in nanoseconds."""
    return {line["triggered_ns"] for line in lines if line.get("requirement") == id} - {None}


def breaks_edge(robot: Robot) -> None:
    """Its brakes fail until EDGE is violated; then it stands, and is put far from the wall."""
    robot.ask("away")
    robot.drives()
    robot.ask("stuck")
    robot.until("EDGE is broken", lambda s: last(s["lines"], "EDGE")["verdict"] == "violated")
    robot.ask("free")
    robot.stands()
    robot.ask("away")


@full_only("a mission in real time: on a busy machine the node may lose scans that others get")
@needs_package("cyclonedds")
def test_node_watch_and_audit_say_one_thing(here: Network, tmp_path: Path, fretc: Fretc) -> None:
    by_stamps(tmp_path / "r1")
    made = write(tmp_path / "r1", tmp_path / "made")
    robot, gate, node = here.robot(), here.interceptor(made), here.monitor(made)
    watch = Watched(
        here.of_fretc, tmp_path, "dds", "--requirements", "r1",
        "--record", "run.mcap", "--evidence", "live.json",
    )  # fmt: skip
    try:
        assert robot.change("configure", "activate") == [True, True]
        robot.until("all hear", lambda s: s["readers"] == [2, 2] and s["gates"] == [1, 1])
        robot.ask("go")
        robot.drives()
        robot.until("it is near", lambda state: state["clearance"] < NEAR)
        robot.ask("hear")
        robot.stands()
        state = robot.until(
            "a stop is requested", lambda s: True in s["stops"] and s["wheels"][-1:] == [0]
        )
        assert state["stops"][-1] is True

        breaks_edge(robot)
        robot.drives()
        robot.ask("rests")
        lines = robot.until(
            "R1 is satisfied",
            lambda s: (
                last(s["lines"], "R1")["verdict"] == "satisfied"
                and last(s["lines"], "R1")["obligation_pending"] is False
            ),
        )["lines"]
        until("the watch says so", lambda: watch.verdict("R1") == "satisfied", PATIENCE)
        assert (node.end(signal.SIGINT), gate.end(signal.SIGTERM)) == (0, 0)
        assert node.said == gate.said == ""
        assert robot.ask()["wheels"][-1] == 0
        assert watch.end() == 1
    finally:
        watch.close()

    ran = fretc("audit", "run.mcap", "--requirements", "r1", "-o", "audit.json")
    assert ran.status == 1, ran.err
    assert Path("audit.json").read_bytes() == Path("live.json").read_bytes()
    audit = {
        each["requirement"]: each for each in json.loads(Path("audit.json").read_text())["results"]
    }
    live = [line for line in watch.lines if line["type"] == "requirement"]
    for id, verdict in (("R1", "satisfied"), ("EDGE", "violated")):
        expected = {each["ns"] for each in audit[id]["triggers"]}
        assert audit[id]["verdict"] == last(lines, id)["verdict"] == verdict
        # Of two ticks judged at once the last is reported.
        assert triggers(lines, id) <= expected, id
        assert triggers(live, id) <= expected, id
    edges = {each["ns"] for each in audit["EDGE"]["triggers"]}
    assert triggers(lines, "EDGE") == triggers(live, "EDGE") == edges
    assert len(edges) >= 2  # more, if the robot came near again before it was told to rest
    broken = audit["EDGE"]["violations"][0]["start_ns"]
    assert last(lines, "EDGE")["violated_ns"] == last(live, "EDGE")["violated_ns"] == broken


@full_only("a mission by a simulated clock")
def test_by_a_simulated_clock_node_and_audit_say_one_thing(
    here: Network, tmp_path: Path, fretc: Fretc
) -> None:
    by_stamps(tmp_path / "r1")
    made = write(tmp_path / "r1", tmp_path / "made")
    robot, node = here.robot(), here.monitor(made, "--ros-args", "-p", "use_sim_time:=true")
    here.interceptor(made)
    robot.ask("simulate 4")
    assert robot.change("configure", "activate") == [True, True]
    robot.until("all hear", lambda s: s["readers"] == [1, 1] and s["gates"] == [1, 1])
    robot.ask("go")
    for _ in range(3):
        robot.ask("away")
        robot.drives()
        robot.stands()
    breaks_edge(robot)
    robot.ask("rests")
    sent = robot.ask("log")["log"]
    end = sent[-1][2]
    lines = robot.until(
        "all of the log is judged", lambda s: s["lines"] and s["lines"][-1]["time_ns"] > end
    )["lines"]

    messages = [Sent(topic, kind, bytes.fromhex(data), time) for topic, kind, time, data in sent]
    write_log(tmp_path / "run.mcap", messages)
    ran = fretc("audit", "run.mcap", "--requirements", "r1", "-o", "audit.json")
    assert ran.status == 1, ran.err
    results = json.loads(Path("audit.json").read_text())["results"]
    assert {each["requirement"] for each in results} == {"R1", "EDGE"}
    for each in results:
        id = each["requirement"]
        expected = {trigger["ns"] for trigger in each["triggers"]}
        assert len(expected) >= 4
        assert {time for time in triggers(lines, id) if time <= end} <= expected
        if id == "EDGE":
            assert triggers(lines, id) == expected
            assert last(lines, id)["violated_ns"] == each["violations"][0]["start_ns"]

    robot.ask("back")
    robot.until("a run begins", lambda s: s["lines"][-1]["time_ns"] < end - 50 * 10**9)
    robot.ask("plans")
    robot.drives()
    robot.until("it is judged", lambda s: last(s["lines"], "EDGE")["verdict"] != "no data")
    assert last(robot.ask()["lines"], "EDGE")["verdict"] != "violated"
    assert node.end(signal.SIGINT) == 0
    assert node.said == ""


# How nodes begin and end -------------------------------------------------------------------------


class Driving:
    """A robot that drives, with the nodes of R1; each can be ended, and is started again."""

    def __init__(self, here: Network, package: Path) -> None:
        self._here, self._package, self.release = here, package, here.release
        self.robot = here.robot()
        self.gate, self.node = here.interceptor(package), here.monitor(package)
        self.robot.ask("go")
        self.activate()

    def activate(self) -> None:
        """Let the node lead, and the robot drive."""
        assert self.robot.change("configure", "activate") == [True, True]
        self.robot.goes_on()

    def restart(self, program: Program) -> float:
        """Start one again, when it is known that it has ended; the first that the wheels get."""
        robot = self.robot
        if program is self.node:
            robot.until("it is gone", lambda s: s["monitors"] == s["managed"] == 0)
            robot.ask("hear")
            self.node = self._here.monitor(self._package)
            assert robot.change("configure", "activate") == [True, True]
        else:
            robot.until("it is gone", lambda state: state["gates"] == [0, 0])
            robot.ask("hear")
            self.gate = self._here.interceptor(self._package)
        first: float = robot.until("it acts", lambda state: state["wheels"])["wheels"][0]
        return first


@pytest.fixture
def driving(here: Network, package: Path) -> Driving:
    return Driving(here, package)


@full_only("each of many starts takes a second")
def test_a_signal_while_real_ros_is_loaded_ends_a_node_without_a_word(
    here: Network, package: Path
) -> None:
    drawn = random.Random(2)
    for start, number in itertools.product(
        (here.monitor, here.interceptor) * 10, (signal.SIGINT, signal.SIGTERM)
    ):
        program = start(package)
        until("it hears signals", lambda: program.hears_signals, PATIENCE)  # noqa: B023
        time.sleep(drawn.uniform(0.0, 0.8))
        assert program.end(number) == 0, program.said
        assert program.said == ""


def test_only_an_active_node_lets_the_robot_go(driving: Driving) -> None:
    robot, node = driving.robot, driving.node
    robot.ask("hear")
    assert robot.change("deactivate") == [True]
    robot.stands()
    stops = robot.until("a stop comes", lambda state: True in state["stops"])["stops"]
    assert stops[-1] is True
    if driving.release == "jazzy":  # its state does not have that, and rclpy does not answer
        robot.ask(f"try {NODE} deactivate")
        until("it is refused", lambda: "a transition was refused" in node.said, PATIENCE)
    else:
        assert robot.change("deactivate") == [False]
    assert robot.change("cleanup") == [True]
    assert robot.ask()["speed"] == 0
    driving.activate()
    robot.ask("hear")
    assert robot.change("active_shutdown") == [True]
    robot.stands()
    assert robot.until("a stop comes", lambda state: state["stops"])["stops"][-1] is True
    assert node.end(signal.SIGTERM) == 0


def test_what_cannot_be_trusted_or_heard_stops_the_robot_and_is_told(driving: Driving) -> None:
    robot, gate = driving.robot, driving.gate
    robot.ask("second")
    robot.stands()
    crowd = "interceptor.py: /gwendolen_control has several publishers: the robot stands until"
    until("it is told", lambda: crowd in gate.said, PATIENCE)
    robot.ask("alone")
    driving.robot.goes_on()
    robot.ask("lossy")  # a planner as best effort, and a reliable subscription
    robot.stands()
    told = "topic '/cmd_vel', offering incompatible QoS."
    until("it is told", lambda: told in gate.said, PATIENCE)
    robot.ask("reliable")
    driving.robot.goes_on()
    robot.ask("rests")
    robot.stands()


FOREIGN = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("foreign")
publisher = node.create_publisher(String, "/gwendolen_control", 10)
rclpy.spin(node)
"""


@full_only("neighbours that are rare")
def test_in_a_domain_of_200_topics_a_node_restarts_and_a_wrong_type_stops_the_robot(
    here: Network, driving: Driving
) -> None:
    robot, gate = driving.robot, driving.gate
    robot.ask("crowd")
    assert driving.node.end(signal.SIGINT) == 0
    assert driving.restart(driving.node) == 0
    driving.robot.goes_on()
    foreign = here.start("-c", FOREIGN, stderr=subprocess.DEVNULL)
    robot.stands()
    crowd = "interceptor.py: /gwendolen_control has several publishers: the robot stands until"
    until("it is told", lambda: crowd in gate.said, PATIENCE)
    here.end(foreign, signal.SIGKILL)
    driving.robot.goes_on()


SEGMENT = re.compile(r"(fastrtps|fastdds)_[0-9a-f]{16}")
"""Shared memory of one process; ports are shared by several."""
ENDS = (
    ("node", signal.SIGINT),
    ("gate", signal.SIGTERM),
    ("node", signal.SIGKILL),
    ("gate", signal.SIGKILL),
    ("node", signal.SIGTERM),
    ("gate", signal.SIGINT),
)


def moments(count: int) -> list[tuple[str, signal.Signals, float]]:
    """Which program gets which signal, and how many seconds after the robot has begun to drive."""
    drawn = random.Random(1)
    ends = [ENDS[i % len(ENDS)] for i in range(count)]
    return [(*end, drawn.uniform(0.0, 1.5)) for end in ends]


def test_whenever_a_node_is_ended_the_last_that_the_wheels_get_is_zero(driving: Driving) -> None:
    """The interceptor gives it where the monitor is killed; of the killed one, the next.

    An interceptor that was asked to end has left a robot that stands: the next may let it go.
    """
    robot = driving.robot
    chosen = moments(60 if FULL else 3)
    for place, (name, number, moment) in enumerate(chosen, 1):
        program: Program = getattr(driving, name)
        time.sleep(moment)
        robot.ask("away")
        robot.ask("hear")
        segments = [
            each
            for each in shared(program.process)
            if SEGMENT.fullmatch(each.name) and each.exists()  # not of one that has ended before
        ]
        status = program.end(number)
        killed = number == signal.SIGKILL
        assert status == (-number if killed else 0), program.said
        assert killed or program.said == ""
        assert killed or not all(each.exists() for each in segments), "its own is left behind"
        if name == "node" or not killed:
            robot.stands()
            robot.until("the wheels have heard zero", lambda s: s["wheels"][-1:] == [0])
            assert robot.ask()["wheels"][-1] == 0
            if name == "node" and not killed:
                robot.until("its last is a stop", lambda s: s["stops"][-1:] == [True])
        if place == len(chosen):
            break
        if killed and name == "gate":
            # The robot drives on into the wall, and the monitor requests a stop.
            robot.until(
                "a stop is requested",
                lambda s: s["clearance"] == WALL and s["stops"][-1:] == [True],
            )
        first = driving.restart(program)
        assert first == 0 or (name == "gate" and not killed)
        driving.robot.goes_on()
