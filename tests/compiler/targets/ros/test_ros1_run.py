"""The paper's architecture on its middleware: robot, monitor and interceptor are ROS 1 processes.

What the node says while it runs, what `fretc watch ros1` says beside it, and what `fretc audit`
says of the bag afterwards are one.
"""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xmlrpc.client import ServerProxy

import pytest
import tomli_w

from compiler.files.text_files import write as deliver
from tests.command import Fretc
from tests.fretc.watch.watched import Watched
from tests.programs import DEBIANS_PATH, DEBIANS_PYTHON, installed
from tests.ros1 import Ended, Ros, ended, ros, ros1_or_skip, until
from tests.ros2.emitted import OWNER

FAR, NEAR, WALL = 0.8, 0.4, 0.03
"""Clearances of the robot, m: where it is put, where it must stop, where it can go no further."""
BINDINGS = """
[clock]
time = "header.stamp"
tick = "50 ms"
phase = "10 ms"
lateness = "1 s"
[signal.clearance]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
reduce = "min"
valid = "range_min <= x and x <= range_max"
invalid = { nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }
max_age = "600 ms"
[signal.speed]
path = "/odom.twist.twist.linear.x"
type = "nav_msgs/Odometry"
max_age = "600 ms"
[signal.word]
path = "/stop.data"
type = "std_msgs/Bool"
max_age = "700 ms"
[proposition.near]
expr = "clearance < 0.4"
[proposition.stands]
expr = "speed < 0.01"
[proposition.scanned]
expr = "clearance > 0"
[proposition.guarded]
expr = "word = 0 or word = 1"
on_unknown = false
[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
period = "20 ms"
stop_timeout = "400 ms"
ros = 1
"""
FOLDERS = {
    "halt": {
        "HALT": "whenever near the robot shall within 500 milliseconds satisfy stands",
        "EDGE": "upon near the robot shall within 1 second satisfy stands",
    },
    "alive": {"ALIVE": "whenever scanned the robot shall immediately satisfy guarded"},
}
TOPICS = ("/scan", "/odom", "/stop", "/halt_monitor/verdicts")

pytestmark = pytest.mark.slow


@pytest.fixture
def here(tmp_path: Path) -> Iterator[Ros]:
    ros1_or_skip()
    with ros(tmp_path) as place:
        yield place


