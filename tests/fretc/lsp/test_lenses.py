"""Code lenses: the last results above each requirement, and commands about it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fretc.lsp import lenses
from tests.command import Fretc, write
from tests.editor import Editor, RefusedError
from tests.fretc.report import cases

Start = Callable[..., Editor]
COMMANDS = ["fretc.explain", "fretc.play", "fretc.test", "fretc.verify"]
FASTER = cases.R1.replace("eventually", "within 3 seconds")


def audited(*verdicts: str, **changes: Any) -> Path:
    """R1 with evidence of these verdicts, a run each; the path of its file."""
    known = cases.project(Path("requirements"))
    results = [
        cases.result(known, verdict, run=f"logs/{at}.mcap", **changes)
        for at, verdict in enumerate(verdicts)
    ]
    Path("build").mkdir(exist_ok=True)
    cases.write_evidence(known, Path("build"), *results)
    return Path.cwd() / "requirements/r1.fret"


def titles(client: Editor, path: Path) -> list[str]:
    document = client.at(path, 0, 0)["textDocument"]
    every = client.ask("textDocument/codeLens", textDocument=document)
    assert all(each["command"]["arguments"] == ["R1", document["uri"]] for each in every)
    assert all(each["range"]["start"] == {"line": 0, "character": 0} for each in every)
    return [each["command"]["title"] for each in every]


def shown(client: Editor, path: Path) -> str:
    """The first lens, once all results are compared."""
    client.open(path)
    assert titles(client, path)[0] == lenses.UNKNOWN
    client.settle()
    return titles(client, path)[0]


def test_a_requirement_without_results_is_not_audited(editor: Start) -> None:
    cases.project(Path("requirements"))
    client, path = editor(), Path.cwd() / "requirements/r1.fret"
    assert shown(client, path) == "not audited"
    assert titles(client, path)[1:] == ["explain", "play", "test", "verify"]


def test_the_last_audit_has_its_verdict_and_margin(editor: Start) -> None:
    path = audited("satisfied", "satisfied")
    assert shown(editor(), path) == (
        "✔ satisfied in 2 runs, 6 triggers, margin of stopped 0.0025 m/s"
    )


def test_a_violation_says_in_how_many_runs(editor: Start) -> None:
    path = audited("satisfied", "violated", violations=[])
    assert shown(editor(), path).startswith("✘ violated in 1 of 2 runs, 6 triggers")


@pytest.mark.parametrize("verdict", ["satisfied", "violated"])
def test_what_is_out_of_date_is_stale_and_never_green(verdict: str, editor: Start) -> None:
    path = audited(verdict)
    client = editor()
    client.open(path, FASTER)
    client.settle()
    title = titles(client, path)[0]
    assert "stale" in title
    assert "✔" not in title
    assert "margin" not in title
    assert title.startswith("✘ violated" if verdict == "violated" else "stale: satisfied (")
    client.change(path, cases.R1)
    assert titles(client, path)[0] == lenses.UNKNOWN, "not yet compared"
    client.settle()
    assert "stale" not in titles(client, path)[0]
    assert client.refreshes >= 2


def test_a_log_of_which_messages_are_missing_shows_nothing(editor: Start) -> None:
    path = audited("satisfied", health={"intact": False})
    assert shown(editor(), path).startswith("stale: satisfied (the log is damaged")


def test_proofs_are_shown_until_their_monitor_changes(fretc: Fretc, editor: Start) -> None:
    cases.project(Path("requirements"))
    path = Path.cwd() / "requirements/r1.fret"
    assert fretc("verify", "requirements/r1.fret", "--monitor").status == 0
    client = editor()
    client.open(path)
    client.settle()
    assert titles(client, path)[1].startswith("✔ ")
    assert titles(client, path)[1].endswith("proved (monitor)")
    client.change(path, FASTER)
    client.settle()
    assert titles(client, path)[1].startswith("stale: proved (")


def test_a_conflict_names_the_other_requirements(fretc: Fretc, editor: Start) -> None:
    sentences = ("the robot shall always satisfy stopped", "the robot shall never satisfy stopped")
    cases.project(
        Path("requirements"),
        *(cases.requirement(f"R{at}", sentence) for at, sentence in enumerate(sentences, 1)),
    )
    assert fretc("analyze").status == 1
    path = Path.cwd() / "requirements/r1.fret"
    client = editor()
    client.open(path)
    client.settle()
    assert titles(client, path)[1] == "✘ in conflict with R2"
    client.open(path.with_name("r2.fret"), "")
    client.settle()
    assert "stale (R2 is no longer part of the set" in titles(client, path)[1]


# Commands -----------------------------------------------------------------------------------------


def test_commands_are_offered_only_to_a_client_that_asks_for_them(editor: Start) -> None:
    def offered(client: Editor) -> list[str]:
        commands: list[str] = client.server["capabilities"]["executeCommandProvider"]["commands"]
        return commands

    assert offered(editor()) == []
    assert {*COMMANDS} < {*offered(editor(commands=True))}


def test_a_command_is_answered_as_text(fretc: Fretc, editor: Start) -> None:
    path = audited("satisfied")
    client = editor(commands=True)
    uri = client.open(path)
    client.settle()
    for name, expected in {
        "explain": fretc("explain", "R1").out.rstrip(),
        "audit": "R1: ✔ satisfied in 1 run",
        "play": "to play with R1: fretc play requirements/r1.fret",
        "test": "to generate tests: fretc test requirements/r1.fret",
        "verify": "to verify: fretc verify requirements/r1.fret",
    }.items():
        text = client.ask(
            "workspace/executeCommand", command=f"fretc.{name}", arguments=["R1", uri]
        )
        assert text.startswith(expected)
        assert client.messages.pop() == text


def test_a_command_with_other_arguments_is_not_answered(editor: Start) -> None:
    path = audited("satisfied")
    client = editor(commands=True)
    uri = client.open(path)
    for arguments in ([], ["R1"], ["R2", uri], [uri, "R1"], [None, None], [{}, [uri]], None):
        answer = client.ask(
            "workspace/executeCommand", command="fretc.explain", arguments=arguments
        )
        assert answer is None
    with pytest.raises(RefusedError):
        client.ask("workspace/executeCommand", command="fretc.delete", arguments=["R1", uri])
    assert client.messages == []


def test_evidence_with_an_error_is_no_verdict(editor: Start) -> None:
    path = audited("satisfied")
    write("build/evidence.json", json.dumps({"schema": "fretc-evidence-1"}))
    assert shown(editor(), path) == "not audited"
