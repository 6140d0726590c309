"""Every scenario on real ROS 2, by a simulated clock that runs faster than real time.

At each time at which the node says something, this is what follows from the audit's ticks until
then. What `fretc watch dds` has recorded beside it gives the same again.
"""

from __future__ import annotations

import json
import os
import struct
import subprocess
import time
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from compiler.files.text_files import write as deliver
from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from monitors.loading import executed
from monitors.perception import KEPT
from monitors.ticking import Ledger
from simulation.world import scenario as scenarios
from tests.command import Fretc
from tests.effort import full_only
from tests.fretc.logs.logs import Sent
from tests.fretc.logs.logs import write as write_log
from tests.fretc.watch.test_session import audited_rows
from tests.fretc.watch.watched import Watched
from tests.programs import needs_package
from tests.ros2.emitted import write
from tests.ros2.real.network import PATIENCE, Network, network
from tests.simulation.missions import Missions

ROOT = Path(__file__).parents[4]
PLAYER = ROOT / "tests/ros2/real/player.py"
EDGE = "upon too_close agilex_agent shall within 1 second satisfy stopped"
LATENESS = 10
"""Seconds of simulated time that a message may take."""
FIRST, LAST = 8.0, 32.0
"""Seconds of a mission that are played."""
LATEST = 10.0
"""Real seconds after which a message does not come any more."""
RATES = (4.0, 1.0, 0.25)
"""How fast; slower where a message was lost, as best effort allows."""
TYPES = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/odom": "nav_msgs/msg/Odometry",
    "/cmd_vel": "geometry_msgs/msg/Twist",
}
SECOND = 10**9
_STAMP = struct.Struct("<iI")

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


def requirements(folder: Path) -> Plan:
    """R1 and a requirement that can be violated, by the clock of the stamps."""
    text = (ROOT / "requirements/bindings.toml").read_text()
    stamps = f'time = "header.stamp"\nlateness = "{LATENESS} s"'
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


def messages(log: Path, begin: int) -> Iterator[Sent]:
    """Those that are played, moved so that the first comes at `begin`; stamps are moved, too."""
    moved = None
    with log.open("rb") as stream:
        first = None
        for _, channel, message in make_reader(stream).iter_messages():
            first = message.log_time if first is None else first
            if channel.topic not in TYPES or not FIRST <= (message.log_time - first) / 1e9 <= LAST:
                continue
            moved = begin - message.log_time if moved is None else moved
            data = bytearray(message.data)
            if channel.topic != "/cmd_vel":
                sec, nanosec = _STAMP.unpack_from(data, 4)
                _STAMP.pack_into(data, 4, *divmod(sec * 10**9 + nanosec + moved, 10**9))
            yield Sent(channel.topic, TYPES[channel.topic], bytes(data), message.log_time + moved)


@dataclass
class Mission:
    """What is played, and what an audit says of it."""

    folder: Path
    log: Sequence[Sent]
    results: Sequence[Mapping[str, Any]]
    rows: Sequence[tuple[int, Mapping[str, Any]]]
    """The time of each tick, with the truth of all propositions."""

    def count(self, topic: str) -> int:
        return sum(each.topic == topic for each in self.log)


def mission(folder: Path, log: Path, begin: int, fretc: Fretc) -> Mission:
    """A mission, moved so that it begins at this time."""
    plan = requirements(folder / "r1")
    sent = [*messages(log, begin)]
    write_log(folder / "sent.mcap", sent)
    recording = read(str(folder / "sent.mcap"), plan.declarations, [*plan.declarations.signals])
    assert isinstance(recording, Recording)
    results = audited(fretc, "sent.mcap")["results"]
    return Mission(folder, sent, results, audited_rows(plan, recording))


def audited(fretc: Fretc, log: str) -> dict[str, Any]:
    ran = fretc("audit", log, "--requirements", "r1", "-o", "audit.json")
    assert ran.status in (0, 1, 3), ran.err
    found: dict[str, Any] = json.loads(Path("audit.json").read_text())
    return found


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


