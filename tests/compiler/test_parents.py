"""Parents that live in StrictDoc, Doorstop, sphinx-needs or ReqIF."""

import json
import zipfile
from pathlib import Path

import pytest

from compiler.parents import Parent, parents
from compiler.settings import Settings, settings
from fretish.diagnostic import Code, Diagnostic
from fretish.rendering import render
from tests.command import Fretc, write

SDOC = """\
[DOCUMENT]
TITLE: Hazards
UID: DOC

[GRAMMAR]
ELEMENTS:
- TAG: HAZARD

[[SECTION]]
UID: SEC-1
TITLE: Motion

[REQUIREMENT]
MID: 12345
UID: SAFE-1
STATUS: Active
TITLE: Stop in time
STATEMENT: >>>
The robot stops.
UID: not a field
<<<

[HAZARD]
UID: HAZ-7
STATEMENT: The robot hits a drum.

[[/SECTION]]

[TEXT]
STATEMENT: >>>
UID: NO
<<<
"""
NEEDS = {
    "current_version": "1.0",
    "versions": {
        "0.9": {"needs": {"OLD": {"title": "old"}}},
        "1.0": {"needs": {"SAFE-1": {"title": "Stop in time", "content": "The robot stops."}}},
    },
}
REQIF = """\
<?xml version="1.0" encoding="UTF-8"?>
<REQ-IF xmlns="http://www.omg.org/spec/ReqIF/20110401/reqif.xsd" xmlns:h="http://www.w3.org/1999/xhtml">
<CORE-CONTENT><REQ-IF-CONTENT>
<SPEC-TYPES><SPEC-OBJECT-TYPE IDENTIFIER="t"><SPEC-ATTRIBUTES>
<ATTRIBUTE-DEFINITION-STRING IDENTIFIER="a1" LONG-NAME="ReqIF.ForeignID"/>
<ATTRIBUTE-DEFINITION-STRING IDENTIFIER="a2" LONG-NAME="ReqIF.Name"/>
<ATTRIBUTE-DEFINITION-XHTML IDENTIFIER="a3" LONG-NAME="ReqIF.Text"/>
</SPEC-ATTRIBUTES></SPEC-OBJECT-TYPE></SPEC-TYPES>
<SPEC-OBJECTS>
<SPEC-OBJECT IDENTIFIER="o1"><VALUES>
<ATTRIBUTE-VALUE-STRING THE-VALUE="SAFE-1"><DEFINITION>
<ATTRIBUTE-DEFINITION-STRING-REF>a1</ATTRIBUTE-DEFINITION-STRING-REF></DEFINITION>
</ATTRIBUTE-VALUE-STRING>
<ATTRIBUTE-VALUE-STRING THE-VALUE="Stop in time"><DEFINITION>
<ATTRIBUTE-DEFINITION-STRING-REF>a2</ATTRIBUTE-DEFINITION-STRING-REF></DEFINITION>
</ATTRIBUTE-VALUE-STRING>
<ATTRIBUTE-VALUE-XHTML><DEFINITION>
<ATTRIBUTE-DEFINITION-XHTML-REF>a3</ATTRIBUTE-DEFINITION-XHTML-REF></DEFINITION>
<THE-VALUE><h:div>The robot <h:b>stops</h:b>.</h:div></THE-VALUE></ATTRIBUTE-VALUE-XHTML>
</VALUES></SPEC-OBJECT>
<SPEC-OBJECT IDENTIFIER="o2" LONG-NAME="Only a name"/>
</SPEC-OBJECTS></REQ-IF-CONTENT></CORE-CONTENT></REQ-IF>
"""
STOP = ("SAFE-1", "Stop in time", "The robot stops.")


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def read(path: str) -> list[tuple[str, str, str]]:
    found, wrong = parents(Settings(Path.cwd(), (path,)))
    assert wrong == ()
    assert {parent.source for parent in found.values()} <= {path}
    return [(parent.id, parent.title, parent.text) for parent in found.values()]


def test_strictdoc_gives_every_node_with_a_uid_and_nothing_within_texts() -> None:
    sdoc = read(write("docs/hazards.sdoc", SDOC))
    assert ("SEC-1", "Motion", "") in sdoc
    assert ("HAZ-7", "", "The robot hits a drum.") in sdoc
    assert ("SAFE-1", "Stop in time", "The robot stops.\nUID: not a field") in sdoc
    assert len(sdoc) == 3


def test_doorstop_gives_every_active_item() -> None:
    write("reqs/.doorstop.yml", "settings:\n  digits: 3\n  prefix: SAFE-\n  sep: ''\n")
    write("reqs/SAFE-1.yml", "active: true\nheader: Stop in time\ntext: |\n  The robot stops.\n")
    write("reqs/SAFE-2.yml", "active: false\ntext: gone\n")
    write("reqs/sub/.doorstop.yml", "settings: {}\n")
    write("reqs/sub/SUB001.yml", "text: below\n")
    assert read("reqs") == [STOP, ("SUB001", "", "below")]


def test_sphinx_needs_gives_the_current_version() -> None:
    assert read(write("needs.json", json.dumps(NEEDS))) == [STOP]


def test_reqif_gives_every_object_by_its_foreign_id() -> None:
    expected = [STOP, ("o2", "Only a name", "")]
    assert read(write("a.reqif", REQIF)) == expected
    with zipfile.ZipFile("b.reqifz", "w") as archive:
        archive.writestr("inside/a.reqif", REQIF)
    assert read("b.reqifz") == expected


