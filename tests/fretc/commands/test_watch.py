"""`fretc watch` as its users meet it: what it prints, records, writes, and exits with."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from threading import Thread

import pytest

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.terminal.screen import Screen, width
from fretc.watch.session import Session
from fretc.watch.text_output import rows
from tests.command import PROCESS, Fretc, write
from tests.fretc.logs.logs import MS, S, Sent, number
from tests.fretc.logs.logs import write as log_of
from tests.fretc.watch.sent import SENTENCES, Setting, plan_of
from tests.fretc.watch.sent import Sent as Message
from tests.json_schemas import validate

ROOT = Path(__file__).parents[3]
FRET = """+++
id = "R1"
title = "Stops near obstacles"
+++
whenever near the robot shall within 2 ticks satisfy still
"""
BINDINGS = """
[clock]
tick = "100 ms"
[signal.gap]
path = "/gap.data"
[signal.v]
path = "/v.data"
[proposition.near]
expr = "gap < 5"
[proposition.still]
expr = "v < 1"
"""


@pytest.fixture(autouse=True)
def project(fretc: Fretc) -> None:
    """It stands in the folder in which the command runs."""
    write("requirements/r1.fret", FRET)
    write("requirements/bindings.toml", BINDINGS)


def messages(*, stops: bool = True) -> Iterator[Sent]:
    """Two seconds; an obstacle is near after one, and the robot stops, or does not."""
    for i in range(20):
        yield number(1.0 if i == 10 else 9.0, 1000 * S + i * 100 * MS, "/gap")
        moves = i < 11 or not stops
        yield number(3.0 if moves else 0.0, 1000 * S + i * 100 * MS + 10 * MS, "/v")


def recorded(path: str, *, stops: bool = True) -> str:
    return str(log_of(Path(path), list(messages(stops=stops)), per_chunk=3))


def lines(out: str) -> list[dict[str, object]]:
    found = [json.loads(line) for line in out.splitlines()]
    for line in found:
        validate("watch.schema.json", line)
    return found


def test_the_evidence_is_that_of_an_audit_of_the_recording(fretc: Fretc) -> None:
    log = recorded("run.mcap")
    run = fretc("watch", log, "--record", "seen.mcap", "--evidence", "live.json")
    assert (run.status, run.out.splitlines()[-1]) == (
        0,
        "run 1 ended after 20 ticks, recorded in seen.mcap: R1 satisfied",
    )
    assert fretc("audit", "seen.mcap", "-o", "later.json").status == 0
    assert Path("live.json").read_bytes() == Path("later.json").read_bytes()
    assert "F432" in fretc("audit", "seen.mcap", "-o", "later.json").err


@pytest.mark.slow
@pytest.mark.parametrize("stops", [True, False])
def test_each_line_for_a_program_fits_the_schema(fretc: Fretc, *, stops: bool) -> None:
    run = fretc("watch", recorded("run.mcap", stops=stops), "--format", "jsonl")
    found = lines(run.out)
    assert run.status == (0 if stops else 1)
    assert found[0] == {"type": "opened", "source": "run.mcap"}
    assert found[-1]["verdicts"] == {"R1": "satisfied" if stops else "violated"}
    obligation_pending = [
        line["obligation_pending"] for line in found if line["type"] == "requirement"
    ]
    assert True in obligation_pending
    assert obligation_pending[-1] is (not stops)
    violated = [line["violated_ns"] for line in found if line["type"] == "requirement"]
    assert violated[-1] == (None if stops else 1000 * S + 1200 * MS + 10 * MS)


def test_a_clock_by_stamps_asks_for_a_lateness(fretc: Fretc) -> None:
    write(
        "requirements/bindings.toml", BINDINGS.replace("[clock]", '[clock]\ntime = "header.stamp"')
    )
    run = fretc("watch", recorded("run.mcap"))
    assert run.status == 2
    assert "F950" in run.err
    assert 'lateness = "50 ms"' in run.err
    assert "bindings.toml:2:1" in run.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["none.mcap"], "F901"),
        (["run.mcap", "other"], "F907"),
        (["run.mcap", "--evidence", "e.json"], "F907"),
        (["run.mcap", "--on-violation", ""], "F907"),
        (["run.mcap", "--record", "run.mcap"], "F905"),
        (["run.mcap", "--record", "there.mcap"], "F905"),
        (["run.mcap", "--record", "no/such/folder.mcap"], "F905"),
        (["run.mcap", "--record", "-"], "F905"),
        (
            ["run.mcap", "--record", "requirements"],
            "F905 `requirements` cannot be written: it is a folder",
        ),
        (["run.mcap", "--record", "new.mcap", "--evidence", "requirements"], "F905"),
        (["requirements/r1.fret"], "F402"),
    ],
)
def test_bad_use_and_bad_input(fretc: Fretc, arguments: list[str], code: str) -> None:
    log = Path(recorded("run.mcap")).read_bytes()
    write("there.mcap", "mine")
    run = fretc("watch", *arguments)
    assert run.status == 2
    assert run.err.splitlines()[0].startswith(code)
    assert Path("run.mcap").read_bytes() == log
    assert Path("there.mcap").read_text() == "mine"
    assert not Path("new.mcap").exists()


def test_a_log_that_breaks_off_satisfies_nothing(fretc: Fretc) -> None:
    data = Path(recorded("run.mcap")).read_bytes()
    for size, why in ((len(data) // 2, "it breaks off"), (0, "it is empty")):
        Path("cut.mcap").write_bytes(data[:size])
        run = fretc("watch", "cut.mcap")
        assert run.status == 2
        assert why in run.err
        assert "missed 1 message: unknown" in run.out
        assert run.out.splitlines()[-1].endswith("R1 no data")


@pytest.mark.parametrize(("log", "code"), [("nowhere.mcap", "F901"), ("folder", "F902")])
def test_what_is_no_file_is_refused_as_an_audit_refuses_it(
    fretc: Fretc, log: str, code: str
) -> None:
    recorded("run.mcap")
    Path("folder").mkdir()
    run = fretc("watch", log)
    assert run.status == 2
    assert f"{code} " in run.err
    assert "\nhelp: " in run.err


def test_a_log_that_is_being_recorded_is_followed_to_its_end(fretc: Fretc) -> None:
    """It comes in pieces of some bytes: each record is there in part before it is whole."""
    data = Path(recorded("whole.mcap", stops=False)).read_bytes()
    Path("run.mcap").write_bytes(b"")

    def grow() -> None:
        with Path("run.mcap").open("ab", buffering=0) as stream:
            for at in range(0, len(data), 97):
                stream.write(data[at : at + 97])

    thread = Thread(target=grow)
    thread.start()
    run = fretc("watch", "run.mcap", "--follow")
    thread.join()
    whole = fretc("watch", "whole.mcap")
    assert (run.status, run.err) == (1, "")
    assert run.out == whole.out.replace("whole.mcap", "run.mcap")


def test_a_command_gets_the_facts_of_a_violation(fretc: Fretc) -> None:
    read_it = "os.environ['FRETC_REQUIREMENT'] + sys.stdin.read()"
    program = f"import os, sys; open('facts', 'w').write({read_it})"
    log = recorded("run.mcap", stops=False)
    run = fretc("watch", log, "--on-violation", f'{sys.executable} -c "{program}"')
    assert (run.status, run.err) == (1, "")
    text = Path("facts").read_text()
    assert text.startswith("R1")
    facts = json.loads(text[2:])
    validate("watch.schema.json", facts)
    assert (facts["requirement"], facts["verdict"]) == ("R1", "violated")


@pytest.mark.parametrize("command", ["false", "/no/such/program"])
def test_a_command_that_fails_is_told_and_changes_nothing(fretc: Fretc, command: str) -> None:
    run = fretc("watch", recorded("run.mcap", stops=False), "--on-violation", command)
    assert run.status == 1
    assert run.err.startswith("F954 warning: ")


def test_a_command_that_hangs_ends_with_the_watch_and_with_all_that_it_started(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fretc.watch.reaction._LAST", 1)
    write("hang.sh", "sleep 60 & echo $! $$ > pids.new; mv pids.new pids; wait\n")
    log = recorded("run.mcap", stops=False)
    run = fretc("watch", log, "--on-violation", "/bin/sh hang.sh")
    assert run.status == 1
    assert run.err.startswith(
        "F954 warning: `/bin/sh` was stopped: it still ran 1 s after the end of the watch"
    )
    for pid in map(int, Path("pids").read_text().split()):
        assert not _is_running(pid)


def _is_running(pid: int) -> bool:
    """Killed and not yet waited for by anybody (`Z`) is not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_publishing_changes_nothing_else(fretc: Fretc) -> None:
    log = recorded("run.mcap", stops=False)
    plain, published = fretc("watch", log), fretc("watch", log, "--publish", "foxglove:0")
    assert (published.status, published.out) == (plain.status, plain.out)
    assert published.err.startswith("publishes at ws://127.0.0.1:")


