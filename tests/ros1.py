"""ROS 1 for tests: a master on a free port, and a world of topics around the node under test.

What runs here are Debian's packages under Debian's Python. Anyone who waits, waits for what the
master or a node tells, never for a time to pass.
"""

from __future__ import annotations

import json
import socket
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xmlrpc.client import ServerProxy

from tests.programs import DEBIANS_PATH, DEBIANS_PYTHON, debians_python

SOON = 10.0
"""Seconds for what takes a fraction of one, on a machine that may be busy."""

_WORLD = '''
"""Stands for planner, safety function and wheels: publishes every 5 ms, keeps what it hears."""
import json, sys, threading
import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import Bool

rospy.init_node(sys.argv[1], disable_signals=True)
wants = json.loads(sys.argv[2])
heard = []
if wants["drives"]:
    rospy.Subscriber("/wheels", Twist, lambda said: heard.append(said.linear.x))
    drive = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
if wants["stop"] is not None:
    safety = rospy.Publisher("/stop", Bool, queue_size=1)
command = Twist()
command.linear.x = 0.4

def say():
    pause = threading.Event()
    while not pause.wait(0.005):
        if wants["drives"]:
            drive.publish(command)
        if wants["stop"] is not None:
            safety.publish(wants["stop"])

threading.Thread(target=say, daemon=True).start()
print("[]", flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    if asked == "clear":
        heard.clear()
    elif isinstance(asked, bool):
        wants["stop"] = asked
    print(json.dumps(heard), flush=True)
'''


def ros1_or_skip() -> None:
    """Skip the test where ROS 1 is not installed."""
    debians_python(
        "rospy", "rosmaster.main", "geometry_msgs.msg", "std_msgs.msg", "sensor_msgs.msg"
    )


def until(what: str, holds: Callable[[], object], seconds: float = SOON) -> None:
    """Wait for it.

    Raises:
        AssertionError: it has not come.
    """
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, f"not within {seconds} s: {what}"
        time.sleep(0.005)


@dataclass
class World:
    """A node that drives and listens, as a process that answers."""

    process: subprocess.Popen[str]

    def ask(self, asked: object = None) -> list[float]:
        """What the wheels have heard, m/s along x; "clear": forget it; a truth value: say that."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps(asked), file=self.process.stdin, flush=True)
        answer: list[float] = json.loads(self.process.stdout.readline())
        return answer


class Ros:
    """A master, and the processes that know it; all end with it."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self._stack = stack
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.uri = f"http://127.0.0.1:{self.port}/"
        self.environment: Mapping[str, str] = {
            "PATH": DEBIANS_PATH,
            "HOME": str(folder),
            "ROS_HOME": str(folder),
            "ROS_LOG_DIR": str(folder / "log"),
            "ROS_MASTER_URI": self.uri,
            "ROS_IP": "127.0.0.1",
        }

    def master(self) -> subprocess.Popen[str]:
        """Start it, and wait until it answers."""
        run = (
            f"import rosmaster.main; rosmaster.main.rosmaster_main(['--core', '-p', '{self.port}'])"
        )
        process = self.start(DEBIANS_PYTHON, "-c", run, stdout=subprocess.DEVNULL)
        until("the master answers", self.state)
        return process

    def start(self, *words: str, **how: Any) -> subprocess.Popen[str]:
        """A process; it is killed when the test ends."""
        process = subprocess.Popen(words, env=self.environment, text=True, **how)
        self._stack.callback(_end, process)
        return process

    def world(self, name: str, *, drives: bool = True, stop: bool | None = False) -> World:
        """A node that publishes every 5 ms, and keeps what the wheels hear."""
        wants = json.dumps({"drives": drives, "stop": stop})
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        world = World(self.start(DEBIANS_PYTHON, "-c", _WORLD, name, wants, **pipes))
        assert world.process.stdout is not None
        assert world.process.stdout.readline() == "[]\n", name
        return world

    def node(self, path: Path, *words: str) -> subprocess.Popen[str]:
        """The file under test, as roslaunch starts it: by itself."""
        return self.start(str(path), *words, stderr=subprocess.PIPE)

    def state(self) -> list[dict[str, list[str]]]:
        """Publishers and subscribers: topic → names of nodes; empty: no master answers."""
        try:
            with ServerProxy(self.uri) as master:
                answer: Any = master.getSystemState("/test")
        except OSError:
            return []
        return [dict(part) for part in answer[2][:2]]

    def joined(self, name: str) -> bool:
        """Whether the master knows that this node hears commands and speaks to the wheels."""
        publishers, subscribers = self.state()
        return name in publishers.get("/wheels", ()) and name in subscribers.get("/cmd_vel", ())


def _end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


@contextmanager
def ros(folder: Path) -> Iterator[Ros]:
    """A place for nodes; there is no master yet."""
    with ExitStack() as stack:
        yield Ros(folder, stack)


@dataclass(frozen=True)
class Ended:
    """How a node ended; `status` is None where it never did, and had to be killed."""

    status: int | None
    said: str


def ended(process: subprocess.Popen[str], number: int = 0, seconds: float = 5.0) -> Ended:
    """Send a signal (0: none), and wait for the end."""
    if number:
        process.send_signal(number)
    try:
        _, output = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        return Ended(None, process.communicate()[1])
    return Ended(process.returncode, output)
