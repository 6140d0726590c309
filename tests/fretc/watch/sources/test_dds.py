"""`fretc watch dds` on the wire of ROS 2: what it says is what an audit of its recording says."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from compiler.targets.python import monitor, perception
from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from simulation.world import scenario as scenarios
from tests.command import Fretc
from tests.dds import domain, environment
from tests.effort import FULL, full_only
from tests.fretc.watch.test_session import audited_rows
from tests.fretc.watch.watched import ROOT, Watched
from tests.programs import needs_package
from tests.ros1 import until
from tests.simulation.missions import Missions

LATENESS = 'lateness = "2 s"'
"""What a machine takes at most that is busy with other tests."""
TOPICS = ("/odom", "/scan")
FIRST, LAST = 8.0, 32.0
"""Seconds of a mission that are played: a first obstacle, or somebody who walks into the path."""

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


@contextmanager
def process(environment: Mapping[str, str], *words: str) -> Iterator[subprocess.Popen[str]]:
    """A program of Python that prints at its end."""
    with subprocess.Popen(
        [sys.executable, "-m", *words],
        env={**environment, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
    ) as running:
        try:
            yield running
        finally:
            running.kill()


def by_stamps(folder: Path) -> Plan:
    """R1 in a folder, with the clock of the robot's stamps; and the core of its node."""
    bindings = (ROOT / "requirements" / "bindings.toml").read_text()
    assert 'time = "log_time"' in bindings
    stamps = bindings.replace('time = "log_time"', f'time = "header.stamp"\n{LATENESS}\n', 1)
    folder.mkdir()
    (folder / "bindings.toml").write_text(stamps)
    (folder / "r1.fret").write_bytes((ROOT / "requirements" / "r1.fret").read_bytes())
    project = read_project(folder)
    (requirement,) = project.formalized
    assert perception.refuse(requirement) is None
    (folder / "perception.py").write_text(perception.text([requirement]))
    (folder / "monitors.py").write_text(monitor.text(requirement))
    plan = planned(project)
    assert isinstance(plan, Plan)
    return plan


def played(log: Path, folder: Path, first: float, last: float) -> tuple[Watched, Any]:
    """Robot, watch and node, each a process; the watch, and what the node says."""
    with domain() as number:
        here = environment(number)
        run = Watched(
            here, folder, "dds", "--requirements", "requirements",
            "--record", "run.mcap", "--evidence", "live.json",
        )  # fmt: skip
        words = str(log), str(first), str(last), "2", *TOPICS
        node = process(here, "tests.dds_node", str(folder / "requirements"), "clearance")
        try:
            with node as core, process(here, "tests.dds_robot", *words) as robot:
                printed = robot.communicate(timeout=300)[0]
                until(
                    "all is over", lambda: all(run.says(f"`{t}` has no publisher") for t in TOPICS)
                )
                said = json.loads(core.communicate(timeout=60)[0])
            assert run.end() in (0, 1, 3)
        finally:
            run.close()
    counts = json.loads(printed)
    assert min(counts[topic] for topic in TOPICS) > 20
    return run, said


def agreed(fretc: Fretc, log: Path, first: float, last: float) -> dict[str, int]:
    """A mission is played; all say the same of it. How often R1 is triggered, and over how much."""
    folder = Path.cwd()
    plan = by_stamps(folder / "requirements")
    run, node = played(log, folder, first, last)
    (folder / "node.json").write_text(json.dumps(node))
    again = fretc("audit", "run.mcap", "--requirements", "requirements", "-o", "audit.json")
    assert again.status in (0, 1, 3), again.err
    assert (folder / "audit.json").read_bytes() == (folder / "live.json").read_bytes()
    results = json.loads((folder / "audit.json").read_text())["results"]
    verdicts = {each["requirement"]: each["verdict"] for each in results}
    assert run.verdicts() == verdicts
    recording = read(str(folder / "run.mcap"), plan.declarations, list(plan.declarations.signals))
    assert isinstance(recording, Recording)
    assert recording.intact, run.codes()
    rows: list[Any] = [[time, row] for time, row in audited_rows(plan, recording)]
    assert node == {"rows": rows, "statuses": verdicts, "resets": 0}
    triggers = sum(row["too_close"] is True for _, row in rows)
    unknown = sum(None in row.values() for _, row in rows)
    return {"ticks": len(rows), "triggers": triggers, "unknown": unknown, **verdicts}


def test_robot_watch_and_node_agree_with_the_audit_in_real_time(fretc: Fretc) -> None:
    first = 4.0 if FULL else 5.0
    found = agreed(fretc, ROOT / "traces" / "mission-seed15.mcap", first, 9.5 if FULL else 8.0)
    assert found["triggers"] > 0
    assert found["ticks"] > (50 if FULL else 25)


@full_only("minutes")
@pytest.mark.parametrize("name", scenarios.names())
def test_they_agree_in_every_scenario(missions: Missions, name: str, fretc: Fretc) -> None:
    mission = missions(replace(scenarios.load(name), duration=LAST))
    found = agreed(fretc, mission.path, FIRST, LAST)
    print(name, found)  # shown by `-rP`
    assert found["ticks"] > 20
