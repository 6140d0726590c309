"""What is known of an unchanged log is taken over, and the store is the one made from nothing."""

import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from sqlite3 import OperationalError
from typing import Any

import pytest

from compiler.files import text_files as files
from compiler.files.user_key import user_key
from fretc.audit import into_store
from fretc.audit.into_store import StoredAudit, StoreWriter
from fretc.audit.many_logs import (
    SEQUENTIAL,
    Engine,
    LogAudits,
    audit_log,
    audit_logs,
    local_executor,
)
from fretc.audit.plan import Plan
from fretc.audit.store import container
from fretc.audit.store.anywhere import source
from fretc.audit.store.container import Row
from fretc.audit.store.reader import Store, evidence, opened
from fretc.audit.store.writer import StoreFile
from fretc.logs.signals.integrity import Integrity
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc, untimed
from tests.effort import some
from tests.fretc.audit.plans import plan
from tests.fretc.audit.store.test_hostile import edit
from tests.traces import part

ROOT = Path(__file__).parents[3]
STORE = Path("build/evidence")
LOGS = ["a.mcap", "b.mcap", "c.mcap"]


@pytest.fixture
def fretc(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> Fretc:
    """Run the command in a folder with requirements and three logs that count as old."""
    monkeypatch.setattr(files, "_COARSEST", -1)
    shutil.copytree(ROOT / "requirements", "requirements")
    for log in LOGS:
        Path(log).write_bytes(part())
    return fretc


def session(
    logs: Sequence[str] = LOGS, own: Plan | None = None, folder: Path = STORE, rehash: bool = False
) -> StoreWriter:
    key = user_key()
    assert isinstance(key, bytes)
    return StoreWriter(folder, own or plan(), logs, key, rehash=rehash)


def stored(
    logs: Sequence[str] = LOGS,
    own: Plan | None = None,
    engine: Engine = SEQUENTIAL,
    folder: Path = STORE,
) -> tuple[StoredAudit, list[str]]:
    """Audit into a store; also the logs that were read."""
    names: list[str] = []
    with session(logs, own, folder) as one:
        found = one.run(engine, names.append)
        assert isinstance(found, StoredAudit), found.message
        return found, names


def known(logs: Sequence[str] = LOGS, *, rehash: bool = False) -> dict[str, str]:
    """Which of the logs need not be read again, and by what they are known."""
    with session(logs, rehash=rehash) as one:
        return {log: by for log, (_, by) in one.known.items()}


def content(folder: Path = STORE) -> tuple[str, list[Row]]:
    """The SHA-256 of the evidence, and the row of each run."""
    store = opened(str(folder))
    assert isinstance(store, Store), store
    return store.sha256, [*store.rows]


def opened_in_full(folder: Path) -> Store:
    """A store of which all has been checked."""
    found = source(str(folder), in_full=True)
    assert isinstance(found, Store), found
    return found


def known_by(folder: Path = STORE) -> list[str]:
    """How each log was identified."""
    with container.opened(folder / container.FILE) as connection:
        entries = connection.execute("SELECT entry FROM runs ORDER BY place").fetchall()
    return [json.loads(entry)["known_by"] for (entry,) in entries]


def damage(log: str) -> None:
    """Change one byte and nothing that `ls -l` shows."""
    before = os.stat(log)
    data = bytearray(Path(log).read_bytes())
    data[len(data) // 2] ^= 1
    Path(log).write_bytes(data)
    os.utime(log, ns=(before.st_atime_ns, before.st_mtime_ns))


def backwards(plan: Plan, logs: Sequence[str]) -> LogAudits:
    """An engine that is done with the last log first."""
    for log in reversed(logs):
        yield log, audit_log(plan, log)


def interrupted(after: int) -> Engine:
    """An engine that Ctrl-C stops when so many logs are done."""

    def engine(plan: Plan, logs: Sequence[str]) -> LogAudits:
        for log in logs[:after]:
            yield log, audit_log(plan, log)
        raise KeyboardInterrupt

    return engine


def stop_after(logs: int) -> None:
    with session() as one, pytest.raises(KeyboardInterrupt):
        one.run(interrupted(logs), lambda _: None)


# The same from nothing ---------------------------------------------------------------------------


@pytest.mark.confined
@pytest.mark.slow
def test_a_store_depends_on_no_engine_and_no_order(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    damage("b.mcap")
    whole = audit_logs(plan(), [*LOGS, "none.mcap"])
    assert not isinstance(whole, Diagnostic)
    first, _ = stored([*LOGS, "none.mcap"])
    assert evidence(first.source).document == whole.document
    assert (first.diagnostics, first.read) == (whole.diagnostics, whole.read)
    for number, engine in enumerate((backwards, local_executor(2))):
        folder = Path(f"store{number}")
        stored([*LOGS, "none.mcap"], engine=engine, folder=folder)
        assert content(folder) == content()


@pytest.mark.slow
def test_what_is_taken_over_is_what_would_be_made_from_nothing(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever is added, changed, gone, or called otherwise."""
    stored()
    shutil.copy("a.mcap", "d.mcap")
    changes: list[tuple[list[str], list[str]]] = [
        (LOGS, []),
        (["a.mcap", "d.mcap", "b.mcap", "c.mcap"], ["d.mcap"]),
        (["d.mcap", "b.mcap"], []),
        (["b.mcap", "a.mcap"], ["a.mcap"]),
    ]
    for number, (logs, read) in enumerate(changes):
        found, names = stored(logs)
        assert names == read
        anew, _ = stored(logs, folder=Path(f"anew{number}"))
        assert content() == content(Path(f"anew{number}"))
        assert found.diagnostics == anew.diagnostics
        assert known_by() == ["read" if log in read else "stamp" for log in logs]


@pytest.mark.slow
def test_a_night_after_a_change_gives_the_store_of_an_audit_from_nothing(fretc: Fretc) -> None:
    """The rows hold the hashes of each record and each summary as they are packed."""
    stored()
    damage("b.mcap")
    found, names = stored()
    assert names == ["b.mcap"]
    anew, _ = stored(folder=Path("anew"))
    assert content() == content(Path("anew"))
    assert [*found.source.summaries()] == [*anew.source.summaries()]
    assert [*found.source.summaries()] == [*opened_in_full(STORE).summaries()]


@pytest.mark.slow
def test_an_idle_night_reads_no_record(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    first, _ = stored()
    before = [*first.source.summaries()]
    for name in ("fretc.audit.into_store.unpacked", "fretc.audit.into_store.packed"):
        monkeypatch.setattr(name, None)
    monkeypatch.setattr("fretc.audit.store.register.file_sha256", None)
    found, names = stored()
    assert names == []
    monkeypatch.setattr("fretc.audit.store.reader.unpacked", None)
    assert [*found.source.summaries()] == before


@pytest.mark.slow
def test_labels_of_the_command_are_those_of_the_last_one(fretc: Fretc) -> None:
    stored(own=replace(plan(), labels={"version": "1", "robot": "x"}))
    found, names = stored(own=replace(plan(), labels={"version": "2"}))
    assert names == []
    assert {str(one.labels) for one in found.source.runs()} == {"{'version': '2'}"}


@pytest.mark.slow
def test_other_labels_keep_the_results_of_requirements_that_are_not_judged(fretc: Fretc) -> None:
    Path("requirements/r2.fret").write_text('+++\nid = "R2"\n+++\nthe robot shall')
    for version in "12":
        assert fretc("audit", *LOGS, "--label", f"version={version}").status == 2
        store = opened(str(STORE))
        assert isinstance(store, Store)
        labelled = {(one.requirement, str(one.labels)) for one in store.results()}
        assert labelled == {(id, f"{{'version': '{version}'}}") for id in ("R1", "R2")}
    assert known_by() == ["stamp"] * 3


@pytest.mark.slow
def test_the_command_says_what_is_known_and_shows_all(fretc: Fretc) -> None:
    whole = fretc("audit", *LOGS)
    again = fretc("audit", *LOGS)
    assert (again.status, untimed(again.out)) == (whole.status, untimed(whole.out))
    assert again.err == f"3 of 3 logs are unchanged: their earlier results are reused\n{whole.err}"
    fewer = fretc("audit", *LOGS[:2])
    assert "\n1 log of the store is not among the inputs: its results are removed\n" in fewer.err


# What is known -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_log_is_known_by_its_stamp_or_its_bytes(fretc: Fretc) -> None:
    stored()
    assert known() == dict.fromkeys(LOGS, "stamp")
    assert known(rehash=True) == dict.fromkeys(LOGS, "sha256")
    shutil.copy("a.mcap", "other.mcap")
    os.replace("other.mcap", "a.mcap")
    damage("b.mcap")
    Path("c.mcap").unlink()
    assert known() == {"a.mcap": "sha256"}


@pytest.mark.slow
def test_a_log_that_had_just_been_written_is_known_by_its_bytes_only(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "_COARSEST", 10**18)
    stored(LOGS[:2])
    assert known() == {"a.mcap": "sha256", "b.mcap": "sha256"}


def test_a_log_of_the_same_name_elsewhere_is_another_one(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored(LOGS[:1])
    Path("elsewhere").mkdir()
    os.link("a.mcap", "elsewhere/a.mcap")
    folder, own = STORE.absolute(), plan()
    monkeypatch.chdir("elsewhere")
    with session(LOGS[:1], own, folder) as one:
        assert one.known == {}


@pytest.mark.slow
def test_a_log_that_could_not_be_read_or_has_changed_meanwhile_is_tried_again(fretc: Fretc) -> None:
    def growing(plan: Plan, logs: Sequence[str]) -> LogAudits:
        for log in logs:
            yield log, replace(audit_log(plan, log), stamp=None)

    Path("bad.mcap").write_bytes(b"no log")
    stored(["bad.mcap", *LOGS[:2]])
    assert known(["bad.mcap", *LOGS[:2]]) == {"a.mcap": "stamp", "b.mcap": "stamp"}
    stored(["c.mcap"], engine=growing)
    assert known() == {}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("requirements/r1.fret", "eventually", "within 300 milliseconds"),
        ("requirements/bindings.toml", "0.01 rad/s", "0.02 rad/s"),
    ],
)
def test_another_requirement_or_binding_makes_all_of_it_new(
    fretc: Fretc, file: str, old: str, new: str
) -> None:
    stored()
    text = Path(file).read_text("utf-8")
    assert old in text
    Path(file).write_text(text.replace(old, new), "utf-8")
    assert known() == {}
    assert fretc("audit", *LOGS).err.startswith(
        "requirements, bindings or fretc have changed: all logs are audited again\n"
    )


@pytest.mark.slow
def test_another_fretc_or_integrity_makes_all_of_it_new(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored()
    with session(own=plan(Integrity.FULL)) as one:
        assert (one.known, one.earlier.stale) == ({}, True)
    monkeypatch.setattr("fretc.audit.plan.build_id", lambda: "another")
    assert known() == {}


# Stopped -----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_an_audit_that_goes_on_gives_the_store_of_one_that_was_not_stopped(fretc: Fretc) -> None:
    whole, _ = stored(folder=Path("whole"))
    stop_after(2)
    assert os.listdir(STORE) == ["unfinished-1.sqlite"]
    again, names = stored()
    assert names == ["c.mcap"]
    assert content() == content(Path("whole"))
    assert again.diagnostics == whole.diagnostics
    assert sorted(os.listdir(STORE)) == sorted(os.listdir("whole"))


@pytest.mark.slow
def test_only_what_is_written_counts_as_kept(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    put, full = StoreFile.put, OperationalError("database or disk is full")

    def put_two(file: StoreFile, *values: Any) -> None:
        if file.runs == 2:
            raise full
        put(file, *values)

    monkeypatch.setattr(StoreFile, "put", put_two)
    with session() as one:
        wrong = one.run(SEQUENTIAL, lambda _: None)
    assert isinstance(wrong, Diagnostic)
    assert wrong.message == f"`{STORE}/evidence.sqlite` cannot be written: database or disk is full"
    assert one.kept == len(known()) == 2


@pytest.mark.slow
def test_an_audit_that_is_stopped_leaves_the_store_of_the_last_one(fretc: Fretc) -> None:
    first, _ = stored(LOGS[:1])
    damage("a.mcap")
    before = evidence(first.source)
    stop_after(1)
    store = opened(str(STORE))
    assert isinstance(store, Store)
    assert evidence(store) == before
    assert known() == {"a.mcap": "stamp"}


STEPS = (
    "StoreFile.put",
    "StoreFile.close",
    "complete",
    "publish",
    "remove_file",
    "earlier_store.remove_tables",
)
"""What an audit calls to change files."""


def killed_at(moment: int) -> bool:
    """Audit in a process that is killed before or after a step; whether it came so far.

    Args:
        moment: the number of begins and ends of steps before that.
    """
    process = os.fork()
    if process == 0:
        count = iter(range(moment + 1))

        def tick() -> None:
            if next(count) == moment:
                os.kill(os.getpid(), signal.SIGKILL)

        def deadly(step: Any) -> Any:
            def own(*values: Any) -> Any:
                tick()
                found = step(*values)
                tick()
                return found

            return own

        for name in STEPS:
            *within, last = name.split(".")
            place: Any = getattr(into_store, within[0]) if within else into_store
            setattr(place, last, deadly(getattr(place, last)))
        try:
            stored()
        finally:
            os._exit(0)
    return os.waitpid(process, 0)[1] == signal.SIGKILL


@pytest.mark.slow
def test_a_changed_night_that_is_killed_at_any_write_loses_nothing(fretc: Fretc) -> None:
    first, _ = stored()
    damage("b.mcap")
    last, _ = stored(folder=Path("whole"))
    shutil.copytree(STORE, "before")
    most = next(moment for moment in range(100) if not killed_again(moment))
    assert most >= 14, "three runs, the end of the file, its head and its name"
    evidences = {first.source.sha256, last.source.sha256}
    for moment in some(range(most), 5):
        assert killed_again(moment)
        assert opened_in_full(STORE).sha256 in evidences
        assert {"a.mcap", "c.mcap"} <= known().keys()
        stored()
        assert content() == content(Path("whole"))
        assert os.listdir(STORE) == ["evidence.sqlite"]


def killed_again(moment: int) -> bool:
    """From the store of the first night on."""
    for path in STORE.iterdir():
        path.unlink()
    shutil.copy("before/evidence.sqlite", STORE)
    return killed_at(moment)


NEVER_DONE = """
import os, time
from fretc.audit import many_logs
from fretc.cli import main

judge, process = many_logs.audit_log, os.getpid()

def audit_log(plan, log, *more):
    while log > "b" and os.getppid() == process:
        time.sleep(0.02)
    return judge(plan, log, *more)

many_logs.audit_log = audit_log
main()
"""
"""`fretc` whose processes wait at some logs as long as it lives."""


def written() -> int:
    """The bytes of the transactions of an audit that is in progress."""
    path = STORE / "unfinished-1.sqlite-wal"
    return path.stat().st_size if path.exists() else 0


@pytest.mark.slow
@pytest.mark.parametrize("stop", some([signal.SIGINT, signal.SIGTERM, signal.SIGKILL], 2))
def test_a_command_is_stopped_and_goes_on(fretc: Fretc, stop: signal.Signals) -> None:
    logs = [f"{name}{number}.mcap" for name in "ab" for number in range(3)]
    for log in logs:
        os.link("a.mcap", log)
    run = subprocess.Popen(
        [sys.executable, "-c", NEVER_DONE, "audit", *logs, "--jobs", "2"],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler) and None,
    )
    deadline = time.monotonic() + 60
    changes = STORE / "unfinished-1.sqlite-wal"
    while time.monotonic() < deadline and not (
        changes.exists() and changes.stat().st_size > 16_000
    ):
        time.sleep(0.01)
    run.send_signal(stop)
    _, errors = run.communicate(timeout=60)
    assert not (STORE / "evidence.sqlite").exists()
    count = len(known(logs))
    assert 0 < count <= 3, "it was stopped before the last three"
    if stop is not signal.SIGKILL:
        words = f"stopped: {count} of 6 logs are saved; run the same command again to continue\n"
        assert (run.returncode, errors) == (130, words)
    resumed = fretc("audit", *logs)
    assert resumed.status == 0
    told = f"{count} of 6 logs are unchanged: their earlier results are reused\n"
    assert resumed.err.startswith(told)
    store = opened(str(STORE))
    assert isinstance(store, Store)
    assert [facts.run for facts in store.runs()] == logs


@pytest.mark.slow
def test_two_audits_do_not_share_a_store(fretc: Fretc) -> None:
    with session():
        run = fretc("audit", *LOGS)
        assert (run.status, run.out) == (2, "")
        assert run.err.startswith(f"F912 another audit is writing to `{STORE}`\n")
    assert fretc("audit", *LOGS).status == 0


# Somebody else's ---------------------------------------------------------------------------------


FOREIGN = (
    f"`{STORE}` was written by another user or in another folder: its results are not reused\n"
)


@pytest.mark.slow
def test_a_store_that_another_user_has_written_is_not_used_and_that_is_said(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with monkeypatch.context() as other:
        other.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
        stored()
    assert known() == {}
    run = fretc("audit", *LOGS)
    assert run.err.startswith(FOREIGN)
    assert known() == dict.fromkeys(LOGS, "stamp")


@pytest.mark.slow
def test_a_store_is_believed_in_its_place_only(fretc: Fretc) -> None:
    stored()
    shutil.move(STORE, "elsewhere")
    with session(folder=Path("elsewhere")) as one:
        assert (one.known, one.earlier.foreign) == ({}, True)


@pytest.mark.slow
def test_a_run_of_which_something_is_another_is_not_believed(fretc: Fretc) -> None:
    """Its log is read again; other runs are believed."""
    stored()
    path = STORE / "evidence.sqlite"
    sound = path.read_bytes()
    for change in (
        "record = x'00'",
        "sha256 = packed_sha256",
        "packed_sha256 = sha256",
        "summary = x'00'",
        "summary_sha256 = sha256",
        "summary_sha256 = NULL",
        "size = 1",
        "results = 2",
        "entry = replace(entry, 'read', 'stamp')",
        "entry = NULL",
        "mark = NULL",
        "mark = ''",
    ):
        path.write_bytes(sound)
        edit(STORE, f"UPDATE runs SET {change} WHERE place = 1")
        assert known() == {"a.mcap": "stamp", "c.mcap": "stamp"}, change
    path.write_bytes(sound)
    edit(STORE, "UPDATE runs SET place = 9 WHERE place = 0")
    assert known() == dict.fromkeys(LOGS, "stamp")


@pytest.mark.slow
def test_a_store_with_another_byte_gives_no_other_results(fretc: Fretc) -> None:
    stored()
    before, data = content(), (STORE / "evidence.sqlite").read_bytes()
    for place in some(range(0, len(data), 101), 7):
        changed = data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]
        (STORE / "evidence.sqlite").write_bytes(changed)
        stored()
        assert content() == before


@pytest.mark.slow
def test_another_plan_in_a_store_does_not_count(fretc: Fretc) -> None:
    stored()
    path = STORE / "evidence.sqlite"
    sound = path.read_bytes()
    for other in ("''", "'{}'", "'['", "1", "NULL", "replace(plan, '}', ' }')", "x'ff'"):
        path.write_bytes(sound)
        edit(STORE, f"UPDATE about SET plan = {other}")
        assert known() == {}


@pytest.mark.slow
def test_a_key_that_others_can_read_is_not_used_and_the_audit_goes_on(fretc: Fretc) -> None:
    stored()
    path = Path(os.environ["XDG_STATE_HOME"]) / "fretc/journal.key"
    path.chmod(0o644)
    run = fretc("audit", *LOGS)
    assert run.status == 0
    assert run.err.startswith(
        f"F920 warning: `{path}` cannot be used: other users may read or write it"
    )
    path.chmod(0o600)
    path.unlink()
    path.symlink_to("/dev/zero")
    assert fretc("audit", *LOGS).err.startswith(f"F920 warning: `{path}` cannot be used: ")


def test_the_key_is_made_once_and_private(fretc: Fretc) -> None:
    before = os.umask(0)
    try:
        first = user_key()
    finally:
        os.umask(before)
    assert first == user_key()
    path = Path(os.environ["XDG_STATE_HOME"]) / "fretc/journal.key"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert os.listdir(path.parent) == ["journal.key"]


# Where it goes -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_one_log_is_a_file_and_several_are_a_store_and_the_other_one_goes(fretc: Fretc) -> None:
    fretc("audit", "a.mcap")
    assert os.listdir("build") == ["evidence.json"]
    run = fretc("audit", *LOGS)
    assert os.listdir("build") == ["evidence"]
    assert "removed build/evidence.json, the evidence of an earlier audit\n" in run.err
    run = fretc("audit", "a.mcap")
    assert os.listdir("build") == ["evidence.json"]
    assert "removed build/evidence, the evidence of an earlier audit\n" in run.err
    for name in ("one", "all.json"):
        assert fretc("audit", *LOGS, "-o", name).status == 0
    assert os.listdir("build") == ["evidence.json"]
    assert len(json.loads(Path("all.json").read_text())["results"]) == 3
    assert fretc("audit", "a.mcap", "-o", "one").status == 0
    assert fretc("report", "--evidence", "one").status in (0, 3)


@pytest.mark.slow
def test_nothing_of_the_user_s_is_replaced_or_removed(fretc: Fretc) -> None:
    Path("build").mkdir()
    Path("build/evidence.json").write_text("{}")
    Path("mine").mkdir()
    Path("mine/results").mkdir()
    Path("mine/results/own.parquet").write_text("precious")
    Path("file").write_text("precious")
    for name in ("mine", "file"):
        run = fretc("audit", *LOGS, "-o", name)
        assert (run.status, run.out) == (2, "")
        assert run.err.startswith(f"F905 `{name}` cannot be written: ")
    assert fretc("audit", *LOGS).status == 0
    assert Path("build/evidence.json").read_text() == "{}"
    run = fretc("report")
    assert run.err.startswith("F517 evidence is in `build/evidence.json` and in `build/evidence`")
    os.symlink("mine", "link")
    assert fretc("audit", *LOGS, "-o", "link").err.startswith("F905 ")
    assert Path("mine/results/own.parquet").read_text() == "precious"


@pytest.mark.slow
def test_a_mistyped_name_does_not_cost_the_evidence_of_the_last_audit(fretc: Fretc) -> None:
    stored()
    before = (STORE / "evidence.sqlite").read_bytes()
    run = fretc("audit", "no.mcap", "none.mcap", "-o", str(STORE))
    assert run.status == 2
    assert f"no log could be read: `{STORE}` is unchanged\n" in run.err
    assert before == (STORE / "evidence.sqlite").read_bytes()
    assert os.listdir(STORE) == ["evidence.sqlite"]
    assert fretc("audit", "no.mcap", "none.mcap", "-o", "new").status == 2
    assert not Path("new").exists()


def test_a_place_that_cannot_be_written_is_told(fretc: Fretc) -> None:
    Path("build").write_text("no folder")
    run = fretc("audit", *LOGS)
    assert run.status == 2
    assert run.err.startswith(f"F905 `{STORE}` cannot be written: ")
    assert Code.NOT_WRITTEN.number == "F905"