@pytest.mark.parametrize("where", ["rviz", "diagnostics"])
def test_what_cannot_be_published_is_said_before_anything_is_recorded(
    fretc: Fretc, where: str
) -> None:
    run = fretc("watch", recorded("run.mcap"), "--record", "seen.mcap", "--publish", where)
    assert run.status == 2
    assert run.err.startswith("F907 ")
    assert not Path("seen.mcap").exists()


@pytest.mark.slow
@pytest.mark.parametrize("number_", [signal.SIGINT, signal.SIGTERM])
def test_a_watch_that_is_stopped_leaves_a_whole_recording_and_its_evidence(number_: int) -> None:
    data = Path(recorded("whole.mcap")).read_bytes()
    summary = int.from_bytes(data[-28:-20], "little")
    Path("run.mcap").write_bytes(data[: summary - 9])  # within the head of its last record
    options = ("--record", "seen.mcap", "--evidence", "e.json", "--format", "jsonl", "--follow")
    with subprocess.Popen(
        [*PROCESS, "watch", "run.mcap", *options],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if '"satisfied"' in line:
                process.send_signal(number_)
                break
        rest = process.stdout.read()
        assert process.wait(60) == 0
    assert lines(rest)[-1]["recording"] == "seen.mcap"
    assert json.loads(Path("e.json").read_text())["results"][0]["verdict"] == "satisfied"
    recording = read("seen.mcap", plan_of(Setting()).declarations, [])
    assert isinstance(recording, Recording)
    assert recording.intact


@pytest.mark.slow
@pytest.mark.parametrize("columns", [40, 60, 120])
def test_no_row_is_wider_than_the_screen(columns: int) -> None:
    session = Session(plan_of(Setting()))
    titles = {"R0": "A title that is much too long for any screen, however wide it may be"}
    screen = Screen(columns)

    def shown() -> list[str]:
        found = ["".join(text for text, _ in row) for row in rows(session, titles, screen)]
        assert all(width(line) <= columns for line in found)
        return found

    assert "waits for" not in shown()[-1]
    session.arrive(Message("/x", 1.0, 0).arrival)
    session.arrive(Message("/x", 1.0, 7).arrival)
    assert "waits for /y" in shown()[-1]
    for at in range(10, 200, 10):
        session.arrive(Message("/x", 1.0, at).arrival)
        session.arrive(Message("/y", 9.0, at, delay=60).arrival)
    found = shown()
    assert len(found) == len(SENTENCES) + 1 + 2 + 1
    assert any("late" in line for line in found)
