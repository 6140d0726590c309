"""`fretc watch ros1` on real ROS 1: what it says is what an audit of its recording says."""

import json
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from threading import Thread
from typing import IO, Any
from xmlrpc.client import ServerProxy

import pytest

from fretc.watch.sources.ros1 import Ros1
from fretc.watch.sources.source import ConnectionLost, Opened, Problem, Reconnected
from fretish.diagnostics.diagnostic import Code
from monitors.stop_supervisor import ERROR, OK
from tests.command import Fretc
from tests.effort import full_only
from tests.fretc.watch.watched import Watched
from tests.programs import DEBIANS_PYTHON, debians_python
from tests.ros1 import Ros, ros, ros1_or_skip, until

BINDINGS = """
[clock]
tick = "50 ms"
time = "log_time"
[signal.told]
path = "/stop.data"
type = "std_msgs/Bool"
[signal.vx]
path = "/cmd_vel.linear.x"
type = "geometry_msgs/Twist"
max_age = "5 s"
[proposition.stop]
expr = "told == 1"
[proposition.moving]
expr = "vx > 0.1"
"""
SENTENCES = {
    "HALT": "whenever stop the robot shall within 2 ticks satisfy !moving",
    "GO": "the robot shall eventually satisfy moving",
}

pytestmark = pytest.mark.slow


@pytest.fixture
def here(tmp_path: Path) -> Iterator[Ros]:
    ros1_or_skip()
    with ros(tmp_path) as place:
        yield place


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "requirements"
    folder.mkdir()
    for name, sentence in SENTENCES.items():
        (folder / f"{name}.fret").write_text(sentence)
    (folder / "bindings.toml").write_text(BINDINGS)
    return folder


def test_verdicts_of_a_running_robot_are_those_of_the_audit_of_the_recording(
    here: Ros, folder: Path, fretc: Fretc, tmp_path: Path
) -> None:
    """And other nodes read them as diagnostics, with the levels of emitted nodes."""
    debians_python("diagnostic_msgs.msg")
    here.master()
    robot = here.world("robot")
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    reader = here.start(DEBIANS_PYTHON, "-c", _READER, **pipes)
    assert reader.stdout is not None
    run = Watched(
        here.environment, tmp_path, "ros1", "--requirements", "requirements",
        "--record", "run.mcap", "--evidence", "live.json", "--publish", "diagnostics",
    )  # fmt: skip
    try:
        until("it moves", lambda: run.verdict("GO") == "satisfied", 30)
        assert run.verdict("HALT") != "violated"
        _until_level(reader.stdout, "GO", OK)
        robot.ask(True)
        until("it goes on in spite of a stop", lambda: run.verdict("HALT") == "violated", 30)
        stamp, found = _until_level(reader.stdout, "HALT", ERROR)
        assert stamp > 0
        assert found["HALT"][1]["verdict"] == "violated"
        assert int(found["sources"][1]["messages of /stop"]) > 0
        here.world("second", drives=True, stop=None)
        until("two publishers are reported", lambda: Code.SEVERAL_PUBLISHERS.number in run.codes())
        assert run.end() == 1
    finally:
        run.close()
    again = fretc("audit", "run.mcap", "--requirements", "requirements", "-o", "audit.json")
    assert again.status == 1, again.err
    assert (tmp_path / "audit.json").read_bytes() == (tmp_path / "live.json").read_bytes()
    assert run.verdicts() == {"GO": "satisfied", "HALT": "violated"}


_READER = """
import json, sys
import rospy
from diagnostic_msgs.msg import DiagnosticArray

def take(message):
    of = [(s.level, s.name, {v.key: v.value for v in s.values}) for s in message.status]
    print(json.dumps([message.header.stamp.to_nsec(), of]), flush=True)

rospy.init_node("reader", disable_signals=True)
rospy.Subscriber("/diagnostics", DiagnosticArray, take)
sys.stdin.read()
"""


def _until_level(stream: IO[str], name: str, level: int) -> tuple[int, dict[str, Any]]:
    """The first message in which a status has this level."""
    for line in stream:
        stamp, statuses = json.loads(line)
        found = {
            text.removeprefix("fretc watch: "): (its, values) for its, text, values in statuses
        }
        if found[name][0] == level:
            return stamp, found
    raise AssertionError("the reader has ended")


def test_a_master_that_is_silent_or_gone_is_sought_again(
    here: Ros, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It says besides that the clock is a simulated one."""
    for name, value in here.environment.items():
        monkeypatch.setenv(name, value)
    master = here.master()
    with ServerProxy(here.uri) as known:
        known.setParam("/test", "/use_sim_time", True)
    source = Ros1()
    found: list[object] = []
    thread = Thread(target=lambda: found.extend(source.arrivals(["/stop"])), daemon=True)
    thread.start()

    def has(kind: type, count: int = 1) -> bool:
        return sum(isinstance(item, kind) for item in tuple(found)) == count

    try:
        until("it is opened", lambda: has(Opened))
        master.send_signal(signal.SIGSTOP)
        until("it is interrupted", lambda: has(ConnectionLost), 30)
        master.send_signal(signal.SIGCONT)
        until("it is connected again", lambda: has(Reconnected), 30)
        master.terminate()
        until("it is interrupted again", lambda: has(ConnectionLost, 2), 30)
        master.wait(10)
        here.master()
        until("it is connected once more", lambda: has(Reconnected, 2), 30)
    finally:
        source.close()
        thread.join(10)
    assert not thread.is_alive()
    gaps = [item for item in found if isinstance(item, Reconnected)]
    losses = [item for item in found if isinstance(item, ConnectionLost)]
    for before, gap in zip(losses, gaps, strict=True):
        assert before.since == gap.since < gap.until
        assert before.problem.code == Code.ROBOT_NOT_REACHED
    problems = [item.diagnostic.code for item in found if isinstance(item, Problem)]
    assert Code.SIMULATED_TIME in problems


def test_without_a_master_there_is_one_error(here: Ros, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in here.environment.items():
        monkeypatch.setenv(name, value)
    (problem,) = [each for each in Ros1().arrivals(["/x"]) if isinstance(each, Problem)]
    assert problem.diagnostic.is_error
    assert problem.diagnostic.code == Code.ROBOT_NOT_REACHED
    assert here.uri.rstrip("/") in problem.diagnostic.message


def test_without_rospy_the_package_is_named(tmp_path: Path) -> None:
    source = Ros1(str(tmp_path / "python"))
    (absent,) = [each for each in source.arrivals(["/x"]) if isinstance(each, Problem)]
    assert absent.diagnostic.code == Code.MISSING_EXTRA
    assert str(tmp_path / "python") in absent.diagnostic.message


@full_only("each by itself is reported by default")
def test_another_type_than_bound_and_a_simulated_clock_are_told_of(
    here: Ros, folder: Path, tmp_path: Path
) -> None:
    bindings = (folder / "bindings.toml").read_text()
    other = bindings.replace("geometry_msgs/Twist", "geometry_msgs/Vector3")
    (folder / "bindings.toml").write_text(other)
    here.master()
    with ServerProxy(here.uri) as master:
        master.setParam("/test", "/use_sim_time", True)
    here.world("robot")
    run = Watched(here.environment, tmp_path, "ros1", "--requirements", "requirements")
    expected = {Code.WRONG_TYPE.number, Code.SIMULATED_TIME.number}
    try:
        until("both are reported", lambda: expected <= run.codes(), 30)
        assert run.verdict("GO") != "satisfied"
    finally:
        run.close()
