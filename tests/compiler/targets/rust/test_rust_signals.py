"""Crates of samples: Clippy finds nothing, whatever the bindings are."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from compiler.project.folder import load
from compiler.targets.rust.monitor import TARGET
from compiler.targets.target import TargetOptions
from tests.each import each
from tests.effort import FULL, some
from tests.programs import installed
from tests.rust_monitors import write
from tests.signal_policies import collected, numbered

ROOT = Path(__file__).parents[4]


@pytest.mark.slow
@each("folder", some(["", "requirements", "requirements/mission", "requirements/agv"], 4))
def test_clippy_finds_nothing(folder: str, tmp_path: Path) -> None:
    if folder:
        requirements = load(
            [str(path) for path in sorted(ROOT.joinpath(folder).glob("*.fret"))]
        ).formalized
    else:
        requirements = tuple(
            numbered(case, i) for i, case in enumerate(collected(40 if FULL else 15))
        )
    files = TARGET.emit(requirements, TargetOptions(one_file=True))
    write(tmp_path, {str(file.path): file.text for file in files})
    installed("cargo-clippy")
    command = [installed("cargo"), "clippy", "--offline", "--quiet", "--all-targets"]
    done = subprocess.run(
        [*command, "--", "-D", "warnings"],
        cwd=tmp_path / "monitors_signals",
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[:2000]
