"""What the server publishes while a project is edited: what `fretc check` would report."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.explanations import explanation
from tests.command import Fretc, write
from tests.each import each
from tests.editor import Editor
from tests.fretc.report import cases

Start = Callable[..., Editor]
NUMBERS = {"error": 1, "warning": 2, "note": 3}
CORPUS = {
    code.number: explanation(code)
    for code in Code
    if explanation(code).wrong and explanation(code).kind in ("fret", "bindings")
}
"""Code → its explanation, with a wrong text and the fixed one."""
OF_MONITORS = "F203"
"""It is reported where a monitor is generated; where no clock is declared, F304 hides it."""


def project(**files: str) -> dict[str, Path]:
    """Files of `requirements/`, by the first part of their names."""
    for name, text in files.items():
        write(f"requirements/{name.replace('_', '.')}", text)
    return {
        name.partition("_")[0]: Path.cwd() / "requirements" / name.replace("_", ".")
        for name in files
    }


def checked(fretc: Fretc) -> list[tuple[Any, ...]]:
    """What the command reports: code, severity, message, file, line, column."""
    record = json.loads(fretc("check", "--format", "json").out)
    return sorted(
        (
            d["code"],
            NUMBERS[d["severity"]],
            d["message"],
            d["file"],
            d["line"],
            d["column"],
        )
        for d in record["diagnostics"]
        if d["file"]
    )


def shown(editor: Editor) -> list[tuple[Any, ...]]:
    """What the editor shows, in the same form; help texts are left out."""
    return sorted(
        (
            d["code"],
            d["severity"],
            d["message"].partition("\nhelp: ")[0],
            str(Path(path).relative_to(editor.root)),
            d["range"]["start"]["line"] + 1,
            d["range"]["start"]["character"] + 1,
        )
        for path, diagnostics in editor.diagnostics.items()
        for d in diagnostics
    )


@pytest.mark.slow
@each("number", CORPUS)
def test_the_corpus_of_mistakes_is_reported_as_the_command_does(
    number: str, fretc: Fretc, editor: Start
) -> None:
    """The editor sees the wrong text unsaved: the disk has the fixed one."""
    case = CORPUS[number]
    Path("requirements/bindings.toml").unlink(missing_ok=True)
    texts = {"r1_fret": cases.R1, **({"bindings_toml": case.declared} if case.declared else {})}
    name = "r1_fret" if case.kind == "fret" else "bindings_toml"
    paths = project(**{**texts, name: case.fixed})
    path = paths[name.partition("_")[0]]
    client = editor("utf-32")
    client.open(path)
    client.change(path, case.wrong)
    client.settle()
    path.write_text(case.wrong, "utf-8")
    expected = checked(fretc)
    assert shown(client) == expected
    assert number in [code for code, *_ in expected] or number == OF_MONITORS
    assert not client.log


@pytest.mark.parametrize(("encoding", "units"), [("utf-8", 17), ("utf-16", 12), ("utf-32", 10)])
def test_characters_are_counted_in_the_units_of_the_client(
    encoding: str, units: int, editor: Start
) -> None:
    """Each of the two emoji has 4 bytes and 2 units of 16 bits, `é` has 2 bytes and 1 unit."""
    paths = project(r1_fret="the R shall satisfy a\n")
    client = editor(encoding)
    assert client.server["capabilities"]["positionEncoding"] == encoding
    client.open(paths["r1"], 'the "\U0001f600\U0001f600é" shal satisfy a\r\n')
    (wrong,) = client.diagnostics[str(paths["r1"])]
    assert wrong["code"] == "F107"
    assert wrong["range"]["start"] == {"line": 0, "character": units}
    assert wrong["range"]["end"] == {"line": 0, "character": units + 4}


def test_a_name_renamed_in_the_bindings_marks_the_sentences(editor: Start) -> None:
    paths = project(r1_fret=cases.R1, bindings_toml=cases.BINDINGS, hazards_toml=cases.HAZARDS)
    client = editor()
    client.open(paths["bindings"])
    assert "F304" not in client.codes(paths["r1"])
    client.change(
        paths["bindings"], cases.BINDINGS.replace("[proposition.stopped]", "[proposition.halted]")
    )
    assert "F304" in client.codes(paths["r1"])
    client.change(paths["bindings"], cases.BINDINGS)
    assert "F304" not in client.codes(paths["r1"])


def test_a_repeated_id_shows_the_first_one(editor: Start) -> None:
    text = '+++\nid = "A"\n+++\nthe R shall always satisfy a\n\n'
    paths = project(r1_fret=text, r2_fret=text)
    client = editor()
    client.open(paths["r1"])
    (wrong,) = [d for d in client.diagnostics[str(paths["r2"])] if d["code"] == "F201"]
    (other,) = wrong["relatedInformation"]
    assert other["location"]["uri"].endswith("/requirements/r1.fret")
    assert other["location"]["range"]["start"] == {"line": 1, "character": 5}


def test_what_is_closed_without_saving_has_the_text_of_the_disk_again(editor: Start) -> None:
    paths = project(
        r1_fret="the R shall always satisfy a\n", r2_fret="the R shall never satisfy a\n"
    )
    client = editor()
    client.open(paths["r2"])
    client.open(paths["r1"], "the R shal always satisfy a\n")
    assert "F107" in client.codes(paths["r1"])
    client.shut(paths["r1"])
    assert "F107" not in client.codes(paths["r1"])


def test_a_closed_project_shows_nothing(editor: Start) -> None:
    paths = project(r1_fret="the R shal always satisfy a\n")
    client = editor()
    client.open(paths["r1"])
    assert client.codes(paths["r1"])
    client.shut(paths["r1"])
    assert client.diagnostics[str(paths["r1"])] == []


def test_a_file_that_is_only_in_the_editor_belongs_to_the_project(editor: Start) -> None:
    paths = project(r1_fret='+++\nid = "A"\n+++\nthe R shall always satisfy a\n')
    client = editor()
    new = Path.cwd() / "requirements/r2.fret"
    client.open(new, paths["r1"].read_text())
    assert "F201" in client.codes(new)


def test_a_file_changed_on_the_disk_is_read_again(editor: Start) -> None:
    paths = project(
        r1_fret="the R shall always satisfy a\n", r2_fret="the R shall never satisfy a\n"
    )
    client = editor()
    client.open(paths["r1"])
    write("requirements/r2.fret", "the R shal never satisfy a\n")
    uri = client.at(paths["r2"], 0, 0)["textDocument"]["uri"]
    client.tell("workspace/didChangeWatchedFiles", changes=[{"uri": uri, "type": 2}])
    assert "F107" in client.codes(paths["r2"])


def test_settings_concern_the_projects_below_them(editor: Start) -> None:
    paths = project(r1_fret="the R shall always satisfy a\n")
    write("fretc.toml", "")
    client = editor()
    client.open(Path.cwd() / "fretc.toml", "parent = []\n")
    assert client.codes(Path.cwd() / "fretc.toml") == ["F520"]
    client.change(Path.cwd() / "fretc.toml", "parents = []\n")
    assert client.codes(Path.cwd() / "fretc.toml") == []
    assert paths


def test_a_workspace_behind_a_link_has_its_unsaved_texts(tmp_path: Path) -> None:
    (tmp_path / "real/requirements").mkdir(parents=True)
    (tmp_path / "real/requirements/r1.fret").write_text("the R shall always satisfy a\n")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    client = Editor(tmp_path / "link")
    path = tmp_path / "link/requirements/r1.fret"
    client.open(path, "the R shal always satisfy a\n")
    assert "F107" in client.codes(path)
    client.close()


def test_a_warning_that_needs_a_review_comes_after_a_silence(fretc: Fretc, editor: Start) -> None:
    paths = project(r1_fret=cases.R1, bindings_toml=cases.BINDINGS, hazards_toml=cases.HAZARDS)
    fretc("lock", "--reviewer", "A", "--role", "B", "--comment", "c", "--date", "2026-01-01")
    client = editor()
    client.open(paths["r1"], cases.R1.replace("eventually", "always"))
    assert "F512" not in client.codes(paths["r1"])
    client.settle()
    assert "F512" in client.codes(paths["r1"])
    client.open(paths["hazards"])
    assert "F512" in client.codes(paths["r1"]), "an edit elsewhere does not make it flicker"
    client.change(paths["r1"], "\n" + cases.R1)
    assert "F512" not in client.codes(paths["r1"]), "its place is not known any more"
    client.settle()
    assert "F512" not in client.codes(paths["r1"])


def test_an_accepted_warning_is_a_hint_with_its_reason(editor: Start) -> None:
    header = '+++\nid = "R"\naccept = { F204 = "so it is meant" }\n+++\n'
    paths = project(r1_fret=f"{header}when a the R shall immediately satisfy b\n")
    client = editor()
    client.open(paths["r1"])
    (hint,) = [d for d in client.diagnostics[str(paths["r1"])] if d["code"] == "F204"]
    assert (hint["severity"], hint["tags"]) == (4, [1])
    assert hint["message"].endswith("accepted: so it is meant")


def test_what_has_no_effect_is_dimmed_and_what_is_retired_struck_out(editor: Start) -> None:
    header = '+++\nid = "R"\nstatus = "STATUS"\naccept = { F204 = "why" }\n+++\n'
    text = f"{header}the R shall always satisfy a\n".replace("STATUS", "approved")
    paths = project(r1_fret=text)
    client = editor()
    uri = client.open(paths["r1"])
    client.settle()
    tags = {d["code"]: d.get("tags") for d in client.diagnostics[str(paths["r1"])]}
    assert tags["F550"] == [1]
    assert tags["F304"] is None
    (symbol,) = client.ask("textDocument/documentSymbol", textDocument={"uri": uri})
    assert "tags" not in symbol
    client.change(paths["r1"], text.replace("approved", "retired"))
    (symbol,) = client.ask("textDocument/documentSymbol", textDocument={"uri": uri})
    assert symbol["tags"] == [1]


def test_other_documents_are_none_of_its_business(editor: Start) -> None:
    client = editor()
    for uri in (
        "untitled:Untitled-1",
        "file:///etc/passwd",
        "git:/r1.fret?x",
        "",
        "file:",
        "file:///%00.fret",
    ):
        document = {"uri": uri, "languageId": "x", "version": 1, "text": "x"}
        client.tell("textDocument/didOpen", textDocument=document)
    assert (client.diagnostics, client.log) == ({}, [])
