"""What may happen to outputs: closed pipes, full disks, files in the way."""

import io
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from itertools import product
from pathlib import Path

import pytest

from fretc.terminal.output import print_diagnostics
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from tests.command import PROCESS, Fretc
from tests.effort import FULL, some

ROOT = Path(__file__).parents[3]
LOG = str(ROOT / "traces/mission-seed15.mcap")
R1 = "whenever too_close agilex_agent shall eventually satisfy stopped\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "requirements", tmp_path / "requirements")
    (tmp_path / "r1.fret").write_text(R1, "utf-8")
    return tmp_path


def in_shell(
    folder: Path, arguments: str, shell: str, encoding: str = "utf-8"
) -> subprocess.CompletedProcess[str]:
    """Run a line in a shell; `{}` in `shell` stands for the command."""
    command = f"{shlex.join(PROCESS)} {arguments}"
    done = subprocess.run(
        ["bash", "-c", shell.format(command)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        encoding=encoding,
        check=False,
    )
    assert "Traceback" not in done.stderr
    return done


@pytest.mark.slow
def test_a_reader_that_goes_away_is_no_violation(folder: Path) -> None:
    done = in_shell(folder, f"audit {LOG}", "{} | true; echo ${{PIPESTATUS[0]}}")
    assert done.stdout == "2\n"


@pytest.mark.slow
def test_a_full_standard_error_leaves_the_exit_status_alone(folder: Path) -> None:
    assert in_shell(folder, f"audit {LOG}", "{} 2>/dev/full").returncode == 0
    assert in_shell(folder, "audit none.mcap", "{} 2>/dev/full").returncode == 2


@pytest.mark.slow
def test_a_full_standard_output_is_told(folder: Path) -> None:
    done = in_shell(folder, "r1.fret", "{} >/dev/full")
    assert done.returncode == 2
    assert "F905 `standard output` cannot be written: No space left on device" in done.stderr


@pytest.mark.slow
def test_a_closed_standard_output_costs_nothing_but_the_output(folder: Path) -> None:
    assert in_shell(folder, "r1.fret --emit ajpf", "{} >&-").returncode == 0
    assert (folder / "build/r1.psl").is_file()


@pytest.mark.slow
def test_an_encoding_that_has_no_tick_mark_still_shows_the_verdict(folder: Path) -> None:
    done = in_shell(folder, f"audit {LOG}", "PYTHONIOENCODING=latin-1 {}", "latin-1")
    assert done.returncode == 0
    assert "+ Stop when an obstacle is within 5 cm (R1)  satisfied" in done.stdout


@pytest.mark.parametrize(
    ("name", "why"),
    [
        (
            "./run.mcap",
            "`run.mcap` cannot be written: an evidence store is a folder, and this is a file",
        ),
        ("run.json", "`run.json` cannot be written: it is `run.mcap`, which is an input"),
    ],
)
def test_evidence_never_replaces_what_is_read(
    folder: Path, fretc: Fretc, name: str, why: str
) -> None:
    shutil.copy(LOG, folder / "run.mcap")
    (folder / "run.json").symlink_to("run.mcap")
    done = fretc("audit", "run.mcap", "-o", name)
    assert (done.status, done.err.splitlines()[0]) == (2, f"F905 {why}")
    assert (folder / "run.mcap").read_bytes() == Path(LOG).read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "line"),
    some(
        product(
            ["bindings.toml", "hazards.toml", "fretc.lock"],
            [
                "audit run.mcap -o requirements/{}",
                "report --csv requirements/{}",
                "verify requirements/r1.fret --monitor -o requirements/{}",
            ],
        ),
        4,
    ),
)
def test_what_stands_beside_requirements_is_never_replaced(
    folder: Path, fretc: Fretc, line: str, name: str
) -> None:
    shutil.copy(LOG, folder / "run.mcap")
    there = folder / "requirements" / name
    there.touch()
    before = there.read_bytes()
    assert fretc(*line.format(name).split()).status == 2
    assert there.read_bytes() == before


