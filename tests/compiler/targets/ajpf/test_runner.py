"""The script of a bundle: its verdicts, and that nothing but a verdict is taken for one."""

import fcntl
import hashlib
import io
import json
import os
import subprocess
import sys
import warnings
from contextlib import redirect_stderr, redirect_stdout
from copy import copy
from pathlib import Path
from shutil import copytree
from typing import Any
from unittest.mock import patch

import pytest

from compiler.targets.ajpf import runner
from compiler.targets.ajpf.bundle import emit
from compiler.targets.ajpf.runner import (
    ERROR,
    HOLDS,
    VIOLATED,
    folded,
    states,
    trace,
    verdict,
)
from tests.compiler.targets.ajpf.test_bundle import R1, requirement
from tests.each import each
from tests.json_schemas import validate

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
    answer, why = verdict(text, status)
    assert answer == expected
    assert bool(why) is (expected == ERROR)


EXPECTED = {
    "R1.jpf": (SAYS_HOLDS, 0),
    "R1_reach.jpf": (SAYS_VIOLATED, 0),
    "R1_resp.jpf": (SAYS_VIOLATED, 0),
    "R1_mutant.jpf": (SAYS_VIOLATED, 0),
}


class Mcapl:
    """A folder of MCAPL with a Java beside it that says what it is reported to say."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.bundle = folder / "r1_ajpf"
        for artifact in emit([requirement(R1)]):
            self.write(folder / artifact.path, artifact.text)
        for jar in ("3rdparty/RunJPF.jar", "3rdparty/antlr-4.7.jar", "antlr-4.13.2-complete.jar"):
            self.write(folder / "mcapl/lib" / jar, "")
        self.write(folder / "mcapl/bin/ail/Agent.class", "")
        self.write(folder / "mcapl/.git/HEAD", "ref: refs/heads/main\n")
        self.write(folder / "mcapl/.git/refs/heads/main", f"{'ab' * 20}\n")
        self.tool("javac", '[ "$1" = --release ] && [ "$2" = 11 ] && mkdir -p classes')
        self.java("11.0.22")
        self.says({})

    def copied(self, folder: Path) -> "Mcapl":
        """The same in another folder, with what has run in it."""
        other = copy(self)
        other.folder, other.bundle = folder, folder / self.bundle.name
        copytree(self.folder, folder)
        return other

    def write(self, path: Path, text: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def tool(self, name: str, script: str) -> None:
        self.write(self.folder / "bin" / name, f"#!/bin/sh\n{script}\n")
        (self.folder / "bin" / name).chmod(0o755)

    def java(self, version: str) -> None:
        """One that takes `-cp PATH gov.nasa.jpf.tool.RunJPF FILE` and nothing else."""
        script = f"""case "$1" in
            -version) echo 'openjdk version "{version}" 2024-01-16' >&2; exit 0;;
            -cp) ;;
            *) echo "not by class path: $1"; exit 9;;
        esac
        echo "$2" > "$SAID/class_path"
        [ "$3" = gov.nasa.jpf.tool.RunJPF ] || exit 9
        name=$(basename "$4"); cp "$4" "$SAID/$name.given"
        cat "$SAID/$name.txt"; exit "$(cat "$SAID/$name.status")\""""
        self.tool("java", script)

    def says(self, other: dict[str, tuple[str, int]]) -> None:
        for name, (text, status) in {**EXPECTED, **other}.items():
            self.write(self.folder / f"said/{name}.txt", text)
            self.write(self.folder / f"said/{name}.status", str(status))

    def result(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads((self.bundle / "result.json").read_text())
        return found

    def environment(self, given: dict[str, str]) -> dict[str, str]:
        return {
            "PATH": f"{self.folder / 'bin'}{os.pathsep}{os.environ['PATH']}",
            "AJPF_HOME": str(self.folder / "mcapl"),
            "SAID": str(self.folder / "said"),
            **given,
        }

    def run(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        """What the script of the bundle does, in this process."""
        out, err = io.StringIO(), io.StringIO()
        with (
            patch.object(runner, "__file__", str(self.bundle / "run.py")),
            patch.dict(os.environ, self.environment(environment), clear=True),
            redirect_stdout(out),
            redirect_stderr(err),
            warnings.catch_warnings(action="ignore", category=ResourceWarning),  # of the lock
        ):
            status = runner.main(arguments)
        return subprocess.CompletedProcess(arguments, status, out.getvalue(), err.getvalue())

    def started(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        """The script in a process of its own."""
        return subprocess.run(
            [sys.executable, str(self.bundle / "run.py"), *arguments],
            env=self.environment(environment),
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=60,
        )


@pytest.fixture
def mcapl(tmp_path: Path) -> Mcapl:
    return Mcapl(tmp_path)


@pytest.mark.slow
def test_all_as_expected_is_shown(mcapl: Mcapl) -> None:
    done = mcapl.started()
    assert done.returncode == 0, done.stderr
    assert done.stdout == (
        "R1.jpf: HOLDS, as expected\n"
        "R1_reach.jpf: VIOLATED, as expected\n"
        "R1_resp.jpf: VIOLATED, as expected\n"
        "R1_mutant.jpf: VIOLATED, as expected\n"
        "AJPF gives every expected verdict\n"
    )
    assert (mcapl.bundle / "logs/R1.jpf.txt").read_text() == SAYS_HOLDS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("answers", "status", "line"),
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
    mcapl: Mcapl, answers: dict[str, tuple[str, int]], status: int, line: str
) -> None:
    mcapl.says(answers)
    done = mcapl.run()
    assert done.returncode == status
    assert line in done.stdout


def test_an_answer_that_does_not_come_is_none(mcapl: Mcapl) -> None:
    mcapl.tool("java", 'if [ "$1" = -version ]; then echo \'version "11"\'; else exec sleep 30; fi')
    done = mcapl.run("--timeout", "0.1")
    assert done.returncode == 3
    assert "R1.jpf: ERROR, EXPECTED HOLDS (no answer in 0.1 seconds)" in done.stdout


def test_without_ajpf_nothing_is_run(mcapl: Mcapl, tmp_path: Path) -> None:
    for environment, message in (
        ({"AJPF_HOME": ""}, "set AJPF_HOME to the folder of MCAPL"),
        ({"AJPF_HOME": str(tmp_path / "nowhere")}, "set AJPF_HOME to the folder of MCAPL"),
        ({"AJPF_HOME": str(tmp_path / "said")}, "there is no RunJPF.jar below"),
        ({"PATH": str(tmp_path / "said")}, "java and javac are needed"),
    ):
        done = mcapl.run(**environment)
        assert done.returncode == 2
        assert message in done.stderr
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
    assert done.stderr == (
        "error: SIF.gwen is not the file that manifest.json lists; "
        "`--agent SIF.gwen` checks an agent of your own\n"
    )


@pytest.mark.slow
@pytest.mark.parametrize("text", ["", "[]", "{}", '{"files": {}, "checks": []}'])
def test_a_manifest_that_says_nothing_is_no_success(mcapl: Mcapl, text: str) -> None:
    (mcapl.bundle / "manifest.json").write_text(text)
    assert mcapl.run().returncode == 2


def test_a_manifest_without_its_controls_is_no_success(mcapl: Mcapl) -> None:
    manifest = json.loads((mcapl.bundle / "manifest.json").read_text())
    manifest["checks"] = manifest["checks"][:1]
    (mcapl.bundle / "manifest.json").write_text(json.dumps(manifest))
    assert mcapl.run().returncode == 2


@each("name", ["my folder", *"a,b a;b a:b a$b ${HOME} a\nb a\\b a'b Büro #1".split(" ")])
def test_a_folder_that_ajpf_cannot_name_is_refused(mcapl: Mcapl, name: str) -> None:
    """It reads paths from lists and from properties, where these letters mean something else."""
    mcapl.bundle = mcapl.folder / name
    done = mcapl.run()
    assert done.returncode == 2
    assert "AJPF reads only paths of letters, digits and `_ . / + @ ~ -`" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("name", ["SIF.gwen", "SIF.psl", "Env.java", "R1.jpf"])
def test_a_file_that_changes_while_ajpf_is_at_work_leaves_no_result(
    mcapl: Mcapl, name: str
) -> None:
    """As when the bundle is emitted again meanwhile."""
    path = mcapl.bundle / name
    script = (mcapl.folder / "bin/java").read_text(encoding="utf-8")
    mcapl.tool("java", script.replace("name=$(base", f"echo >> '{path}'; name=$(base"))
    done = mcapl.run()
    assert done.returncode == 2
    assert done.stderr == "error: a file was changed while AJPF was running: start run.py again\n"
    assert not (mcapl.bundle / "result.json").exists()


def test_an_agent_of_ones_own_that_changes_meanwhile_leaves_no_result(mcapl: Mcapl) -> None:
    own = mcapl.folder / "own.gwen"
    own.write_text((mcapl.bundle / "SIF.gwen").read_text(encoding="utf-8"), encoding="utf-8")
    script = (mcapl.folder / "bin/java").read_text(encoding="utf-8")
    mcapl.tool("java", script.replace("name=$(base", f"echo >> '{own}'; name=$(base"))
    assert mcapl.run("--agent", str(own)).returncode == 2
    assert not (mcapl.bundle / "result.json").exists()


@pytest.mark.slow
def test_two_runs_in_one_folder_do_not_read_each_others_files(mcapl: Mcapl) -> None:
    with (mcapl.bundle / "run.lock").open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        done = mcapl.run()
    assert done.returncode == 2
    assert done.stderr == f"error: another run.py is running in {mcapl.bundle}\n"
    assert mcapl.run().returncode == 0


@pytest.mark.slow
def test_ajpf_starts_where_there_is_nothing_but_what_it_is_given(mcapl: Mcapl) -> None:
    """Java PathFinder reads a `jpf.properties` where it starts."""
    mcapl.write(mcapl.bundle / "jpf.properties", "search.depth_limit = 1\n")
    mcapl.write(mcapl.bundle / "run/jpf.properties", "search.depth_limit = 1\n")
    script = (mcapl.folder / "bin/java").read_text(encoding="utf-8")
    mcapl.tool("java", script.replace("name=$(base", 'ls > "$SAID/beside"; name=$(base'))
    assert mcapl.run().returncode == 0
    beside = (mcapl.folder / "said/beside").read_text(encoding="utf-8").split()
    assert beside == sorted([*EXPECTED, "SIF.ail", "SIF_mutant.ail"])


# What is run, and how --------------------------------------------------------------------------


def test_the_newest_antlr_comes_before_the_others_on_the_class_path(mcapl: Mcapl) -> None:
    mcapl.run()
    places = (mcapl.folder / "said/class_path").read_text().strip().split(os.pathsep)
    assert [Path(place).name for place in places] == [
        "bin",
        "antlr-4.13.2-complete.jar",
        "RunJPF.jar",
        "antlr-4.7.jar",
    ]


def test_without_an_antlr_that_is_new_enough_nothing_is_run(mcapl: Mcapl) -> None:
    (mcapl.folder / "mcapl/lib/antlr-4.13.2-complete.jar").unlink()
    done = mcapl.run()
    assert done.returncode == 2
    assert "MCAPL's parsers need ANTLR 4.13.2" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("version", ["17.0.9", "1.8.0_392", "21"])
def test_another_java_than_11_is_refused(mcapl: Mcapl, version: str) -> None:
    mcapl.java(version)
    done = mcapl.run()
    assert done.returncode == 2
    assert f"is Java {version}, and AJPF needs Java 11" in done.stderr
    assert "set JAVA_HOME to a JDK 11" in done.stderr
    assert not (mcapl.bundle / "result.json").exists()


@pytest.mark.slow
def test_all_paths_that_ajpf_reads_are_absolute(mcapl: Mcapl) -> None:
    mcapl.run()
    for name in ("R1", "R1_mutant"):
        text = (mcapl.folder / f"said/{name}.jpf.given").read_text()
        assert "${config_path}" not in text
        (arguments,) = (line for line in text.splitlines() if line.startswith("target.args"))
        ail, psl, key = arguments.partition(" = ")[2].split(",")
        assert (Path(psl), key) == (mcapl.bundle / "SIF.psl", "R1")
        (agent,) = (x for x in Path(ail).read_text().splitlines() if x.startswith("mas.file"))
        wanted = "SIF_mutant.gwen" if name == "R1_mutant" else "SIF.gwen"
        assert agent == f"mas.file = {mcapl.bundle / wanted}"


@pytest.mark.slow
def test_modules_that_stand_beside_it_are_not_imported(mcapl: Mcapl) -> None:
    for name in ("json", "hashlib", "argparse", "subprocess", "dataclasses", "__future__"):
        mcapl.write(mcapl.bundle / f"{name}.py", "raise SystemExit(0)")
    for path in ("", f"{os.pathsep}{mcapl.bundle}", str(mcapl.bundle)):
        done = mcapl.started(PYTHONPATH=path)
        assert done.returncode == 0
        assert "AJPF gives every expected verdict" in done.stdout


@pytest.mark.slow
def test_an_agent_of_ones_own_is_checked_where_that_is_asked_for(mcapl: Mcapl) -> None:
    agent = mcapl.bundle / "SIF.gwen"
    agent.write_text(agent.read_text().replace("do_stopped", "brake"), encoding="utf-8")
    done = mcapl.run("--agent", str(agent))
    assert done.returncode == 0, done.stderr
    digest = hashlib.sha256(agent.read_bytes()).hexdigest()
    assert done.stdout.startswith(f"about the agent {agent}, SHA-256 {digest[:12]}...\n")
    found = mcapl.result()
    assert found["agent"] == {"file": str(agent), "sha256": digest}
    ail = (mcapl.bundle / "run/SIF.ail").read_text()
    assert f"mas.file = {agent}\n" in ail
    (mcapl.bundle / "SIF.psl").write_text("R1: F")
    assert mcapl.run("--agent", str(agent)).returncode == 2


def test_an_agent_of_another_name_is_refused(mcapl: Mcapl) -> None:
    own = mcapl.folder / "other.gwen"
    for text, message in ((":name: rover", "is called `rover`"), ("", "has no `:name:`")):
        own.write_text(f"GWENDOLEN\n{text}\n")
        done = mcapl.run("--agent", str(own))
        assert done.returncode == 2
        assert message in done.stderr
    assert mcapl.run("--agent", str(mcapl.folder / "nowhere.gwen")).returncode == 2


# The result ------------------------------------------------------------------------------------

STATISTICS = """
elapsed time:       00:00:33
states:             new=303,visited=52,backtracked=355,end=0
"""
PATH = "An Accepting Path has been found: \n" + (
    "[MS: 0, BS: 1, UN: 0], [MS: 1, BS: 2, UN: 0], [MS: 2, BS: 2, UN: 0], [MS: 4, BS: 2, UN: 0], "
    "[MS: 5, BS: 2, UN: 0], \n[MS: 4, BS: 2, UN: 1], \n"
)
RECORDED = f"""JavaPathfinder core system v8.0
====================================================== search started: 22/11/26
[INFO] New State is 0
[FINE] Updating B(agilex_agent,stopped()) to false
[FINE] Updating B(agilex_agent,too_close()) to false
[INFO] New State is 1
[INFO] New State is 2
[FINE] Updating B(agilex_agent,too_close()) to true
[INFO] New State is 3
[FINE] Updating B(agilex_agent,stopped()) to true
[INFO] agilex_agent done drive_on
[INFO] New State is 4
[INFO] New State is 5
[FINE] Updating B(agilex_agent,too_close()) to false
{PATH}
====================================================== error 1
ajpf.MCAPLListener
An Accepting Path has been found:  {PATH}

====================================================== results
error #1: ajpf.MCAPLListener "An Accepting Path has been found:  [MS: 0, BS: 1, UN: 0], ..."

====================================================== statistics{STATISTICS}"""
ENDING = f"""JavaPathfinder core system v8.0
====================================================== results
no errors detected

====================================================== statistics{STATISTICS}"""


def test_a_run_that_breaks_the_property_is_a_table_of_beliefs_and_actions_by_state() -> None:
    assert verdict(RECORDED, 0) == (VIOLATED, "")
    assert trace(RECORDED) == {
        "names": ["B(agilex_agent,stopped)", "B(agilex_agent,too_close)"],
        "rows": [[False, False], [False, False], [False, True], [False, True], [False, False]],
        "states": [0, 1, 2, 4, 5],
        "actions": ["", "", "", "drive_on", ""],
        "cycle": 3,
    }


def test_what_a_state_does_not_mention_before_is_unknown() -> None:
    text = RECORDED.replace("[FINE] Updating B(agilex_agent,stopped()) to false\n", "")
    found = trace(text)
    assert found is not None
    assert found["names"] == ["B(agilex_agent,too_close)"]
    later = RECORDED.replace(
        "[INFO] New State is 5\n",
        "[INFO] New State is 5\n[FINE] Updating B(agilex_agent,q()) to true\n",
    )
    found = trace(later)
    assert found is not None
    assert [row[0] for row in found["rows"]] == [None, None, None, None, True]


@pytest.mark.parametrize(
    ("path", "rows", "cycle"),
    [
        ([0, 1, 2, 3, 2], [0, 1, 2, 3], 2),
        ([0, 1, 2, 2], [0, 1, 2], 2),
        ([0, 1, 2, 3, 4, 2, 3], [0, 1, 2, 3, 4], 2),
        ([0, 1, 2, 3, 4, 2, 3, 4], [0, 1, 2, 3, 4], 2),
        ([0, 1, 2], [0, 1, 2], None),
        ([], [], None),
    ],
)
def test_the_second_round_of_a_loop_is_left_out(
    path: list[int], rows: list[int], cycle: int | None
) -> None:
    assert folded(path) == (rows, cycle)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (f"MODEL PRODUCED BY AJPF\n0:\n{ENDING}", "only the model was built"),
        (f"[SEVERE] ajpf[WARNING|main]: file not found\n{ENDING}", "[SEVERE]"),
        (f"line 1:0 mismatched input '<EOF>'\n{ENDING}", "a file was misread: line 1:0"),
        ("java.lang.NullPointerException\n\tat ajpf.psl", "no verdict in the output"),
        ("no errors detected\n", "no verdict in the output"),
        (
            '=== results\nerror #1: gov.nasa.jpf.vm.NoUncaughtExceptionsProperty "x"\n',
            "AJPF stopped: gov.nasa.jpf.vm.NoUncaughtExceptionsProperty",
        ),
        ("Could not deserialize ATN with version 4 (expected 3)", "an ANTLR that is older"),
        ("NoSuchMethodError: jdk.internal.misc.Unsafe.getReferenceAcquire", "AJPF needs Java 11"),
    ],
)
def test_what_is_no_verdict_says_why(text: str, why: str) -> None:
    answer, reason = verdict(text, 0)
    assert answer == ERROR
    assert why in reason


