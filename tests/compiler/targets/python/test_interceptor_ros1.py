"""`--emit interceptor` on real ROS 1: the file as roslaunch starts it, and whatever ends it."""

import os
import signal
import subprocess
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest

from compiler.files.text_files import write as deliver
from compiler.targets.python.interceptor import text
from fretish.bindings.declarations import Interception, InterceptorForm
from tests.effort import FULL, some
from tests.programs import DEBIANS_PATH
from tests.ros1 import Ended, Ros, World, ended, ros, ros1_or_skip, until

MS = 1_000_000
TIMED = Interception("/stop", "/cmd_vel", "/wheels", period=2 * MS, stop_timeout=400 * MS, ros=1)
PAPER = Interception("/stop", "/cmd_vel", "/wheels", form=InterceptorForm.EVENT, ros=1)
FORMS = (TIMED, PAPER)
SIGNALS = (signal.SIGINT, signal.SIGTERM)
FAST = 0.4

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def _ros_1() -> None:
    ros1_or_skip()


@pytest.fixture
def here(tmp_path: Path) -> Iterator[Ros]:
    """A place for nodes; no master runs yet."""
    with ros(tmp_path) as place:
        yield place


def file(here: Path, node: Interception) -> Path:
    path = here / "interceptor.py"
    assert deliver({path: text(node, "bindings.toml")}) is None
    return path


def moving(world: World) -> None:
    """Forget what the wheels have heard, and wait until they move."""
    world.ask("clear")
    until("the robot moves", lambda: FAST in world.ask())


def standing(world: World) -> None:
    """Wait until the wheels hear zero, and see that they hear nothing else from then on."""
    until("the robot stands", lambda: world.ask()[-1:] == [0.0])
    world.ask("clear")
    until("it goes on to stand", lambda: len(world.ask()) >= 20)
    assert set(world.ask()) == {0.0}


@pytest.mark.parametrize(("number", "node"), some(product(SIGNALS, FORMS), 3))
def test_a_signal_ends_the_node_and_the_last_that_the_wheels_hear_is_zero(
    here: Ros, tmp_path: Path, node: Interception, number: int
) -> None:
    path = file(tmp_path, node)
    here.master()
    world = here.world("world")
    for _ in range(5 if FULL else 1):
        started = here.node(path)
        moving(world)
        assert ended(started, number) == Ended(0, "")
        until("the last is zero", lambda: world.ask()[-1:] == [0.0], 2.0)
        until("it has left", lambda: not here.joined("/interceptor"), 2.0)


def test_without_a_master_it_says_so_and_with_a_late_one_it_goes_to_work(
    here: Ros, tmp_path: Path
) -> None:
    path = file(tmp_path, TIMED)
    started = here.node(path)
    until("it waits for the master", lambda: (tmp_path / "log").exists())
    found = ended(started, signal.SIGINT)
    assert found.status == 3
    assert found.said.endswith(f"interceptor.py: no ROS master has answered at {here.uri}\n")
    late = here.node(path)
    here.master()
    moving(here.world("world"))
    assert ended(late, signal.SIGINT).status == 0


def test_a_second_node_of_the_name_ends_the_first_which_says_so(here: Ros, tmp_path: Path) -> None:
    path = file(tmp_path, TIMED)
    here.master()
    world = here.world("world")
    first = here.node(path)
    moving(world)
    second = here.node(path)
    found = ended(first)
    assert found.status == 4
    assert found.said.startswith("interceptor.py: ROS has ended it: ")
    assert found.said.endswith("new node registered with same name]\n")
    moving(world)
    assert ended(second, signal.SIGTERM) == Ended(0, "")
    until("the last is zero", lambda: world.ask()[-1:] == [0.0], 2.0)


@pytest.mark.parametrize("node", some(FORMS, 2), ids=lambda node: node.form.value)
def test_while_two_safety_functions_speak_the_robot_stands(
    here: Ros, tmp_path: Path, node: Interception
) -> None:
    path = file(tmp_path, node)
    here.master()
    world = here.world("world")
    started = here.node(path)
    moving(world)
    for stop in (True, False):
        other = here.world("other", drives=False, stop=stop)
        standing(world)
        other.process.kill()
        moving(world)
    assert ended(started, signal.SIGINT) == Ended(
        0,
        "interceptor.py: /stop has several publishers: the robot stands until one is left\n"
        "interceptor.py: /stop has one publisher again, which decides\n" * 2,
    )


def test_a_stop_and_the_silence_of_the_safety_function_halt_the_robot(
    here: Ros, tmp_path: Path
) -> None:
    path = file(tmp_path, TIMED)
    here.master()
    world = here.world("world", stop=None)
    safety = here.world("safety", drives=False)
    started = here.node(path)
    moving(world)
    safety.ask(True)
    standing(world)
    safety.ask(False)
    moving(world)
    safety.process.kill()
    standing(world)
    here.world("safety", drives=False)
    moving(world)
    assert ended(started, signal.SIGTERM) == Ended(0, "")


def test_it_runs_with_debians_python_alone(tmp_path: Path) -> None:
    path = file(tmp_path, TIMED)
    assert os.access(path, os.X_OK)
    clean = {"PATH": DEBIANS_PATH}
    ran = subprocess.run([path, "--help"], env=clean, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.endswith("another node has taken its name, say\n")
