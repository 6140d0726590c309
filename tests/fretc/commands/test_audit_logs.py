"""Which logs an audit takes, how long it may take, and whom it tells."""

import json
import os
import shutil
import stat
import sys
import time
from pathlib import Path

import pytest

from fretc.audit import many_logs
from fretc.audit.evidence.writer import text
from fretc.audit.store.anywhere import read
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, write
from tests.fretc.logs import logs
from tests.json_schemas import validate

NIGHT = 1_795_000_000
"""Seconds since 1970: in November 2026."""
BINDINGS = (
    '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.data"\n[proposition.low]\nexpr = "x < 20"\n'
)


@pytest.fixture
def robot(fretc: Fretc) -> Fretc:
    """Three nights of one log each; the second one is violated."""
    write(
        "requirements/r1.fret",
        '+++\nid = "R1"\ntitle = "Low"\n+++\nthe robot shall always satisfy low',
    )
    write("requirements/bindings.toml", BINDINGS)
    for night, most in enumerate((5, 30, 12)):
        start = (NIGHT + night * 86_400) * logs.S
        values = [logs.number(i, start + i * 100 * logs.MS) for i in range(most)]
        Path("runs").mkdir(exist_ok=True)
        logs.write(Path(f"runs/{night}.mcap"), values)
    return fretc


def evidence(path: str = "build/evidence") -> dict[str, object]:
    """That of a store, if no file is named."""
    found = read(path)
    assert not isinstance(found, Diagnostic), found.message
    content: dict[str, object] = json.loads(text(found.document))
    validate("evidence.schema.json", content)
    return content


def runs() -> list[str]:
    return [one["run"] for one in evidence()["results"]]  # type: ignore[attr-defined]


@pytest.mark.slow
def test_since_takes_the_later_logs_and_evidence_says_so(robot: Fretc) -> None:
    run = robot("audit", "runs", "--since", "2026-11-20")
    assert run.status == 0
    assert runs() == ["runs/2.mcap"]
    since = "2026-11-20T00:00:00+00:00"
    assert f"1 of 3 logs: 2 are from before {since}" in run.err
    selection = {
        "named": 3, "since": since, "older": 2, "sample_of": None, "seed": None, "audited": 1
    }  # fmt: skip
    assert evidence()["selection"] == selection
    robot("audit", "runs", "--since", "2026-11-20", "-o", "e.json")
    assert evidence("e.json")["selection"] == selection
    assert robot("audit", "runs").status == 1
    assert "selection" not in evidence()


def test_where_no_log_is_left_nothing_is_shown_and_evidence_stays(robot: Fretc) -> None:
    robot("audit", "runs")
    before = Path("build/evidence/evidence.sqlite").read_bytes()
    run = robot("audit", "runs", "--since", "2030-01-01")
    assert run.status == 3
    assert "no log is audited" in run.err
    assert Path("build/evidence/evidence.sqlite").read_bytes() == before


@pytest.mark.slow
def test_a_sample_is_reported_as_one(robot: Fretc) -> None:
    run = robot("audit", "runs", "--sample", "2", "--seed", "5")
    assert "2 of 3 logs: a sample of 3 chosen at random, seed 5" in run.err
    assert len(runs()) == 2
    first = evidence()
    robot("audit", "runs", "--sample", "2", "--seed", "5")
    assert evidence() == first
    assert robot("report", "--json", "r.json").status == 0
    claims = json.loads(Path("r.json").read_text())["claims"]
    assert claims.endswith(
        "audited against 2 runs, which are 2 of 3 logs: a sample of 3 chosen at random, seed 5."
    )


