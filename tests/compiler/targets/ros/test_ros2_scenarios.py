"""Scenarios on real ROS 2, by a simulated clock that runs as fast as the node.

All states of a requirement that the node reports are those of the audit, in their order, and the
last ones are equal. What `fretc watch dds` has recorded beside it gives the same again.
"""

from __future__ import annotations

import json
import struct
import subprocess
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader

from compiler.files.text_files import write as deliver
from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from monitors.loading import executed
from simulation.world import scenario as scenarios
from tests.command import Fretc
from tests.effort import FULL
from tests.fretc.logs.logs import Sent
from tests.fretc.logs.logs import write as write_log
from tests.fretc.watch.test_session import audited_rows
from tests.fretc.watch.watched import Watched
from tests.programs import needs_package
from tests.ros2.emitted import write
from tests.ros2.real.network import PATIENCE, Network, network
from tests.simulation.missions import Missions, cut_off

ROOT = Path(__file__).parents[4]
PLAYER = ROOT / "tests/ros2/real/player.py"
EDGE = "upon too_close agilex_agent shall within 1 second satisfy stopped"
LATENESS, OF_WATCH = 6, 60
"""Seconds for which node and watch wait for messages: simulated and real ones.

The clock of one log jumps ahead by 5 s.
"""
BEFORE = 30
"""Seconds from the first stamp to its message: the mission is over before all of it is judged."""
SPANS = (
    dict.fromkeys(scenarios.without_agent(), (8.0, 32.0)) if FULL else {"safety-off": (11.5, 14.0)}
)
"""Scenario: the seconds of the mission that are played; in this one EDGE is violated."""
SECOND = 10**9
TYPES = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/odom": "nav_msgs/msg/Odometry",
    "/cmd_vel": "geometry_msgs/msg/Twist",
}

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


def requirements(folder: Path, lateness: int) -> Plan:
    """R1 and a requirement that can be violated, by the clock of the stamps."""
    text = (ROOT / "requirements/bindings.toml").read_text()
    stamps = f'time = "header.stamp"\nlateness = "{lateness} s"'
    assert 'time = "log_time"' in text
    files = {
        "bindings.toml": text.replace('time = "log_time"', stamps, 1),
        "r1.fret": (ROOT / "requirements/r1.fret").read_text(),
        "EDGE.fret": EDGE,
    }
    assert deliver({folder / each: text for each, text in files.items()}) is None
    plan = planned(read_project(folder))
    assert isinstance(plan, Plan)
    return plan


def messages(log: Path, begin: float, end: float) -> Iterator[Sent]:
    """Those of some seconds of the mission, or until the log is cut off."""
    with log.open("rb") as stream, suppress(McapError):
        first = None
        for _, channel, message in NonSeekingReader(stream).iter_messages(log_time_order=False):
            first = message.log_time if first is None else first
            if channel.topic in TYPES and begin <= (message.log_time - first) / SECOND <= end:
                yield Sent(channel.topic, TYPES[channel.topic], message.data, message.log_time)


def played(here: Network, folder: Path, messages: Iterable[Sent]) -> dict[str, Any]:
    """What node and interceptor said of the mission beside a watch."""
    made = write(folder / "node/r1", folder / "made")
    file = folder / "messages.txt"
    file.write_text("".join(f"{m.time} {m.topic} {m.payload.hex()}\n" for m in messages))
    watch = Watched(
        here.of_fretc, folder, "dds", "--requirements", "watch/r1",
        "--record", "run.mcap", "--evidence", "live.json",
    )  # fmt: skip
    try:
        here.monitor(made, "--ros-args", "-p", "use_sim_time:=true", "-p", "heartbeat:=0.01")
        here.interceptor(made)
        words = (str(PLAYER), str(file), "2", str(BEFORE), str(LATENESS))
        player = here.start(*words, stdout=subprocess.PIPE)
        assert player.stdout is not None
        assert player.stdout.readline() == "played\n"
        assert watch.end() in (0, 1, 3)  # now, so that its run ends with the last message
        said, _ = player.communicate(timeout=5 * PATIENCE)
        assert player.returncode == 0
    finally:
        watch.close()
    found: dict[str, Any] = json.loads(said)
    return found


