"""Tests as logs: the audit of the messages gives what the test expects, or it says why not."""

from __future__ import annotations

from pathlib import Path

import pytest

from compiler.project.folder import load
from compiler.project.project import Project
from fretc.analysis.assumptions import assumptions
from fretc.testing.assembly import jobs, suite
from fretc.testing.log_synthesis.logs import LogTestResult, logs
from tests.effort import some

BINDINGS = """
[clock]
tick = "100 ms"

[signal.gap]
path      = "/scan.ranges[:]"
type      = "sensor_msgs/LaserScan"
reduce    = "outline"
footprint = [[0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3], [0.3, -0.3]]
sensor    = [0.0, 0.0, 0.0]
unit      = "m"
valid     = "range_min <= x and x <= range_max"
invalid   = { nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }
max_age   = "300 ms"

[signal.speed]
path    = "/odom.twist.twist.linear.x"
type    = "nav_msgs/Odometry"
unit    = "m/s"
max_age = "100 ms"

[signal.mode]
path   = "/mode.data"
type   = "std_msgs/String"
values = ["idle", "drive", "dock"]

[signal.button]
path    = "/button.data"
type    = "std_msgs/Bool"
max_age = "300 ms"

[signal.alive]
path    = "/alive.data"
type    = "std_msgs/Bool"
max_age = "500 ms"

[signal.nameless]
path = "/nameless.data"

[proposition.too_close]
expr = "gap < 5 cm"
agg  = "any"

[proposition.stopped]
expr = "abs(speed) < 0.01 m/s for 200 ms"

[proposition.torn]
expr = "speed < 1 m/s"
on_unknown = false

[proposition.faster]
expr = "pre(0 m/s, speed) < speed"

[proposition.unnamed]
expr = "nameless > 1"
"""


def staged(sentence: str, folder: Path) -> list[LogTestResult]:
    """What becomes of the tests of a sentence."""
    project = read(sentence, folder)
    assumed, _ = assumptions(project.formalized, project.declarations)
    made = [batch for job in jobs(project.formalized, assumed, 20) for batch in job.ask(())]
    tests = suite(project.formalized, assumed, made).tests
    assert tests
    out = folder / "out"
    out.mkdir()
    found = [*logs(project, tests, out, lambda done: None)]
    written = {path.stem for path in out.iterdir()}
    assert written == {one.test.name for one in found if one.outcome == "confirmed"}
    assert len(found) == len(tests)
    return found


def read(sentence: str, folder: Path) -> Project:
    (folder / "bindings.toml").write_text(BINDINGS)
    (folder / "q.fret").write_text(f'+++\nid = "Q"\n+++\n{sentence}\n')
    return load([str(folder / "q.fret")])


@pytest.mark.parametrize(
    "sentence",
    some(
        [
            "upon button the robot shall for 200 milliseconds satisfy speed < 1 m/s & gap >= 0.2 m",
            "whenever too_close the robot shall within 300 milliseconds satisfy speed = 0",
            "whenever mode = dock the robot shall immediately satisfy absReal(speed) <= 0.3 m/s",
        ],
        2,
    ),
)
@pytest.mark.slow
def test_each_test_is_a_log_whose_audit_says_what_it_expects(sentence: str, tmp_path: Path) -> None:
    assert {one.outcome for one in staged(sentence, tmp_path)} == {"confirmed"}


@pytest.mark.slow
def test_what_looks_back_has_ticks_before_the_test(tmp_path: Path) -> None:
    found = staged("whenever too_close the robot shall eventually satisfy stopped", tmp_path)
    assert {one.outcome for one in found} == {"confirmed"}
    assert {one.lead for one in found} == {0, 2}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("torn", "it turns unknown values into known ones"),
        ("faster", "reads numbers of the tick before"),
        ("unnamed", "the binding of `nameless` names no message type"),
    ],
)
def test_what_messages_cannot_bring_about_is_refused_in_words(
    name: str, why: str, tmp_path: Path
) -> None:
    found = staged(f"the robot shall always satisfy {name}", tmp_path)
    assert not any(one.outcome == "not confirmed" for one in found)
    assert any(why in one.why for one in found)


def test_a_bool_is_unknown_by_silence_only(tmp_path: Path) -> None:
    """A message counts for 500 ms: no tick that follows one at once can be unknown."""
    found = staged("the robot shall always satisfy alive", tmp_path)
    assert not any(one.outcome == "not confirmed" for one in found)
