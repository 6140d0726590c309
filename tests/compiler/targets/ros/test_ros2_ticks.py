"""The node of ROS 2 sees at each tick what the audit of a recording of its messages sees."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.watch.sources.source import Arrival
from tests.c_monitors import CHECKED_IN_CPP
from tests.effort import examples
from tests.fretc.watch.sent import MS, START, Sent
from tests.fretc.watch.test_session import audited_rows, recorded
from tests.ros2.cpp import built
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


@dataclass(frozen=True)
class Subject:
    """The emitted package of a setting, and the plan of an audit."""

    package: Path
    plan: Plan = field(repr=False)


@pytest.fixture(scope="module")
def subjects(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, int], Subject]:
    """Of each setting."""
    found = {}
    for time, lateness in SETTINGS:
        folder = tmp_path_factory.mktemp("requirements")
        for i, sentence in enumerate(SENTENCES):
            (folder / f"R{i}.fret").write_text(sentence)
        (folder / "bindings.toml").write_text(BINDINGS.format(time=time, lateness=lateness))
        plan = planned(read_project(folder))
        assert isinstance(plan, Plan), plan
        found[time, lateness] = Subject(write(folder, folder / "src"), plan)
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
@examples(12)
@given(st.sampled_from(SETTINGS), messages, st.sampled_from([0, 3, 40]))
def test_every_tick_is_that_of_the_audit(
    subjects: dict[tuple[str, int], Subject],
    setting: tuple[str, int],
    some: list[Sent],
    idle: int,
) -> None:
    subject = subjects[setting]
    ordered = sorted(some, key=lambda each: each.arrival.log_time)
    posed = [Posed(**vars(each), rank=rank) for rank, each in enumerate(ordered)]
    ledger = node(subject.package, posed, idle)._status_publisher._supervisor._evaluator.ledger
    _, _, recording = recorded(subject.plan, posed, idle)
    rows = audited_rows(subject.plan, recording)
    live = [(ledger.time(i), dict(ledger.row(i))) for i in range(len(ledger))]
    assert live == rows[: len(live)]
    assert len(rows) - len(live) <= 12


# The same in C++ ---------------------------------------------------------------------------------

DRIVER = """
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include "setting.hpp"
#include "stop_supervisor.hpp"

struct Point { double x, y, z; };
struct Posed { Point point; };

static void tell(fretc::StopSupervisor<fretc::Machine> & supervisor, double steady)
{
  std::printf("%s", supervisor.stop(steady) ? "[true" : "[false");
  for (const std::string & line : supervisor.news()) { std::printf(", %s", line.c_str()); }
  std::printf("]\\n");
}

int main()
{
  fretc::BindingConfig setting = fretc::setting();
  long long lateness, topic, stamp, arrival;
  std::cin >> setting.stamped >> lateness;
  setting.lateness = lateness;
  fretc::StopSupervisor<fretc::Machine> supervisor(setting, {0, 1}, 0.02);
  std::string value;
  while (std::cin >> topic >> stamp >> arrival >> value) {
    const Posed message{{std::strtod(value.c_str(), nullptr), 0.0, 0.0}};
    const double steady = static_cast<double>(arrival) / 1e9;
    if (topic < 0) {
      supervisor.pass_to(arrival);
    } else if (value == "refused" || value == "also") {
      supervisor.refuse(topic, value, arrival);
    } else {
      supervisor.arrive(topic, stamp, arrival, steady,
        topic == 0 ? fretc::read_0(message) : fretc::read_1(message));
    }
    tell(supervisor, steady);
  }
  for (const auto & tick : supervisor.evaluator().ticks()) {
    std::printf("[%lld", static_cast<long long>(tick.time));
    for (const auto truth : tick.row) { std::printf(", %d", truth); }
    std::printf("]\\n");
  }
}
"""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Judges arrivals by the emitted headers in C++ and the monitors in C."""
    folder = tmp_path_factory.mktemp("cpp")
    for i, sentence in enumerate(SENTENCES):
        (folder / f"R{i}.fret").write_text(sentence)
    (folder / "bindings.toml").write_text(BINDINGS.format(time="header.stamp", lateness=5))
    source = write(folder, folder / "package", "ros2-cpp-package") / "src"
    (folder / "driver.cpp").write_text(DRIVER)
    strict = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Wno-float-conversion".split()
    in_cpp = [*strict, *CHECKED_IN_CPP, f"-I{source}"]
    return built(folder, source, folder / "driver.cpp", CHECKED_IN_CPP, in_cpp)


@pytest.mark.slow
@examples(12)
@given(
    st.sampled_from(SETTINGS),
    messages,
    st.dictionaries(st.integers(0, 24), st.sampled_from(["refused", "also"]), max_size=4),
    st.sampled_from([0, 3, 40, 5000]),
)
def test_the_package_in_cpp_says_the_same(
    program: Path,
    subjects: dict[tuple[str, int], Subject],
    setting: tuple[str, int],
    some: list[Sent],
    refusals: dict[int, str],
    idle: int,
) -> None:
    """A refusal comes with a message: who publishes there would be misread."""
    package = subjects[setting].package
    module = World().process().load(package, "perception")
    monitors = World().process().load(package, "monitor")
    supervisor = module.StopSupervisor(monitors.MONITOR, module.SETTING, (), 0.02)
    ordered = sorted(some, key=lambda each: each.arrival.log_time)
    posed = [Posed(**vars(each), rank=rank) for rank, each in enumerate(ordered)]
    lines = [f"{int(module.SETTING.stamped)} {module.SETTING.lateness}"]
    expected = []
    for place, each in enumerate(posed):
        arrival = each.arrival.log_time
        if place in refusals:
            supervisor.refuse(each.topic, refusals[place], arrival)
            expected.append([supervisor.stop(arrival / 1e9), *_states(supervisor)])
            topic = module.SETTING.topics.index(each.topic)
            lines.append(f"{topic} 0 {arrival} {refusals[place]}")
            continue
        supervisor.arrive(each.topic, each.message, arrival, arrival / 1e9)
        expected.append([supervisor.stop(arrival / 1e9), *_states(supervisor)])
        value = "nan" if each.value is None else each.value
        topic = module.SETTING.topics.index(each.topic)
        lines.append(f"{topic} {START + each.at * MS} {arrival} {value}")
    end = posed[-1].arrival.log_time + idle * MS
    supervisor.pass_to(end)
    expected.append([supervisor.stop(end / 1e9), *_states(supervisor)])
    lines.append(f"-1 0 {end} 0")
    ran = subprocess.run(
        [program], input="\n".join(lines), capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    told = [json.loads(line) for line in ran.stdout.splitlines()]
    known: dict[str, Any] = {}
    for expectation, (stop, *news) in zip(expected, told, strict=False):
        known |= {line["requirement"]: line for line in news}
        found = [tuple(known[id][name] for name in STATE) for id in ("R0", "R1")]
        assert [stop, *found] == expectation
    ledger = supervisor._evaluator.ledger
    names = [meaning.name for meaning in module.SETTING.meanings]
    rows = [
        [ledger.time(i), *(_code(ledger.row(i)[name]) for name in names)]
        for i in range(len(ledger))
    ]
    assert told[len(expected) :] == rows


STATE = ("verdict", "obligation_pending", "triggered_ns", "violated_ns")


def _states(supervisor: Any) -> list[tuple[Any, ...]]:
    return [tuple(getattr(state, name) for name in STATE) for state in supervisor.states()]


def _code(truth: bool | None) -> int:
    return 2 if truth is None else int(truth)
