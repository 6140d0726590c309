"""What the server answers about a place: hover, completion, names, renaming, fixes, formatting."""

import base64
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from compiler.project.folder import load_folder
from compiler.project.project import Project
from fretc.lsp.outline import TOKEN_TYPES
from tests.command import Fretc, write
from tests.each import each
from tests.editor import Editor, RefusedError
from tests.fretc.report import cases

Start = Callable[..., Editor]
ROOT = Path(__file__).parents[3]
R2 = """\
+++
id = "R2"
parents = ["R1"]
params = { near = "5 cm" }
+++
upon near & vx > 2 m/s the robot shall within 2 seconds satisfy stopped
"""


def opened(editor: Start, r1: str = cases.R1) -> tuple[Editor, Path, Path]:
    """An editor, and two files of a project: its requirements and its bindings."""
    write("requirements/r1.fret", r1)
    write("requirements/bindings.toml", cases.BINDINGS)
    write("requirements/hazards.toml", cases.HAZARDS)
    client, folder = editor(), Path.cwd() / "requirements"
    client.open(folder / "r1.fret")
    return client, folder / "r1.fret", folder / "bindings.toml"


def place(client: Editor, path: Path, text: str, at: str) -> dict[str, Any]:
    """The parameters for the first place of `at` in a text."""
    before = text[: text.index(at)]
    return client.at(path, before.count("\n"), len(before) - before.rfind("\n") - 1)


def applied(edits: list[Any], text: str) -> str:
    """A text of one-unit characters with the edits of one answer."""
    lines = text.splitlines(keepends=True)
    starts = [sum(map(len, lines[:line])) for line in range(len(lines) + 1)]

    def offset(position: Mapping[str, int]) -> int:
        return starts[position["line"]] + position["character"]

    for edit in sorted(edits, key=lambda edit: -offset(edit["range"]["start"])):
        start, end = (offset(edit["range"][key]) for key in ("start", "end"))
        text = text[:start] + edit["newText"] + text[end:]
    return text


def places(locations: list[Any]) -> list[tuple[str, int, int]]:
    """Name of the file, line and character of each location."""
    return sorted(
        (each["uri"].rpartition("/")[2], *each["range"]["start"].values()) for each in locations
    )


FORMULAS = """\
FT  G(!(near & (vx > 2)) & X(near & (vx > 2)) -> X F[0,20] stopped) & (near & (vx > 2) -> F[0,20] stopped)
PT  H(O[20,20](near & (vx > 2) & Z !(near & (vx > 2)) & !stopped) -> O[0,19]((Z FALSE) | stopped))
"""  # noqa: E501
# Hover --------------------------------------------------------------------------------------------


def hovered(client: Editor, path: Path, text: str, at: str) -> str:
    answer = client.ask("textDocument/hover", **place(client, path, text, at))
    assert answer is not None
    return str(answer["contents"]["value"])


def test_a_sentence_is_explained(editor: Start, fretc: Fretc) -> None:
    client, path, _ = opened(editor, R2)
    explained = fretc("explain", "R2").out
    shown = hovered(client, path, R2, "satisfy")
    assert shown.startswith(
        "**R2**\n\n"
        "Over the whole run: at every tick at which `near & vx > 2 m/s` becomes true (or is true "
        "at the first tick), `stopped` must be true at that tick or within the next 20 ticks (2 s) "
        "(nothing is required if the run ends before that).\n\n"
        f"```\n{FORMULAS}```"
    )
    diagram, traces = shown.split("```")[3].split("\n\n", 1)
    assert all(line.strip() in explained for line in f"{diagram}\n{traces}".splitlines())
    assert "near & vx > 2 m/s" in diagram
    assert "▲" in diagram
    assert [traces.count(sign) for sign in ("✔ satisfied: ", "✘ violated: ")] == [1, 1]


