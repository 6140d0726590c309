"""From a scan to the stop and to zero on the wheels: the emitted nodes, and one by hand.

    python -m benchmarks.live_latency [--ros 1|2] [--scans 800]

A lidar of 720 beams at 40 Hz is near in each second scan; both nodes hear it at the same time. Wall
time from before its publication to the arrival of the stop, and of zero, at its process; the share
of CPU time that each node takes. No test asserts them.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import statistics
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from benchmarks.figures import Figure
from compiler.emit import TARGETS
from compiler.files.text_files import write as deliver
from compiler.project.folder import load
from compiler.project.paths import expanded_paths
from compiler.targets.target import TargetOptions
from fretish.diagnostics.diagnostic import Diagnostic
from tests.programs import DEBIANS_PYTHON
from tests.ros1 import ros, ros1_or_skip, until
from tests.ros2.real.network import network

HERE = Path(__file__).parent
BINDINGS = """
[clock]
tick = "100 ms"
time = "{time}"
lateness = "100 ms"
[signal.clearance]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
{reduce}
valid = "range_min <= x and x <= range_max"
invalid = {{ nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }}
max_age = "300 ms"
[signal.speed]
path = "/odom.twist.twist.linear.x"
type = "nav_msgs/Odometry"
max_age = "300 ms"
[proposition.near]
expr = "clearance < {least}"
[proposition.stands]
expr = "abs(speed) < 0.01 for 200 ms"
[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
period = "50 ms"
stop_timeout = "500 ms"
ros = {ros}
"""
KINDS = {
    "least": {"reduce": 'reduce = "min"', "least": "1.0"},
    "outline": {
        "reduce": 'reduce = "outline"\n'
        "footprint = [[0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3], [0.3, -0.3]]",
        "least": "0.4",
    },
}


def package(folder: Path, kind: str, count: int, time: str, ros: int) -> Path:
    """The package of so many requirements, all of which a near scan triggers."""
    project_folder = folder / "live"
    texts: dict[Path, str | bytes] = {
        project_folder / f"R{i}.fret": "whenever near the robot shall immediately satisfy stands"
        if i == 0
        else f"whenever near the robot shall within {i} ticks satisfy near"
        for i in range(count)
    }
    texts[project_folder / "bindings.toml"] = BINDINGS.format(time=time, ros=ros, **KINDS[kind])
    assert deliver(texts) is None
    paths = expanded_paths([str(project_folder)])
    assert not isinstance(paths, Diagnostic)
    project = load(paths)
    target, options = (
        TARGETS[f"ros{ros}-package"],
        TargetOptions(declarations=project.declarations, attribution=project.attribution),
    )
    assert [target.refuse(requirement) for requirement in project.formalized] == [None] * count
    files = target.emit(project.formalized, options)
    assert deliver({folder / file.path: file.text for file in files}) is None
    return folder / files[0].path.parts[0]


def seconds(process: subprocess.Popen[str]) -> float:
    """Of CPU time that it has taken."""
    fields = (
        Path(f"/proc/{process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    )
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


Measured = tuple[dict[str, list[float]], tuple[float, float]]
"""Milliseconds to each answer, and CPU seconds of the emitted node and of the one by hand."""


def measured(made: Path, kind: str, scans: int) -> Measured:
    """Both nodes hear the same scans."""
    with tempfile.TemporaryDirectory() as folder, ros(Path(folder)) as here:
        here.environment = {**here.environment, "PYTHONPATH": str(made / "src")}
        here.master()
        here.start(str(made / "scripts/interceptor.py"))
        node = here.start(str(made / "scripts/monitor_node.py"))
        by_hand = here.start(DEBIANS_PYTHON, str(HERE / "live_robot.py"), "by-hand", kind)
        here.start(DEBIANS_PYTHON, str(HERE / "live_robot.py"), "listener")
        until(
            "they listen",
            lambda: {"/scan", "/stop", "/by_hand"} <= set((here.state() or [{}, {}])[1]),
        )
        words = (DEBIANS_PYTHON, str(HERE / "live_robot.py"), "lidar", str(scans))
        lidar = here.start(*words, stdout=subprocess.PIPE)
        assert lidar.stdout is not None
        assert lidar.stdout.readline() == "begun\n"
        before = seconds(node), seconds(by_hand)
        times = json.loads(lidar.stdout.readline())
        return times, (seconds(node) - before[0], seconds(by_hand) - before[1])


def measured_in_ros2(made: Path, kind: str, scans: int, count: int) -> Measured:
    """The same in ROS 2."""
    with tempfile.TemporaryDirectory() as folder, network(Path(folder)) as here:
        robot = str(HERE / "live_robot_ros2.py")
        here.interceptor(made)
        node = here.monitor(made).process
        by_hand = here.start(robot, "by-hand", kind, str(count))
        here.start(robot, "listener")
        lidar = here.start(robot, "lidar", str(scans), made.name, stdout=subprocess.PIPE)
        assert lidar.stdout is not None
        assert lidar.stdout.readline() == "begun\n"
        before = seconds(node), seconds(by_hand)
        times = json.loads(lidar.stdout.readline())
        return times, (seconds(node) - before[0], seconds(by_hand) - before[1])


def line(times: dict[str, list[float]], took: tuple[float, float], scans: int) -> str:
    """The cells of a row of the table."""
    spreads = " | ".join(_spread(times[each]) for each in ("stop", "by hand", "zero"))
    shares = " | ".join(f"{100 * each / (scans * 0.025):.1f} %" for each in took)
    late = " | ".join(str(scans // 2 - 1 - len(times[each])) for each in ("stop", "by hand"))
    return f"{spreads} | {late} | {shares} | {took[0] / took[1]:.2f}"


def _spread(times: list[float]) -> str:
    if len(times) < 2:
        return f"{len(times)} answers | | "
    centiles = statistics.quantiles(times, n=100)
    return f"{centiles[49]:.2f} | {centiles[98]:.2f} | {max(times):.2f}"


NEXT = 50
"""Milliseconds to the next near scan: a later answer is not known to be of this one."""
LIMIT = 1.3
"""Times the CPU seconds of the node by hand."""
_COUNT = 20
"""Requirements in the emitted node."""


def figures(scans: int = 400) -> Iterator[Figure]:
    """CPU time of the emitted nodes, in each ROS that is installed."""
    for number in (1, 2):
        with tempfile.TemporaryDirectory() as folder, suppress(pytest.skip.Exception):
            if number == 1:
                ros1_or_skip()
            made = package(Path(folder), "least", _COUNT, "header.stamp", number)
            _, (ours, theirs) = (
                measured(made, "least", scans)
                if number == 1
                else measured_in_ros2(made, "least", scans, _COUNT)
            )
            what = f"node of {_COUNT} requirements, ROS {number}, CPU"
            yield Figure(what, ours / theirs, "x by hand", LIMIT)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scans", type=int, default=800)
    parser.add_argument("--ros", type=int, choices=(1, 2), default=1)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=[*KINDS])
    options = parser.parse_args()
    scans = options.scans
    if options.ros == 1:
        ros1_or_skip()
    head = "p50 | p99 | max | by hand: p50 | p99 | max | zero: p50 | p99 | max"
    late = f"later than {NEXT} ms | by hand"
    print(f"| stop, ms: | {head} | {late} | CPU | by hand | ratio |\n{'|---' * 15}|")
    for kind, time, count in itertools.product(
        options.kinds, ("header.stamp", "log_time"), (1, 20)
    ):
        with tempfile.TemporaryDirectory() as folder:
            made = package(Path(folder), kind, count, time, options.ros)
            both = (
                measured(made, kind, scans)
                if options.ros == 1
                else measured_in_ros2(made, kind, scans, count)
            )
            print(f"| {count}, {kind}, {time} | {line(*both, scans)} |", flush=True)


if __name__ == "__main__":
    main()