def test_the_statistics_are_read() -> None:
    assert verdict(ENDING, 0) == (HOLDS, "")
    assert states(ENDING) == {"new": 303, "visited": 52, "backtracked": 355, "end": 0}
    assert states("nothing") == {}


@pytest.mark.slow
def test_a_result_is_what_its_schema_says_and_names_what_was_run(mcapl: Mcapl) -> None:
    mcapl.says({"R1.jpf": (ENDING, 0), "R1_mutant.jpf": (RECORDED, 0)})
    assert mcapl.run().returncode == 0
    found = mcapl.result()
    validate("ajpf-result.schema.json", found)
    assert (found["requirement"], found["verdict"], found["java"]) == ("R1", "shown", "11.0.22")
    assert found["mcapl"] == {"commit": "ab" * 20}
    assert found["agent"] is None
    manifest = json.loads((mcapl.bundle / "manifest.json").read_text())
    assert found["files"] == manifest["files"]
    assert [(c["role"], c["key"], c["told"]) for c in found["checks"]] == [
        ("requirement", "R1", "HOLDS"),
        ("control", "R1_reach", "VIOLATED"),
        ("control", "R1_resp", "VIOLATED"),
        ("mutant", "R1", "VIOLATED"),
    ]
    assert found["checks"][0]["states"]["new"] == 303
    assert found["checks"][0]["trace"] is None
    assert found["checks"][3]["trace"]["cycle"] == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("answers", "verdict_"),
    [
        ({"R1.jpf": (RECORDED, 0)}, "refuted"),
        ({"R1_mutant.jpf": (ENDING, 0)}, "not shown"),
        ({"R1.jpf": ("", 0)}, "not shown"),
    ],
)
def test_a_result_that_shows_nothing_is_written_too(
    mcapl: Mcapl, answers: dict[str, tuple[str, int]], verdict_: str
) -> None:
    mcapl.says(answers)
    mcapl.run()
    found = mcapl.result()
    validate("ajpf-result.schema.json", found)
    assert found["verdict"] == verdict_


@pytest.mark.slow
def test_a_run_that_cannot_begin_leaves_the_last_result_alone(mcapl: Mcapl) -> None:
    mcapl.run()
    before = mcapl.result()
    mcapl.java("17.0.1")
    assert mcapl.run().returncode == 2
    assert mcapl.result() == before