def states(made: Path, rows: Sequence[tuple[int, Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """Verdict, last trigger and first violation, by the emitted monitor; entry i: after i ticks."""
    monitor = executed((made / made.name / "monitor.py").read_text(), "m").MONITOR()
    times = [at for at, _ in rows]

    def state() -> dict[str, Any]:
        pairs = zip(monitor.statuses(), monitor.certain.marks(), strict=True)
        return {
            status.requirement: (
                str(status.verdict),
                times[mark.last] if mark.last >= 0 else None,
                None if status.first_violation is None else times[status.first_violation],
            )
            for status, mark in pairs
        }

    found = [state()]
    for _, row in rows:
        monitor.advance((row,))
        found.append(state())
    return found


def changes(values: Sequence[Any]) -> list[Any]:
    """Without those that say the same as the one before."""
    return [value for value, _ in groupby(values)]


def is_part(some: Sequence[Any], all_: Sequence[Any]) -> bool:
    """Whether the first are some of the second, in their order.

    On busy cores a node judges two ticks at once, and reports the state after them.
    """
    rest = iter(all_)
    return all(any(each == one for one in rest) for each in some)


def marks(results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Verdict, triggers and violations of each requirement."""
    return {
        each["requirement"]: (
            each["verdict"],
            [mark["ns"] for mark in each["triggers"]],
            [mark["start_ns"] for mark in each["violations"]],
        )
        for each in results
    }


def audited(fretc: Fretc, log: str) -> dict[str, Any]:
    ran = fretc("audit", log, "--requirements", "watch/r1", "-o", "audit.json")
    assert ran.status in (0, 1, 3), ran.err
    found: dict[str, Any] = json.loads(Path("audit.json").read_text())
    return found


def recorded_messages(log: Path) -> dict[str, list[bytes]]:
    """The payloads of each topic that is read, in order."""
    found: dict[str, list[bytes]] = {}
    with log.open("rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages():
            found.setdefault(channel.topic, []).append(message.data)
    return {topic: changes(found[topic]) for topic in ("/scan", "/odom")}


@pytest.mark.parametrize("name", SPANS)
def test_in_a_scenario_node_watch_and_audit_say_one_thing(
    missions: Missions, name: str, tmp_path: Path, fretc: Fretc
) -> None:
    begin, end = SPANS[name]
    log = missions(replace(scenarios.load(name), duration=end) if FULL else cut_off(name)).path
    plan = requirements(tmp_path / "watch/r1", OF_WATCH)
    requirements(tmp_path / "node/r1", LATENESS)
    with network(tmp_path) as here:
        said = played(here, tmp_path, messages(log, begin, end))

    sent = [Sent(topic, TYPES[topic], bytes.fromhex(data), at) for at, topic, data in said["sent"]]
    write_log(tmp_path / "sent.mcap", sent)
    recording = read("sent.mcap", plan.declarations, [*plan.declarations.signals])
    assert isinstance(recording, Recording)
    rows = audited_rows(plan, recording)
    times = [at for at, _ in rows]
    expected = states(tmp_path / "made/r1_monitor", rows)

    passed = [at - LATENESS * SECOND for at in (*(each.time for each in sent), *said["times"])]
    judged = [bisect_left(times, at) for at in passed]
    assert judged[-1] >= len(times) - 1
    for id in expected[-1]:
        lines = [
            (line["verdict"], line["triggered_ns"], line["violated_ns"])
            for line in said["lines"]
            if line["requirement"] == id
        ]
        wanted = changes([expected[count][id] for count in (0, *judged)])
        assert is_part(changes(lines), wanted), id
        assert lines[-1] == wanted[-1], id

    commands = {
        struct.unpack_from("<d", each.payload, 4)[0] for each in sent if each.topic == "/cmd_vel"
    }
    assert {*said["wheels"]} <= commands | {0.0}
    assert said["wheels"][-1] == 0.0
    results = marks(audited(fretc, "sent.mcap")["results"])
    again = marks(audited(fretc, "run.mcap")["results"])
    assert Path("audit.json").read_bytes() == Path("live.json").read_bytes()
    assert again == results
    assert recorded_messages(Path("run.mcap")) == recorded_messages(Path("sent.mcap"))