@pytest.mark.parametrize(
    ("path", "text", "why"),
    [
        ("a.sdoc", "TITLE: x\n", "it does not begin with `[DOCUMENT]`"),
        ("a.json", "{", "it is not JSON"),
        ("a.json", "[]", "it has no `versions`, as a needs.json has"),
        ("a.reqif", "<REQ-IF>", "it is not XML"),
        ("a.reqif", "<html/>", "its root is no `REQ-IF`"),
        ("a.reqif", '<!DOCTYPE x [<!ENTITY a "b">]><REQ-IF>&a;</REQ-IF>', "it declares entities"),
        ("a.reqifz", "x", "it is no archive of ReqIF files"),
        ("a.txt", "x", "no format is known by that ending"),
        ("reqs/x", "x", "no format is known by that ending"),
        ("gone.sdoc", None, "No such file or directory"),
    ],
)
def test_a_document_that_cannot_be_read_is_told(path: str, text: str | None, why: str) -> None:
    if text is not None:
        write(path, text)
    found, (said,) = parents(Settings(Path.cwd(), (path,)))
    assert found == {}
    assert said.code is Code.BAD_PARENTS
    assert said.message.startswith(f"the parents in `{path}` cannot be read: {why}")


def test_a_folder_without_items_is_told() -> None:
    write("reqs/a.md", "x")
    _, (said,) = parents(Settings(Path.cwd(), ("reqs",)))
    assert "no `.doorstop.yml` is in it" in said.message


# Settings --------------------------------------------------------------------------------------


def test_the_nearest_settings_upwards_hold() -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["far.sdoc"]\n')
    write("a/pyproject.toml", '[project]\nname = "other"\n')
    write("a/b/requirements/r1.fret", "x")
    found = settings("a/b/requirements")
    assert isinstance(found, Settings)
    assert (found.folder, found.parents) == (Path.cwd(), ("far.sdoc",))
    write("a/b/pyproject.toml", '[tool.fretc]\nparents = ["near.sdoc"]\n')
    found = settings("a/b/requirements")
    assert isinstance(found, Settings)
    assert (found.folder, found.parents) == (Path.cwd() / "a/b", ("near.sdoc",))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('[tool.fretc]\nparent = ["a"]\n', "F520 `parent` is no field of [tool.fretc]"),
        ('[tool.fretc]\nparents = "a"\n', "F520 `parents` must be a list of paths"),
        ("[tool]\nfretc = 1\n# tool.fretc\n", "F520 `fretc` must be a table"),
        ("[tool.fretc\n", "F520 pyproject.toml is not TOML"),
    ],
)
def test_settings_with_a_mistake_are_told(text: str, told: str) -> None:
    write("pyproject.toml", text)
    found = settings(".")
    assert isinstance(found, Diagnostic)
    assert render(found).startswith(told)


# The whole way ---------------------------------------------------------------------------------


def test_ids_are_checked_against_the_documents(fretc: Fretc) -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["docs/hazards.sdoc"]\n')
    write("docs/hazards.sdoc", SDOC)
    good = '+++\nid = "R1"\nparents = ["SAFE-1"]\n+++\nthe sw shall always satisfy p\n'
    write("requirements/r1.fret", good)
    run = fretc("report", "--json", "out.json")
    assert (run.status, "F501" in run.err) == (0, False)
    (view,) = json.loads(Path("out.json").read_text())["requirements"]
    title = "Stop in time (docs/hazards.sdoc)"
    assert view["parents"] == [{"id": "SAFE-1", "title": title, "anchor": ""}]
    write("requirements/r1.fret", good.replace("SAFE-1", "SAFE-2"))
    run = fretc("report")
    assert "F501 warning: R1 names the parent `SAFE-2`, which is not declared" in run.err
    assert "help: did you mean `SAFE-1`?" in run.err


def test_a_changed_parent_makes_what_is_below_it_suspect(fretc: Fretc) -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["docs/hazards.sdoc"]\n')
    write("docs/hazards.sdoc", SDOC)
    write(
        "requirements/r1.fret",
        '+++\nid = "R1"\nparents = ["SAFE-1"]\n+++\nthe sw shall always satisfy p\n',
    )
    by = ("--reviewer", "A", "--role", "B", "--comment", "c", "--date", "2026-01-01")
    assert fretc("lock", *by).status == 0
    write("docs/hazards.sdoc", SDOC.replace("The robot stops.", "The robot\n stops."))
    assert fretc("diff").status == 0, "white space is no change"
    write("docs/hazards.sdoc", SDOC.replace("The robot stops", "The robot stands"))
    run = fretc("diff")
    assert run.status == 3
    assert "  changed  parent SAFE-1\n" in run.out
    assert "  suspect  parent SAFE-1 → text R1 (parent SAFE-1)\n" in run.out


def test_the_first_document_that_has_an_id_counts() -> None:
    write("a.sdoc", SDOC)
    write("needs.json", json.dumps(NEEDS))
    found, wrong = parents(Settings(Path.cwd(), ("needs.json", "a.sdoc")))
    assert wrong == ()
    assert found["SAFE-1"] == Parent(*STOP, "needs.json")
    assert "HAZ-7" in found
