"""`fretc verify --file` of monitors in C, Rust, Java and JavaScript."""

import json
import os
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

from fretc.verification.c.build import FLAGS as C_FLAGS
from fretc.verification.java.language import FLAGS as JAVA_FLAGS
from fretc.verification.javascript.node import FLAGS as NODE_FLAGS
from fretc.verification.rust.build import FLAGS as RUST_FLAGS
from tests.command import PROCESS, Fretc, write
from tests.compiled_monitors import TONGUES
from tests.effort import some
from tests.programs import installed, needs

R1 = "whenever p the sw shall within 2 ticks satisfy q"


@dataclass(frozen=True)
class Made:
    """A language, and a monitor that was made in it."""

    name: str
    emit: str
    file: str
    artefacts: tuple[str, ...]
    flags: tuple[str, ...]
    bound: tuple[str, str]
    """A statement, and a wrong one."""
    strange: tuple[str, str]
    """A statement, and what fretc would not write beside it."""
    missing: str


MADE = {
    each.name: each
    for each in (
        Made(
            "C", "c", "r1_monitor.c", ("r1_monitor.c", "r1_monitor.h", "r1_monitor.so"), C_FLAGS,
            ("approximation->oldest_1 >= 2", "approximation->oldest_1 >= 1"),
            ("    fretc_reading *reading;", "abort();"),
            "a monitor in C is compiled for its proof, but none of `gcc`, `clang`, `cc` is "
            "installed",
        ),
        Made(
            "Rust", "rust", "r1_monitor/src/lib.rs", ("lib.rs", "lib.so"), RUST_FLAGS,
            ("self.oldest_1 >= 2", "self.oldest_1 >= 1"),
            ("        // r1: what is remembered", "\nabort();"),
            "a monitor in Rust is compiled for its proof, but `rustc` is not installed",
        ),
        Made(
            "Java", "java", "R1Monitor.java", ("R1Monitor.java",), JAVA_FLAGS,
            ("this.oldest_1 >= 2", "this.oldest_1 >= 1"),
            ("            this.since_1 = this.oldest_1", "\nabort();"),
            "a monitor in Java is compiled and run for its proof, but `javac` and `java` are not "
            "both installed",
        ),
        Made(
            "JavaScript", "js", "r1_monitor.mjs", ("r1_monitor.mjs",), NODE_FLAGS,
            ("approximation.oldest_1 >= 2", "approximation.oldest_1 >= 1"),
            ("  approximation.signals = [", "\nabort();"),
            "a monitor in JavaScript is run for its proof, but `node` is not installed",
        ),
    )
}  # fmt: skip


@pytest.fixture(params=MADE)
def made(fretc: Fretc, request: pytest.FixtureRequest) -> Made:
    """The monitor in one language that was made of `r1.fret`."""
    found: Made = MADE[request.param]
    installed(TONGUES[found.name.lower()].program)
    write("r1.fret", R1)
    assert fretc("r1.fret", "--emit", found.emit, "-o", ".").status == 0
    return found


def edited(path: str, old: str, new: str) -> None:
    text = Path(path).read_text(encoding="utf-8")
    assert text.count(old) == 1
    write(path, text.replace(old, new))


@pytest.mark.slow
@pytest.mark.confined
@pytest.mark.parametrize("made", some(MADE, 3, 1), indirect=True)
def test_it_is_proved_as_what_it_is(fretc: Fretc, made: Made) -> None:
    run = fretc("verify", "--file", made.file, "r1.fret")
    assert run.status == 0, run
    assert run.out.startswith("✔ r1  monitor  proved under (1): the monitor means")
    (proof,) = json.loads(Path("build/verification.json").read_text())["evidence"]
    assert tuple(proof["artefacts"]) == made.artefacts
    (assumption,) = proof["assumptions"]
    assert all(flag in assumption for flag in made.flags)
    edited(made.file, *made.bound)
    run = fretc("verify", "--file", made.file, "r1.fret", "--traces", "runs")
    assert run.status == 1
    assert Path("runs/r1_monitor_1.csv").exists()


def test_a_text_that_fretc_would_not_write_is_not_run(fretc: Fretc, made: Made) -> None:
    before, strange = made.strange
    edited(made.file, before, f"{strange} {before}")
    run = fretc("verify", "--file", made.file, "r1.fret")
    assert run.status == 3
    text = Path(made.file).read_text(encoding="utf-8")
    line = text[: text.index("abort")].count("\n") + 1
    assert f"; line {line} is not laid out as fretc writes it: `abort ( )" in run.out


def test_without_its_tool_it_says_what_to_install(
    fretc: Fretc, made: Made, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    run = fretc("verify", "--file", made.file, "r1.fret")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(f"F908 {made.missing}")


def test_a_loop_takes_it_not(fretc: Fretc, made: Made) -> None:
    run = fretc("verify", "--layer", "loop", "--file", made.file, "r1.fret")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith("F907 `--layer loop` needs a monitor in Python")


def test_a_text_of_another_kind_is_not_run(fretc: Fretc, made: Made) -> None:
    name = f"other{Path(made.file).suffix}"
    write(name, '#include "other.h"\nabort();\n')
    write("other.h", "")
    run = fretc("verify", "--file", name, "r1.fret")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(
        f"F602 `{name}` is not a generated monitor: it contains no requirement"
    )
    assert run.err.endswith(f"help: name a file that `--emit {made.emit}` wrote\n")


@pytest.mark.slow
@needs("gcc")
def test_a_monitor_in_c_needs_its_header(fretc: Fretc) -> None:
    write("r1.fret", R1)
    assert fretc("r1.fret", "--emit", "c", "-o", ".").status == 0
    header = Path("r1_monitor.h").read_bytes()
    run = fretc("verify", "--file", "r1_monitor.c", "r1.fret", "-o", "r1_monitor.h")
    assert (run.status, Path("r1_monitor.h").read_bytes()) == (2, header)
    assert (
        "F905 `r1_monitor.h` cannot be written: it is `r1_monitor.h`, which is an input" in run.err
    )
    Path("r1_monitor.h").unlink()
    assert fretc("verify", "--file", "r1_monitor.c", "r1.fret").err.startswith("F901")
    write("other.c", "int x;\n")
    run = fretc("verify", "--file", "other.c", "r1.fret")
    assert run.status == 2
    assert run.err.startswith(
        "F602 `other.c` is not a generated monitor: it does not include its header"
    )


@pytest.mark.slow
@pytest.mark.parametrize("made", some(MADE, 3), indirect=True)
def test_ctrl_c_leaves_no_file_and_no_process(fretc: Fretc, made: Made, tmp_path: Path) -> None:
    """In the midst of the exploration: the bound takes minutes."""
    Path("r1.fret").write_text(R1.replace("2 ticks", "1000000 ticks"), encoding="utf-8")
    assert fretc("r1.fret", "--emit", made.emit, "-o", ".").status == 0
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    running = subprocess.Popen(
        [*PROCESS, "verify", "--file", made.file, "r1.fret"],
        env={**os.environ, "TMPDIR": str(temporary)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    explored = "errors.txt" if made.emit in ("js", "java") else "monitor.so"
    deadline = time.monotonic() + 60
    while not [*temporary.glob(f"*/{explored}")] and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.5)
    os.killpg(running.pid, signal.SIGINT)
    out, err = running.communicate(timeout=30)  # a process that is left would hold the pipes
    assert (running.returncode, out) == (130, "")
    assert err.startswith("stopped")
    assert not Path("build/verification.json").exists()
    assert [*temporary.iterdir()] == []
