"""The text of samples in C compiles where it is exact, without a warning, and nowhere else."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from compiler.project.folder import load
from compiler.targets.c.monitor import TARGET
from compiler.targets.target import TargetOptions
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Proposition, Signal
from fretish.bindings.declarations import Path as Place
from fretish.clock import Clock
from fretish.diagnostics.source import Source
from fretish.units import ONE
from tests.c_monitors import STRICT
from tests.each import each
from tests.effort import some
from tests.emitting import requirement
from tests.programs import installed

ROOT = Path(__file__).parents[4]


@pytest.mark.slow
@each("folder", some(["requirements/mission", "requirements/agv", "requirements"], 3))
@pytest.mark.parametrize(
    "command",
    [
        ["gcc", *STRICT],
        ["clang", *STRICT],
        ["gcc", *STRICT, "-m32", "-msse2", "-mfpmath=sse", "-ffreestanding"],
        ["g++", "-x", "c++", "-std=c++17", *STRICT[1:]],
    ],
)
def test_the_projects_of_this_repository_compile_without_a_warning(
    folder: str, command: list[str], tmp_path: Path
) -> None:
    project = load([str(path) for path in sorted(ROOT.joinpath(folder).glob("*.fret"))])
    for file in TARGET.emit(project.formalized, TargetOptions(one_file=True)):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    compile_ = [installed(command[0]), *command[1:], "-c", "monitors_signals.c", "-o", "x.o"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]


@each("flag", ["-ffast-math", "-ffinite-math-only", "-m32 -mno-sse -ffreestanding"])
def test_inexact_arithmetic_is_no_text_that_compiles(flag: str, tmp_path: Path) -> None:
    project = load([str(ROOT / "requirements/r1.fret")])
    for file in TARGET.emit(project.formalized):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    compile_ = [installed("gcc"), *flag.split(), "-c", "r1_signals.c", "-o", "x.o"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "#error" in done.stderr


@pytest.mark.slow
def test_names_of_one_requirement_are_no_names_of_another(tmp_path: Path) -> None:
    """In one program, with each header in one file: a function is of a signal, or of a monitor."""
    names = ("init", "step", "state", "inputs", "motor_init", "motor_step", "x_sample_init")
    place, declared = Place("/t", ("f",)), e.Or(tuple(map(e.Name, names)))
    signals = {name: Signal(name, place, ONE, "") for name in names}
    bound = {"p": Proposition("p", declared)}
    declarations = Declarations(Source("bindings.toml", ""), Clock(10**8), signals, bound)
    ids = ("R1", "R1_sample", "R1_sample_motor", "R1_sample_x_sample", "R1_step", "R1_samples")
    subjects = [requirement("the sw shall always satisfy p", id) for id in ids]
    requirements = [replace(subject, declarations=declarations) for subject in subjects]
    apart = [file for alone in requirements for file in TARGET.emit([alone])]
    assert [*TARGET.emit(requirements)] == apart
    for file in apart:
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    headers = sorted(path.name for path in tmp_path.glob("*.h"))
    includes = "".join(f'#include "{name}"\n' for name in headers)
    tmp_path.joinpath("main.c").write_text(f"{includes}int main(void) {{ return 0; }}\n")
    sources = sorted(path.name for path in tmp_path.glob("*.c"))
    compile_ = [installed("gcc"), *STRICT, *sources, "-o", "main"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
