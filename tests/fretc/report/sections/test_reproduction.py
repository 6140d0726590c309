from pathlib import Path

import pytest

from compiler.files.text_files import sha256
from compiler.project.folder import load
from compiler.targets import ltl
from fretc.report.make import make
from tests.fretc.report.cases import (
    LOG,
    R1,
    as_json,
    content_of,
    project,
    report_of,
    requirement,
    result,
)


def test_the_commands_can_be_typed_as_they_stand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bounded = requirement("R2", "when near the robot shall within 3 ticks satisfy stopped")
    project(tmp_path / "req", R1, bounded)
    monkeypatch.chdir(tmp_path)
    known = load(["req/r1.fret", "req/r2.fret"], "req/bindings.toml", "req/hazards.toml")
    report_of(known, tmp_path, result(known, "satisfied", run="logs/a b.mcap"))
    commands = as_json(make(known, "evidence.json"))["commands"]
    assert [command["text"] for command in commands] == [
        "fretc --version   # fretc 0.1.0",
        f"printf '%s\\n' '{LOG}  logs/a b.mcap' | sha256sum --check",
        "fretc audit 'logs/a b.mcap' --requirements req -o evidence.json",
        "fretc req/r1.fret --emit monitor --emit ltl --emit ajpf --emit json --output build",
        "fretc req/r2.fret --emit monitor --emit ltl --emit json --output build",
        "fretc report --requirements req --evidence evidence.json",
    ]


def test_logs_of_the_same_name_in_several_folders_are_told_apart(tmp_path: Path) -> None:
    known = project(tmp_path)
    runs = [result(known, "satisfied", run=f"/data/{day}/a.mcap") for day in ("mon", "tue")]
    content = as_json(report_of(known, tmp_path, *runs))
    texts = [command["text"] for command in content["commands"]]
    assert texts[1] == (
        f"printf '%s\\n' '{LOG}  mon/a.mcap' '{LOG}  tue/a.mcap' | sha256sum --check"
    )
    assert texts[2].startswith("fretc audit mon/a.mcap tue/a.mcap --requirements ")
    names = [line["name"] for line in content["manifest"] if line["kind"] == "run"]
    assert names == ["mon/a.mcap", "tue/a.mcap"]


def test_the_manifest_has_the_hash_of_everything(tmp_path: Path) -> None:
    known = project(tmp_path)
    manifest = content_of(known, tmp_path, result(known, "satisfied"))["manifest"]
    assert [(line["kind"], line["name"]) for line in manifest] == [
        ("sentence", "R1"),
        ("bindings", "bindings.toml"),
        ("monitor", "r1_monitor.py"),
        ("ltl", "r1.ltl"),
        ("ajpf", "r1.psl"),
        ("json", "r1.json"),
        ("evidence", "evidence.json"),
        ("run", "logs/a.mcap"),
    ]
    hashes = {line["kind"]: line["sha256"] for line in manifest}
    assert hashes["ltl"] == sha256(ltl.text(known.formalized[0]))
    assert hashes["evidence"] == sha256((tmp_path / "evidence.json").read_text(encoding="utf-8"))
    assert hashes["run"] == LOG


def test_defaults_that_were_taken_are_reported(tmp_path: Path) -> None:
    known = project(tmp_path)
    one = result(known, "satisfied", assumptions=["signal old: something else"])
    assert content_of(known, tmp_path, one)["assumptions"] == [
        "signal clearance: readings that are no measurement are as REP 117 says",
        "signal old: something else (in the audit)",
    ]