@pytest.mark.slow
def test_a_report_never_replaces_its_evidence_nor_its_other_form(
    folder: Path, fretc: Fretc
) -> None:
    fretc("audit", LOG)
    before = (folder / "build/evidence.json").read_bytes()
    assert fretc("report", "--html", "build/evidence.json").status == 2
    assert fretc("report", "--html", "build/x", "--json", "build/./x").status == 2
    assert not (folder / "build/x").exists()
    assert (folder / "build/evidence.json").read_bytes() == before


def test_one_form_of_the_report_that_cannot_be_written_keeps_the_other_from_being_written(
    folder: Path,
    fretc: Fretc,
) -> None:
    assert fretc("report", "--html", "new.html", "--json", "r1.fret/x.json").status == 2
    assert not (folder / "new.html").exists()


def test_a_report_about_requirements_with_an_error_is_written_and_exits_with_2(
    folder: Path,
    fretc: Fretc,
) -> None:
    (folder / "requirements/r2.fret").write_text("the sw shall stopped\n", "utf-8")
    done = fretc("report", "--html", "report.html")
    assert (done.status, (folder / "report.html").is_file()) == (2, True)


def test_a_link_is_followed_and_a_file_keeps_its_permissions(folder: Path, fretc: Fretc) -> None:
    real = folder / "real.fret"
    real.write_text(R1.replace("satisfy stopped", "satisfy (stopped)"), "utf-8")
    real.chmod(0o640)
    (folder / "link.fret").symlink_to(real)
    assert fretc("fmt", "link.fret").status == 0
    assert (folder / "link.fret").is_symlink()
    assert real.read_text("utf-8") == R1
    assert real.stat().st_mode & 0o777 == 0o640


def test_what_is_no_regular_file_is_never_replaced(folder: Path, fretc: Fretc) -> None:
    os.mkfifo(folder / "pipe")
    assert fretc("simulate", "--duration", "1", "-o", "pipe").status == 2
    assert fretc("audit", LOG, "-o", "pipe").status == 2
    assert fretc("audit", "pipe").status == 2
    assert (folder / "pipe").is_fifo()


