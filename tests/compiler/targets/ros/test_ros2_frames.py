"""Signals of frames in an emitted node: each tick is that of the audit of a recording."""

from __future__ import annotations

import random
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.traces import trace
from monitors.kernel.columns import rows_of
from monitors.loading import executed
from tests.fretc.logs.frames.robot import TYPE, drive
from tests.fretc.logs.logs import MS, S, Sent, declare
from tests.fretc.logs.logs import write as write_log
from tests.ros2.emitted import write
from tests.ros2.messages import message_class
from tests.ros2.rclpy import Durability, QoSProfile
from tests.ros2.world import World

BINDINGS = """
[clock]
tick = "50 ms"
lateness = "0 ms"

[signal.x]
frame = "laser"
in = "map"
path = "x"
max_age = "60 ms"

[signal.heading]
frame = "base_link"
in = "map"
path = "yaw"
unit = "deg"

[proposition.far]
expr = "x > 250 cm"

[proposition.ahead]
expr = "heading < 20 deg for 100 ms"
"""
pytestmark = pytest.mark.slow
SENTENCE = "whenever far the r shall within 1 second satisfy ahead"


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("requirements")
    (folder / "R.fret").write_text(SENTENCE)
    (folder / "bindings.toml").write_text(BINDINGS)
    return write(folder, folder / "src")


def loaded(package: Path, name: str) -> ModuleType:
    (file,) = package.glob(f"*/{name}.py")
    module: ModuleType = executed(file.read_text(), f"emitted_{name}")
    return module


def test_the_package_reads_the_topics_of_transforms(package: Path) -> None:
    (node,) = package.glob("*/node.py")
    text = node.read_text()
    assert '("/tf", tf2_msgs.msg.TFMessage, 100),' in text.replace("'", '"')
    assert '("/tf_static", tf2_msgs.msg.TFMessage, KEPT_ALL),' in text.replace("'", '"')
    assert "<depend>tf2_msgs</depend>" in (package / "package.xml").read_text().replace(
        "exec_depend", "depend"
    )


@pytest.mark.parametrize("seed", range(4))
def test_each_tick_is_that_of_the_audit(package: Path, tmp_path: Path, seed: int) -> None:
    chance = random.Random(seed)
    sent = [one for one in drive(90) if chance.random() < 0.8]
    sent = [*drive(0), *sent]
    declared = declare(BINDINGS)
    log = read(str(write_log(tmp_path / "run.mcap", sent)), declared, list(declared.signals))
    assert isinstance(log, Recording)
    names = ("far", "ahead")
    found = trace(declared, log, names)
    times = found.timeline.times.tolist()
    rows = rows_of([found.columns[name] for name in names], len(times))
    audited = {
        time: dict(zip(names, row, strict=True)) for time, row in zip(times, rows, strict=True)
    }
    rows_of_node = judged(package, sent)
    last = max(one.time for one in sent)
    assert [time for time in times if time < last - S // 20] == [*rows_of_node][:-1]
    assert {time: audited[time] for time in rows_of_node} == rows_of_node
    assert {None, True, False} == {row["far"] for row in audited.values()}


def judged(package: Path, sent: list[Sent]) -> dict[int, dict[str, bool | None]]:
    """The rows of the ticks before the last message, as the node evaluates them."""
    perception, monitor = loaded(package, "perception"), loaded(package, "monitor")
    node = perception.OnlineEvaluator(monitor.MONITOR, perception.SETTING)
    rows: dict[int, dict[str, bool | None]] = {}
    advance = node.ledger.advance

    def kept(time: int, row: dict[str, bool | None]) -> None:
        rows[time] = dict(row)
        advance(time, row)

    node.ledger.advance = kept
    types = get_typestore(Stores.ROS2_JAZZY)
    for one in sent:
        node.arrive(one.topic, one.time, one.time, types.deserialize_cdr(one.payload, TYPE))
    return rows


def test_a_node_that_starts_late_gets_the_static_transforms_and_the_status(tmp_path: Path) -> None:
    """Its subscriptions keep: what was published before it started reaches it."""
    (tmp_path / "R.fret").write_text("whenever far the r shall immediately satisfy docked")
    tables = """
[signal.goal]
action = "/dock"
[proposition.docked]
expr = "goal = succeeded"
"""
    (tmp_path / "bindings.toml").write_text(BINDINGS.replace("250 cm", "1 cm") + tables)
    package = write(tmp_path, tmp_path / "src")
    world = World(2 * S)
    robot, process = world.node("robot"), world.process()
    kept = QoSProfile(depth=1, durability=Durability.TRANSIENT_LOCAL)
    statuses = robot.create_publisher(
        message_class("action_msgs/GoalStatusArray"), "/dock/_action/status", kept
    )
    status = message_class("action_msgs/GoalStatus")(status=4)
    statuses.publish(message_class("action_msgs/GoalStatusArray")(status_list=[status]))
    kind = message_class("tf2_msgs/TFMessage")
    static = robot.create_publisher(kind, "/tf_static", kept)
    static.publish(kind(transforms=[stamped("base_link", "laser", 1.0, 0)]))
    moving = robot.create_publisher(kind, "/tf", 100)
    module = process.load(package, "node")
    process.init()
    node = module.MonitorNode()
    assert node.change("configure")
    assert node.change("activate")
    for i in range(20):
        message = kind(transforms=[stamped("map", "base_link", 1.0, i)])
        world.after(i * 50 * MS, robot, partial(moving.publish, message))
    world.run(1.0)
    ledger = node._status_publisher._supervisor._evaluator.ledger
    rows = [dict(ledger.row(i)) for i in range(len(ledger))]
    assert len(rows) > 10
    assert rows[-1] == {"far": True, "docked": True}


def stamped(parent: str, child: str, x: float, count: int) -> Any:
    """A transform, 50 ms later each."""
    found = message_class("geometry_msgs/TransformStamped")()
    found.header.stamp.sec, found.header.stamp.nanosec = divmod(2 * S + count * 50 * MS, S)
    found.header.frame_id, found.child_frame_id = parent, child
    found.transform.translation.x, found.transform.rotation.w = x, 1.0
    return found
