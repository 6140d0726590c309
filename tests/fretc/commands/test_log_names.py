"""Files are called anything: every command has one name for a log, and finds the log by it."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from urllib.parse import unquote_to_bytes

import pytest

from compiler.files.text_files import content
from fretc.logs.storage.log_names import name_of, path_of
from tests.command import Fretc, write
from tests.effort import FULL
from tests.fretc.audit.test_refusals import log

NAMES = {
    b"plain": "plain",
    b"\xff": r"\xff",
    b"a\nb": r"a\nb",
    rb"a\nb": r"a\\nb",
    rb"a\xff": r"a\\xff",
    b"a%0Ab\r": r"a%0Ab\r",
    b"\xed\xa0\x80": r"\xed\xa0\x80",
    b"caf\xc3\xa9 \xe2\x80\xae\x1b[31m\x07": r"café \xe2\x80\xae\x1b[31m\x07",
    b"C:\\data": r"C:\\data",
    b"'$(id)`&<b>\"|*": "'$(id)`&<b>\"|*",
    b"-o": "-o",
}
"""How a log is called, without `.mcap`, and its name."""
if not FULL:  # what is like another one
    for name in (rb"a\xff", b"a%0Ab\r", b"\xed\xa0\x80", b"C:\\data"):
        del NAMES[name]


@pytest.fixture
def runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Paths of logs that violate a requirement of the project."""
    monkeypatch.chdir(tmp_path)
    write(
        "requirements/bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/a.x"\n'
        '[proposition.ok]\nexpr = "x < 1"\n'
        '[run.label]\nrobot = "path:{robot}.mcap"\n',
    )
    write("requirements/r.fret", "the sw shall always satisfy ok\n")
    Path("runs").mkdir()
    paths = [f"runs/{os.fsdecode(name)}.mcap" for name in NAMES]
    for place, path in enumerate(paths):
        log(path, [0.5, 2.0, 0.5, place + 3.0])
    return paths


COMMANDS = (
    "audit runs -o e.json",
    "audit runs",
    *(f"audit runs --format {form} -o x" for form in ("json", "sarif", "junit")),
    *(f"audit runs --format {form}" for form in ("github", "text")),
    "audit runs -v --annotate --parquet x.parquet",
    "audit runs --since 2000-01-01 --sample 5 -o s.json",
    "bind --check runs",
    "bind --check runs --format json",
    "coverage runs",
    "coverage --evidence e.json",
    "info runs",
    "info runs --format json",
    "report --evidence e.json --html x.html --json x.json --markdown x.md --sarif x.sarif "
    "--junit x.xml --reqif x.reqif --csv x.csv",
    "report --evidence build/evidence --html y.html",
    "lock --evidence e.json --reviewer a --role b --comment c --accept-violations",
    "diff --evidence e.json --format json",
    "trends e.json --html t.html --format json",
    "verify-evidence e.json --manifest m --format json",
    "verify-evidence build/evidence --manifest m",
)
ONE = (
    "info {}",
    "init new --from {}",
    "bind --from {} -o -",
    "watch {}",
    "play --log {} -o q.html",
)


@pytest.mark.slow
def test_no_command_fails_on_a_name_and_all_say_the_same_one(fretc: Fretc, runs: list[str]) -> None:
    with Path("m").open("wb") as manifest:
        subprocess.run(["sha256sum", "--", *map(os.fsencode, runs)], stdout=manifest, check=True)
    for command in COMMANDS:
        run = fretc(*command.split())
        assert run.status in (0, 1, 3), (command, run.err)
    evidence = json.loads(Path("e.json").read_text("utf-8"))
    names = {each["run"] for each in evidence["results"]}
    assert names == {f"runs/{name}.mcap" for name in NAMES.values()}
    assert {path_of(name) for name in names} == {*runs}
    labels = {each["labels"]["robot"] for each in evidence["results"]}
    assert labels == {*NAMES.values()}
    sarif = json.loads(Path("x.sarif").read_text("utf-8"))
    uris = {unquote_to_bytes(each["location"]["uri"]) for each in sarif["runs"][0]["artifacts"]}
    assert {os.fsencode(path) for path in runs} <= uris
    for file in (each for each in Path().rglob("*") if each.is_file()):
        if file.suffix in (".json", ".html", ".md", ".xml", ".sarif", ".csv", ".lock"):
            text = content(file).decode("utf-8")
            assert "\\udc" not in text, file
            assert "\x1b" not in text, file
    rechecked = fretc(*"verify-evidence e.json --manifest m --format json".split())
    assert rechecked.status == 0, rechecked.out
    kept = {each["run"] for each in json.loads(rechecked.out)["results"]}
    assert names <= kept


@pytest.mark.slow
@pytest.mark.parametrize("command", ONE)
def test_a_command_about_one_log_takes_any_name(
    fretc: Fretc, runs: list[str], command: str
) -> None:
    for place, path in enumerate(runs):
        words = [path if word == "{}" else word for word in command.split()]
        words = [f"new{place}" if word == "new" else word for word in words]
        run = fretc(*words)
        assert run.status in (0, 1, 3), (path, run.err)
        assert "\\udc" not in run.out + run.err


@pytest.mark.slow
@pytest.mark.parametrize("command", ["audit {}", "info {}", "init new --from {}", "watch {}"])
@pytest.mark.parametrize("name", [b"no\xff.mcap", b"no\n.mcap", b"folder\xff"])
def test_a_log_that_is_not_there_is_named_as_any_other(
    fretc: Fretc, runs: list[str], command: str, name: bytes
) -> None:
    path = os.fsdecode(name)
    if b"folder" in name:
        Path(path).mkdir()
    run = fretc(*(path if word == "{}" else word for word in command.split()))
    assert run.status == 2
    assert name_of(path) in run.err
    assert "\\udc" not in run.err
