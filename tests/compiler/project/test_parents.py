"""Parents that live in StrictDoc, Doorstop, sphinx-needs or ReqIF."""

import json
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest

from compiler.files.settings import Settings, settings
from compiler.project.parents import Parent, parents
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render
from tests.command import Fretc, write
from tests.programs import installed, needs

SDOC = """\
[DOCUMENT]
TITLE: Hazards

[[SECTION]]
UID: SEC-1
TITLE: Motion

[REQUIREMENT]
UID: SAFE-1
STATUS: Active
TITLE: Stop in time
STATEMENT: >>>
The robot stops.

[REQUIREMENT]
UID: NOT-A-NODE
<<<

[REQUIREMENT]
STATEMENT: Nobody can point at this one.

[[/SECTION]]

[TEXT]
STATEMENT: >>>
UID: NO
<<<
"""
"""What `strictdoc export --formats=json` reads."""
STATEMENT = "The robot stops.\n\n[REQUIREMENT]\nUID: NOT-A-NODE"


def strictdoc(*more: Mapping[str, object], statement: str = STATEMENT) -> str:
    """What StrictDoc 0.30.4 writes for it, but for the grammar."""
    safe = {
        "_TOC": "1.1",
        "_NODE_TYPE": "REQUIREMENT",
        "UID": "SAFE-1",
        "STATUS": "Active",
        "TITLE": "Stop in time",
        "STATEMENT": f"{statement}\n",
    }
    nameless = {"_NODE_TYPE": "REQUIREMENT", "STATEMENT": "Nobody can point at this one."}
    section = {
        "_TOC": "1",
        "_NODE_TYPE": "SECTION",
        "UID": "SEC-1",
        "TITLE": "Motion",
        "NODES": [safe, nameless, *more],
    }
    text = {"_TOC": "2", "_NODE_TYPE": "TEXT", "STATEMENT": "UID: NO\n"}
    document = {
        "_NODE_TYPE": "DOCUMENT",
        "UID": "DOC",
        "TITLE": "Hazards",
        "GRAMMAR": {"ELEMENTS": []},
        "NODES": [section, text],
    }
    return json.dumps({"_COMMENT": "", "DOCUMENTS": [document]})


DOORSTOP = """\
SAFE-1:
  active: true
  derived: false
  header: |
    Stop in time
  level: 1.0
  links: []
  normative: true
  ref: ''
  reviewed: null
  text: |
    The robot stops.

"""
"""What `doorstop export --yaml` of Doorstop 3.2 writes, of YAML and of Markdown items alike."""
NEEDS = {
    "current_version": "1.0",
    "versions": {
        "0.9": {"needs": {"OLD": {"title": "old"}}},
        "1.0": {"needs": {"SAFE-1": {"title": "Stop in time", "content": "The robot stops."}}},
    },
}
REQIF = (Path(__file__).parents[2] / "data/parents.reqif").read_text("utf-8")
STOP = ("SAFE-1", "Stop in time", "The robot stops.")


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def read(path: str) -> list[tuple[str, str, str]]:
    found, wrong = parents(Settings(Path.cwd(), (path,)))
    assert wrong == ()
    assert {parent.source for parent in found.values()} <= {path}
    return [(parent.id, parent.title, parent.text) for parent in found.values()]


def test_strictdoc_gives_every_node_with_a_uid_and_its_whole_statement() -> None:
    hazard = {"_NODE_TYPE": "HAZARD", "UID": "HAZ-7", "HARM": "a drum", "CAUSE": "speed"}
    assert read(write("out/index.json", strictdoc(hazard))) == [
        ("SEC-1", "Motion", ""),
        ("SAFE-1", "Stop in time", STATEMENT),
        ("HAZ-7", "", "a drum\nspeed"),
    ]


@needs("strictdoc")
def test_strictdoc_itself_writes_what_is_read() -> None:
    write("docs/hazards.sdoc", SDOC)
    subprocess.run(
        [installed("strictdoc"), "export", "--formats=json", "--output-dir", "out", "docs"],
        check=True,
        capture_output=True,
    )
    assert read("out/json/index.json") == [
        ("SEC-1", "Motion", ""),
        ("SAFE-1", "Stop in time", STATEMENT),
    ]


def test_doorstop_gives_every_item_of_a_document_or_of_a_folder() -> None:
    write("out/SAFE.yml", DOORSTOP)
    write("out/SUB.yml", "SUB001:\n  active: true\n  level: 1.0\n  text: below\n")
    assert read("out/SAFE.yml") == [STOP]
    assert read("out") == [STOP, ("SUB001", "", "below")]


