"""The script of a bundle: its verdicts, and that nothing but a verdict is taken for one."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from compiler.ajpf_run import ERROR, HOLDS, VIOLATED, verdict
from compiler.targets.bundle import emit
from tests.compiler.targets.test_bundle import R1, rule

SAYS_HOLDS = "====== results\nno errors detected\n====== statistics\n"
SAYS_VIOLATED = (
    "====== error 1\najpf.MCAPLListener\nAn Accepting Path has been found: \n(MS: 0)\n"
    '====== results\nerror #1: ajpf.MCAPLListener "An Accepting Path has been found: ..."\n'
)
CRASH = "====== results\nerror #1: gov.nasa.jpf.vm.NoUncaughtExceptionsProperty\n"


@pytest.mark.parametrize(
    ("text", "status", "expected"),
    [
        (SAYS_HOLDS, 0, HOLDS),
        (SAYS_VIOLATED, 0, VIOLATED),
        (SAYS_VIOLATED, 1, VIOLATED),
        ("", 0, ERROR),
        ("no verdict at all", 0, ERROR),
        (SAYS_HOLDS, 1, ERROR),
        (SAYS_HOLDS, -9, ERROR),
        (SAYS_VIOLATED, -9, ERROR),
        (CRASH, 0, ERROR),
        (f"{SAYS_HOLDS}{CRASH}", 0, ERROR),
        (f"line 1:2 mismatched input 'X'\n{SAYS_HOLDS}", 0, ERROR),
        (f"line 1:2 mismatched input 'X'\n{SAYS_VIOLATED}", 0, ERROR),
        (f"{SAYS_HOLDS}{SAYS_VIOLATED}", 0, ERROR),
        (f"search constraint encountered, eventualities not checked\n{SAYS_HOLDS}", 0, ERROR),
        ("Exception in thread main java.lang.NullPointerException", 1, ERROR),
    ],
)
def test_only_a_clear_verdict_is_one(text: str, status: int, expected: str) -> None:
    told, why = verdict(text, status)
    assert told == expected
    assert bool(why) is (expected == ERROR)


EXPECTED = {
    "R1.jpf": (SAYS_HOLDS, 0),
    "R1_reach.jpf": (SAYS_VIOLATED, 0),
    "R1_resp.jpf": (SAYS_VIOLATED, 0),
    "R1_mutant.jpf": (SAYS_VIOLATED, 0),
}


class Mcapl:
    """A folder of MCAPL with a Java beside it that says what it is told to say."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.bundle = folder / "r1_ajpf"
        for artifact in emit([rule(R1)]):
            self.write(folder / artifact.path, artifact.text)
        self.write(folder / "mcapl/lib/3rdparty/RunJPF.jar", "")
        self.tool("javac", '[ "$1" = --release ] && [ "$2" = 11 ] && mkdir -p classes')
        self.tool("java", 'shift $(($# - 1)); cat "$SAID/$1.txt"; exit "$(cat "$SAID/$1.status")"')
        self.says({})

    def write(self, path: Path, text: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def tool(self, name: str, script: str) -> None:
        self.write(self.folder / "bin" / name, f"#!/bin/sh\n{script}\n")
        (self.folder / "bin" / name).chmod(0o755)

    def says(self, other: dict[str, tuple[str, int]]) -> None:
        for name, (text, status) in {**EXPECTED, **other}.items():
            self.write(self.folder / f"said/{name}.txt", text)
            self.write(self.folder / f"said/{name}.status", str(status))

    def run(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        path = f"{self.folder / 'bin'}{os.pathsep}{os.environ['PATH']}"
        given = {
            "PATH": path,
            "AJPF_HOME": str(self.folder / "mcapl"),
            "SAID": str(self.folder / "said"),
            **environment,
        }
        return subprocess.run(
            [sys.executable, "-I", str(self.bundle / "run.py"), *arguments],
            env=given,
            capture_output=True,
            text=True,
            timeout=60,
        )


@pytest.fixture
def mcapl(tmp_path: Path) -> Mcapl:
    return Mcapl(tmp_path)


def test_all_as_expected_is_shown(mcapl: Mcapl) -> None:
    done = mcapl.run()
    assert done.returncode == 0, done.stderr
    assert done.stdout == (
        "R1.jpf: HOLDS, as expected\n"
        "R1_reach.jpf: VIOLATED, as expected\n"
        "R1_resp.jpf: VIOLATED, as expected\n"
        "R1_mutant.jpf: VIOLATED, as expected\n"
        "AJPF says all that is expected of it\n"
    )
    assert (mcapl.bundle / "logs/R1.jpf.txt").read_text() == SAYS_HOLDS


@pytest.mark.parametrize(
    ("said", "status", "line"),
    [
        ({"R1.jpf": (SAYS_VIOLATED, 0)}, 1, "R1.jpf: VIOLATED, EXPECTED HOLDS"),
        ({"R1_reach.jpf": (SAYS_HOLDS, 0)}, 3, "R1_reach.jpf: HOLDS, EXPECTED VIOLATED"),
        ({"R1_mutant.jpf": (SAYS_HOLDS, 0)}, 3, "R1_mutant.jpf: HOLDS, EXPECTED VIOLATED"),
        ({"R1.jpf": ("", 0)}, 3, "R1.jpf: ERROR, EXPECTED HOLDS (no verdict in the output, "),
        ({"R1.jpf": ("Exception", 1)}, 3, "R1.jpf: ERROR, EXPECTED HOLDS (no verdict"),
        (
            {"R1_resp.jpf": (f"line 1:2 extra\n{SAYS_VIOLATED}", 0)},
            3,
            "R1_resp.jpf: ERROR, EXPECTED VIOLATED (a file was misread: line 1:2 extra)",
        ),
        ({"R1.jpf": (SAYS_VIOLATED, 0), "R1_resp.jpf": ("", 0)}, 1, "AJPF refutes the requirement"),
    ],
)
def test_what_is_not_expected_is_no_success(
    mcapl: Mcapl, said: dict[str, tuple[str, int]], status: int, line: str
) -> None:
    mcapl.says(said)
    done = mcapl.run()
    assert done.returncode == status
    assert line in done.stdout


def test_an_answer_that_does_not_come_is_none(mcapl: Mcapl) -> None:
    mcapl.tool("java", "exec sleep 30")
    done = mcapl.run("--timeout", "0.1")
    assert done.returncode == 3
    assert "R1.jpf: ERROR, EXPECTED HOLDS (no answer in 0.1 seconds)" in done.stdout


def test_without_ajpf_nothing_is_run(mcapl: Mcapl, tmp_path: Path) -> None:
    for environment, told in (
        ({"AJPF_HOME": ""}, "set AJPF_HOME to the folder of MCAPL"),
        ({"AJPF_HOME": str(tmp_path / "nowhere")}, "set AJPF_HOME to the folder of MCAPL"),
        ({"AJPF_HOME": str(tmp_path / "said")}, "there is no RunJPF.jar below"),
        ({"PATH": str(tmp_path / "said")}, "java and javac are needed"),
    ):
        done = mcapl.run(**environment)
        assert done.returncode == 2
        assert told in done.stderr
        assert done.stdout == ""


def test_an_environment_that_does_not_compile_is_told(mcapl: Mcapl) -> None:
    mcapl.tool("javac", "echo 'Env.java:3: error' >&2; exit 1")
    done = mcapl.run()
    assert done.returncode == 2
    assert "Env.java does not compile:\nEnv.java:3: error" in done.stderr


def test_a_file_that_was_changed_is_not_verified(mcapl: Mcapl) -> None:
    (mcapl.bundle / "SIF.gwen").write_text("GWENDOLEN")
    done = mcapl.run()
    assert done.returncode == 2
    assert done.stderr == "error: SIF.gwen is not the file that manifest.json tells of\n"


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"files": {}, "checks": []}'])
def test_a_manifest_that_says_nothing_is_no_success(mcapl: Mcapl, text: str) -> None:
    (mcapl.bundle / "manifest.json").write_text(text)
    assert mcapl.run().returncode == 2


def test_a_manifest_without_its_controls_is_no_success(mcapl: Mcapl) -> None:
    manifest = json.loads((mcapl.bundle / "manifest.json").read_text())
    manifest["checks"] = manifest["checks"][:1]
    (mcapl.bundle / "manifest.json").write_text(json.dumps(manifest))
    assert mcapl.run().returncode == 2


def test_a_folder_that_ajpf_cannot_name_is_refused(tmp_path: Path) -> None:
    done = Mcapl(tmp_path / "my folder").run()
    assert done.returncode == 2
    assert "AJPF cannot read a path with a space or a comma" in done.stderr
