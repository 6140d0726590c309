"""The node of ROS 2 sees at each tick what the audit of a recording of its messages sees."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.watch.sources.source import Arrival
from tests.fretc.watch.sent import MS, START, Sent
from tests.fretc.watch.test_session import audited_rows, recorded
from tests.ros2.emitted import write
from tests.ros2.messages import message_class
from tests.ros2.world import World

BINDINGS = """
[clock]
tick = "10 ms"
time = "{time}"
lateness = "{lateness} ms"
[signal.x]
path = "/x.point.x"
type = "geometry_msgs/PointStamped"
max_age = "17 ms"
[signal.y]
path = "/y.point.x"
type = "geometry_msgs/PointStamped"
[proposition.near]
expr = "x < 5"
agg = "any"
[proposition.still]
expr = "(y < 5 for 12 ms) or x < 2"
agg = "last"
"""
SENTENCES = (
    "whenever near the r shall within 2 ticks satisfy still",
    "the r shall always satisfy !near | still",
)
SETTINGS = [(time, lateness) for time in ("log_time", "header.stamp") for lateness in (0, 5)]
messages = st.lists(
    st.builds(
        Sent,
        topic=st.sampled_from(["/x", "/x", "/y"]),
        value=st.sampled_from([1.0, 3.0, 9.0, None]),
        at=st.integers(0, 120),
        delay=st.sampled_from([0, 0, 1, 5, 6, 21, 60]),
    ),
    min_size=1,
    max_size=25,
)


@dataclass(frozen=True)
class Posed(Sent):
    """The same as a point; no two are received in one nanosecond."""

    rank: int = 0

    @property
    def arrival(self) -> Arrival:
        plain = super().arrival
        content = json.loads(plain.payload)
        content["point"] = {"x": self.value, "y": 0.0, "z": 0.0}
        received = plain.log_time + self.rank
        return replace(plain, payload=json.dumps(content).encode(), log_time=received)

    @property
    def message(self) -> Any:
        sec, nanosec = divmod(START + self.at * MS, 10**9)
        found = message_class("geometry_msgs/PointStamped")()
        found.header.stamp.sec, found.header.stamp.nanosec = sec, nanosec
        found.point.x = math.nan if self.value is None else self.value
        return found


@pytest.fixture(scope="module")
def subjects(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, int], tuple[Path, Plan]]:
    """Of each setting the emitted package, and the plan of an audit."""
    found = {}
    for time, lateness in SETTINGS:
        folder = tmp_path_factory.mktemp("requirements")
        for i, sentence in enumerate(SENTENCES):
            (folder / f"R{i}.fret").write_text(sentence)
        (folder / "bindings.toml").write_text(BINDINGS.format(time=time, lateness=lateness))
        plan = planned(read_project(folder))
        assert isinstance(plan, Plan), plan
        found[time, lateness] = write(folder, folder / "src"), plan
    return found


def node(package: Path, some: Sequence[Posed], idle: int) -> Any:
    """The node to which the messages have come."""
    world = World(START)
    robot, process = world.node("robot"), world.process("-p", "heartbeat:=0.003")
    kind = message_class("geometry_msgs/PointStamped")
    topics = {topic: robot.create_publisher(kind, topic, 10) for topic in ("/x", "/y")}
    module = process.load(package, "node")
    process.init()
    found = module.MonitorNode()
    assert found.change("configure")
    assert found.change("activate")
    for each in some:
        delay = each.arrival.log_time - START
        message, publisher = each.message, topics[each.topic]
        world.after(delay, robot, partial(publisher.publish, message))
    world.run((some[-1].arrival.log_time - START + idle * MS) / 10**9)
    return found


@pytest.mark.slow
@given(st.sampled_from(SETTINGS), messages, st.sampled_from([0, 3, 40]))
def test_every_tick_is_that_of_the_audit(
    subjects: dict[tuple[str, int], tuple[Path, Plan]],
    setting: tuple[str, int],
    some: list[Sent],
    idle: int,
) -> None:
    package, plan = subjects[setting]
    ordered = sorted(some, key=lambda each: each.arrival.log_time)
    posed = [Posed(**vars(each), rank=rank) for rank, each in enumerate(ordered)]
    ledger = node(package, posed, idle)._voice._guard._judging.ledger
    _, _, recording = recorded(plan, posed, idle)
    rows = audited_rows(plan, recording)
    live = [(ledger.time(i), dict(ledger.row(i))) for i in range(len(ledger))]
    assert live == rows[: len(live)]
    assert len(rows) - len(live) <= 12
