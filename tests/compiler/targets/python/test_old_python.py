"""What is emitted for robots runs on Python 3.8 and 3.9, and gives the same results there."""

import random
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from compiler.targets.python import interceptor, monitor
from monitors.interceptor import (
    CommandHeard,
    Options,
    ScanHeard,
    State,
    StopHeard,
    TimerRang,
    Velocity,
    step,
)
from tests.compiler.targets.ros.test_package import described, written
from tests.effort import some
from tests.monitoring import requirement
from tests.programs import python
from tests.strategies import few_templates

VERSIONS = ("3.8", "3.9")
VALUES = ("0", "1", "")
COMPARISONS = (
    "when docking the sw shall within 3 ticks satisfy battery < 0.5",
    "the sw shall always satisfy preReal(0.5, speed) <= maxReal(speed, 1 / 3)",
)
STEPS = """
import sys
sys.path.insert(0, sys.argv[1])
from gate import *
for hold, latching, stop, held, age in EVERY:
    options = Options(hold, 2, 0, 2, latching=latching)
    state = State(stop, held, Velocity(0.5), age, 0, 1)
    for event in (StopHeard(True), StopHeard(False), CommandHeard(ZERO), ScanHeard(), TimerRang()):
        print(step(state, event, options))
"""
STATES = [*product((0, 2), (False, True), (False, True), (0, 1), (0, 2))]


def run(*command: str, folder: Path) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1, 3), done.stderr
    assert done.stderr == ""
    return done.stdout


TEMPLATES = [requirement(t.sentence, f"T{i}") for i, t in enumerate(few_templates((0, 3)))]
NUMBERS = [requirement(sentence, f"N{i}") for i, sentence in enumerate(COMPARISONS)]


def table(names: Sequence[str], ticks: int) -> str:
    choose = random.Random(ticks)
    rows = (",".join(choose.choices(VALUES, (9, 9, 1), k=len(names))) for _ in range(ticks))
    return "\n".join([",".join(names), *rows]) + "\n"


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_monitors_of_all_templates_give_the_same_outcomes(version: str, tmp_path: Path) -> None:
    """By columns and step by step, as the Python of the other tests."""
    old = python(version)
    for emitted, names in ((TEMPLATES, "mpqs"), (NUMBERS, ("docking", "battery", "speed"))):
        (tmp_path / "all.py").write_text(monitor.text(*emitted))
        for ticks in (1, 7, 200):
            (tmp_path / "trace.csv").write_text(table(names, ticks))
            for engine in ("columns", "online"):
                command = ("all.py", "trace.csv", "--format", "json", "--engine", engine)
                said = run(old, *command, folder=tmp_path)
                assert said == run(sys.executable, *command, folder=tmp_path)
                assert said.count('"verdict"') == len(emitted)


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("path", ["requirements/agv", "requirements/r1.fret"])
def test_packages_pass_their_own_tests(version: str, path: str, tmp_path: Path) -> None:
    """Each of the shortest runs to a verdict, which come from the definition of the language."""
    own = written(described(path), tmp_path)
    command = [python(version), "-m", "unittest", "discover", "test"]
    done = subprocess.run(command, cwd=own, capture_output=True, text=True, check=False)
    assert (done.returncode, "Ran 5 tests" in done.stderr) == (0, True), done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_the_core_of_an_interceptor_makes_the_same_steps(version: str, tmp_path: Path) -> None:
    node = described("requirements/r1.fret").interception
    assert node is not None
    (tmp_path / "gate.py").write_text(interceptor.text(node, "bindings.toml"))
    script = STEPS.replace("EVERY", repr(STATES))
    expected = [
        repr(step(State(stop, held, Velocity(0.5), age, 0, 1), event, options))
        for hold, latching, stop, held, age in STATES
        for options in [Options(hold, 2, 0, 2, latching=latching)]
        for event in (
            *(StopHeard(True), StopHeard(False)),
            *(CommandHeard(Velocity()), ScanHeard(), TimerRang()),
        )
    ]
    said = run(python(version), "-c", script, str(tmp_path), folder=tmp_path)
    assert said.splitlines() == expected


@pytest.mark.slow
def test_no_emitted_text_asks_for_more_than_python_3_8(tmp_path: Path) -> None:
    """The annotations are texts, which vermin reads and Python does not evaluate."""
    (tmp_path / "all.py").write_text(monitor.text(*TEMPLATES))
    for path in some(("requirements/agv", "requirements/r1.fret"), 2):
        written(described(path), tmp_path)
    node = described("requirements/r1.fret").interception
    assert node is not None
    for ros in (1, 2):
        text = interceptor.text(replace(node, ros=ros), "bindings.toml")
        (tmp_path / f"interceptor{ros}.py").write_text(text)
    command = [str(Path(sys.executable).with_name("vermin")), "--no-tips", "--violations"]
    done = subprocess.run(
        [*command, "-t=3.8-", str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, "Minimum required versions: 3.8" in done.stdout) == (0, True), done
