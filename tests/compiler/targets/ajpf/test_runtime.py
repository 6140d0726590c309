"""`--emit agent-runtime`: its files, its refusals, and that its Java compiles without a warning."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.ajpf import bundle, runtime_runner
from compiler.targets.ajpf.percepts import literal
from compiler.targets.ajpf.runtime import emit, refusal
from fretish.diagnostics.rendering import render
from tests.bound_requirements import bound_requirement
from tests.programs import installed, mcapl, needs

ROOT = Path(__file__).parents[4]
R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"
BINDINGS = (ROOT / "requirements/bindings.toml").read_text(encoding="utf-8")
PLAIN = ("Bridge", "Cbor", "Json", "Percepts", "Reading", "Signal", "View")
"""The classes that need nothing of MCAPL."""


def made(bindings: str = BINDINGS, sentence: str = R1) -> FormalizedRequirement:
    return bound_requirement(sentence, bindings=bindings)


def texts(subject: FormalizedRequirement) -> dict[str, str]:
    found = refusal(subject)
    assert found is None, render(found)
    return {artifact.path.name: artifact.text for artifact in emit([subject])}


def write(folder: Path, files: dict[str, str]) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def test_what_runs_is_the_text_that_is_model_checked() -> None:
    files = {file.path.name: file.text for file in bundle.emit([made()])}
    assert texts(made())["SIF.gwen"] == files["SIF.gwen"]


def test_the_files_of_the_papers_requirement(golden: Callable[[str, str], None]) -> None:
    files = texts(made())
    for name in ("Percepts.java", "SIF.ail", "SIF.gwen", "README.md"):
        golden(f"agent-runtime/r1_agent/{name}", files[name])
    manifest = json.loads(files["manifest.json"])
    digests = manifest.pop("files")
    golden("agent-runtime/r1_agent/manifest.json", f"{json.dumps(manifest, indent=1)}\n")
    del files["manifest.json"]
    assert digests == {name: sha256(text) for name, text in files.items()}
    assert all(text.isascii() for text in files.values())


# Refusals ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[action.undo_stopped]", "[action.other]", "F619 the agent of R1 does `undo_stopped`"),
        (
            "[action.stop_moving]",
            '[call.stop_moving]\nservice = "/stop"\ntype = "std_srvs/Trigger"\n[action.x]',
            "no action of the agent of R1 publishes true on `/gwendolen_control`",
        ),
        ("[interceptor]", "[xinterceptor]", ""),
        (
            'topic   = "/gwendolen_control"',
            'topic   = "/other"',
            "no action of the agent of R1 publishes true on `/gwendolen_control`",
        ),
        (
            "message = { data = true }",
            "message = { data = 1 }",
            '`stop_moving` publishes `{"data":1}` of type `std_msgs/Bool` on `/gwendolen_control`',
        ),
        (
            'topic   = "/gwendolen_control"',
            'topic   = "/scan"',
            "an agent at run time cannot express the topic `/scan` with two types of R1",
        ),
        (
            'expr = "clearance < 5 cm"',
            'expr = "clearance < 5 cm for 1 s"',
            "an agent at run time cannot express `for` in the percept `too_close` of R1",
        ),
        (
            'expr = "clearance < 5 cm"\nrole = "input"\nkind = "belief"\nagg  = "any"',
            'expr = "pre(9 m, clearance) < 5 cm"',
            "an agent at run time cannot express `pre` in the percept `too_close` of R1",
        ),
        (
            'expr = "clearance < 5 cm"',
            'expr = "min(clearance, vx * 1 s) < 5 cm"',
            "an agent at run time cannot express `min` or `max` of a number",
        ),
        (
            'type      = "sensor_msgs/LaserScan"\n',
            "",
            "an agent at run time cannot express `clearance`, which has no ROS type of R1",
        ),
        (
            "[proposition.too_close]",
            "[proposition.very_close]",
            "an agent at run time cannot express the percept `too_close`, which is not bound",
        ),
    ],
)
def test_what_the_bindings_leave_open_is_refused(old: str, new: str, message: str) -> None:
    assert old in BINDINGS
    if not message:  # without the table
        head, _, rest = BINDINGS.partition("[interceptor]")
        found = refusal(made(f"{head}{rest[rest.index('[assume]') :]}"))
        message = "F619 the agent of R1 has no topic for stop requests"
    else:
        found = refusal(made(BINDINGS.replace(old, new)))
    assert found is not None
    assert message in render(found)
    assert found.help


# Java -------------------------------------------------------------------------------------------


def test_a_string_of_java_cannot_end_early() -> None:
    assert literal('a"b\\c\n\r\t\x00\x7f') == '"a\\"b\\\\c\\012\\015\\011\\000\\177"'
    assert literal("\\u0022") == '"\\\\u0022"'
    assert literal("\xe9\u2028\U0001f600") == '"\\351\\u2028\\ud83d\\ude00"'


HOSTILE = r"""
[clock]
tick = "100 ms"
[signal.mode]
path = "/mode.word"
type = "a_msgs/Mode"
values = ['\u0022);}{', '\\u000a', '*/ é\']
[signal.level]
path = "/mode.level"
type = "a_msgs/Mode"
unit = "1"
[proposition.near]
expr = 'mode = "\\u000a" or level < 3'
[proposition.stopped]
expr = "level > 4"
[interceptor]
stop = "/stop"
command = "/c"
output = "/o"
period = "50 ms"
[action.do_stopped]
topic = "/stop"
type = "std_msgs/Bool"
message = { data = true }
[action.undo_stopped]
topic = "/say"
type = "std_msgs/String"
message = { data = '\u0022); System.exit(0); //', other = "\u000a\\" }
"""
HOSTILE_R1 = "whenever near the sw shall eventually satisfy stopped"


@needs("javac")
@pytest.mark.slow
def test_texts_of_users_stay_strings(tmp_path: Path) -> None:
    """Java replaces Unicode escapes before it reads a string."""
    for number, (bindings, sentence) in enumerate(((BINDINGS, R1), (HOSTILE, HOSTILE_R1))):
        files = texts(made(bindings, sentence))
        folder = write(tmp_path / str(number), files)
        compiled(folder, *(f"{name}.java" for name in PLAIN))


def compiled(folder: Path, *files: str, classes: str = "") -> Path:
    done = subprocess.run(
        [
            *(installed("javac"), "--release", "11", "-Xlint:all,-path", "-Werror"),
            *("-d", "out", *(("-cp", classes) if classes else ()), *files),
        ],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder / "out"


@needs("javac")
@pytest.mark.slow
def test_all_classes_compile_with_mcapl_without_a_warning(tmp_path: Path) -> None:
    classes = runtime_runner.class_path(Path(mcapl()))
    files = texts(made())
    folder = write(tmp_path / "r1_agent", files)
    compiled(folder, *(name for name in files if name.endswith(".java")), classes=classes)


# run.py -----------------------------------------------------------------------------------------


def started(folder: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(folder / "run.py"), *arguments],
        env={"PATH": os.environ["PATH"], **environment},
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.slow
def test_run_py_says_what_is_missing(tmp_path: Path) -> None:
    folder = write(tmp_path / "r1_agent", texts(made()))
    home = tmp_path / "mcapl"
    (home / "bin/ail/mas").mkdir(parents=True)
    for arguments, environment, message in (
        ([], {}, "set AJPF_HOME to the folder of MCAPL"),
        ([], {"AJPF_HOME": str(tmp_path / "none")}, "set AJPF_HOME to the folder of MCAPL"),
        ([], {"AJPF_HOME": str(home)}, "there is no ail/mas/AIL.class in"),
        ([], {"AJPF_HOME": str(home), "PATH": ""}, "java and javac are needed"),
        (["--url", "ws://a b"], {}, "is no address such as ws://localhost:9090"),
        (["--url", "ws://a\nenv = x"], {}, "is no address such as ws://localhost:9090"),
        (["--trace", "/a\nenv = x"], {}, "is no topic"),
    ):
        done = started(folder, *arguments, **environment)
        assert (done.returncode, done.stdout) == (2, "")
        assert message in done.stderr
    (home / "bin/ail/mas/AIL.class").write_text("")
    done = started(folder, AJPF_HOME=str(home))
    assert "there is no antlr-4.13.*.jar below" in done.stderr
    (folder / "View.java").write_text("class View {}")
    done = started(folder, AJPF_HOME=str(home))
    assert done.stderr == "error: View.java is not the file that manifest.json lists\n"


OWN = """\
GWENDOLEN
:name: agilex_agent

:Initial Beliefs:
awake

:Initial Goals:

:Plans:
// +far : {True} <- fly;
+too_close : {B awake, ~B halted} <- print("<- a, b; +x"), stop_moving, +halted;
+halted : {True} <- print(1, f(2, 3)), undo_stopped, -awake;
-too_close : {True};
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("", "", "error: set AJPF_HOME to the folder of MCAPL\n"),
        ("+too_close", "+too_near", "error: F919 no percept shows `too_near`, and the agent does"),
        ("-too_close", "-too_near", "error: F919 no percept shows `too_near`"),
        ("B awake", "B happy", "error: F919 no percept shows `happy`"),
        ("stop_moving", "stop", "error: F919 nothing is bound to the action `stop`: add"),
        ("undo_stopped", "move(2,3)", "error: F919 nothing is bound to the action `move(2,3)`"),
        ("agilex_agent", "other", "has no agent `agilex_agent`"),
        ("GWENDOLEN", "\udcff", "is no text"),
    ],
)
def test_an_agent_of_your_own_is_compared_with_the_bindings_before_anything_starts(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    folder = write(tmp_path / "r1_agent", texts(made()))
    assert old in OWN
    text = OWN.replace(old, new) if old else OWN
    (tmp_path / "own.gwen").write_bytes(text.encode("utf-8", "surrogateescape"))
    done = started(folder, "--agent", str(tmp_path / "own.gwen"))
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr


def test_the_events_of_an_agent_are_those_of_its_plans(tmp_path: Path) -> None:
    (tmp_path / "own.gwen").write_text(OWN)
    manifest = json.loads(texts(made())["manifest.json"])
    assert runtime_runner.fitting(tmp_path / "own.gwen", manifest) == "halted too_close"
    (tmp_path / "own.gwen").write_text(texts(made())["SIF.gwen"])
    assert runtime_runner.fitting(tmp_path / "own.gwen", manifest) == "too_close"
