"""`fretc test --against` and `--emit` as their users meet them."""

import json
import sys
from pathlib import Path
from shlex import join

import pytest

from tests.command import Fretc
from tests.fretc.commands.test_analyze import written
from tests.fretc.testing.controllers import INPUTS, OUTPUTS, PROMISE, SENTENCES, program

ROLES = {**dict.fromkeys(INPUTS, "input"), **dict.fromkeys(OUTPUTS, "output")}
ASSUMED = f'[[assume.requirement]]\nid = "A1"\nsentence = "{PROMISE}"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return written(tmp_path, SENTENCES, ROLES, ASSUMED)


def command(folder: Path, fault: str | None) -> str:
    path = folder / "line.py"
    path.write_text(program(fault))
    return join([sys.executable, "-ISE", str(path)])


@pytest.mark.slow
def test_a_violation_is_shown_tick_by_tick(fretc: Fretc, folder: Path) -> None:
    place = folder / "seen.json"
    what = command(folder, "alarm ends a tick early")
    run = fretc("test", str(folder), "--against", what, "-o", str(place))
    assert run.status == 1
    assert "✘ R3 is violated at tick 2: triggered at tick 0, `alarm` is false at tick 2" in run.out
    assert "    alarm (output)     1  0\n" in run.out
    (failure,) = json.loads(place.read_text())["failures"]
    assert failure["requirement"] == "R3"


def test_a_program_that_ends_does_not_conform(fretc: Fretc, folder: Path) -> None:
    what = join([sys.executable, "-ISE", "-c", "input(); print('alarm,run')"])
    run = fretc("test", str(folder), "--against", what, "-o", str(folder / "seen.json"))
    assert run.status == 2
    assert "F943 " in run.err
    assert "✔" not in run.out
    assert "the test is not complete" in run.out


def test_what_cannot_be_started_is_said(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "--against", str(folder / "none"), "-o", "-")
    assert run.status == 2
    assert "F940 " in run.err


@pytest.mark.parametrize("text", ["", "'a"])
def test_no_command_is_bad_use(fretc: Fretc, folder: Path, text: str) -> None:
    run = fretc("test", str(folder), "--against", text)
    assert run.status == 2
    assert "names no program" in run.err


@pytest.mark.slow
@pytest.mark.parametrize(("form", "file"), [("pytest", "test_r1.py"), ("csv", "tests.csv")])
def test_tests_are_emitted(fretc: Fretc, folder: Path, form: str, file: str) -> None:
    out = folder / "out"
    run = fretc("test", str(folder), "-o", "-", "--emit", form, "--emit-to", str(out))
    assert run.status == 0
    assert (out / form / file).is_file()
