"""What is installed is what is in the tree, and it works without the tree."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.command import PROCESS
from tests.effort import FULL

pytestmark = pytest.mark.slow

SECONDS = "1" if FULL else "0.1"

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (built,) = folder.glob("*.whl")
    return built


def test_the_top_level_is_exactly_our_packages(wheel: Path) -> None:
    names = {name.partition("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {name for name in names if not name.endswith(".dist-info")} == {
        "fretish",
        "monitors",
        "compiler",
        "fretc",
        "simulation",
    }


def test_every_module_grammar_and_template_is_inside(wheel: Path) -> None:
    packed = set(zipfile.ZipFile(wheel).namelist())
    for package in ("fretish", "monitors", "compiler", "fretc", "simulation"):
        for path in (ROOT / package).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                assert str(path.relative_to(ROOT)) in packed
    for path in (ROOT / "templates").rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            assert f"compiler/{path.relative_to(ROOT)}" in packed
    sentence = zipfile.ZipFile(wheel).read("compiler/requirements/mission/r01.fret")
    assert sentence == (ROOT / "requirements/r1.fret").read_bytes()


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("installed")
    zipfile.ZipFile(wheel).extractall(folder)
    return folder


def ran(installed: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the installed command in a folder."""
    return subprocess.run(
        [*PROCESS, *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_it_makes_a_monitor_far_from_the_checkout(installed: Path, tmp_path: Path) -> None:
    sentence = tmp_path / "r.fret"
    sentence.write_text("whenever p the rover shall eventually satisfy q", encoding="utf-8")
    run = ran(installed, tmp_path, "r.fret", "--emit", "monitor", "-o", "out")
    assert (run.returncode, run.stdout) == (0, "")
    assert (tmp_path / "out" / "r_monitor.py").is_file()


def test_it_simulates_far_from_the_checkout(installed: Path, tmp_path: Path) -> None:
    run = ran(installed, tmp_path, "simulate", "walker", "--duration", SECONDS, "-o", "run.mcap")
    assert (run.returncode, run.stderr) == (0, "wrote run.mcap\n")
