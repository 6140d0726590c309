"""Signals of frames in every command: a drive whose poses are known."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.command import Fretc
from tests.fretc.logs.frames.robot import drive
from tests.fretc.logs.logs import write

BINDINGS = """
[clock]
tick = "100 ms"

[signal.x]
frame = "base_link"
in = "map"
path = "x"
unit = "cm"
max_age = "200 ms"
"""
FRET = """
+++
id = "NEAR"
+++
the robot shall always satisfy x < 300
"""

pytestmark = pytest.mark.slow


def test_every_command_reads_a_pose(
    fretc: Fretc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The robot is at `1 + t` metres: at 3 m, 2 s after its start, of which a message says."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "requirements"
    folder.mkdir()
    (folder / "bindings.toml").write_text(BINDINGS)
    (folder / "all.fret").write_text(FRET)
    write(tmp_path / "run.mcap", drive(250))
    assert fretc("check").status == 0
    assert fretc("audit", "run.mcap").status == 1
    (near,) = json.loads(Path("build/evidence.json").read_text())["results"]
    (violation,) = near["violations"]
    # The grid begins 3 ms after the first stamp, with the message of that stamp.
    assert violation["first_tick"] == 20
    assert violation["values"] == {"x": pytest.approx(3.0)}
    watched = fretc("watch", "run.mcap", "--format", "jsonl")
    verdicts = [json.loads(line) for line in watched.out.splitlines() if '"verdict"' in line]
    assert verdicts[-1]["verdict"] == "violated"
    assert "    x = x of base_link in map cm\n" in fretc("bind", "--check", "run.mcap").out
    assert fretc("report", "-o", "r.html").status == 0
    assert "x of base_link in map" in Path("r.html").read_text()
    again = fretc("verify-evidence", "build/evidence.json")
    assert (again.status, again.err) == (0, "")
    review = ("--reviewer", "A", "--role", "b", "--comment", "c", "--accept-violations")
    assert fretc("lock", *review).status == 0
    (folder / "bindings.toml").write_text(BINDINGS.replace('"map"', '"odom"'))
    assert "in of x: map → odom" in fretc("diff").out