@pytest.mark.slow
def test_a_log_for_which_there_is_no_time_is_no_data(
    robot: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(many_logs, "read", lambda *_: time.sleep(3600))
    run = robot("audit", "runs/0.mcap", "runs/2.mcap", "--log-time", "100ms")
    assert run.status == 3
    assert run.err.count("F440 warning: the audit of `runs/") == 2
    assert run.out.splitlines()[-1].count("2 no data") == 1
    assert not Path("build/evidence").exists()  # no log was read: that of before would stay


@pytest.mark.slow
def test_a_log_for_which_there_was_no_time_is_audited_when_there_is(
    robot: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot("audit", "runs/0.mcap", "-o", "build/evidence")
    with monkeypatch.context() as patch:
        patch.setattr(many_logs, "read", lambda *_: time.sleep(3600))
        run = robot("audit", "runs", "--log-time", "100ms")
    assert run.status == 3
    assert "1 of 3 logs are unchanged" in run.err
    assert [one["verdict"] for one in evidence()["results"]] == [  # type: ignore[attr-defined]
        "satisfied", "no data", "no data"
    ]  # fmt: skip
    run = robot("audit", "runs")
    assert run.status == 1
    assert "1 of 3 logs are unchanged" in run.err
    assert "F440" not in run.err
    assert robot("audit", "runs").err.startswith("3 of 3 logs are unchanged")


def test_what_the_time_of_an_audit_does_not_reach_is_no_data(robot: Fretc) -> None:
    run = robot("audit", "runs/0.mcap", "runs/2.mcap", "--time", "1ns", "--format", "json")
    assert run.status == 3
    assert "F441 warning: the 1 ns of the audit were over: no data (in 2 of 2 logs" in run.err
    results = json.loads(run.out)
    assert [one["verdict"] for one in results] == ["no data"] * 2
    codes = {finding["code"] for one in results for finding in one["health"]["findings"]}
    assert codes == {"F441"}


@pytest.mark.slow
def test_limits_that_are_not_reached_change_nothing(robot: Fretc) -> None:
    whole = robot("audit", "runs", "--time", "1h", "--log-time", "1h")
    assert whole.status == 1
    timed = evidence()
    shutil.rmtree("build")
    robot("audit", "runs")
    assert evidence() == timed


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--time", "soon"], "`--time soon` is not a duration"),
        (["--log-time", "5"], "`--log-time 5` is not a duration"),
        (["--since", "soon"], "`--since soon` is neither a date nor a length of time"),
        (["--time", "1h", "--engine", "dask"], "`--engine dask` does not support time limits"),
        (["--notify", ""], "`--notify` names no command: it is empty"),
        (["--notify", "a 'b"], "`--notify` names no command: no closing quotation"),
    ],
)
def test_a_bad_option_is_told_before_anything_is_audited(
    robot: Fretc, options: list[str], message: str
) -> None:
    run = robot("audit", "runs", *options)
    assert run.status == 2
    assert f"F907 {message}" in run.err
    assert not Path("build").exists()


# Notices ---------------------------------------------------------------------------------------


def hook(name: str, text: str) -> str:
    path = Path(name)
    path.write_text(f"#!{sys.executable}\nimport sys\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path.absolute())


@pytest.mark.slow
def test_a_command_gets_the_summary_and_no_shell_sees_it(robot: Fretc) -> None:
    keep = hook("keep", "open(sys.argv[1], 'w').write(sys.stdin.read())")
    run = robot("audit", "runs", "--notify", f"{keep} 'a b;touch $HOME'")
    assert run.status == 1
    told = json.loads(Path("a b;touch $HOME").read_text())
    text = told.pop("text").splitlines()
    times = "\N{MULTIPLICATION SIGN}"
    assert text[0] == (
        f"3 runs {times} 1 requirement: 1 violated (1 requirement in 1 run), 2 satisfied"
    )
    assert text[1] == "worst: Low (R1) violated in runs/1.mcap"
    assert told == {
        "status": 1,
        "runs": 3,
        "requirements": 1,
        "counts": {"violated": 1, "satisfied": 2},
        "evidence": "build/evidence",
    }


@pytest.mark.slow
def test_the_store_is_free_when_the_command_reads_it(robot: Fretc) -> None:
    lock = hook(
        "lock",
        "import fcntl, os\n"
        "folder = os.open('build/evidence', os.O_RDONLY)\n"
        "fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)",
    )
    assert "sent the summary to" in robot("audit", "runs", "--notify", lock).err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "how"),
    [
        ("./no-such-command", "cannot be started: No such file or directory"),
        ("./fails", "ended with exit status 7"),
        ("./deaf", "ended with exit status 3"),
    ],
)
def test_a_command_that_fails_is_told_and_changes_nothing(
    robot: Fretc, command: str, how: str
) -> None:
    hook("fails", "sys.stdin.read(); print('noise'); sys.exit(7)")
    hook("deaf", "sys.exit(3)")
    plain = robot("audit", "runs", "--format", "json")
    shutil.rmtree("build")
    run = robot("audit", "runs", "--format", "json", "--notify", command)
    assert (run.status, run.out) == (plain.status, plain.out)
    assert f"F922 warning: `{command}` {how}: the summary was not delivered" in run.err
    assert os.path.exists("build/evidence/evidence.sqlite")