@needs("doorstop", "git")
def test_doorstop_itself_writes_what_is_read_of_yaml_and_of_markdown() -> None:
    def run(*arguments: str) -> None:
        subprocess.run([*arguments], check=True, capture_output=True)

    run("git", "init", "-q", ".")
    run("doorstop", "create", "-s", "-", "SAFE", "reqs")
    run("doorstop", "create", "-s", "-", "-p", "SAFE", "-i", "markdown", "MD", "md")
    run("doorstop", "add", "SAFE")
    run("doorstop", "add", "MD")
    (item,) = Path("reqs").glob("SAFE*.yml")
    item.write_text("active: true\nlevel: 1.0\nheader: Stop in time\ntext: The robot stops.\n")
    (other,) = Path("md").glob("MD*.md")
    other.write_text("---\nactive: true\nlevel: 1.0\n---\n\n# Below\n\nIt is seen.\n")
    run("doorstop", "export", "--yaml", "all", "out")
    assert read("out") == [("MD-001", "Below", "It is seen."), ("SAFE-001", *STOP[1:])]


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
        ("a.sdoc", "[DOCUMENT]\nTITLE: x\n", "only StrictDoc itself can read its documents"),
        ("a.json", "{", "it is not JSON"),
        ("a.json", "[]", "it has neither `DOCUMENTS` (StrictDoc) nor `versions` (sphinx-needs)"),
        ("a.json", '{"DOCUMENTS": [3]}', "its nodes are not as StrictDoc writes them"),
        ("a.json", '{"versions": {}}', "its `current_version` is not among its `versions`"),
        ("a.json", '{"versions": {"1": {"needs": {"A": 3}}}, "current_version": "1"}', "`A` is no"),
        ("a.yml", "a: [", "a.yml cannot be read as YAML"),
        (
            "a.yml",
            "active: true\nlevel: 1.0\ntext: an item\n",
            "a.yml is not an export of Doorstop",
        ),
        ("a.yml", "A: {level: 1, text: !!python/name:os.system }", "a.yml cannot be read as YAML"),
        ("a.yml", "A: {level: 1, text: [x]}", "a.yml is not an export of Doorstop"),
        ("a.reqif", "<REQ-IF>", "the library `reqif` cannot read it: Premature end of data"),
        ("a.reqif", "<html/>", "the library `reqif` cannot read it: Expected root tag"),
        ("a.reqif", '<!DOCTYPE x [<!ENTITY a "b">]><x>&a;</x>', "it declares a document type"),
        ("a.reqifz", "x", "it is not an archive of ReqIF files"),
        ("a.txt", "x", "its extension belongs to no supported format"),
        ("reqs/x", "x", "its extension belongs to no supported format"),
        ("gone.json", None, "No such file or directory"),
    ],
)
def test_a_document_that_cannot_be_read_is_told(path: str, text: str | None, why: str) -> None:
    if text is not None:
        write(path, text)
    found, (diagnostic,) = parents(Settings(Path.cwd(), (path,)))
    assert found == {}
    assert diagnostic.code is Code.BAD_PARENTS
    assert diagnostic.message.startswith(f"the parents in `{path}` cannot be read: {why}")


def test_a_folder_without_items_is_told() -> None:
    write("reqs/a.md", "x")
    _, (diagnostic,) = parents(Settings(Path.cwd(), ("reqs",)))
    assert "it has no export of Doorstop (`*.yml`)" in diagnostic.message


def test_a_folder_of_items_is_to_be_exported() -> None:
    write("reqs/.doorstop.yml", "settings: {}\n")
    write("reqs/SAFE001.yml", "active: true\nlevel: 1.0\ntext: The robot stops.\n")
    _, (diagnostic,) = parents(Settings(Path.cwd(), ("reqs",)))
    assert (
        "it holds the items; `doorstop export --yaml all FOLDER` writes them" in diagnostic.message
    )


def test_a_document_beyond_all_measure_is_not_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compiler.project.parents._MOST", 1024**2)
    with zipfile.ZipFile("bomb.reqifz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.reqif", " " * 1024**2 + REQIF)
    for path in ("bomb.reqifz", write("a.yml", "# " * 1024**2)):
        found, (diagnostic,) = parents(Settings(Path.cwd(), (path,)))
        assert (found, "it is larger than 1 MiB" in diagnostic.message) == ({}, True)


def test_reqif_without_its_library_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "reqif.parser", None)
    found, (diagnostic,) = parents(Settings(Path.cwd(), (write("a.reqif", REQIF),)))
    assert (found, diagnostic.code) == ({}, Code.MISSING_EXTRA)
    assert diagnostic.help is not None
    assert "pip install 'fretc[reqif]'" in diagnostic.help


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
    ("text", "message"),
    [
        ('[tool.fretc]\nparent = ["a"]\n', "F520 unknown field `parent` in [tool.fretc]"),
        ('[tool.fretc]\nparents = "a"\n', "F520 `parents` must be a list of paths"),
        ("[tool]\nfretc = 1\n# tool.fretc\n", "F520 `fretc` must be a table"),
        ("[tool.fretc\n", "F520 pyproject.toml is not TOML"),
    ],
)
def test_settings_with_a_mistake_are_told(text: str, message: str) -> None:
    write("pyproject.toml", text)
    found = settings(".")
    assert isinstance(found, Diagnostic)
    assert render(found).startswith(message)


