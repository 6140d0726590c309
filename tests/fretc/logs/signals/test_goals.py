"""Actions and services of ROS 2 as signals of recordings, streams and emitted nodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.logs.stream import ClockTick, SampleStream
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from monitors.loading import executed
from tests.fretc.logs.logs import MS, S, Sent, declare, payload, store, write
from tests.ros2.emitted import write as write_package

BINDINGS = """
[clock]
tick = "100 ms"

[signal.goal]
action = "/navigate_to_pose"
agg = "any"

[signal.busy]
action = "/navigate_to_pose"
goal = "any"
status = ["accepted", "executing"]

[signal.over]
action = "/navigate_to_pose"
goal = "all"
status = ["succeeded", "aborted"]
"""
TYPE = "action_msgs/msg/GoalStatusArray"
ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(1, 7)
Goals = tuple[tuple[int, int], ...]
"""Of each goal the second in which it was accepted, and its status."""
RUN: tuple[Goals, ...] = (
    ((1, ACCEPTED),),
    ((1, EXECUTING),),
    ((1, EXECUTING), (3, ACCEPTED)),
    ((1, ABORTED), (3, EXECUTING)),
    ((1, ABORTED), (3, SUCCEEDED)),
    ((3, SUCCEEDED), (9, ACCEPTED)),
    (),
)
WORDS = ("accepted", "executing", "accepted", "executing", "succeeded", "accepted", "none")
BUSY = (1, 1, 1, 1, 0, 1, 0)
OVER = (0, 0, 0, 0, 1, 0, 0)


def statuses(goals: Goals) -> Any:
    types = store("cdr").types
    return types[TYPE](
        [
            types["action_msgs/msg/GoalStatus"](
                types["action_msgs/msg/GoalInfo"](
                    types["unique_identifier_msgs/msg/UUID"](np.full(16, i, np.uint8)),
                    types["builtin_interfaces/msg/Time"](second, 0),
                ),
                status,
            )
            for i, (second, status) in enumerate(goals)
        ]
    )


def sent(goals: Goals, time: int) -> Sent:
    data = payload(TYPE, status_list=statuses(goals).status_list)
    return Sent("/navigate_to_pose/_action/status", TYPE, data, time)


def times() -> list[int]:
    return [S + i * 100 * MS for i in range(len(RUN))]


def test_a_recording_has_the_statuses_of_goals(tmp_path: Path) -> None:
    log = write(tmp_path / "run.mcap", [sent(*each) for each in zip(RUN, times(), strict=True)])
    recording = read(str(log), declare(BINDINGS), ["goal", "busy", "over"])
    assert isinstance(recording, Recording)
    assert recording.findings == ()
    goal = recording.samples["goal"]
    assert goal.times.tolist() == times()
    assert tuple(goal.words[int(place)] for place in goal.values) == WORDS
    assert tuple(recording.samples["busy"].values) == BUSY
    assert tuple(recording.samples["over"].values) == OVER


def test_a_stream_reads_the_messages_of_rclpy() -> None:
    text = BINDINGS + '[proposition.p]\nexpr = "goal = accepted or over"\n'
    stream = SampleStream(declare(text), ["p"])
    for goals, time in zip(RUN, times(), strict=True):
        topic = "/navigate_to_pose/_action/status"
        assert stream.message(topic, time, statuses(goals)) is None
    ticks = stream.until(S + 601 * MS)
    assert isinstance(ticks, tuple)
    assert all(isinstance(tick, ClockTick) for tick in ticks)
    accepted = [word == "accepted" or bool(over) for word, over in zip(WORDS, OVER, strict=True)]
    assert [tick.truth["p"] for tick in ticks] == accepted


@pytest.mark.slow
def test_an_emitted_node_reads_the_same(tmp_path: Path) -> None:
    folder = tmp_path / "requirements"
    folder.mkdir()
    tables = '[proposition.p]\nexpr = "goal = accepted"\n[proposition.q]\nexpr = "busy or over"\n'
    (folder / "bindings.toml").write_text(f"{BINDINGS}\n{tables}")
    (folder / "R.fret").write_text("whenever p the r shall within 1 second satisfy q")
    package = write_package(folder, tmp_path / "src")
    assert "GoalStatusArray, KEPT_ALL)" in next(package.glob("*/node.py")).read_text()
    perception = executed(next(package.glob("*/perception.py")).read_text(), "perception")
    types = get_typestore(Stores.ROS2_JAZZY)
    policies = {policy.name: policy for policy in perception.SETTING.policies}
    read_back = [
        types.deserialize_cdr(sent(goals, time).payload, TYPE)
        for goals, time in zip(RUN, times(), strict=True)
    ]
    found = {
        name: [perception.sample(policy, message) for message in read_back]
        for name, policy in policies.items()
    }
    assert [policies["goal"].words[int(place)] for place in found["goal"]] == [*WORDS]
    assert tuple(found["busy"]) == BUSY
    assert tuple(found["over"]) == OVER


def event(kind: int, time: int) -> Sent:
    """An event of std_srvs/SetBool, without a definition, as rosbag2 records it."""
    data = b"\0\1\0\0" + bytes([kind]) + bytes(43)
    return Sent("/arm/_service_event", "std_srvs/srv/SetBool_Event", data, time)


def test_a_service_has_the_events_of_its_messages(tmp_path: Path) -> None:
    events = [event(kind, S + i * MS) for i, kind in enumerate((0, 1, 2, 3, 7))]
    path = write(
        tmp_path / "run.mcap", events, definitions={"std_srvs/srv/SetBool_Event": b"SRV: unknown"}
    )
    declared = declare('[clock]\ntick = "1 ms"\n[signal.arm]\nservice = "/arm"\n')
    recording = read(str(path), declared, ["arm"])
    assert isinstance(recording, Recording)
    arm = recording.samples["arm"]
    words = [None if np.isnan(place) else arm.words[int(place)] for place in arm.values]
    assert words == ["request_sent", "request_received", "response_sent", "response_received", None]
    assert [each.code for each in recording.findings] == [Code.FOREIGN_VALUE]


def test_another_type_is_refused(tmp_path: Path) -> None:
    topic = "/navigate_to_pose/_action/status"
    other = Sent(topic, "std_msgs/msg/Float64", b"\0\1\0\0" + bytes(8), S)
    recording = read(str(write(tmp_path / "run.mcap", [other])), declare(BINDINGS), ["goal"])
    assert isinstance(recording, Recording)
    assert [each.code for each in recording.findings] == [Code.WRONG_TYPE]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('action = ""', "`action` is not the name that ROS 2 has for it"),
        ('service = "a b"', "`service` is not the name that ROS 2 has for it"),
        (
            'action = "/a"\nstatus = "aborted"',
            '`status` belongs to `goal = "any"` or `goal = "all"`',
        ),
        (
            'action = "/a"\ngoal = "all"\nstatus = "lost"',
            'with `goal = "all"`, `status` says which statuses are meant',
        ),
        ('action = "/a"\npath = "/b.c"', "unknown field `path` in [signal.x] with `action`"),
    ],
)
def test_mistakes_are_named(table: str, message: str) -> None:
    text = f'[clock]\ntick = "1 s"\n[signal.x]\n{table}\n'
    found, wrong = read_bindings(Source("bindings.toml", text))
    assert found is not None
    assert [each.message for each in wrong] == [message]
    assert "x" not in found.signals
