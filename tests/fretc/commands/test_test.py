"""`fretc test` as its users meet it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import jsonschema  # type: ignore[import-untyped]
import pytest

from compiler.files.records import decoded, plain
from compiler.files.templating import to_json
from fretc.testing import suite
from tests.command import Fretc

SENTENCES = (
    "whenever start the line shall within 2 ticks satisfy run",
    "whenever hold the line shall immediately satisfy !run",
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return written(tmp_path, SENTENCES)


def written(folder: Path, sentences: Sequence[str]) -> Path:
    for number, sentence in enumerate(sentences, 1):
        (folder / f"r{number}.fret").write_text(f'+++\nid = "R{number}"\n+++\n{sentence}\n')
    return folder


@pytest.mark.slow
def test_a_row_tells_of_each_requirement(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder))
    assert run.status == 0
    head, gap, titles, first, *_ = run.out.splitlines()
    assert head.startswith("✔ 2 requirements: ")
    assert head.endswith("; each situation is covered or impossible, and no mutant survives")
    assert gap == ""
    assert titles.split() == ["tests", "ticks", "situations", "mutants"]
    assert first.split()[0] == "R1"
    assert (folder / "build/tests/suite.json").is_file()


@pytest.mark.slow
def test_the_suite_is_as_its_schema_says_and_is_read_back(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "-o", "-")
    found = json.loads(run.out)
    jsonschema.validate(found, suite.schema())
    again = decoded(found, suite.Suite)
    assert json.loads(to_json(plain(again))) == found
    assert not (folder / "build").exists()


@pytest.mark.slow
def test_tests_of_one_requirement_are_drawn(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "--show", "R1")
    assert run.status == 0
    assert run.out.startswith(
        "R1  whenever start the line shall within 2 ticks satisfy run\n  its tests also satisfy "
        "R2\n"
    )
    assert (
        "✔ r1-answered-at-last-tick-kept: satisfied\n"
        "  `run` at the last tick that counts (2 ticks after the first open trigger); R1 is kept\n"
        "    tick   0  1  2\n"
        "    run    0  0  1\n"
        "    start  1  0  0\n"
        "  triggered at tick 0, `run` is true at tick 2, 2 ticks later; the bound is 2 ticks\n"
    ) in run.out


def test_a_requirement_that_there_is_not_is_a_mistake(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "--show", "R3")
    assert run.status == 2
    assert "F907 there is no requirement `R3`" in run.err
    assert not (folder / "build").exists()


@pytest.mark.slow
def test_what_was_not_searched_is_told(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "--time", "0.000001")
    assert run.status == 3
    assert run.out.startswith(
        "? 2 requirements: 0 tests of 0 ticks together; the search is not complete"
    )
    assert "not searched: not answered within 1e-06 CPU seconds" in run.out


@pytest.mark.slow
def test_what_others_exclude_is_told(fretc: Fretc, tmp_path: Path) -> None:
    folder = written(tmp_path, (SENTENCES[0], "the line shall never satisfy start"))
    run = fretc("test", str(folder), "-o", str(tmp_path / "suite.json"))
    assert run.status == 0
    assert "○ R1: not with R2: triggered at tick 0\n" in run.out


def test_a_sentence_that_cannot_be_read_is_a_mistake(fretc: Fretc, tmp_path: Path) -> None:
    folder = written(tmp_path, ("the line shal run",))
    run = fretc("test", str(folder))
    assert run.status == 2
    assert "Traceback" not in run.err


@pytest.mark.slow
def test_a_run_that_only_its_end_makes_wrong_is_not_called_broken(
    fretc: Fretc, tmp_path: Path
) -> None:
    folder = written(tmp_path, ["upon go the sw shall eventually satisfy up"])
    made = json.loads(fretc("test", str(folder), "-o", "-").out)["tests"]
    ends = [test["words"] for test in made if test["verdict"] == "inconclusive"]
    assert ends
    assert all(words.endswith("; the run ends while R1 is not met") for words in ends)


@pytest.mark.slow
def test_nothing_is_said_line_by_line_where_nothing_was_searched(
    fretc: Fretc, tmp_path: Path
) -> None:
    sentences = ["upon persists(2, a) the sw shall immediately satisfy b", SENTENCES[0] + " & a"]
    run = fretc("test", str(written(tmp_path, sentences)), "-o", str(tmp_path / "suite.json"))
    assert run.status == 3
    why = "`persists(2,a)` is not a value at a single tick"
    assert run.out.split("\n\n")[2].splitlines()[:2] == [
        f"? R1: not searched: {why}",
        f"? R2: not searched: its tests must satisfy R1, but {why}",
    ]


@pytest.mark.parametrize("command", ["test", "analyze"])
def test_a_time_that_is_no_number_is_a_mistake(fretc: Fretc, folder: Path, command: str) -> None:
    run = fretc(command, str(folder), "--time", "nan")
    assert run.status == 2
    assert "nan is not a number of seconds" in run.err


@pytest.mark.slow
def test_tests_for_pytest_are_of_the_languages_that_are_named(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "--emit", "pytest", "--language", "js", "--language", "c")
    assert run.status == 0
    names = {path.name for path in (folder / "build/tests/pytest").iterdir()}
    monitors = {f"r{i}_monitor.{ending}" for i in (1, 2) for ending in ("c", "h", "mjs")}
    assert names == monitors | {"test_r1.py", "test_r2.py"}


@pytest.mark.parametrize("emitted", [(), ("--emit", "c")])
def test_a_language_without_tests_for_pytest_is_a_mistake(
    fretc: Fretc, folder: Path, emitted: Sequence[str]
) -> None:
    run = fretc("test", str(folder), *emitted, "--language", "c")
    assert run.status == 2
    assert "F907 `--language` needs `--emit pytest`" in run.err
    assert not (folder / "build").exists()


@pytest.mark.slow
def test_the_self_test_stands_beside_the_monitors(fretc: Fretc, folder: Path) -> None:
    run = fretc("test", str(folder), "--emit", "c")
    assert run.status == 0
    names = {path.name for path in (folder / "build/tests/c").iterdir()}
    monitors = {f"r{i}_monitor.{ending}" for i in (1, 2) for ending in ("c", "h")}
    assert names == monitors | {"fretc_self_test.c"}
    assert fretc("test", str(folder), "--emit", "java", "--suite", "build/tests/suite.json").out
    names = {path.name for path in (folder / "build/tests/java").iterdir()}
    assert names == {"R1Monitor.java", "R2Monitor.java", "FretcSelfTest.java"}


@pytest.mark.slow
def test_tests_of_a_file_are_written_again_as_they_are(fretc: Fretc, folder: Path) -> None:
    assert fretc("test", str(folder), "--emit", "csv").status == 0
    made = {path.name: path.read_text() for path in Path("build/tests/csv").iterdir()}
    Path("build/tests/suite.json").rename("kept.json")
    again = fretc(
        "test", str(folder), "--suite", "kept.json", "--emit", "csv", "--emit-to", "again"
    )
    assert (again.status, Path("build/tests/suite.json").exists()) == (0, False)
    assert {path.name: path.read_text() for path in Path("again/csv").iterdir()} == made
    assert again.out.splitlines()[0].endswith(" together; the monitors give the expected results")
    assert again.out.splitlines()[2].split() == ["tests", "ticks"]  # the rest nobody has checked
    text = Path("kept.json").read_text()
    Path("kept.json").write_text(text.replace('"verdict": "violated"', '"verdict": "satisfied"', 1))
    wrong = fretc("test", str(folder), "--suite", "kept.json", "--emit", "csv", "--emit-to", "new")
    assert (wrong.status, Path("new").exists()) == (2, False)
    assert "expects another result than the monitor gives: violated" in wrong.err


@pytest.mark.slow
@pytest.mark.parametrize("option", [(), ("--show", "R1")])
def test_texts_of_a_file_are_not_for_the_terminal(
    fretc: Fretc, folder: Path, option: tuple[str, ...]
) -> None:
    document = json.loads(fretc("test", str(folder), "-o", "-").out)
    for each in (*document["tests"], *document["obligations"]):
        each["words"] = "\x1b]0;title\x07 \u202e"
    for each in document["requirements"]:
        each["sentence"] = each["doubt"] = "\x1b]0;title\x07 \u202e"
    Path("hostile.json").write_text(json.dumps(document))
    run = fretc("test", str(folder), "--suite", "hostile.json", *option)
    assert run.status == 0
    assert not {"\x1b", "\x07", "\u202e"} & {*run.out, *run.err}