def test_settings_above_the_repository_are_anybodys() -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["/etc/passwd"]\n')
    write("a/.git/HEAD", "")
    write("a/requirements/r1.fret", "x")
    assert settings("a/requirements") == Settings(Path.cwd() / "a/requirements")


def test_a_worktree_is_a_repository_too() -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["a"]\n')
    write("a/.git", "gitdir: elsewhere")
    write("a/requirements/r1.fret", "x")
    assert settings("a/requirements") == Settings(Path.cwd() / "a/requirements")


def test_outside_of_a_repository_settings_above_the_present_folder_do_not_hold(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["a"]\n')
    write("a/requirements/r1.fret", "x")
    monkeypatch.chdir("a")
    assert settings("requirements") == Settings(Path.cwd() / "requirements")
    monkeypatch.chdir("requirements")
    assert settings("../../a") == Settings(Path.cwd().parent)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["../outside.json", "link.json", "way", "{}/outside.json"])
@pytest.mark.parametrize("option", ["--parents {}", "--parents={}", ""])
def test_parents_leave_the_project_only_where_the_command_line_says_so(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, name: str, option: str
) -> None:
    outside = Path.cwd()
    write("outside.json", strictdoc())
    write("exports/req.yml", "SAFE-1: {text: The robot stops., active: true, level: 1.0}\n")
    path = name.format(outside)
    write("a/pyproject.toml", f'[tool.fretc]\nparents = ["{path}"]\n')
    write("a/.git/HEAD", "")
    header = '+++\nid = "R1"\nparents = ["SAFE-1"]\n+++\n'
    write("a/requirements/r1.fret", f"{header}the robot shall always satisfy stopped")
    monkeypatch.chdir("a")
    Path("link.json").symlink_to("../outside.json")
    Path("way").mkdir()
    Path("way/req.yml").symlink_to("../../exports/req.yml")
    run = fretc(*option.format(outside).split(), "check")
    refused = f"F521 the parents in `{path}` cannot be read: it lies outside of the project"
    assert (refused in run.err + run.out) is (option == "")


# The whole way ---------------------------------------------------------------------------------


def test_ids_are_checked_against_the_documents(fretc: Fretc) -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["docs/hazards.json"]\n')
    write("docs/hazards.json", strictdoc())
    good = '+++\nid = "R1"\nparents = ["SAFE-1"]\n+++\nthe sw shall always satisfy p\n'
    write("requirements/r1.fret", good)
    run = fretc("report", "--json", "out.json")
    assert (run.status, "F501" in run.err) == (0, False)
    (view,) = json.loads(Path("out.json").read_text())["requirements"]
    title = "Stop in time (docs/hazards.json)"
    assert view["parents"] == [{"id": "SAFE-1", "title": title, "anchor": ""}]
    write("requirements/r1.fret", good.replace("SAFE-1", "SAFFE-1"))
    run = fretc("report")
    assert "F501 warning: R1 names the parent `SAFFE-1`, which is not declared" in run.err
    assert "help: did you mean `SAFE-1`?" in run.err


def test_a_changed_parent_makes_what_is_below_it_suspect(fretc: Fretc) -> None:
    write("pyproject.toml", '[tool.fretc]\nparents = ["docs/hazards.json"]\n')
    write("docs/hazards.json", strictdoc())
    write(
        "requirements/r1.fret",
        '+++\nid = "R1"\nparents = ["SAFE-1"]\n+++\nthe sw shall always satisfy p\n',
    )
    by = ("--reviewer", "A", "--role", "B", "--comment", "c", "--date", "2026-01-01")
    assert fretc("lock", *by).status == 0
    write(
        "docs/hazards.json", strictdoc(statement=STATEMENT.replace("robot stops", "robot\n stops"))
    )
    assert fretc("diff").status == 0, "white space is no change"
    write("docs/hazards.json", strictdoc(statement=STATEMENT.replace("NOT-A", "STILL-NOT-A")))
    run = fretc("diff")
    assert run.status == 3
    assert "text of SAFE-1: " in run.out
    assert "links are suspect: text of SAFE-1 changed\n" in run.out


def test_the_first_document_that_has_an_id_counts() -> None:
    write("a.json", strictdoc())
    write("needs.json", json.dumps(NEEDS))
    found, wrong = parents(Settings(Path.cwd(), ("needs.json", "a.json")))
    assert wrong == ()
    assert found["SAFE-1"] == Parent(*STOP, "needs.json")
    assert "SEC-1" in found
