"""`fretc write`: readings, questions, the file, and what it says of wrong input."""

import json
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from fretc.commands import write as command
from tests.command import Fretc, runner, write

TEXT = "if the battery is low, the drone must return within 5 ticks"
FIRST = "when battery_low the drone shall within 5 ticks satisfy return"
SECOND = "whenever battery_low the drone shall within 5 ticks satisfy return"


@pytest.fixture
def fretc(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Fretc:
    monkeypatch.chdir(tmp_path)
    return runner(monkeypatch, capsys)


def answering(monkeypatch: pytest.MonkeyPatch, replies: str) -> Iterator[str]:
    """Let a person on a terminal type the replies."""
    left = iter(replies)
    monkeypatch.setattr(command, "_is_terminal", lambda: True)
    monkeypatch.setattr(click, "prompt", lambda *_, **__: next(left))
    return left


def test_without_a_terminal_the_readings_are_listed(fretc: Fretc) -> None:
    run = fretc("write", TEXT)
    assert (run.status, run.err) == (3, "")
    lines = run.out.splitlines()
    assert lines[0] == f"“{TEXT}”"
    assert f"1  {FIRST}" in lines
    assert f"2  {SECOND}" in lines
    assert "battery_low  the battery is low" in lines


def test_one_reading_needs_no_choice(fretc: Fretc) -> None:
    assert fretc("write", "the robot must never enter the zone").status == 0


def test_seconds_without_a_clock_are_reported_once(fretc: Fretc) -> None:
    err = fretc("write", "if p is on, the drone must return within 5 seconds").err
    assert err.count("F312") == 1


def test_the_bindings_give_names_and_ticks(fretc: Fretc) -> None:
    write(
        "requirements/bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.battery]\npath = "/b.p"\nunit = "%"\n'
        '[proposition.low_battery]\nexpr = "battery < 20 %"\n',
    )
    write("requirements/r.fret", "the drone shall always satisfy battery > 5 %")
    out = fretc("write", "if the battery is low, it must return within 5 s").out
    assert "1  when low_battery the drone shall within 5 seconds satisfy return" in out
    assert "50 ticks (5 s)" in out


def test_answers_choose_a_reading_and_become_tests(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    answering(monkeypatch, "n")
    run = fretc("write", TEXT, "-o", "dock.fret")
    assert run.status == 0
    assert run.out.count("May this run happen") == 1
    assert run.out.endswith(f"\n{SECOND}\n")
    assert Path("dock.fret").read_text("utf-8") == (
        f'+++\nid = "dock"\ntext = "{TEXT}"\n+++\n{SECOND}\n'
    )
    (test,) = json.loads(Path("dock.answers.json").read_text("utf-8"))["tests"]
    assert (test["name"], test["polarity"], test["finite"]) == ("dock-answer-1", "broken", False)
    assert test["words"] == "answered: this run must not happen"
    checked = fretc("test", "dock.fret", "--suite", "dock.answers.json")
    assert (checked.status, checked.err) == (0, "")
    assert "1 requirement: 1 test" in checked.out


def test_wrong_answers_in_the_file_are_refused_by_fretc_test(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    answering(monkeypatch, "n")
    fretc("write", TEXT, "-o", "dock.fret")
    path = Path("dock.answers.json")
    path.write_text(path.read_text("utf-8").replace('"finite": false', '"finite": true'), "utf-8")
    checked = fretc("test", "dock.fret", "--suite", "dock.answers.json")
    assert checked.status == 2
    assert "F503" in checked.err


def test_answers_of_several_requirements_share_a_file(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    answering(monkeypatch, "ny")
    fretc("write", TEXT, "-o", "dock.fret")
    fretc("write", TEXT.replace("return", "land"), "-o", "dock.fret")
    assert 'id = "dock-2"' in Path("dock.fret").read_text("utf-8")
    suite = json.loads(Path("dock.answers.json").read_text("utf-8"))
    assert [test["name"] for test in suite["tests"]] == ["dock-answer-1", "dock-2-answer-1"]
    assert (
        "2 requirements: 2 tests" in fretc("test", "dock.fret", "--suite", "dock.answers.json").out
    )


def test_a_skipped_question_is_no_answer(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    answering(monkeypatch, "s" * 99)
    run = fretc("write", TEXT, "-o", "dock.fret")
    assert run.status == 2
    assert f"left: {FIRST}" in run.out
    assert run.err == (
        "F977 2 readings are left, so nothing is written\nhelp: choose one: `--choose N`\n"
    )
    assert not Path("dock.fret").exists()


def test_a_reading_is_chosen_by_its_number(fretc: Fretc) -> None:
    assert fretc("write", TEXT, "--choose", "2", "-o", "r.fret", "--id", "R-7").status == 0
    assert SECOND in Path("r.fret").read_text("utf-8")
    assert not Path("r.answers.json").exists()
    assert fretc("r.fret").status == 0
    run = fretc("write", TEXT, "--choose", "3")
    assert run.status == 2
    assert "F978 there is no reading 3\nhelp: the text has 2\n" in run.err


def test_an_id_must_be_free_and_an_id(fretc: Fretc) -> None:
    write("r.fret", f"{FIRST}\n")
    taken = fretc("write", TEXT, "--choose", "2", "-o", "r.fret", "--id", "R")
    assert taken.err.startswith("F979 `r.fret` already has a requirement `R`")
    wrong = fretc("write", TEXT, "--choose", "2", "-o", "r.fret", "--id", "a b")
    assert wrong.err.startswith("F979 `a b` cannot be an id")
    assert (taken.status, wrong.status) == (2, 2)
    assert Path("r.fret").read_text("utf-8") == f"{FIRST}\n"


def test_a_text_without_a_reading_and_no_text_are_refused(fretc: Fretc) -> None:
    run = fretc("write", "the")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith("F975 no reading of this text was found: the\n")
    assert fretc("write", " . ").err.startswith("F975 there is no text\n")
    assert fretc("write", "a is on. b is on", "--choose", "1").err.startswith("F978 `--id` and")


def test_words_that_no_reading_contains_are_reported(fretc: Fretc) -> None:
    run = fretc("write", "the drone must brake at once, whatever the pilot says")
    assert run.err == (
        "F976 warning: no reading contains the words `whatever the pilot says`\n"
        "help: if they matter, write the text in other words\n"
    )


def test_the_readings_as_json_have_the_runs_that_distinguish_them(fretc: Fretc) -> None:
    run = fretc("write", TEXT, "--format", "json")
    assert (run.status, run.err) == (3, "")
    whole = json.loads(run.out)
    (text,) = whole["texts"]
    assert whole["schema"] == "fretc-readings-1"
    assert [each["sentence"] for each in text["readings"]] == [FIRST, SECOND]
    assert {tuple(each["allowed"]) for each in text["questions"]} >= {(0,)}
    assert text["readings"][0]["names"] == {"battery_low": "the battery is low", "return": "return"}


def test_an_error_in_the_bindings_is_reported_and_the_text_is_read(fretc: Fretc) -> None:
    write("requirements/bindings.toml", '[clock]\ntick = "100 ms"\n[signal.v]\npath = "v"\n')
    run = fretc("write", "the robot must never beep")
    assert run.status == 2
    assert "requirements/bindings.toml" in run.err
    assert "the robot shall never satisfy beep" in run.out


def test_a_folder_that_is_named_must_exist(fretc: Fretc) -> None:
    run = fretc("write", "the robot must never beep", "--requirements", "nowhere")
    assert (run.status, run.out) == (2, "")
    assert "nowhere" in run.err
