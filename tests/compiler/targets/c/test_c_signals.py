"""The text of samples in C compiles where it is exact, without a warning, and nowhere else."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from compiler.project.folder import load
from compiler.targets.c.monitor import TARGET
from compiler.targets.target import Options
from tests.c_monitors import STRICT, compiler
from tests.each import each

ROOT = Path(__file__).parents[4]


@each("folder", ["requirements", "requirements/mission", "requirements/agv"])
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
    for file in TARGET.emit(project.rules, Options(one_file=True)):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    compile_ = [compiler(command[0]), *command[1:], "-c", "monitors_signals.c", "-o", "x.o"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]


@each("flag", ["-ffast-math", "-ffinite-math-only", "-m32 -mno-sse -ffreestanding"])
def test_inexact_arithmetic_is_no_text_that_compiles(flag: str, tmp_path: Path) -> None:
    project = load([str(ROOT / "requirements/r1.fret")])
    for file in TARGET.emit(project.rules):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    compile_ = [compiler("gcc"), *flag.split(), "-c", "r1_signals.c", "-o", "x.o"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "#error" in done.stderr
