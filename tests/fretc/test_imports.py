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
ALWAYS |= {"foxglove", "pyarrow", "rosbags", "spot", "websockets", "xml", "z3", "zipfile"}
TEXTS = ALWAYS | {"mcap", "multiprocessing", "numpy", "socket", "subprocess", "zstandard"}
HELP = TEXTS | {"jinja2", "lark", "tomllib"}
COMMANDS: dict[tuple[str, ...], set[str]] = {
    ("--version",): HELP | {"difflib", "msgspec"},
    ("--help",): HELP,
    (R1,): TEXTS,
    (R1, "--emit", "monitor", "-o", "-"): TEXTS,
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
    assert not COMMANDS[command] & set(modules)