def test_an_editor_that_shows_images_gets_the_diagram_as_one(
    editor: Start, fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    general = {"markdown": {"parser": "marked"}}
    monkeypatch.setattr("tests.editor.GENERAL", general)
    client, path, _ = opened(editor, R2)
    shown = hovered(client, path, R2, "satisfy")
    data = shown.partition("![diagram](data:image/svg+xml;base64,")[2].partition(")")[0]
    fretc("explain", "R2", "--svg", "r2.svg")
    assert base64.b64decode(data).decode() == Path("r2.svg").read_text("utf-8")
    assert "▲" not in shown
    assert "✘ violated: " in shown


def test_a_sentence_that_is_costly_to_explain_keeps_its_meaning(editor: Start) -> None:
    client, path, _ = opened(editor)
    text = f"{HEADER}upon near the robot shall within 999999 seconds satisfy stopped\n"
    client.change(path, text)
    shown = hovered(client, path, text, "satisfy")
    assert "Over the whole run" in shown
    assert "▲" not in shown
    assert "violated: " not in shown
    assert client.log == []


def test_a_name_shows_its_range_in_the_last_audit(editor: Start) -> None:
    known = cases.project(Path("requirements"))
    Path("build").mkdir()
    cases.write_evidence(known, Path("build"), cases.result(known, "satisfied"))
    client, path = editor(), Path.cwd() / "requirements/r1.fret"
    client.open(path)
    client.settle()
    shown = hovered(client, path, cases.R1, "stopped")
    line = "`abs(vx) < 0.01 m/s`: 0 m/s to 0.0075 m/s, margin 0.0025 m/s in the last audit"
    assert f"\n{line}\n" in shown
    client.change(path, cases.R1.replace("eventually", "always"))
    client.settle()
    assert f"\n{line}, which is stale\n" in hovered(
        client, path, cases.R1.replace("eventually", "always"), "stopped"
    )


def test_a_name_shows_its_binding_and_its_users(editor: Start) -> None:
    client, path, bindings = opened(editor)
    write("requirements/r2.fret", R2)
    client.tell("textDocument/didSave", textDocument=client.at(path, 0, 0)["textDocument"])
    near = (
        "**`near`**\n\nproposition, input: `clearance < 5 cm`\n\nan obstacle is near"
        "\n\nused by R1, R2"
    )
    assert hovered(client, path, cases.R1, "near robot"[:4] + " the") == near
    assert hovered(client, bindings, cases.BINDINGS, "near]") == near
    signal = hovered(client, bindings, cases.BINDINGS, "vx]")
    assert signal == "**`vx`**\n\nsignal in `m/s`: `/odom.twist.twist.linear.x`\n\nused by R2"
    assert hovered(client, path, cases.R1, "HAZ-1").startswith(
        "**`HAZ-1`**\n\nhazard: The robot hits"
    )


def test_markup_in_a_title_is_shown_as_it_is(editor: Start) -> None:
    header = '+++\nid = "R"\ntitle = "<img src=x> [a](b) *c* `d`"\n+++\n'
    text = f"{header}the robot shall always satisfy near\n"
    client, path, _ = opened(editor, text)
    title = hovered(client, path, text, "shall").splitlines()[0]
    assert title == r"**\<img src=x\> \[a\](b) \*c\* `d` (R)**"


def test_a_code_is_explained_where_it_is_accepted_and_reported(editor: Start) -> None:
    header = '+++\nid = "R"\naccept = { F204 = "so it is meant" }\n+++\n'
    text = f"{header}the robot shal always satisfy near\n"
    client, path, _ = opened(editor, text)
    assert hovered(client, path, text, "F204").startswith("**F204** `when` and `if` trigger")
    assert "**F107** a key word of FRETish is misspelt" in hovered(client, path, text, "shal ")


# Completion ---------------------------------------------------------------------------------------


def labels(client: Editor, path: Path, text: str, marked: str) -> list[str]:
    """What is offered at `|` in a text."""
    client.change(path, text + marked.replace("|", ""))
    whole = text + marked.partition("|")[0]
    position = client.at(path, whole.count("\n"), len(whole) - whole.rfind("\n") - 1)
    return [item["label"] for item in client.ask("textDocument/completion", **position)["items"]]


HEADER = '+++\nid = "R1"\n+++\n'


@each(
    "case",
    (
        ("the |", ["robot"]),
        ("the robot sh|", ["shall"]),
        (
            "the robot shall within 2 |",
            ["hours", "microseconds", "milliseconds", "minutes", "seconds", "ticks"],
        ),
        ("the robot shall at the |", ["first", "last", "next", "same"]),
        ("the robot shall always |", ["satisfy"]),
        ("the robot shall with |", ["probability"]),
    ),
)
def test_words_are_those_that_the_grammar_allows(
    case: tuple[str, list[str]], editor: Start
) -> None:
    client, path, _ = opened(editor)
    write("requirements/r2.fret", R2)
    marked, expected = case
    assert labels(client, path, HEADER, marked) == expected


def test_every_word_of_a_sentence_is_offered_where_it_stands(editor: Start) -> None:
    sentence = (
        "in near mode whenever near & vx the robot shall within 2 seconds satisfy stopped & near"
    )
    write("requirements/r2.fret", R2)
    client, path, _ = opened(editor)
    words = sentence.split()
    for at, word in enumerate(words):
        if word.isalpha() and word != "vx":
            before = " ".join(words[:at]) + (" " if at else "")
            assert word in labels(client, path, HEADER, f"{before}|"), before


def test_an_empty_sentence_is_offered_patterns(editor: Start) -> None:
    client, path, _ = opened(editor)
    offered = labels(client, path, HEADER, "|")
    assert "whenever ... shall within ..." in offered
    assert {"whenever", "the", "in"} <= {*offered}


def test_the_values_of_a_signal_are_offered_behind_its_comparison(editor: Start) -> None:
    client, path, bindings = opened(editor)
    more = '\n[signal.stage]\npath = "/s.data"\nvalues = ["drive", "dock"]\n'
    client.open(bindings, cases.BINDINGS + more)
    assert labels(client, path, HEADER, "while stage = |") == ["drive", "dock"]


@each(
    "case",
    (
        ("requirements/r1.fret", '+++\nid = "R1"\nst|', ["id", "kind", "title"]),
        ("requirements/r1.fret", '+++\nid = "R1"\nstatus = "|', ["draft", "approved", "retired"]),
        ("requirements/r1.fret", '+++\nid = "R1"\nparents = ["|', ["HAZ-1"]),
        ("requirements/bindings.toml", "[|", ["signal.", "proposition.", "variable."]),
        ("requirements/bindings.toml", "[clock]\n|", ["time", "tick", "phase"]),
        ("requirements/bindings.toml", "[signal.x]\n|", ["path", "type", "reduce"]),
        (
            "requirements/bindings.toml",
            '[proposition.x]\nrole = "|',
            ["input", "output", "internal"],
        ),
        ("requirements/hazards.toml", "[HAZ-1]\n|", ["title", "text", "severity", "source"]),
        ("requirements/waivers.toml", '[R1]\nverdict = "|', ["violated"]),
    ),
)
def test_keys_and_values_of_toml_are_offered(
    case: tuple[str, str, list[str]], editor: Start
) -> None:
    client, _, _ = opened(editor)
    name, marked, expected = case
    path = Path.cwd() / name
    client.open(path, "")
    offered = labels(client, path, "", marked)
    assert offered[: len(expected)] == expected or expected[0] in offered[:1]


# Names --------------------------------------------------------------------------------------------


def test_a_name_is_found_in_all_files(editor: Start) -> None:
    client, path, bindings = opened(editor)
    write("requirements/r2.fret", R2)
    client.tell("textDocument/didSave", textDocument=client.at(path, 0, 0)["textDocument"])
    near = place(client, path, cases.R1, "near robot"[:4] + " the")
    line = cases.BINDINGS[: cases.BINDINGS.index("near]")].count("\n")
    assert places(client.ask("textDocument/definition", **near)) == [("bindings.toml", line, 13)]
    context = {"includeDeclaration": True}
    assert places(client.ask("textDocument/references", **near, context=context)) == [
        ("bindings.toml", line, 13),
        ("r1.fret", 9, 9),
        ("r2.fret", 3, 11),
        ("r2.fret", 5, 5),
    ]
    parent = place(client, path, cases.R1, "HAZ-1")
    assert places(client.ask("textDocument/definition", **parent)) == [("hazards.toml", 0, 1)]
    signal = place(client, bindings, cases.BINDINGS, "clearance <")
    line = cases.BINDINGS[: cases.BINDINGS.index("clearance]")].count("\n")
    assert places(client.ask("textDocument/definition", **signal)) == [("bindings.toml", line, 8)]


def renamed(client: Editor, where: Mapping[str, Any], new: str) -> dict[str, str]:
    """The files that a renaming changes, on the disk, with their new texts."""
    answer = client.ask("textDocument/rename", **where, newName=new)
    texts = {}
    for uri, edits in answer["changes"].items():
        path = Path(uri.removeprefix("file://"))
        texts[path.name] = applied(edits, path.read_text("utf-8"))
        path.write_text(texts[path.name], "utf-8")
    return texts


def loaded() -> Project:
    project = load_folder("requirements")
    assert isinstance(project, Project)
    return project


@pytest.mark.slow
@each("new", ("halted", "in store", "Shall", "x.y"))
def test_a_renaming_changes_names_and_nothing_else(new: str, editor: Start) -> None:
    """`near` is in two sentences, in `params`, and in the bindings."""
    client, path, _ = opened(editor)
    write("requirements/r2.fret", R2)
    before = loaded()
    client.tell("textDocument/didSave", textDocument=client.at(path, 0, 0)["textDocument"])
    texts = renamed(client, place(client, path, cases.R1, "near robot"[:4] + " the"), new)
    assert {*texts} == {"r1.fret", "r2.fret", "bindings.toml"}
    after = loaded()
    assert [d.code for d in after.diagnostics] == [d.code for d in before.diagnostics]
    for one, other in zip(before.formalized, after.formalized, strict=True):
        assert [new if name == "near" else name for name in one.variables] == [*other.variables]
        assert [new if key == "near" else key for key in one.entry.params] == [*other.entry.params]
    assert before.declarations is not None
    assert after.declarations is not None
    assert after.declarations.propositions[new].expression == (
        before.declarations.propositions["near"].expression
    )


def test_a_computed_signal_is_shown_and_renamed_with_its_value(editor: Start) -> None:
    client, path, bindings = opened(editor)
    text = cases.BINDINGS + '\n[signal.pace]\nvalue = "hypot(vx, 1 m/s)"\n'
    write("requirements/bindings.toml", text)
    write("requirements/r2.fret", R2.replace("vx >", "pace >"))
    client.tell("textDocument/didSave", textDocument=client.at(path, 0, 0)["textDocument"])
    client.open(bindings)
    assert "signal in `m/s`: `hypot(vx, 1 m/s)`" in hovered(client, bindings, text, "pace]")
    texts = renamed(client, place(client, bindings, text, "vx]"), "v_x")
    assert 'value = "hypot(v_x, 1 m/s)"' in texts["bindings.toml"]
    assert 'expr = "abs(v_x) < 0.01 m/s for 200 ms"' in texts["bindings.toml"]
    assert [each for each in loaded().diagnostics if each.is_error] == []


def test_a_hazard_and_a_requirement_are_renamed_with_what_refers_to_them(editor: Start) -> None:
    client, path, _ = opened(editor)
    write("requirements/r2.fret", R2)
    write("fretc.toml", '[accept]\nF522 = { "HAZ-1" = "it is known" }\n')
    client.tell("textDocument/didSave", textDocument=client.at(path, 0, 0)["textDocument"])
    texts = renamed(client, place(client, path, cases.R1, "HAZ-1"), "HAZ-002")
    assert {*texts} == {"r1.fret", "hazards.toml", "fretc.toml"}
    assert all("HAZ-002" in text and "HAZ-1" not in text for text in texts.values())
    client.change(path, texts["r1.fret"])
    client.tell("textDocument/didSave", textDocument=client.at(path, 0, 0)["textDocument"])
    texts = renamed(client, place(client, path, texts["r1.fret"], "R1"), "STOP-1")
    assert {*texts} == {"r1.fret", "r2.fret"}
    assert 'parents = ["STOP-1"]' in texts["r2.fret"]


@each(
    "case",
    (
        ("near", "stopped", "`stopped` is already in use"),
        ("near", 'a"b', "a name is printable, and without quotes and backslashes"),
        ("near", "FTP", "it is the name of the first tick"),
        ("vx", "v x", "the expressions of the bindings take letters, digits and `_`"),
        ("vx", "and", "the expressions of the bindings take letters, digits and `_`"),
        ("robot", "near mode\n", "a name is printable, and without quotes and backslashes"),
        ("R1", "", "an id has letters, digits, `_`, `-` and `.`"),
        ("R1", "HAZ-1", "`HAZ-1` is already in use"),
    ),
)
def test_a_renaming_that_would_clash_is_refused(case: tuple[str, str, str], editor: Start) -> None:
    name, new, reason = case
    client, path, _ = opened(editor, R2.replace("R1", "HAZ-1").replace('"R2"', '"R1"'))
    text = path.read_text()
    with pytest.raises(RefusedError, match=r"^F966 ") as error:
        client.ask("textDocument/rename", **place(client, path, text, name), newName=new)
    assert str(error.value).endswith(reason)


def test_nothing_is_renamed_while_a_file_cannot_be_read(editor: Start) -> None:
    client, path, bindings = opened(editor)
    client.open(bindings, cases.BINDINGS + "\n[")
    with pytest.raises(RefusedError, match=r"first fix F301 at requirements/bindings.toml:"):
        client.ask(
            "textDocument/rename", **place(client, path, cases.R1, "stopped"), newName="halted"
        )


# Edits --------------------------------------------------------------------------------------------

UGLY = """\
+++
id = "R1"
+++
Whenever near   the robot shall \r
  within 2 secs satisfy ((stopped))
"""


def test_formatting_is_that_of_the_command(editor: Start, fretc: Fretc) -> None:
    client, path, _ = opened(editor)
    client.change(path, UGLY)
    options = {"tabSize": 4, "insertSpaces": True}
    document = client.at(path, 0, 0)["textDocument"]
    edits = client.ask("textDocument/formatting", textDocument=document, options=options)
    path.write_bytes(UGLY.encode())
    assert fretc("fmt", "requirements/r1.fret").status == 0
    assert applied(edits, UGLY) == path.read_bytes().decode()
    client.change(path, path.read_bytes().decode())
    assert client.ask("textDocument/formatting", textDocument=document, options=options) == []


def actions(client: Editor, path: Path, **context: Any) -> list[Any]:
    everything = {"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}}
    answer: list[Any] = client.ask(
        "textDocument/codeAction",
        textDocument=client.at(path, 0, 0)["textDocument"],
        range=everything,
        context={"diagnostics": [], **context},
    )
    return answer


WRONG = "whenever near the robot shal within 2 secnds satisfy stopped and near"


@each("sentence", (WRONG, "the robot shall stopped", "when near the robot must satisfy stopped"))
def test_all_safe_fixes_are_those_of_the_command(
    sentence: str, editor: Start, fretc: Fretc
) -> None:
    client, path, _ = opened(editor)
    client.change(path, f"{HEADER}{sentence}\n")
    (action,) = actions(client, path, only=["source.fixAll"])
    path.write_text(f"{HEADER}{sentence}\n")
    fretc("check", "--fix")
    (edits,) = action["edit"]["changes"].values()
    assert applied(edits, f"{HEADER}{sentence}\n") == path.read_text()
    assert path.read_text() != f"{HEADER}{sentence}\n"


def test_each_fix_is_offered_at_its_mistake(editor: Start) -> None:
    client, path, _ = opened(editor)
    client.change(path, f"{HEADER}{WRONG}\n")
    offered = actions(client, path, only=["quickfix"])
    assert [(action["title"], action["isPreferred"]) for action in offered] == [
        ("write `shall` (F107)", True),
        ("write `seconds` (F108)", False),
    ]


def test_a_missing_binding_and_a_reason_can_be_added(editor: Start) -> None:
    client, path, bindings = opened(editor)
    client.change(path, f"{HEADER}when far the robot shall immediately satisfy stopped\n")
    titles = {action["title"]: action for action in actions(client, path)}
    assert {*titles} >= {
        "add `[proposition.far]` to bindings.toml (F304)",
        "accept F204 with a reason (F204)",
    }
    (edits,) = titles["add `[proposition.far]` to bindings.toml (F304)"]["edit"]["changes"].values()
    assert applied(edits, cases.BINDINGS) == (
        f'{cases.BINDINGS}\n[proposition.far]\nexpr = "TODO"\nrole = "input"\n'
    )
    assert bindings.exists()
    (edits,) = titles["accept F204 with a reason (F204)"]["edit"]["changes"].values()
    assert applied(edits, HEADER) == '+++\nid = "R1"\naccept = { F204 = "TODO" }\n+++\n'


ENGLISH = "if the battery is low, the drone must return within 5 seconds"


def test_a_sentence_in_plain_english_can_become_one_of_its_readings(
    editor: Start, fretc: Fretc
) -> None:
    client, path, _ = opened(editor)
    client.change(path, f"{HEADER}{ENGLISH}\n")
    offered = [each for each in actions(client, path) if each["title"].startswith("write `when")]
    readings = json.loads(fretc("write", ENGLISH, "--format", "json").out)
    sentences = [reading["sentence"] for each in readings["texts"] for reading in each["readings"]]
    texts = []
    for action in offered:
        (edits,) = action["edit"]["changes"].values()
        text = applied(edits, f"{HEADER}{ENGLISH}\n")
        texts.append(text.removeprefix(HEADER).rstrip("\n"))
        assert action["title"] == f"write `{texts[-1]}`"
    assert texts == sentences
    assert len(texts) > 1
    client.change(path, f"{HEADER}The robot must stop. It must start again.\n")
    assert not [each for each in actions(client, path) if "the robot shall" in each["title"]]
    assert client.log == []


@pytest.mark.slow
def test_missing_bindings_are_drafted_from_the_latest_audited_log(
    editor: Start, fretc: Fretc
) -> None:
    shutil.copytree(ROOT / "requirements", "requirements", ignore=shutil.ignore_patterns("*/"))
    Path("traces").mkdir()
    log = Path(shutil.copy(ROOT / "traces/mission-seed15.mcap", "traces"))
    fretc("audit", str(log), "-o", "build/evidence.json")
    path = Path.cwd() / "requirements/r1.fret"
    client = editor()
    sentence = "whenever too_close the robot shall eventually satisfy !moving & battery < 20 %"
    client.open(path, f"{HEADER}{sentence}\n")
    client.settle()
    titles = {each["title"]: each for each in actions(client, path)}
    (title,) = [each for each in titles if "`moving`" in each and "drafted from" in each]
    assert title == f"add `moving` to bindings.toml, drafted from {log} (F304)"
    resolved = client.ask("codeAction/resolve", **titles[title])
    (edits,) = resolved["edit"]["changes"].values()
    before = Path("requirements/bindings.toml").read_text()
    after = applied(edits, before)
    assert after.startswith(before)
    assert "[proposition.moving]" in after
    other = {**titles[title], "data": {**titles[title]["data"], "log": "/etc/passwd"}}
    assert "edit" not in client.ask("codeAction/resolve", **other)
    log.write_bytes(b"not a log")
    with pytest.raises(RefusedError, match="F4"):
        client.ask("codeAction/resolve", **titles[title])


# Outline ------------------------------------------------------------------------------------------


def test_the_outline_of_a_file(editor: Start) -> None:
    client, path, bindings = opened(editor, f"{cases.R1}\n{R2}")
    document = client.at(path, 0, 0)["textDocument"]
    symbols = client.ask("textDocument/documentSymbol", textDocument=document)
    assert [(each["name"], each["detail"]) for each in symbols] == [
        ("R1", "Stop when something is near"),
        ("R2", ""),
    ]
    folds = client.ask("textDocument/foldingRange", textDocument=document)
    assert [(each["startLine"], each["endLine"]) for each in folds] == [(0, 9), (11, 16)]
    everything = {"start": {"line": 0, "character": 0}, "end": {"line": 99, "character": 0}}
    hints = client.ask("textDocument/inlayHint", textDocument=document, range=everything)
    assert [(each["label"], each["position"]) for each in hints] == [
        ("= 20 ticks", {"line": 16, "character": len(R2.splitlines()[-1].partition(" satisfy")[0])})
    ]
    document = client.at(bindings, 0, 0)["textDocument"]
    symbols = client.ask("textDocument/documentSymbol", textDocument=document)
    assert [each["name"] for each in symbols] == ["clearance", "vx", "near", "stopped"]
    symbols = client.ask("workspace/symbol", query="something")
    assert [each["name"] for each in symbols] == ["R1"]


def test_words_are_coloured_by_what_they_are(editor: Start) -> None:
    sentence = 'upon "near" & persisted(2, \U0001f600 vx) the robot shall within 2 s satisfy true'
    text = f"{HEADER}{sentence}\n"
    client, path, _ = opened(editor, text)
    data = client.ask(
        "textDocument/semanticTokens/full", textDocument=client.at(path, 0, 0)["textDocument"]
    )["data"]
    lines = text.splitlines()
    words, line, character = [], 0, 0
    for down, right, length, kind, _ in zip(*[iter(data)] * 5, strict=True):
        line, character = line + down, right if down else character + right
        units = lines[line].encode("utf-16-le")
        word = units[2 * character : 2 * (character + length)].decode("utf-16-le")
        words.append((word, TOKEN_TYPES[kind]))
    assert words == [
        ("upon", "keyword"),
        ('"near"', "variable"),
        ("&", "operator"),
        ("persisted", "function"),
        ("2", "number"),
        ("vx", "variable"),
        ("the", "keyword"),
        ("robot", "class"),
        ("shall", "keyword"),
        ("within", "keyword"),
        ("2 s", "number"),
        ("satisfy", "keyword"),
        ("true", "keyword"),
    ]


@pytest.mark.slow
def test_the_shipped_projects_are_read_without_a_mistake(editor: Start) -> None:
    shutil.copytree(ROOT / "requirements", "requirements")
    client = editor()
    for path in sorted(Path.cwd().glob("requirements/**/*.fret")):
        client.open(path)
        document = client.at(path, 0, 0)["textDocument"]
        assert client.ask("textDocument/semanticTokens/full", textDocument=document)["data"]
    client.settle()
    errors = [d for some in client.diagnostics.values() for d in some if d["severity"] == 1]
    assert errors == []
    assert json.dumps(client.log) == "[]"
