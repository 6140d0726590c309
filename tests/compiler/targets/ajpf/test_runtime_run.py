"""The agent in MCAPL against the endpoint: what it publishes, and that it stops when in doubt."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, Queue
from typing import Any

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.ajpf import runtime_runner
from fretc.rosbridge.endpoint import Endpoint
from fretc.rosbridge.session import NO_SERVICES, Service
from tests.compiler.targets.ajpf.test_runtime import compiled, made, texts, write
from tests.programs import installed, mcapl, needs

WAIT = 30.0
STOP, TRACE = "/gwendolen_control", "/agent/trace"


def scan(distance: float) -> dict[str, Any]:
    """A scan with one beam ahead of the robot, whose outline ends at 0.306 m."""
    ranges = array("f", [math.inf] * 101)
    ranges[50] = distance
    return {
        "header": {"stamp": _stamp()},
        "angle_min": -0.5,
        "angle_increment": 0.01,
        "range_min": 0.05,
        "range_max": 30.0,
        "ranges": ranges,
    }


class Robot:
    """The endpoint and the agent; the robot sends scans."""

    def __init__(
        self,
        folder: Path,
        subject: FormalizedRequirement,
        services: Mapping[str, Service] = NO_SERVICES,
        arguments: Sequence[str] = (),
    ) -> None:
        self.stops: list[bool] = []
        self.traces: Queue[dict[str, Any]] = Queue()
        self.errors = (folder / "errors.txt").open("w+")
        self.endpoint = Endpoint(
            {"/scan": "sensor_msgs/LaserScan"}, self._receive, services=services
        )
        bundle = write(folder / "r1_agent", texts(subject))
        self.process = subprocess.Popen(
            [sys.executable, str(bundle / "run.py"), "--url", self.endpoint.url]
            + ["--trace", TRACE, *arguments],
            env={**os.environ, "AJPF_HOME": mcapl()},
            stdout=subprocess.DEVNULL,
            stderr=self.errors,
        )

    def _receive(self, topic: str, kind: str, message: Any) -> None:
        if topic == STOP:
            assert kind == "std_msgs/Bool"
            self.stops.append(message["data"])
        elif topic == TRACE:
            self.traces.put(json.loads(message["data"]))

    def drive(self, distance: float, until: Callable[[], bool]) -> None:
        """Send scans until a condition holds."""
        end = time.monotonic() + WAIT
        while not until():
            assert time.monotonic() < end, self.stops[-5:]
            assert self.process.poll() is None
            self.endpoint.publish("/scan", scan(distance))
            time.sleep(0.02)

    def wait(self, until: Callable[[], bool]) -> None:
        end = time.monotonic() + WAIT
        while not until():
            assert time.monotonic() < end, self.stops[-5:]
            time.sleep(0.01)

    def last(self, value: bool) -> Callable[[], bool]:
        return lambda: bool(self.stops) and self.stops[-1] is value

    def actions(self) -> list[str]:
        found: list[str] = []
        while True:
            try:
                record = self.traces.get_nowait()
            except Empty:
                return found
            if record["action"] is not None:
                found.append(record["action"])

    def record(self) -> dict[str, Any]:
        return self.traces.get(timeout=WAIT)

    def close(self) -> None:
        self.process.send_signal(signal.SIGCONT)
        self.process.terminate()
        self.process.wait(WAIT)
        self.endpoint.close()
        self.errors.close()


def _stamp() -> dict[str, int]:
    now = time.time_ns()
    return {"sec": now // 10**9, "nanosec": now % 10**9}


@contextmanager
def robot(
    folder: Path,
    subject: FormalizedRequirement | None = None,
    services: Mapping[str, Service] = NO_SERVICES,
    arguments: Sequence[str] = (),
) -> Iterator[Robot]:
    running = Robot(folder, subject or made(), services, arguments)
    try:
        yield running
    finally:
        running.close()


@needs("java", "javac")
@pytest.mark.slow
def test_the_agent_stops_for_an_obstacle_and_releases_the_robot(tmp_path: Path) -> None:
    with robot(tmp_path) as subject:
        subject.drive(5.0, subject.last(False))
        subject.actions()
        subject.drive(0.31, subject.last(True))
        subject.drive(5.0, subject.last(False))
        records = [subject.record(), subject.record()]
        while records[0]["action"] != "stop_moving":  # what was told of the beginning
            records = [records[1], subject.record()]
        while records[1]["action"] is None:
            records = [records[0], subject.record()]
        assert [(record["action"], record["beliefs"]) for record in records] == [
            ("stop_moving", ["too_close"]),
            ("undo_stopped", ["stopped"]),
        ]


DOUBTS: tuple[dict[str, Any] | None, ...] = (
    None,  # silence
    {"ranges": 3},
    {**scan(5.0), "ranges": array("f")},
    {**scan(5.0), "header": {"stamp": 3}},
)


@needs("java", "javac")
@pytest.mark.slow
def test_in_doubt_the_robot_is_stopped(tmp_path: Path) -> None:
    with robot(tmp_path) as subject:
        for message in DOUBTS:
            subject.drive(5.0, subject.last(False))
            if message is not None:
                subject.endpoint.publish("/scan", message)
            subject.wait(subject.last(True))


TWO = """
[clock]
tick = "100 ms"
[signal.a]
path = "/a.data"
type = "std_msgs/Float64"
unit = "1"
[signal.b]
path = "/b.data"
type = "std_msgs/Float64"
unit = "1"
[proposition.near]
expr = "a > 1"
[proposition.allowed]
expr = "b > 1"
[proposition.stopped]
expr = "a > 5"
[interceptor]
stop = "/gwendolen_control"
command = "/c"
output = "/o"
period = "50 ms"
[action.do_stopped]
topic = "/gwendolen_control"
type = "std_msgs/Bool"
message = { data = true }
"""


@needs("java", "javac")
@pytest.mark.slow
def test_an_unknown_percept_stops_the_robot_even_if_no_plan_does(tmp_path: Path) -> None:
    sentence = "whenever near & !allowed the sw shall eventually satisfy stopped"
    with robot(tmp_path, made(TWO, sentence)) as subject:
        subject.wait(lambda: subject.endpoint.subscribers("/a") == 1)
        subject.endpoint.publish("/a", {"data": 0.5})
        subject.wait(lambda: len(subject.stops) > 10)
        assert subject.actions() == []
        assert set(subject.stops) == {True}
        subject.endpoint.publish("/b", {"data": 0.5})
        subject.wait(subject.last(False))


GRIPPER = (
    TWO.replace(
        "[interceptor]",
        """[proposition.closed]
