"""The drifts that a published robot had between its paper and its files: each of them is found.

The requirement says 5 cm and the code compares with 0.9 m; the scan drops whatever is nearer than
0.2 m, so that 5 cm can never be seen; the property is triggered by an action, which no agent
believes; the interceptor latches its stop, and speaks only when a command comes.
"""

import json
from pathlib import Path

import pytest

from tests.command import Fretc, write
from tests.fretc.logs.logs import MS, S, Sent, number, scan
from tests.fretc.logs.logs import write as write_log

HAZARDS = '[HAZ-1]\ntitle = "The robot hits an obstacle"\n'
REQUIREMENTS = {
    "r1": (
        'parents = ["HAZ-1"]\nparams = { too_close = "5 cm" }\nverify = ["audit", "ajpf"]',
        "whenever too_close agilex_agent shall eventually satisfy stopped",
    ),
    "r2": (
        'parents = ["R1"]\nverify = ["ajpf"]',
        "whenever stop_moving agilex_agent shall eventually satisfy stopped",
    ),
    "r3": (
        'parents = ["HAZ-1"]\nparams = { touching = "5 cm" }\nverify = ["audit"]',
        "whenever touching agilex_agent shall within 2 seconds satisfy stopped",
    ),
    "r4": (
        'parents = ["HAZ-1"]\nverify = ["audit"]',
        "when released agilex_agent shall within 2 seconds satisfy driving",
    ),
}
BINDINGS = """\
[clock]
time = "log_time"
tick = "100 ms"

[signal.nearest]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
reduce = "min"
unit = "m"
valid = "range_min <= x and x <= range_max"
max_age = "300 ms"

[signal.speed]
path = "/speed.data"
unit = "m/s"
max_age = "300 ms"

[signal.request]
path = "/request.data"
max_age = "300 ms"

[proposition.too_close]
expr = "nearest < 0.9 m"
role = "input"
kind = "belief"
agg = "any"

[proposition.touching]
expr = "nearest < 5 cm"
role = "input"
kind = "belief"
agg = "any"

[proposition.stop_moving]
expr = "request > 0.5"
role = "output"
kind = "command"
agg = "any"

[proposition.released]
expr = "request < 0.5 and nearest >= 0.9 m"
role = "input"
agg = "last"

[proposition.stopped]
expr = "abs(speed) < 0.01 m/s"
role = "output"
kind = "physical"
agg = "last"

[proposition.driving]
expr = "abs(speed) >= 0.01 m/s"
role = "output"
kind = "physical"
agg = "last"

[interceptor]
stop = "/gwendolen_control"
command = "/cmd_vel"
output = "/cmd_vel_filtered"
form = "event"
latching = true

[assume]
stands = "stopped"
latency = "100 ms"
braking = "200 ms"
requests = "edge"
"""
AGENT = """\
GWENDOLEN
:name: agilex_agent

:Initial Beliefs:

:Initial Goals:

:Plans:
+too_close : {True} <- stop_moving, +stopped;
"""
PROPERTIES = """\
PAPER: [] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))
PUBLISHED: [] ((B(agilex_agent,stop_moving)) -> (<> (B(agilex_agent,stopped))))
"""


def samples() -> list[Sent]:
    """An obstacle comes from 3 m to 1 cm and goes; nearer than 0.2 m no scan tells of it."""
    messages = []
    for i in range(100):
        time = S + i * 100 * MS
        distance = max(0.01, abs(i - 40) * 0.08) if i < 80 else 3.2
        reading = distance if distance >= 0.2 else float("inf")
        near = 25 <= i <= 51
        messages.append(scan([5.0, reading], time, range_min=0.2))
        messages.append(number(1.0 if near else 0.0, time + MS, "/request"))
        messages.append(number(0.3 if i < 26 else 0.0, time + 2 * MS, "/speed"))
    return messages


