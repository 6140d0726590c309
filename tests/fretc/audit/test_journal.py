"""What a stopped audit has finished is not audited again, where it would be the same."""

import hashlib
import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from compiler.files import text_files as files
from compiler.files.user_key import user_key
from compiler.project.folder import load
from compiler.project.paths import beside, requirement_files
from fretc.audit.journal import Journal
from fretc.audit.many_logs import Audit, LogAudit, audit_logs, audited
from fretc.audit.plan import Plan, planned
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc, untimed

ROOT = Path(__file__).parents[3]
EVIDENCE = Path("build/evidence.json")
JOURNAL = Path("build/evidence.json.journal")
LOGS = ["a.mcap", "b.mcap", "c.mcap"]


@pytest.fixture
def fretc(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> Fretc:
    """Run the command in a folder with requirements and three logs that count as old."""
    monkeypatch.setattr(files, "_COARSEST", -1)
    shutil.copytree(ROOT / "requirements", "requirements")
    for log in LOGS:
        shutil.copy(ROOT / "traces/mission-seed15.mcap", log)
    return fretc


def plan(evaluation: str = "columns") -> Plan:
    paths = requirement_files("requirements")
    assert not isinstance(paths, Diagnostic)
    result = planned(load(paths, beside("requirements", "bindings.toml")), evaluation)
    assert isinstance(result, Plan)
    return result


def journal_of(plan: Plan, evidence: Path = EVIDENCE) -> Journal:
    key = user_key()
    assert isinstance(key, bytes)
    return Journal(evidence, plan, key)


def stopped(logs: Sequence[str] = LOGS[:2]) -> None:
    """Leave what an audit leaves that was stopped when these logs were finished."""
    journal = journal_of(plan())
    for log in logs:
        assert journal.keep(log, audited(plan(), log)) is True
    journal.close()


def finished() -> list[str]:
    """The logs that need not be audited again."""
    journal = journal_of(plan())
    audits = journal.finished(LOGS)
    assert not isinstance(audits, Diagnostic)
    journal.close()
    return list(audits)


def damage(log: str) -> None:
    """Change one byte and nothing that `ls -l` shows."""
    before = os.stat(log)
    data = bytearray(Path(log).read_bytes())
    data[len(data) // 2] ^= 1
    Path(log).write_bytes(data)
    os.utime(log, ns=(before.st_atime_ns, before.st_mtime_ns))


@pytest.mark.slow
def test_what_is_finished_is_what_was_shown(fretc: Fretc) -> None:
    damage("b.mcap")
    stopped()
    journal = journal_of(plan())
    assert journal.finished(LOGS) == {log: audited(plan(), log) for log in LOGS[:2]}


@pytest.mark.slow
def test_an_audit_that_goes_on_gives_the_evidence_of_one_that_was_not_stopped(
    fretc: Fretc,
) -> None:
    damage("b.mcap")
    whole = fretc("audit", *LOGS)
    evidence = EVIDENCE.read_bytes()
    for jobs in ("1", "2"):
        EVIDENCE.unlink()
        stopped()
        run = fretc("audit", *LOGS, "--resume", "--jobs", jobs)
        assert EVIDENCE.read_bytes() == evidence
        assert (run.status, untimed(run.out)) == (whole.status, untimed(whole.out))
        assert run.err == f"2 of 3 logs are audited already\n{whole.err}"
        assert not JOURNAL.exists()


def test_only_what_is_not_finished_is_audited(fretc: Fretc) -> None:
    stopped()
    journal = journal_of(plan())
    audits = journal.finished(LOGS)
    assert not isinstance(audits, Diagnostic)
    names: list[str] = []
    result = audit_logs(plan(), LOGS, finished=audits, tell=lambda log, _: names.append(log))
    assert isinstance(result, Audit)
    assert names == ["c.mcap"]


def test_a_log_with_another_byte_is_audited_again_whatever_its_time_says(fretc: Fretc) -> None:
    stopped()
    assert finished() == ["a.mcap", "b.mcap"]
    damage("a.mcap")
    assert finished() == ["b.mcap"]


def test_a_log_that_is_moved_aside_and_back_is_known_by_its_hash(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    stopped()
    shutil.copy("a.mcap", "other.mcap")
    os.replace("other.mcap", "a.mcap")
    assert finished() == ["a.mcap", "b.mcap"]
    hashed: list[str] = []
    monkeypatch.setattr("fretc.audit.journal.file_sha256", hashed.append)
    assert finished() == ["b.mcap"]
    assert hashed == ["a.mcap"]


def test_a_log_that_had_just_been_written_is_known_by_its_hash_only(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "_COARSEST", 10**18)
    stopped()
    monkeypatch.setattr("fretc.audit.journal.file_sha256", lambda log: None)
    assert finished() == []


def test_a_log_that_is_gone_is_not_known(fretc: Fretc) -> None:
    stopped()
    Path("a.mcap").unlink()
    assert finished() == ["b.mcap"]


def test_a_log_that_could_not_be_read_or_has_changed_meanwhile_is_not_kept(fretc: Fretc) -> None:
    journal = journal_of(plan())
    assert journal.keep("no.mcap", audited(plan(), "no.mcap")) is False
    good = audited(plan(), "a.mcap")
    assert journal.keep("a.mcap", LogAudit(good.results, (), read=True, stamp=None)) is False
    assert not JOURNAL.exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("requirements/r1.fret", "eventually", "within 300 milliseconds"),
        ("requirements/bindings.toml", "0.01 rad/s", "0.02 rad/s"),
        ("requirements/bindings.toml", "[clock]", "# a line more\n[clock]"),
    ],
)
def test_another_requirement_or_binding_makes_all_of_it_new(
    fretc: Fretc, file: str, old: str, new: str
) -> None:
    stopped()
    text = Path(file).read_text("utf-8")
    assert old in text
    Path(file).write_text(text.replace(old, new), "utf-8")
    assert finished() == []
    run = fretc("audit", *LOGS, "--resume")
    assert run.err.startswith(
        "0 of 3 logs are audited already: requirements, bindings or fretc have changed since then\n"
    )


def test_an_audit_that_was_not_stopped_is_said_to_begin_anew(fretc: Fretc) -> None:
    run = fretc("audit", *LOGS, "--resume")
    assert run.err.startswith("no stopped audit was found: all logs are audited\n")


def test_another_fretc_or_evaluation_makes_all_of_it_new(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = plan()
    assert plan().key == before.key
    assert plan("online").key != before.key
    stopped()
    monkeypatch.setattr("fretc.audit.plan.edition", lambda: "another")
    assert plan().key != before.key
    assert finished() == []


@pytest.mark.slow
@pytest.mark.parametrize("tail", [b'{"log": "c.mcap", "sha', b"\0\0\0\n", b"[1]\n", b"\xff\n"])
def test_a_line_that_is_not_whole_does_not_count(fretc: Fretc, tail: bytes) -> None:
    fretc("audit", *LOGS)
    whole = EVIDENCE.read_bytes()
    stopped()
    good = JOURNAL.read_bytes()
    JOURNAL.write_bytes(good + tail)
    assert finished() == ["a.mcap", "b.mcap"]
    assert JOURNAL.read_bytes() == good
    fretc("audit", *LOGS, "--resume")
    assert EVIDENCE.read_bytes() == whole


def test_a_line_cut_anywhere_leaves_those_before_it(fretc: Fretc) -> None:
    stopped()
    data = JOURNAL.read_bytes()
    head = data.index(b"\n") + 1
    second = data.index(b"\n", head) + 1
    for end, expected in [
        (0, []),
        (head - 1, []),
        (head, []),
        (second - 1, []),
        (second, ["a.mcap"]),
        (len(data) - 1, ["a.mcap"]),
    ]:
        JOURNAL.write_bytes(data[:end])
        assert finished() == expected, end


def test_without_resume_an_audit_begins_anew(fretc: Fretc) -> None:
    stopped()
    first = JOURNAL.read_bytes()
    journal = journal_of(plan())
    journal.keep("c.mcap", audited(plan(), "c.mcap"))
    journal.close()
    assert JOURNAL.read_bytes() != first
    assert finished() == ["c.mcap"]


@pytest.mark.slow
def test_two_audits_do_not_share_a_journal(fretc: Fretc) -> None:
    stopped()
    other = journal_of(plan())
    assert other.finished(LOGS)
    run = fretc("audit", *LOGS, "--resume")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(f"F912 another audit is at work on `{JOURNAL}`\n")
    assert fretc("audit", *LOGS).err.startswith("F912 ")
    other.close()
    assert fretc("audit", *LOGS, "--resume").status == 0


def test_a_place_where_nothing_can_be_kept_is_told(fretc: Fretc) -> None:
    Path("build").write_text("no folder")
    run = fretc("audit", *LOGS)
    assert run.status == 2
    assert run.err.startswith(f"F905 `{JOURNAL}` cannot be written: ")
    diagnostic = journal_of(plan()).keep("a.mcap", audited(plan(), "a.mcap"))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.code is Code.NOT_WRITTEN


def test_evidence_that_is_printed_keeps_nothing(fretc: Fretc) -> None:
    run = fretc("audit", *LOGS, "--evidence", "-")
    assert (run.status, run.err) == (0, "")
    assert not list(Path().glob("*.journal"))
    assert fretc("audit", *LOGS, "--evidence", "-", "--resume").err.startswith("F907 ")


@pytest.mark.slow
@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_audit_is_stopped_and_goes_on(fretc: Fretc, stop: signal.Signals) -> None:
    logs = [f"{name}{number}.mcap" for name in "ab" for number in range(12)]
    for log in logs:
        os.link("a.mcap", log)
    command = [sys.executable, "-c", "from fretc.cli import main; main()", "audit", *logs]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    run = subprocess.Popen(
        [*command, "--jobs", "2"],
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler) and None,
    )
    deadline = time.monotonic() + 60
    while (
        not (JOURNAL.exists() and JOURNAL.read_bytes().count(b"\n") > 1)
        and time.monotonic() < deadline
    ):
        time.sleep(0.01)
    run.send_signal(stop)
    _, errors = run.communicate(timeout=60)
    assert not EVIDENCE.exists()
    lines = JOURNAL.read_bytes().count(b"\n") - 1
    if stop is not signal.SIGKILL:
        words = f"stopped: {lines} of 24 logs are kept, `--resume` goes on from there\n"
        assert (run.returncode, errors) == (130, words)
    resumed = fretc("audit", *logs, "--resume")
    assert resumed.status == 0
    assert resumed.err.startswith(f"{lines} of 24 logs are audited already\n")
    assert 0 < lines < 24
    assert [result["run"] for result in json.loads(EVIDENCE.read_text())["results"]] == logs


@pytest.mark.slow
def test_a_line_with_another_byte_is_not_believed(fretc: Fretc) -> None:
    stopped()
    data = JOURNAL.read_bytes()
    second = data.rindex(b"\n", 0, -1) + 1
    verdict = data.index(b'"satisfied"', second) + 1
    for at in (verdict, *range(second, len(data), 977), len(data) - 1):
        JOURNAL.write_bytes(data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :])
        assert finished() == ["a.mcap"], at
    for line in (b'{"log": "b.mcap"}', b'{"log": "b.mcap", "check": ""}', b"[]", b"1"):
        JOURNAL.write_bytes(data[:second] + line + b"\n")
        assert finished() == ["a.mcap"], line


