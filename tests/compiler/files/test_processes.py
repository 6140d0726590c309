"""Side files: modules that lie where a command runs, or beside a generated file."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.command import Fretc
from tests.effort import FULL, some

ROOT = Path(__file__).parents[3]
FRETC = str(Path(sys.executable).parent / "fretc")
OURS = ("fretish", "monitors", "compiler", "fretc", "simulation")
OTHERS = ("numpy", "click", "lark", "mcap", "yaml", "z3", "dask", "distributed", "tornado")
EXECUTED = "EXECUTED"
HOSTILE = f"""\
import os
os.write(os.open({EXECUTED!r}, os.O_CREAT | os.O_APPEND | os.O_WRONLY), (__name__ + " ").encode())
"""


def surrounded(folder: Path, *, but: Sequence[str] = ()) -> None:
    """Put a module of every name that we import into the folder."""
    for name in {*sys.stdlib_module_names, *OURS, *OTHERS} - {*but}:
        (folder / f"{name}.py").write_text(HOSTILE.replace(EXECUTED, str(folder / EXECUTED)))


def run(*command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    free = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
    return subprocess.run(
        command, cwd=folder, env=free, capture_output=True, text=True, timeout=300, check=False
    )


def executed(folder: Path) -> str:
    path = folder / EXECUTED
    return path.read_text() if path.exists() else ""


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with requirements, two logs and a module of every name.

    Another one for each test would take longer than the test.
    """
    folder = tmp_path_factory.mktemp("hostile")
    (folder / "requirements").symlink_to(ROOT / "requirements")
    for name in ("a.mcap", "b.mcap"):
        (folder / name).symlink_to(ROOT / "traces/mission-seed15.mcap")
    surrounded(folder)
    return folder


@pytest.fixture(autouse=True)
def _nothing_executed(hostile: Path) -> None:
    (hostile / EXECUTED).unlink(missing_ok=True)


def test_the_modules_are_executed_where_nobody_keeps_them_out(hostile: Path) -> None:
    run(sys.executable, "-c", "import json", folder=hostile)
    assert executed(hostile)


BEGUN_ANEW = [
    ["requirements/r1.fret", "--emit", "monitor", "--emit", "interceptor"],
    ["verify", "requirements/r1.fret", "--layer", "monitor"],
    ["audit", "a.mcap", "b.mcap", "--jobs", "1", "--engine", "dask"],
]
"""A plain command; and those that begin other processes, which look for modules again."""
IN_ONE_PROCESS = [
    ["verify", "requirements/r1.fret", "--layer", "loop"],
    ["audit", "a.mcap", "b.mcap", "--jobs", "2"],
    ["audit", "a.mcap", "--parquet", "table.parquet"],
    ["check"],
    ["report"],
    ["explain", "requirements/r1.fret"],
]
"""In one process, or in copies of it."""


@pytest.mark.slow
@pytest.mark.parametrize("command", [*BEGUN_ANEW, *(IN_ONE_PROCESS if FULL else ())], ids=" ".join)
def test_no_command_executes_what_lies_in_the_present_folder(
    hostile: Path, command: list[str]
) -> None:
    done = run(FRETC, *command, folder=hostile)
    assert executed(hostile) == ""
    assert "Traceback" not in done.stderr
    assert done.returncode in (0, 1, 3), done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("target", "file", "arguments", "status"),
    [
        ("monitor", "r1_monitor.py", ["trace.csv", "--engine", "online", "--format", "json"], 3),
        ("interceptor", "interceptor.py", ["--help"], 0),
        *([("monitor", "r1_monitor.py", ["trace.csv"], 3)] * FULL),
    ],
)
def test_a_generated_file_executes_nothing_that_lies_beside_it(
    fretc: Fretc, tmp_path: Path, target: str, file: str, arguments: list[str], status: int
) -> None:
    here, build = tmp_path / "here", tmp_path / "here/build"
    build.mkdir(parents=True)
    emitted = fretc(str(ROOT / "requirements/r1.fret"), "--emit", target, "--output", str(build))
    assert emitted.status == 0, emitted.err
    (here / "trace.csv").write_text("too_close,stopped\n1,0\n")
    surrounded(build)
    done = run(sys.executable, f"build/{file}", *arguments, folder=here)
    assert executed(build) == ""
    assert (done.returncode, done.stderr) == (status, "")


@pytest.mark.slow
@pytest.mark.parametrize("option", some(["-P", "-I"], 2))
def test_a_generated_monitor_runs_where_python_leaves_its_folder_out_itself(
    fretc: Fretc, tmp_path: Path, option: str
) -> None:
    fretc(str(ROOT / "requirements/r1.fret"), "--emit", "monitor")
    (tmp_path / "trace.csv").write_text("too_close,stopped\n1,0\n0,1\n")
    done = run(sys.executable, option, "build/r1_monitor.py", "trace.csv", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_a_generated_monitor_is_imported_without_a_change_of_the_path(
    fretc: Fretc, tmp_path: Path
) -> None:
    fretc(str(ROOT / "requirements/r1.fret"), "--emit", "monitor")
    code = "import sys; before = [*sys.path]; import r1_monitor; print(sys.path == before)"
    done = run(sys.executable, "-c", code, folder=tmp_path / "build")
    assert (done.stdout, done.stderr) == ("True\n", "")
