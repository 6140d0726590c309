"""The commands of the README without POSIX: no `fcntl`, no `resource`, no fork, no timer."""

import json
import os
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

import pytest

from tests.command import Fretc

ROOT = Path(__file__).parent.parent
LOG = "traces/mission-seed15.mcap"
WALK = f"""
0 requirements/r1.fret --emit monitor
0 check
0 check --requirements requirements/agv
0 audit {LOG}
0 audit {LOG} second.mcap --jobs 2 -o build/two.json
2 audit {LOG} --time 10s
0 report
0 explain R1
0 test requirements/r1.fret
0 analyze requirements/r1.fret
0 verify requirements/r1.fret --monitor
0 watch {LOG}
"""
"""An exit status and a command in each line."""


def started(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A process as on such a system."""
    places = os.pathsep.join((str(ROOT / "tests/other_system"), str(ROOT)))
    environment = {**os.environ, "PYTHONPATH": places, "XDG_STATE_HOME": str(folder / "state")}
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def lines(printed: str, begin: str) -> list[str]:
    return [line for line in printed.splitlines() if line.startswith(begin)]


def test_what_is_hidden_cannot_be_imported_or_found(tmp_path: Path) -> None:
    script = "import os; print(hasattr(os, 'fork'), hasattr(os, 'getpid')); import resource"
    done = started("-c", script, folder=tmp_path)
    assert done.stdout == "False True\n"
    assert done.stderr.endswith("ModuleNotFoundError: No module named 'resource'\n")


WALKED = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from fretc.cli import main

for line in sys.argv[1].strip().splitlines():
    status, _, words = line.partition(" ")
    sys.argv[1:] = words.split()
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            said = [line, end.code or 0, out.getvalue(), err.getvalue()]
            print(json.dumps(said), file=sys.__stdout__)
"""


@pytest.mark.slow
def test_every_command_of_the_readme_works(tmp_path: Path) -> None:
    for name in ("requirements", "traces"):
        shutil.copytree(ROOT / name, tmp_path / name)
    shutil.copyfile(ROOT / LOG, tmp_path / "second.mcap")
    done = started("-c", WALKED, WALK, folder=tmp_path)
    assert done.stderr == ""
    found = [json.loads(line) for line in done.stdout.splitlines()]
    assert [line for line, *_ in found] == WALK.strip().splitlines()
    for line, status, out, err in found:
        assert int(line[0]) == status, (line, out, err)
        assert "F999" not in err, (line, err)
    said = {line.split()[1]: err for line, _, _, err in found}
    assert said["analyze"].count("F932 note: this operating system cannot fork a process") == 1
    assert said["test"].count("F932") == 1
    evidence = json.loads((tmp_path / "build/evidence.json").read_text(encoding="utf-8"))
    assert [result["verdict"] for result in evidence["results"]] == ["satisfied"]
    proofs = json.loads((tmp_path / "build/verification.json").read_text(encoding="utf-8"))
    assert [proof["result"] for proof in proofs["evidence"]] == ["proved"]


WORDS = ("test", "requirements/r1.fret", "-o", "-")
CALLS = """
from fretc.verification.engines.sandbox import CallLimits, confined
from tests.test_other_systems import double, endless, growing

if __name__ == "__main__":
    limits = CallLimits(seconds=1, memory=2**28)
    print(confined(limits, endless).reason)
    print(confined(limits, growing).reason)
    print(confined(limits, double, 21))
"""


@pytest.mark.slow
def test_files_with_line_ends_of_windows_mean_the_same(fretc: Fretc, tmp_path: Path) -> None:
    said = []
    for name in ("lf", "crlf"):
        folder = tmp_path / name / "requirements"
        shutil.copytree(ROOT / "requirements", folder)
        for path in folder.rglob("*") if name == "crlf" else ():
            if path.is_file():
                path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
        with chdir(tmp_path / name):
            check = fretc("check", "--requirements", "requirements/agv")
            agv = fretc("requirements/agv", "--format", "json")
            said.append((check, agv, fretc("requirements/r1.fret")))
    assert said[0] == said[1]


@pytest.mark.slow
def test_an_output_does_not_depend_on_the_order_of_hashes() -> None:
    found = set()
    for seed in ("5", "7"):
        done = subprocess.run(
            [sys.executable, "-c", "from fretc.start import main; main()", *WORDS],
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            check=True,
        )
        found.add(done.stdout)
    assert len(found) == 1


@pytest.mark.slow
def test_a_call_that_takes_too_much_is_ended_by_a_thread(tmp_path: Path) -> None:
    (tmp_path / "calls.py").write_text(CALLS, encoding="utf-8")
    done = started("calls.py", folder=tmp_path)
    assert done.stdout.splitlines() == [
        "out of time: more than 1 CPU seconds",
        "out of memory: more than 0.25 GiB",
        "42",
    ]
    assert done.stderr == ""


def endless() -> None:
    while True:
        pass


def growing() -> None:
    kept: list[bytes] = []
    while True:
        kept.append(bytes([1]) * 2**20)


def double(number: int) -> int:
    return 2 * number
