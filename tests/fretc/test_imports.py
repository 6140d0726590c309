"""How fast a command starts, as what it does not import."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.each import each

ROOT = Path(__file__).parents[2]
R1 = "requirements/r1.fret"
LOG = "traces/mission-seed15.mcap"
ALWAYS = {
    "asyncio",
    "cyclonedds",
    "dask",
    "importlib.metadata",
    "matplotlib",
    "mujoco",
    "numpy.ma",
}
ALWAYS |= {
    "foxglove",
    "lark",
    "pyarrow",
    "rosbags",
    "spot",
    "websockets",
    "xml",
    "z3",
    "zenoh",
    "zipfile",
}
TEXTS = ALWAYS | {
    "fretish.syntax_errors",
    "mcap",
    "multiprocessing",
    "numpy",
    "socket",
    "subprocess",
    "zstandard",
}
HELP = TEXTS | {"jinja2", "tomllib"}
REPORT = ALWAYS | {"compiler.targets.ajpf.bundle", "mcap", "multiprocessing", "numpy", "socket"}
COMMANDS: dict[tuple[str, ...], set[str]] = {
    ("--version",): HELP | {"compiler.logic.formula", "difflib", "msgspec"},
    ("--help",): HELP,
    (R1,): TEXTS,
    (R1, "--emit", "monitor", "-o", "-"): TEXTS,
    ("check",): TEXTS,
    ("audit", LOG, "--requirements", R1, "-o", "-"): ALWAYS,
}
"""Commands, and what is heavy and none of their business."""
RUN = """
import json, sys
from fretc.cli import main
try:
    main()
except SystemExit as exit_:
    sys.stderr.write(json.dumps([exit_.code, *sys.modules]))
"""


@pytest.mark.slow
@each("command", COMMANDS)
def test_a_command_imports_only_what_it_needs(command: tuple[str, ...]) -> None:
    assert not COMMANDS[command] & imported(command)


@pytest.mark.slow
def test_a_report_of_runs_without_a_violation_computes_nothing_with_arrays(tmp_path: Path) -> None:
    evidence = str(tmp_path / "evidence.json")
    common = ("--requirements", R1)
    assert "numpy" in imported(("audit", LOG, *common, "-o", evidence))
    command = ("report", *common, "--evidence", evidence, "-o", str(tmp_path / "report"))
    assert not REPORT & imported(command)


def imported(command: tuple[str, ...]) -> set[str]:
    """The modules that a command has loaded when it ends."""
    run = subprocess.run(
        [sys.executable, "-c", RUN, *command],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    status, *modules = json.loads(run.stderr.splitlines()[-1])
    assert status in (0, 1, 3)
    return set(modules)