expr = "b > 5"
[interceptor]""",
    )
    + """
[call.do_closed]
service = "/gripper/close"
type = "std_srvs/srv/SetBool"
request = { data = true }
limit = "300 ms"
"""
)


def refusing(request: Mapping[str, Any]) -> Mapping[str, Any]:
    raise ValueError("the gripper is stuck")


ANSWERS: dict[str, tuple[Service, str]] = {
    "done": (lambda request: {"success": True}, ""),
    "not done": (lambda request: {"success": False, "message": "stuck"}, "the service refuses"),
    "refused": (refusing, "the service refuses: the gripper is stuck"),
    "silent": (lambda request: None, "there is no answer"),
}


@needs("java", "javac")
@pytest.mark.slow
@pytest.mark.parametrize("answer", ANSWERS)
def test_an_action_calls_a_service_and_a_failure_is_a_stop(tmp_path: Path, answer: str) -> None:
    """The call comes first: without it, the agent neither believes `closed` nor does the rest."""
    service, why = ANSWERS[answer]
    requests: list[Any] = []

    def perform(request: Mapping[str, Any]) -> Mapping[str, Any] | None:
        requests.append(request)
        return service(request)

    sentence = "whenever near the sw shall eventually satisfy closed & stopped"
    with robot(tmp_path, made(GRIPPER, sentence), {"/gripper/close": perform}) as subject:
        subject.wait(lambda: subject.endpoint.subscribers("/a") == 1)
        subject.endpoint.publish("/a", {"data": 0.5})
        subject.wait(subject.last(False))
        subject.endpoint.publish("/a", {"data": 2.0})
        subject.wait(subject.last(True))
        record = subject.record()
        while record["action"] is None:
            record = subject.record()
        assert (record["action"], record.get("failed", False)) == ("do_closed", bool(why))
        assert requests == [{"data": True}]
        if why:
            count = len(subject.stops)
            subject.wait(lambda: len(subject.stops) > count + 5)
            assert {*subject.stops[count:]} == {True}
            assert subject.actions() == []
        else:
            while record["beliefs"] != ["closed", "near", "stopped"]:
                record = subject.record()
    said = (tmp_path / "errors.txt").read_text()
    assert (f"do_closed has failed: {why}" in said) is bool(why)


LATCH = """
package r1_agent;
import ail.util.AILConfig;
import java.util.*;
public final class Latch {
    /** Each argument: the distances of scans, of which the agent then perceives. */
    public static void main(String[] args) throws Exception {
        Environment environment = new Environment();
        environment.configure(new AILConfig());
        for (String each : args) {
            for (String distance : each.split(" ")) {
                if (!distance.isEmpty()) {
                    environment.message("/scan", scan(Float.parseFloat(distance)));
                }
            }
            System.out.println(environment.getPercepts("agilex_agent", true));
        }
    }
    private static Map<String, Object> scan(Float distance) {
        Map<String, Object> scan = new HashMap<>();
        scan.put("ranges", Arrays.asList(distance));
        scan.put("angle_min", 0.0);
        scan.put("angle_increment", 0.1);
        scan.put("range_min", 0.05);
        scan.put("range_max", 30.0);
        return scan;
    }
    private Latch() {}
}
"""


OWN = """\
GWENDOLEN
:name: agilex_agent