@pytest.fixture
def robot(fretc: Fretc) -> Fretc:
    """The project folder, with a log of its robot."""
    for id, (header, sentence) in REQUIREMENTS.items():
        head = f'id = "{id.upper()}"\nstatus = "approved"\n{header}'
        write(f"requirements/{id}.fret", f"+++\n{head}\n+++\n{sentence}\n")
    write("requirements/bindings.toml", BINDINGS)
    write("requirements/hazards.toml", HAZARDS)
    write("agent.gwen", AGENT)
    write("agent.psl", PROPERTIES)
    write_log(Path("run.mcap"), samples())
    return fretc


def test_check_finds_the_other_threshold_the_own_trigger_and_the_latch(robot: Fretc) -> None:
    run = robot("check")
    assert run.status == 3
    codes = [line.split(":")[0] for line in run.err.splitlines() if line.startswith("F")]
    for code in ("F310 warning", "F209 warning", "F633 warning", "F632 warning"):
        assert code in codes
    assert "the requirement states 5 cm for `too_close`" in run.err
    assert "R2 is triggered by `stop_moving`, which agilex_agent itself commands" in run.err


def test_audit_finds_the_blind_sensor_and_the_stop_that_is_never_released(robot: Fretc) -> None:
    run = robot("audit", "run.mcap", "--format", "json")
    assert run.status == 1
    verdicts = {one["requirement"]: one["verdict"] for one in json.loads(run.out)}
    assert verdicts["R3"] == "vacuous", "5 cm was never seen, though the obstacle came to 1 cm"
    assert verdicts["R4"] == "violated", "the robot stands on after its release"
    assert (
        "F311 warning: `touching` compares `nearest` with 0.05 m, and `/scan` reports nothing "
        "nearer than 0.2 m" in run.err
    )


def test_verify_finds_that_no_agent_believes_an_action(robot: Fretc) -> None:
    files = ("--agent", "agent.gwen", "--properties", "agent.psl")
    run = robot(
        "verify",
        "requirements/r2.fret",
        "--layer",
        "agent",
        *files,
        "--percept",
        "too_close",
        "--all",
    )
    assert run.status == 3
    lines = run.out.splitlines()
    assert any(line.startswith("✔ PAPER") for line in lines)
    (line,) = [line for line in lines if line.startswith("∅ PUBLISHED")]
    assert "`stop_moving` is an action, and an action is never a belief" in line


def test_verify_finds_that_the_published_environment_triggers_nothing(robot: Fretc) -> None:
    files = ("--agent", "agent.gwen", "--properties", "agent.psl")
    run = robot(
        "verify", "requirements/r1.fret", "--layer", "agent", *files, "--percept", "stopped"
    )
    assert run.status == 3
    assert [line[0] for line in run.out.splitlines() if line[1:8] == " PAPER "] == ["∅"]


@pytest.mark.slow
@pytest.mark.confined
def test_verify_finds_that_the_loop_does_not_stop_and_never_starts_again(robot: Fretc) -> None:
    run = robot("verify", "requirements/r1.fret", "--layer", "loop")
    assert run.status == 1
    kept, released = [line for line in run.out.splitlines() if line.startswith("✘ R1")]
    assert "satisfy the requirement" in kept
    assert "the stop is released" in released


@pytest.mark.slow
def test_the_report_shows_all_of_it(robot: Fretc) -> None:
    assert robot("audit", "run.mcap").status == 1
    assert robot("report", "--json", "report.json").status == 0
    report = json.loads(Path("report.json").read_text())
    codes = {remark["code"] for remark in report["remarks"]}
    assert {"F310", "F209", "F632", "F633"} <= codes
    assert "F311" in [f["code"] for run in report["runs"] for f in run["findings"]]
    verdicts = {view["id"]: view["mark"]["word"] for view in report["requirements"]}
    assert verdicts["R3"] == "vacuous"
    assert verdicts["R4"] == "violated"
    assert report["overall"]["mark"]["word"] == "violated"
