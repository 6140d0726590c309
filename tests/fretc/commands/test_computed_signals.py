"""Computed signals in every command: one log, and what NumPy computes of its numbers."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import copyfile
from typing import Any

import numpy as np
import pytest

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from tests.command import Fretc
from tests.fretc.logs.logs import declare
from tests.test_layers import ROOT

LOG = ROOT / "traces/mission-seed15.mcap"
BINDINGS = """
[clock]
tick = "100 ms"
time = "log_time"

[signal.x]
path = "/odom.pose.pose.position.x"
unit = "m"

[signal.y]
path = "/odom.pose.pose.position.y"
unit = "m"

[signal.vx]
path = "/odom.twist.twist.linear.x"
unit = "m/s"

[signal.distance]
value = "hypot(x, y - 1 m)"
unit = "cm"

[signal.speed]
value = "clamp(abs(vx), 0 m/s, 1 m/s)"

[proposition.slow]
expr = "speed < 0.1 m/s"
"""
FRET = """
+++
id = "NEAR"
+++
the robot shall always satisfy distance < 500
+++
id = "SLOW"
+++
whenever distance > 200 the robot shall within 2 seconds satisfy slow
"""


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "requirements"
    folder.mkdir()
    (folder / "bindings.toml").write_text(BINDINGS)
    (folder / "all.fret").write_text(FRET)
    monkeypatch.chdir(tmp_path)
    copyfile(LOG, "run.mcap")
    return folder


def recorded() -> Recording:
    found = read(str(LOG), declare(BINDINGS), ["x", "y", "vx"])
    assert isinstance(found, Recording)
    return found


def far_ticks() -> list[int]:
    """The ticks at which the last position is 5 m or more from (0, 1), by NumPy alone."""
    log = recorded()
    x, y = log.samples["x"], log.samples["y"]
    ticks = np.arange(log.start_ns, log.end_ns + 1, 10**8)
    at_x = x.values[np.searchsorted(x.times, ticks, "right") - 1]
    at_y = y.values[np.searchsorted(y.times, ticks, "right") - 1]
    return np.nonzero(np.sqrt(at_x**2 + (at_y - 1) ** 2) >= 5)[0].tolist()


@pytest.mark.slow
def test_an_audit_gives_the_verdict_of_an_independent_computation(
    fretc: Fretc, project: Path
) -> None:
    run = fretc("audit", "run.mcap")
    assert run.status == 1
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    near = next(each for each in results if each["requirement"] == "NEAR")
    broken = [
        tick
        for violation in near["violations"]
        for tick in range(violation["first_tick"], violation["last_tick"] + 1)
    ]
    assert broken == far_ticks()
    assert 0 < len(broken) < 900

    (first, *_) = near["violations"]
    assert set(first["values"]) == {"x", "y", "distance"}
    numbers = first["values"]
    assert numbers["distance"] == np.sqrt(numbers["x"] ** 2 + (numbers["y"] - 1) ** 2)
    assert near["units"] == {"x": "m", "y": "m", "distance": "m"}


@pytest.mark.slow
def test_every_command_reads_a_computed_signal(fretc: Fretc, project: Path) -> None:
    assert fretc("check").status == 0
    assert fretc("audit", "run.mcap").status == 1
    watched = fretc("watch", "run.mcap", "--format", "jsonl")
    last = {
        line["requirement"]: line["verdict"]
        for line in map(json.loads, watched.out.splitlines())
        if line.get("requirement") and line.get("verdict")
    }
    assert last == {"NEAR": "violated", "SLOW": "violated"}
    bind = fretc("bind", "--check", "run.mcap")
    assert "    distance = hypot(x, y - 1 m) cm\n" in bind.out
    assert "    speed = clamp(abs(vx), 0 m/s, 1 m/s) m/s\n" in bind.out
    coverage = fretc("coverage")
    assert "`distance` one step above the threshold of `distance > 200 cm`" in coverage.out
    assert fretc("report", "-o", "r.html").status == 0
    page = Path("r.html").read_text()
    assert "hypot(x, y - 1 m)" in page
    again = fretc("verify-evidence", "build/evidence.json")
    assert (again.status, again.err) == (0, "")
    review = ("--reviewer", "A", "--role", "b", "--comment", "c", "--accept-violations")
    assert fretc("lock", *review).status == 0
    bindings = project / "bindings.toml"
    bindings.write_text(BINDINGS.replace("y - 1 m", "y - 2 m"))
    diff = fretc("diff")
    assert diff.status != 0
    assert "distance: hypot(x, y - 1 m → 2 m" in diff.out


@pytest.mark.slow
def test_what_sentences_state_of_a_computed_signal_is_compared(fretc: Fretc, project: Path) -> None:
    text = '+++\nid = "R1"\nparams = { distance = "5 m" }\n+++\n' + FRET.splitlines()[4] + "\n"
    (project / "all.fret").write_text(text)
    assert "F310" not in fretc("check").out
    (project / "all.fret").write_text(text.replace("5 m", "6 m"))
    assert "F310" in fretc("check").err + fretc("check").out


def roles(**numbers: str) -> str:
    tables = "".join(
        f'[signal.{name}]\n{value}\nrole = "output"\n' for name, value in numbers.items()
    )
    return '[clock]\ntick = "100 ms"\n' + tables


def analyzed(fretc: Fretc, folder: Path, bindings: str, *sentences: str) -> Any:
    (folder / "bindings.toml").write_text(bindings)
    texts = (f'+++\nid = "R{i}"\n+++\n{text}\n' for i, text in enumerate(sentences))
    (folder / "all.fret").write_text("".join(texts))
    return fretc("analyze")


@pytest.mark.slow
def test_an_analysis_knows_that_a_computed_signal_depends_on_others(
    fretc: Fretc, project: Path
) -> None:
    bindings = roles(
        x='path = "/x.data"\nunit = "m"',
        ahead='value = "x - 1 m"\nunit = "cm"',
        square='value = "sqrt(x * x)"',
    )
    always = "the robot shall always satisfy"
    fight = analyzed(fretc, project, bindings, f"{always} ahead > 100", f"{always} x < 1")
    assert fight.status == 1
    assert "R0 and R1 cannot be satisfied together" in fight.out
    good = analyzed(fretc, project, bindings, f"{always} ahead > 100", f"{always} x < 3")
    assert good.status == 0
    order = analyzed(fretc, project, bindings, f"{always} square > 7", f"{always} square < 5")
    assert order.status == 1
    unknown = analyzed(fretc, project, bindings, f"{always} square > 7", f"{always} x < 5")
    assert unknown.status == 3
    assert "read the same numbers, and are treated as independent" in unknown.out