# A journal of somebody else -------------------------------------------------------------------


FOREIGN = f"`{JOURNAL}` was not kept by you in this place: that is not used\n"


@pytest.mark.slow
def test_a_journal_that_another_user_has_kept_is_not_used_and_that_is_said(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with monkeypatch.context() as other:
        other.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
        stopped()
    assert finished() == []
    run = fretc("audit", *LOGS, "--resume")
    assert run.err.startswith(f"no stopped audit was found: all logs are audited\n{FOREIGN}")
    assert run.status == 0


def test_lines_that_another_user_has_written_below_our_head_are_not_used(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with monkeypatch.context() as other:
        other.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
        stopped(LOGS)
        lines = JOURNAL.read_bytes().splitlines(keepends=True)
        JOURNAL.unlink()
    stopped(["a.mcap"])
    with JOURNAL.open("ab") as file:
        file.write(lines[2])
    assert finished() == ["a.mcap"]


def test_a_check_without_a_key_is_not_believed(fretc: Fretc) -> None:
    """As journals had it before: whoever wrote a line could write its check."""
    stopped()
    head, first, second = JOURNAL.read_bytes().splitlines()
    content = json.loads(second)
    unchecked = json.dumps({**content, "check": ""})
    check = hashlib.sha256(unchecked.encode()).hexdigest()
    line = json.dumps({**content, "check": check}).encode()
    JOURNAL.write_bytes(b"\n".join([head, first, line, b""]))
    assert finished() == ["a.mcap"]


def test_a_journal_counts_in_its_place_only(fretc: Fretc) -> None:
    stopped()
    Path("elsewhere").mkdir()
    shutil.move(JOURNAL, f"elsewhere/{JOURNAL.name}")
    other = journal_of(plan(), Path("elsewhere") / EVIDENCE.name)
    assert other.finished(LOGS) == {}
    assert (other.stale, other.foreign) == (False, True)
    other.close()


def test_lines_of_another_plan_do_not_count_below_this_ones_head(fretc: Fretc) -> None:
    journal = journal_of(plan("online"))
    assert journal.keep("b.mcap", audited(plan("online"), "b.mcap")) is True
    journal.close()
    line = JOURNAL.read_bytes().splitlines(keepends=True)[1]
    stopped(["a.mcap"])
    with JOURNAL.open("ab") as file:
        file.write(line)
    assert finished() == ["a.mcap"]


@pytest.mark.slow
@pytest.mark.parametrize("link", [os.symlink, os.link])
def test_a_journal_that_is_a_link_leaves_its_target_as_it_is(
    fretc: Fretc, link: Callable[[str, Path], None]
) -> None:
    Path("build").mkdir()
    Path("precious").write_text("precious")
    link(os.path.abspath("precious"), JOURNAL)
    for options in ([], ["--resume"]):
        run = fretc("audit", *LOGS, *options)
        assert run.status == 2
        assert run.err.startswith(f"F905 `{JOURNAL}` cannot be written: ")
        assert Path("precious").read_text() == "precious"


@pytest.mark.slow
def test_a_key_that_others_can_read_is_not_used_and_the_audit_goes_on(fretc: Fretc) -> None:
    stopped()
    path = Path(os.environ["XDG_STATE_HOME"]) / "fretc/journal.key"
    path.chmod(0o644)
    run = fretc("audit", *LOGS, "--resume")
    assert run.status == 0
    assert run.err.startswith(f"F920 warning: `{path}` cannot be used: others may read or write it")
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