def played(here: Network, mission: Mission, rate: float) -> dict[str, Any] | None:
    """What the node and the interceptor said beside a watch; None: a message was lost."""
    folder = mission.folder
    made = write(folder / "r1", folder / "made")
    file = folder / "messages.txt"
    file.write_text("".join(f"{m.time} {m.topic} {m.payload.hex()}\n" for m in mission.log))
    watch = Watched(
        here.of_fretc, folder, "dds", "--requirements", "r1",
        "--record", "run.mcap", "--evidence", "live.json",
    )  # fmt: skip
    try:
        here.monitor(made, "--ros-args", "-p", "use_sim_time:=true", "-p", "heartbeat:=0.01")
        here.interceptor(made)
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        player = here.start(str(PLAYER), str(file), str(rate), "2", **pipes)
        state = heard(player, mission)
        if state is None:
            return None
        assert watch.end() in (0, 1, 3)
    finally:
        watch.close()
    return state


def heard(player: subprocess.Popen[str], mission: Mission) -> dict[str, Any] | None:
    """What was said until all is judged; None: a message was lost."""
    assert player.stdin is not None
    assert player.stdout is not None

    def ask(what: str) -> dict[str, Any]:
        print(what, file=player.stdin, flush=True)
        assert player.stdout is not None
        found: dict[str, Any] = json.loads(player.stdout.readline())
        return found

    count = {f"messages of {topic}": mission.count(topic) for topic in ("/scan", "/odom")}
    end = None
    while not count.items() <= {name: int(n) for name, n in ask("how")["values"].items()}.items():
        end = end or time.monotonic() + LATEST
        if time.monotonic() > end:
            return None
        time.sleep(0.1)
    end = time.monotonic() + PATIENCE
    while int((state := ask("on"))["values"]["ticks"]) < len(mission.rows):
        assert time.monotonic() < end, state
        time.sleep(0.1)
    return state


def says(made: Path, rows: Sequence[tuple[int, Mapping[str, Any]]]) -> Iterator[dict[str, Any]]:
    """After each of these ticks: where each requirement stands, as a line of the node has it."""
    module = executed((made / made.name / "monitor.py").read_text(), "m")
    stepped = module.MONITOR()
    ledger = Ledger((stepped,), KEPT)
    times = [at for at, _ in rows]
    for at, row in rows:
        ledger.advance(at, row)
        pairs = zip(stepped.statuses(), stepped.certain.marks(), strict=True)
        yield {
            status.requirement: {
                "verdict": str(status.verdict),
                "triggered_ns": times[mark.last] if mark.last >= 0 else None,
                "violated_ns": None
                if status.first_violation is None
                else times[status.first_violation],
            }
            for status, mark in pairs
        }


@full_only("minutes")
@pytest.mark.parametrize("name", scenarios.names())
def test_in_every_scenario_node_watch_and_audit_say_one_thing(
    missions: Missions, name: str, tmp_path: Path, fretc: Fretc
) -> None:
    log = missions(replace(scenarios.load(name), duration=LAST)).path
    for rate in RATES:
        folder = tmp_path / f"{rate:g}"
        folder.mkdir()
        os.chdir(folder)
        with network(folder) as here:
            mine = mission(folder, log, time.time_ns() + 10 * SECOND, fretc)
            state = played(here, mine, rate)
        if state is not None:
            break
    assert state is not None, "messages are lost, also at their own rate"
    assert state["wheels"][-1] == 0

    after = [*says(folder / "made/r1_monitor", mine.rows)]
    times = [at for at, _ in mine.rows]
    compared = 0
    told: dict[str, set[int | None]] = {id: set() for id in after[-1]}
    for line in state["lines"]:
        judged = bisect_left(times, line["time_ns"] - LATENESS * SECOND)
        if 0 < judged < len(times):
            expected = after[judged - 1][line["requirement"]]
            assert {each: line[each] for each in expected} == expected
            compared += 1
            told[line["requirement"]].add(line["triggered_ns"])
    assert compared >= len(told)
    expected_marks = marks(mine.results)
    for id, (_, triggers, _) in expected_marks.items():
        assert told[id] - {None} <= {*triggers}
    print(name, rate, compared, {id: len(each[1]) for id, each in expected_marks.items()})

    recorded = audited(fretc, "run.mcap")
    assert Path("audit.json").read_bytes() == Path("live.json").read_bytes()
    assert marks(recorded["results"]) == expected_marks