class Robot:
    """It answers each word by its clearance and its speed."""

    def __init__(self, here: Ros) -> None:
        script = Path(__file__).with_name("ros1_robot.py")
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        self._process = here.start(DEBIANS_PYTHON, str(script), **pipes)

    def ask(self, what: str = "how") -> tuple[float, float, int]:
        """What it is reported; its clearance, its speed, and the count of its scans."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(what, file=self._process.stdin, flush=True)
        clearance, speed, count = json.loads(self._process.stdout.readline())
        return clearance, speed, count

    def stands(self) -> bool:
        return self.ask()[1] == 0.0

    def drives(self) -> bool:
        return self.ask()[1] > 0.0

    def goes_to_the_wall(self) -> None:
        """From far away, until it stands before it."""
        self.ask("away")
        until("it drives", self.drives)
        until("it is near", lambda: self.ask()[0] < NEAR)
        until("it stands", self.stands)


def package(fretc: Fretc, folder: Path) -> Path:
    """The requirements, and the package of those of `halt`."""
    for name, sentences in FOLDERS.items():
        texts = {f"{id}.fret": sentence for id, sentence in sentences.items()}
        for file, text in {"bindings.toml": BINDINGS, **texts}.items():
            assert deliver({folder / name / file: text}) is None
    settings = tomli_w.dumps({"project": asdict(OWNER)})
    assert deliver({folder / "fretc.toml": settings}) is None
    made = fretc("halt", "--emit", "ros1-package", "-o", ".")
    assert made.status == 0, made.err
    return folder / "halt_monitor"


def audited(fretc: Fretc, name: str) -> dict[str, dict[str, Any]]:
    """The results of an audit of the bag by each requirement of a folder."""
    ran = fretc("audit", "run.bag", "--requirements", name, "-o", f"{name}.json")
    assert ran.status == 1, ran.err
    results = json.loads(Path(f"{name}.json").read_text())["results"]
    return {each["requirement"]: each for each in results}


_LINES = """
import json, sys
import rosbag
bag = rosbag.Bag(sys.argv[1])
print(json.dumps([json.loads(said.data) for _, said, _ in bag.read_messages(sys.argv[2])]))
"""


def said_by_node(bag: Path) -> list[dict[str, Any]]:
    """The lines that it has published."""
    ran = subprocess.run(
        [DEBIANS_PYTHON, "-c", _LINES, bag, "/halt_monitor/verdicts"],
        env={"PATH": DEBIANS_PATH},
        capture_output=True,
        check=True,
    )
    found: list[dict[str, Any]] = json.loads(ran.stdout)
    return found


def heard_by(here: Ros, name: str, topics: Sequence[str]) -> bool:
    """Whether the master knows that this node hears all of the topics."""
    state = here.state()
    return bool(state) and all(
        any(each.startswith(name) for each in state[1].get(topic, ())) for topic in topics
    )


def triggers(lines: Sequence[dict[str, Any]], id: str) -> set[int]:
    """All that were told, in nanoseconds."""
    return {line["triggered_ns"] for line in lines if line["requirement"] == id} - {None}


def violated(lines: Sequence[dict[str, Any]], id: str) -> int | None:
    """When it was for the first time, as told last."""
    time: int | None = [line for line in lines if line["requirement"] == id][-1]["violated_ns"]
    return time


def test_node_watch_and_audit_say_one_thing(here: Ros, tmp_path: Path, fretc: Fretc) -> None:
    made = package(fretc, tmp_path)
    here.environment = {**here.environment, "PYTHONPATH": str(made / "src")}
    here.master()
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    bag = tmp_path / "run.bag"
    record = here.start(installed("rosbag"), "record", "-O", str(bag), *TOPICS, **quiet)
    interceptor = here.node(made / "scripts/interceptor.py")
    node = here.node(made / "scripts/monitor_node.py")
    watch = Watched(here.environment, tmp_path, "ros1", "--requirements", "halt")
    try:
        hearers = {"/record": TOPICS, "/halt_monitor": TOPICS[:2], "/fretc": TOPICS[:2]}
        until("all hear", lambda: all(heard_by(here, n, t) for n, t in hearers.items()), 30)
        robot = Robot(here)
        robot.ask("go 3")

        robot.goes_to_the_wall()
        assert robot.ask()[0] > WALL
        robot.goes_to_the_wall()
        robot.ask("away")
        until("it drives", robot.drives)
        robot.ask("stuck")
        until("the watch sees it", lambda: watch.verdict("EDGE") == "violated", 30)
        robot.ask("free")
        until("it stands", robot.stands)

        robot.ask("away")
        until("it drives again", robot.drives)
        node.kill()  # nobody says anything any more
        until("it stands without a monitor", robot.stands)
        clearance, _, count = robot.ask()
        assert clearance > NEAR
        until("some time has passed", lambda: robot.ask()[2] > count + 40)
        assert robot.stands()

        node = here.node(made / "scripts/monitor_node.py")
        until("it drives with another monitor", robot.drives)
        assert ended(node, signal.SIGINT) == Ended(0, "")
        until("it stands at the end of the monitor", robot.stands)
        assert ended(interceptor, signal.SIGTERM) == Ended(0, "")
        assert watch.end() == 1
    finally:
        watch.close()
    record.send_signal(signal.SIGINT)
    record.wait(20)
    until("the bag has its name", bag.exists)  # `rosbag` ends before what it has started

    audit, alive = audited(fretc, "halt"), audited(fretc, "alive")["ALIVE"]
    edges = {each["ns"] for each in audit["EDGE"]["triggers"]}
    assert len(edges) == 3
    first = next(each for each in alive["violations"] if each["start_ns"] > max(edges))
    lost = first["start_ns"]  # the word of the monitor has been too old from then on
    said = [line for line in said_by_node(bag) if line["time_ns"] < lost]
    live = [line for line in watch.lines if line["type"] == "requirement"]
    for id in FOLDERS["halt"]:
        expected = {each["ns"] for each in audit[id]["triggers"]}
        # Of two ticks judged at once the last is reported.
        assert triggers(said, id) <= expected, id
        assert triggers(live, id) <= expected, id
        broken = audit[id]["violations"][0]["start_ns"]
        assert violated(said, id) == violated(live, id) == broken, id
    assert triggers(said, "EDGE") == triggers(live, "EDGE") == edges
    assert first["missing"] == "guarded"


def test_what_can_go_wrong_around_the_node_stops_the_robot(
    here: Ros, tmp_path: Path, fretc: Fretc
) -> None:
    made = package(fretc, tmp_path)
    here.environment = {**here.environment, "PYTHONPATH": str(made / "src")}
    program = made / "scripts/monitor_node.py"
    here.master()
    with ServerProxy(here.uri) as master:
        master.setParam("/test", "/halt_monitor/source_timeout", -1.0)
        said = "monitor_node.py: ValueError: source_timeout is from 0 to 3600 s, not -1.0\n"
        assert ended(here.node(program)) == Ended(1, said)
        master.setParam("/test", "/halt_monitor/source_timeout", 5)
        master.setParam("/test", "/halt_monitor/stop_for", ["OTHER"])
        said = "monitor_node.py: ValueError: unknown requirement OTHER: there are EDGE, HALT\n"
        assert ended(here.node(program)) == Ended(1, said)
        master.deleteParam("/test", "/halt_monitor/stop_for")
        master.setParam("/test", "/use_sim_time", True)

    here.node(made / "scripts/interceptor.py")
    first = here.node(program)
    until("it hears", lambda: heard_by(here, "/halt_monitor", TOPICS[:2]), 30)
    robot = Robot(here)
    robot.ask("go 1")
    until("scans come", lambda: robot.ask()[2] > 40)
    assert robot.ask()[:2] == (FAR, 0.0)  # time has not begun
    robot.ask("clock 1000")
    until("it drives", robot.drives)
    robot.ask("blind")
    until("it stands, for all beams are NaN", robot.stands)
    robot.ask("sees")
    robot.ask("away")
    until("it drives", robot.drives)
    second = here.node(program)
    found = ended(first)
    assert found.status == 4
    assert found.said.endswith("new node registered with same name]\n")
    robot.ask("away")
    until("it drives with the second node", robot.drives)
    robot.ask("clock 900")  # another run begins
    robot.ask("away")
    until("it is near", lambda: robot.ask()[0] < NEAR)
    until("it stands", robot.stands)
    assert robot.ask()[0] > WALL
    assert ended(second, signal.SIGTERM) == Ended(0, "")