@pytest.mark.slow
def test_a_termination_leaves_no_temporary_file(folder: Path) -> None:
    ids = "".join(f'+++\nid = "R{i}"\n+++\n{R1}' for i in range(1000 if FULL else 300))
    (folder / "many.fret").write_text(ids, "utf-8")
    run = subprocess.Popen(
        [*PROCESS, "many.fret", "--emit", "monitor"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 60
    while not list(folder.glob("build/.*.tmp")) and time.monotonic() < deadline:
        time.sleep(0.01)
    run.send_signal(signal.SIGTERM)
    assert run.wait(60) == 130
    assert list(folder.glob("build/.*.tmp")) == []


def test_ids_whose_files_would_be_one_are_refused(folder: Path, fretc: Fretc) -> None:
    pairs = "".join(f'+++\nid = "{id}"\n+++\n{R1}' for id in ("a-b", "A.B"))
    (folder / "two.fret").write_text(pairs, "utf-8")
    done = fretc("two.fret", "--emit", "monitor")
    assert done.status == 2
    assert "F201 the id `A.B` is taken: two.fret:2" in done.err.splitlines()


@pytest.mark.parametrize(
    "sentence",
    [
        f"whenever p the sw shall within {'9' * 5000} ticks satisfy q",
        "whenever p the sw shall within 1000000000000000 ticks satisfy q",
    ],
)
def test_a_number_without_end_is_told(folder: Path, fretc: Fretc, sentence: str) -> None:
    (folder / "long.fret").write_text(sentence, "utf-8")
    done = fretc("long.fret")
    assert (done.status, done.err.splitlines()[0]) == (
        2,
        "F108 a duration has at most 15 digits",
    )


def test_a_predicate_that_looks_back_needs_no_column_of_its_own(folder: Path, fretc: Fretc) -> None:
    (folder / "p.fret").write_text(
        "whenever persisted(1,p) the sw shall immediately satisfy q", "utf-8"
    )
    assert fretc("p.fret", "--emit", "monitor").status == 0
    table = "p,q\n1,0\n1,1\n1,0\n"
    (folder / "t.csv").write_text(table, "utf-8")
    done = subprocess.run(
        [sys.executable, "-I", "-S", "build/p_monitor.py", "t.csv"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (1, "t.csv: p: violated (ticks 2..2)\n")


@pytest.mark.slow
@pytest.mark.parametrize("shell", ["{} >&-", "{} >/dev/full", "{} <&-"])
def test_a_monitor_with_a_closed_or_full_stream_tells_so(
    folder: Path, fretc: Fretc, shell: str
) -> None:
    fretc("r1.fret", "--emit", "monitor")
    (folder / "t.csv").write_text("too_close,stopped\n0,1\n", "utf-8")
    trace = "-" if "<" in shell else "t.csv"
    command = f"'{sys.executable}' build/r1_monitor.py {trace}"
    done = subprocess.run(
        ["bash", "-c", shell.format(command)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("standard ")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("evidence", ["runs/b.mcap", "runs/link.json", "runs", "link"])
def test_no_audit_is_begun_whose_evidence_would_replace_a_log(
    folder: Path, fretc: Fretc, evidence: str
) -> None:
    (folder / "runs").mkdir()
    logs = ("runs/a.mcap", "runs/b.mcap")
    for name in logs:
        shutil.copy(LOG, folder / name)
    (folder / "runs/link.json").symlink_to("b.mcap")
    (folder / "link").symlink_to("runs")
    done = fretc("audit", *logs, "-o", evidence)
    assert done.status == 2
    assert done.err.startswith("F905 ")
    assert "wrote" not in done.err
    assert {path.name for path in folder.glob("runs/*")} == {"a.mcap", "b.mcap", "link.json"}
    assert all((folder / name).read_bytes() == Path(LOG).read_bytes() for name in logs)


@pytest.mark.slow
def test_no_name_of_a_log_writes_a_verdict_of_its_own(folder: Path, fretc: Fretc) -> None:
    forged = "a.mcap\n  \u2714 R1  satisfied\x1b[2K"
    shutil.copy(LOG, folder / forged)
    done = fretc("audit", forged, "-o", "build/x\ny")
    assert done.out.splitlines()[0] == "a.mcap\\n  \u2714 R1  satisfied\\x1b[2K"
    assert len(done.out.splitlines()) == 4  # the name, a verdict, situations, counts
    assert done.err == "wrote build/x\\ny\n"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


DIAGNOSTIC = Diagnostic(
    Code.NOT_FRETISH, "a message", Source("r.fret", "the text").span(4, 8), help="some help"
)


def shown(stream: io.StringIO, monkeypatch: pytest.MonkeyPatch, **environment: str) -> str:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "stderr", stream)
    print_diagnostics([DIAGNOSTIC])
    return stream.getvalue()


def test_a_terminal_shows_the_same_text_in_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    coloured = shown(Terminal(), monkeypatch)
    assert coloured.count("\x1b[") > 5
    assert re.sub("\x1b\\[[0-9;]*m", "", coloured) == f"{render(DIAGNOSTIC)}\n"


@pytest.mark.parametrize("environment", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_a_user_who_wants_no_colours_gets_none(
    monkeypatch: pytest.MonkeyPatch, environment: dict[str, str]
) -> None:
    assert shown(Terminal(), monkeypatch, **environment) == f"{render(DIAGNOSTIC)}\n"


def test_a_file_gets_no_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    assert shown(io.StringIO(), monkeypatch) == f"{render(DIAGNOSTIC)}\n"
