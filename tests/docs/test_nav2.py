"""The files of docs/nav2.md: they are clean, and what is made of them stops a robot on ROS 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.command import Fretc, write
from tests.docs.pages import FOLDER, blocks
from tests.ros2.real.network import network

NODE = "nav_1_monitor"


def write_files() -> None:
    """All files of the page, in their places."""
    page = (FOLDER / "nav2.md").read_text(encoding="utf-8")
    (sentence,) = blocks(page, "fret")
    bindings, project = blocks(page, "toml")
    write("requirements/keep_distance.fret", sentence)
    write("requirements/bindings.toml", bindings)
    write("fretc.toml", project)


def test_the_files_have_no_errors_and_no_warnings(fretc: Fretc) -> None:
    write_files()
    run = fretc("check")
    assert run.status == 0, run.err
    assert "0 errors, 0 warnings" in run.out + run.err


@pytest.mark.slow
def test_the_robot_stands_before_the_obstacle(fretc: Fretc, tmp_path: Path) -> None:
    write_files()
    emitted = fretc("requirements", "--emit", "ros2-package", "-o", "src")
    assert emitted.status == 0, emitted.err
    package = Path("src", NODE).resolve()
    with network(tmp_path) as here:
        words = ("/cmd_vel:=/cmd_vel_checked", "/cmd_vel_filtered:=/cmd_vel")
        remaps = [each for word in words for each in ("-r", word)]
        robot = here.robot("--ros-args", *remaps)
        here.monitor(package)
        here.interceptor(package)
        for transition in ("configure", "activate"):
            assert robot.ask(f"change {NODE} {transition}")["done"]
        robot.ask("go")
        robot.drives()
        state = robot.until("it is near", lambda state: state["clearance"] < 0.1)
        robot.stands()
        before = robot.ask()["clearance"]
        assert before > 0.01, state