:Initial Beliefs:

:Initial Goals:

:Plans:
+too_close : {True} <- print("too near; I stop"), stop_moving, +halted;
"""


@needs("java", "javac")
@pytest.mark.slow
def test_an_agent_that_was_written_by_hand_runs(tmp_path: Path) -> None:
    """It never releases the robot, unlike the emitted one."""
    (tmp_path / "own.gwen").write_text(OWN)
    with robot(tmp_path, arguments=["--agent", str(tmp_path / "own.gwen")]) as subject:
        subject.drive(5.0, subject.last(False))
        subject.drive(0.31, subject.last(True))
        record = subject.record()
        while record["beliefs"] != ["halted", "too_close"]:
            record = subject.record()
        subject.stops.clear()
        subject.drive(5.0, lambda: len(subject.stops) > 5)
        assert {*subject.stops} == {True}
        while record["beliefs"] != ["halted"]:
            record = subject.record()


@needs("java", "javac")
@pytest.mark.slow
def test_what_comes_and_goes_between_two_perceptions_is_perceived(tmp_path: Path) -> None:
    classes = runtime_runner.class_path(Path(mcapl()))
    folder = write(tmp_path, {**texts(made()), "Latch.java": LATCH})
    files = (file.name for file in folder.glob("*.java"))
    out = compiled(folder, *files, classes=classes)
    perceptions = ["", "5", "5 0.31 5", "", "0.31", "0.31 5 0.31", "", "5", ""]
    done = subprocess.run(
        [installed("java"), "-cp", f"{out}{os.pathsep}{classes}", "r1_agent.Latch", *perceptions],
        capture_output=True,
        text=True,
        check=True,
    )
    near, nothing, same = "[too_close]", "[]", "null"
    assert done.stdout.split() == [
        *(nothing, same, near, nothing, near),  # unknown at first
        *(nothing, near, nothing, same),
    ]


@needs("java", "javac")
@pytest.mark.slow
def test_after_a_lost_connection_it_connects_again(tmp_path: Path) -> None:
    with robot(tmp_path) as subject:
        subject.drive(5.0, subject.last(False))
        port = int(subject.endpoint.url.rpartition(":")[2])
        subject.endpoint.close()
        subject.stops.clear()
        types = {"/scan": "sensor_msgs/LaserScan"}
        subject.endpoint = Endpoint(types, subject._receive, port=port)
        subject.wait(lambda: bool(subject.stops))
        assert subject.stops[0]  # nothing is known
        subject.drive(5.0, subject.last(False))


@needs("java", "javac")
@pytest.mark.slow
def test_a_topic_of_another_type_ends_it_before_it_begins(tmp_path: Path) -> None:
    mcapl()
    with Endpoint({"/scan": "std_msgs/String"}, lambda *message: None) as endpoint:
        bundle = write(tmp_path / "r1_agent", texts(made()))
        done = subprocess.run(
            [sys.executable, str(bundle / "run.py"), "--url", endpoint.url],
            env={**os.environ, "AJPF_HOME": mcapl()},
            capture_output=True,
            text=True,
            timeout=2 * WAIT,
        )
    assert done.returncode == 2
    assert "/scan has the type std_msgs/String, not sensor_msgs/LaserScan" in done.stderr
    assert "error: F919 a topic is of another type, or cannot be used" in done.stderr
