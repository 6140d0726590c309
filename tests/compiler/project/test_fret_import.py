"""FRET's exports, and CSV, become `.fret` files and bindings that fretc reads."""

import json
import time
from pathlib import Path
from typing import Any

import pytest

from compiler.project.folder import load
from compiler.project.project import Project
from fretish import documents
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from tests.command import Fretc, Run, write


def export(content: Any) -> str:
    return write("export.json", json.dumps(content))


def record(reqid: str = "R1", fulltext: str = "the sw shall always satisfy p", **more: Any) -> Any:
    return {"reqid": reqid, "fulltext": fulltext, **more}


def written(folder: str = "requirements") -> dict[str, str]:
    return {path.name: path.read_bytes().decode() for path in sorted(Path(folder).iterdir())}


def project(folder: str = "requirements") -> Project:
    """What fretc reads of the folder that was written; it finds no error in it."""
    found = load([str(path) for path in sorted(Path(folder).glob("*.fret"))])
    assert [d for d in found.diagnostics if d.is_error] == []
    return found


def requirements(folder: str = "requirements") -> list[RequirementEntry]:
    return list(project(folder).requirements)


def imported(fretc: Fretc, content: Any) -> list[RequirementEntry]:
    run = fretc("import", export(content))
    assert run.status == 0, run.err
    return requirements()


# JSON -----------------------------------------------------------------------------------------

ROVER = {
    "reqid": "R-1",
    "parent_reqid": "HAZ-1, SYS-2",
    "project": "Rover",
    "rationale": "Obstacles are hard.\nReally.",
    "comments": "to be reviewed",
    "fulltext": "Whenever too_close the rover shall within 3 ticks satisfy stopped.",
    "status": "completed",
    "semantics": {"type": "nasa", "ft": "(G stale)", "condition": "regular"},
    "input": {},
    "_id": "1f-2e",
}
FREE = {
    "reqid": "R-2",
    "project": "Rover",
    "fulltext": '"It should look nice."',
    "status": "paused",
    "semantics": {"type": "freeForm"},
}
STOPPED = {
    "_id": "Roverroverstopped",
    "project": "Rover",
    "component_name": "rover",
    "variable_name": "stopped",
    "reqs": ["1f-2e"],
    "dataType": "boolean",
    "idType": "Output",
    "moduleName": "",
    "description": "the wheels stand",
    "assignment": "speed = 0.0",
    "modeRequirement": "",
    "modeldoc": False,
    "modeldoc_id": "",
    "completed": True,
}
SPEED = {
    "project": "Rover",
    "component_name": "rover",
    "variable_name": "speed",
    "dataType": "double",
    "idType": "Internal",
    "modeldoc": False,
}


def test_an_array_of_requirements_becomes_one_file_for_its_project(fretc: Fretc) -> None:
    assert fretc("import", export([ROVER, FREE])) == Run(
        0, "", "wrote requirements/rover.fret\nimported 2 requirements, 0 variables\n"
    )
    assert written() == {
        "rover.fret": "+++\n"
        'id = "R-1"\n'
        "parents = [\n"
        '    "HAZ-1",\n'
        '    "SYS-2",\n'
        "]\n"
        'rationale = "Obstacles are hard.\\nReally."\n'
        'status = "approved"\n'
        "\n"
        "[fret]\n"
        'project = "Rover"\n'
        'comments = "to be reviewed"\n'
        'status = "completed"\n'
        '_id = "1f-2e"\n'
        "+++\n"
        "Whenever too_close the rover shall within 3 ticks satisfy stopped.\n"
        "\n"
        "+++\n"
        'id = "R-2"\n'
        'status = "draft"\n'
        "\n"
        "[fret]\n"
        'project = "Rover"\n'
        'status = "paused"\n'
        "+++\n"
        '"It should look nice."\n'
    }


def test_an_object_has_variables_too(fretc: Fretc) -> None:
    run = fretc("import", export({"requirements": [ROVER], "variables": [STOPPED, SPEED]}))
    assert run.err.endswith("imported 1 requirements, 2 variables\n")
    assert written()["bindings.toml"] == (
        "# The variables of the requirements, as FRET's glossary has them. To audit logs,\n"
        "# declare a [clock], and bind each variable by a [proposition.NAME] over signals.\n"
        "\n"
        "[variable.stopped]\n"
        'component = "rover"\n'
        'type = "boolean"\n'
        'role = "output"\n'
        'text = "the wheels stand"\n'
        "\n"
        "[variable.stopped.fret]\n"
        'assignment = "speed = 0.0"\n'
        "completed = true\n"
        'project = "Rover"\n'
        "\n"
        "[variable.speed]\n"
        'component = "rover"\n'
        'type = "double"\n'
        'role = "internal"\n'
        "\n"
        "[variable.speed.fret]\n"
        'project = "Rover"\n'
    )


def test_what_was_written_is_read_without_an_error(fretc: Fretc) -> None:
    fretc("import", export({"requirements": [ROVER, FREE], "variables": [STOPPED, SPEED]}))
    found = project()
    assert [requirement.id for requirement in found.formalized] == ["R-1"]
    assert [failed.diagnostic.code for failed in found.failed] == [Code.FREE_TEXT]
    assert found.declarations is not None
    stopped = found.declarations.variables["stopped"]
    assert (stopped.component, stopped.type, stopped.role) == ("rover", "boolean", "output")
    assert fretc("requirements/rover.fret").status == 0


def test_formulas_are_made_anew(fretc: Fretc) -> None:
    fretc("import", export([ROVER]))
    assert "stale" not in "".join(written().values())


def test_an_old_export_sorts_its_variables_by_kind(fretc: Fretc) -> None:
    old = {
        "requirements": [record(semantics={"condition": "noTrigger", "ft": "<b>G</b> p"})],
        "variables": {
            "regular": [{"variable_name": "p", "dataType": "boolean", "component_name": "sw"}],
            "modes": [{"variable_name": "m", "idType": "Mode", "component_name": "sw"}],
        },
    }
    assert fretc("import", export(old)).err.endswith("imported 1 requirements, 2 variables\n")
    declarations = project().declarations
    assert declarations is not None
    assert [(v.name, v.type, v.role) for v in declarations.variables.values()] == [
        ("p", "boolean", ""),
        ("m", "", "mode"),
    ]


def test_an_array_of_something_else_than_requirements_is_variables(fretc: Fretc) -> None:
    run = fretc("import", export([STOPPED, SPEED]))
    assert run.err == "wrote requirements/bindings.toml\nimported 0 requirements, 2 variables\n"


def test_the_export_of_the_editor_alone_is_read(fretc: Fretc) -> None:
    (found,) = imported(fretc, {"requirement": record("R7")})
    assert found.id == "R7"


def test_a_glossary_alone_is_read(fretc: Fretc) -> None:
    run = fretc("import", export({"variables": {"docs": [STOPPED]}}))
    assert run.err == "wrote requirements/bindings.toml\nimported 0 requirements, 1 variables\n"


def test_imported_signals_of_models_are_no_variables_and_are_kept(fretc: Fretc) -> None:
    signal = {**SPEED, "modeldoc": True, "portType": "Inport"}
    run = fretc("import", export([signal]))
    assert run.err == "wrote requirements/bindings.toml\nimported 0 requirements, 0 variables\n"
    assert written()["bindings.toml"].endswith(
        "[[fret.variable]]\n"
        'project = "Rover"\n'
        'component_name = "rover"\n'
        'variable_name = "speed"\n'
        'dataType = "double"\n'
        'idType = "Internal"\n'
        "modeldoc = true\n"
        'portType = "Inport"\n'
    )


def test_null_and_lists_stand_where_there_is_no_text(fretc: Fretc) -> None:
    empty: dict[str, Any] = {
        "parent_reqid": None,
        "project": [],
        "rationale": None,
        "comments": [],
        "status": None,
    }
    (found,) = imported(fretc, {"requirements": [record(**empty)], "variables": None})
    assert found == RequirementEntry("R1", found.wording)


def test_null_in_variables_is_nothing(fretc: Fretc) -> None:
    variable: dict[str, Any] = {
        "variable_name": "p",
        "dataType": None,
        "idType": [],
        "assignment": None,
    }
    fretc("import", export({"requirements": [record()], "variables": [variable, None, 3]}))
    assert written()["bindings.toml"].endswith("[variable.p]\n")
    assert project().declarations is not None


def test_a_requirement_without_text_is_left_out_and_told(fretc: Fretc) -> None:
    run = fretc("import", export([record("R1"), record("R2", ""), record("", "  ")]))
    assert run == Run(
        0,
        "",
        "F505 warning: requirement 2 (R2) has no text: it is left out\n"
        "  --> export.json\n"
        "\n"
        "F505 warning: requirement 3 (no id) has no text: it is left out\n"
        "  --> export.json\n"
        "wrote requirements/requirements.fret\n"
        "imported 1 requirements, 0 variables\n",
    )


def test_a_text_that_is_no_fretish_is_taken_over_and_told(fretc: Fretc) -> None:
    run = fretc("import", export([record("R1", "the sw must satisfy p")]))
    assert run == Run(
        0,
        "",
        "F107 warning: a requirement uses `shall`, not `must`\n"
        "  --> R1 (fulltext):1:8\n"
        "   | the sw must satisfy p\n"
        "   |        ^^^^\n"
        "help: write `shall`\n"
        "wrote requirements/requirements.fret\n"
        "imported 1 requirements, 0 variables\n",
    )
    assert written()["requirements.fret"].endswith("+++\nthe sw must satisfy p\n")


def test_a_key_word_as_a_name_gets_quotes(fretc: Fretc) -> None:
    """The name stays the same, so that variables and formulas do."""
    text = "the sw shall always satisfy next => !last & next"
    run = fretc("import", export([record("R1", text)]))
    assert run.status == 0
    assert run.err.count("F109 warning: `next` is a key word of FRETish: it is imported as") == 2
    written_ = written()["requirements.fret"]
    assert written_.endswith('+++\nthe sw shall always satisfy "next" => !"last" & "next"\n')
    assert f'fulltext = "{text}"' in written_
    assert fretc("requirements", "--emit", "ltl", "-o", "-").status == 0


def test_an_id_that_contains_assumption_makes_an_assumption(fretc: Fretc) -> None:
    """FRET's convention: it has no field for it, and ignores case."""
    names = ("WIND_assumption", "Assumption-2", "ASSUME-3")
    run = fretc("import", export([record(id, "the sw shall always satisfy p") for id in names]))
    assert run.err.endswith("imported 3 requirements (2 of them assumptions), 0 variables\n")
    made, _ = documents.requirements(Source("r.fret", written()["requirements.fret"]))
    assert [each.id for each in made if each.is_assumption] == ["WIND_assumption", "Assumption-2"]


# Ids and projects -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("reqid", "id"),
    [
        ("R1", "R1"),
        ("R 1/a", "R-1-a"),
        ("  R1  ", "R1"),
        ("_R1", "R1"),
        ("ä/ö", "requirement"),
        ("R.1_a-b", "R.1_a-b"),
        ("../../etc/passwd", "etc-passwd"),
        ("", "requirement-1"),
        (17, "17"),
    ],
)
def test_an_id_becomes_one_that_fretc_takes(fretc: Fretc, reqid: Any, id: str) -> None:
    (found,) = imported(fretc, [record(reqid)])
    assert found.id == id
    assert found.fret.get("reqid", id) == (str(reqid) or id)


def test_ids_that_fret_tells_apart_stay_apart(fretc: Fretc) -> None:
    found = imported(
        fretc,
        [
            record("R1", project="A"),
            record("R1", project="B"),
            record("r1", project="A"),
            record("R 1", project="A"),
            record("R/1", project="A"),
            record("R1", project="B"),
        ],
    )
    by_project = [(r.fret["project"], r.id, r.fret.get("reqid")) for r in found]
    assert by_project == [
        ("A", "R1", None),
        ("A", "A-r1", "r1"),
        ("A", "R-1", "R 1"),
        ("A", "A-R-1", "R/1"),
        ("B", "B-R1", "R1"),
        ("B", "R1-2", "R1"),
    ]


@pytest.mark.parametrize(
    ("parent", "project", "id"), [("SYS 1", "A", "SYS-1"), ("R1", "B", "B-R1"), ("R1", "A", "R1")]
)
def test_a_child_names_its_parent_by_the_id_that_it_has_now(
    fretc: Fretc, parent: str, project: str, id: str
) -> None:
    """FRET's ids are those of one project."""
    child = record("CHILD", project=project, parent_reqid=parent)
    parents = [("SYS 1", "A"), ("R1", "A"), ("R1", "B")]
    records = [*(record(reqid, project=name) for reqid, name in parents), child]
    found = {requirement.id: requirement for requirement in imported(fretc, records)}
    assert found["CHILD"].parents == (id,)
    assert id in found


def test_each_project_has_its_file(fretc: Fretc) -> None:
    imported(fretc, [record("R1", project="Rover"), record("R2", project="Arm"), record("R3")])
    assert list(written()) == ["arm.fret", "requirements.fret", "rover.fret"]


@pytest.mark.parametrize(
    "projects",
    [
        ("A B", "A-B"),
        ("Rover", "rover"),
        ("", "requirements"),
        ("\u65e5", "\u672c"),
        ("a/b", "a b"),
    ],
)
def test_no_project_takes_the_file_of_another(fretc: Fretc, projects: tuple[str, str]) -> None:
    found = imported(fretc, [record(f"R{i}", project=p) for i, p in enumerate(projects)])
    assert sorted(r.id for r in found) == ["R0", "R1"]


def test_a_new_id_is_told(fretc: Fretc) -> None:
    records = [record("R2", project="A"), record("R2", project="A"), record("r2", project="B")]
    run = fretc("import", export(records))
    lines = [line for line in run.err.splitlines() if line.startswith("F531")]
    why = "is taken, and ids are compared without case"
    assert lines == [
        f"F531 warning: requirement 2 (R2 of project A) is imported as `A-R2`: `R2` {why}",
        f"F531 warning: requirement 3 (r2 of project B) is imported as `B-r2`: `r2` {why}",
    ]
    assert "F531" not in fretc("import", export([record("R1"), record("R2")]), "-o", "other").err


def test_a_variable_that_says_the_same_twice_is_one(fretc: Fretc) -> None:
    run = fretc("import", export({"requirements": [], "variables": [STOPPED, dict(STOPPED)]}))
    assert written()["bindings.toml"].count("[variable.stopped]") == 1
    assert "F530" not in run.err


@pytest.mark.parametrize(
    ("change", "lost"),
    [
        ({"project": "Arm"}, "project `Arm`"),
        ({"description": "of the arm"}, "text `of the arm`"),
        ({"dataType": "integer"}, "type `integer`"),
        ({"idType": "Input"}, "role `input`"),
        ({"assignment": "speed < 1"}, "assignment `speed < 1`"),
        ({"assignment": ""}, "assignment ``"),
        ({"modeRequirement": "m"}, "modeRequirement `m`"),
    ],
)
def test_a_variable_that_says_something_else_is_told(
    fretc: Fretc, change: dict[str, str], lost: str
) -> None:
    run = fretc(
        "import", export({"requirements": [], "variables": [STOPPED, {**STOPPED, **change}]})
    )
    assert run.status == 0
    warning = (
        f"F530 warning: a second variable `stopped` is kept for FRET, but not read: it has {lost}\n"
    )
    assert warning in run.err
    assert 'component = "rover"' in written()["bindings.toml"]


def test_a_name_of_two_components_is_two_variables(fretc: Fretc) -> None:
    """FRET keeps a variable for each component: no role, type or assignment is lost."""
    other = {**SPEED, "component_name": "arm", "idType": "Input", "dataType": "integer"}
    fast = {**SPEED, "variable_name": "fast", "assignment": "3.0"}
    faster = {**fast, "component_name": "arm", "assignment": "speed"}
    sentences = [
        record(f"R-{name}", f"the {name} shall always satisfy speed < fast")
        for name in ("rover", "arm", "hand")
    ]
    content = {"requirements": sentences, "variables": [SPEED, fast, other, faster]}
    run = fretc("import", export(content))
    assert "F530" not in run.err
    assert run.err.endswith("imported 3 requirements, 2 variables\n")
    rover, arm, hand = project().formalized
    assert [requirement.glossary["speed"].role for requirement in (rover, arm, hand)] == [
        "internal",
        "input",
        "internal",
    ]
    assert [requirement.glossary["speed"].type for requirement in (rover, arm)] == [
        "double",
        "integer",
    ]
    values = [str(requirement.ft_infinite) for requirement in (rover, arm, hand)]
    assert "3.0" in values[0]
    assert "3.0" in values[2]
    assert "3.0" not in values[1]


# What cannot be read --------------------------------------------------------------------------


def test_broken_json_is_told_with_its_place(fretc: Fretc) -> None:
    path = write("export.json", '[\n  {"reqid": "R1",\n   "fulltext" "the sw shall satisfy p"}\n]')
    assert fretc("import", path) == Run(
        2,
        "",
        "F505 `export.json` cannot be imported: it is not JSON: expecting ':' delimiter\n"
        "  --> export.json:3:15\n"
        '   |    "fulltext" "the sw shall satisfy p"}\n'
        "   |               ^\n"
        "help: use an export of FRET (JSON), or a CSV file\n",
    )
    assert not Path("requirements").exists()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "it is not JSON: expecting value"),
        ("the sw shall satisfy p", "it is not JSON: expecting value"),
        ("3", "it is neither an array nor an object"),
        ('"R1"', "it is neither an array nor an object"),
        ("null", "it is neither an array nor an object"),
        ("{}", "it has neither `requirements` nor `variables`"),
        ('{"reqid": "R1"}', "it has neither `requirements` nor `variables`"),
        ("[1, 2]", "it is an array with items that are not objects"),
        ('[{"reqid": "R1", "fulltext": "p"}, 2]', "it is an array with items that are not objects"),
        ("[" * 100_000, "it is nested too deep"),
    ],
)
def test_what_is_no_export_is_refused(fretc: Fretc, text: str, why: str) -> None:
    run = fretc("import", write("export.json", text))
    assert run.status == 2
    assert run.err.startswith(f"F505 `export.json` cannot be imported: {why}\n")
    assert not Path("requirements").exists()


def test_a_number_without_end_is_refused(fretc: Fretc) -> None:
    run = fretc("import", write("export.json", f'[{{"reqid": {"1" * 5000}, "fulltext": "p"}}]'))
    assert run.status == 2
    assert run.err.startswith("F505 `export.json` cannot be imported: ")


def test_a_file_in_another_encoding_is_refused(fretc: Fretc) -> None:
    Path("export.json").write_bytes("[]".encode("utf-16"))
    assert fretc("import", "export.json").err.startswith("F904 `export.json` is not UTF-8 text")


def test_a_byte_order_mark_changes_nothing(fretc: Fretc) -> None:
    assert fretc("import", write("export.json", f"\ufeff{json.dumps([record()])}")).status == 0


# Writing --------------------------------------------------------------------------------------


def test_files_that_are_there_are_not_overwritten(fretc: Fretc) -> None:
    path = export({"requirements": [record()], "variables": [STOPPED]})
    Path("requirements").mkdir()
    write("requirements/bindings.toml", "mine")
    assert fretc("import", path) == Run(
        2,
        "",
        "F905 `requirements/bindings.toml` already exists\n"
        "help: name another folder with `-o`, or overwrite it with `--force`\n",
    )
    assert written() == {"bindings.toml": "mine"}


def test_force_writes_over_them(fretc: Fretc) -> None:
    path = export([record()])
    Path("requirements").mkdir()
    write("requirements/requirements.fret", "mine")
    assert fretc("import", path, "--force").status == 0
    assert "the sw shall always satisfy p" in written()["requirements.fret"]


def test_another_folder_may_be_named(fretc: Fretc) -> None:
    assert fretc("import", export([record()]), "-o", "other/folder").status == 0
    assert list(written("other/folder")) == ["requirements.fret"]


def test_minus_prints_and_writes_nothing(fretc: Fretc) -> None:
    run = fretc("import", export([record()]), "-o", "-")
    assert run.out == '+++\nid = "R1"\nstatus = "draft"\n+++\nthe sw shall always satisfy p\n'
    assert not Path("requirements").exists()


# CSV ------------------------------------------------------------------------------------------


def test_a_csv_with_columns_that_speak_for_themselves(fretc: Fretc) -> None:
    path = write(
        "list.csv",
        "Priority,ID,Text,Project\n"
        "high,R1,the sw shall always satisfy p,Demo\n"
        'low,R2,"It should ""look"" nice,\nand more.",Demo\n',
    )
    assert fretc("import", path).err.endswith("imported 2 requirements, 0 variables\n")
    first, second = requirements()
    assert (first.id, first.rationale, first.fret["project"]) == ("R1", "Priority: high", "Demo")
    assert first.wording.text == "the sw shall always satisfy p"
    assert second.is_free_text
    assert second.wording.text == "\"It should 'look' nice,\nand more.\""


def test_columns_may_be_named(fretc: Fretc) -> None:
    path = write(
        "list.csv",
        "Nr,Satz,Ort,Text\n"
        "7,the sw shall satisfy p,Demo,a remark\n"
        "8,the sw shall satisfy q,Demo,\n",
    )
    run = fretc(
        "import", path, "--id-column", "Nr", "--text-column", "Satz", "--project-column", "Ort"
    )
    assert run.status == 0
    assert list(written()) == ["demo.fret"]
    first, second = requirements()
    assert (first.id, first.wording.text) == ("7", "the sw shall satisfy p")
    assert (first.rationale, second.rationale) == ("Text: a remark", "")


def test_a_column_that_is_not_there_is_told_with_its_neighbour(fretc: Fretc) -> None:
    path = write("list.csv", "id,sentence\nR1,the sw shall satisfy p\n")
    assert fretc("import", path, "--text-column", "sentense") == Run(
        2,
        "",
        "F505 `list.csv` cannot be imported: there is no column `sentense`\n"
        "  --> list.csv:1:1\n"
        "   | id,sentence\n"
        "   | ^\n"
        "help: did you mean `sentence`?\n",
    )


def test_a_csv_without_a_text_column_is_refused(fretc: Fretc) -> None:
    path = write("list.csv", "a,b\n1,2\n")
    assert fretc("import", path) == Run(
        2,
        "",
        "F505 `list.csv` cannot be imported: no column looks like the text of a requirement\n"
        "  --> list.csv:1:1\n"
        "   | a,b\n"
        "   | ^\n"
        "help: name it with `--text-column`; there are a, b\n",
    )


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "it is empty"),
        ("id,text\n", "it has a header, but no rows"),
        ('id,text\nR1,"open\n', "it is not CSV: unexpected end of data"),
    ],
)
def test_what_is_no_csv_is_refused(fretc: Fretc, text: str, why: str) -> None:
    run = fretc("import", write("list.csv", text))
    assert run.status == 2
    assert run.err.startswith(f"F505 `list.csv` cannot be imported: {why}\n")


@pytest.mark.parametrize("parted", [",", ";", "\t"])
def test_commas_semicolons_and_tabs_part_columns(fretc: Fretc, parted: str) -> None:
    sentence = "the sw shall, in all modes; here, satisfy p"
    rows = [("ID", "Text", "Note, short"), ("R1", sentence, "a;b")]
    text = "".join(parted.join(f'"{cell}"' for cell in row) + "\r\n" for row in rows)
    run = fretc("import", write("list.csv", text))
    assert run.status == 0
    (found,) = requirements()
    assert (found.id, found.rationale) == ("R1", "Note, short: a;b")
    assert found.wording.text == f'"{sentence}"'


def test_the_header_says_what_parts_columns_not_the_texts(fretc: Fretc) -> None:
    text = "id;text\nR1;the sw shall, here, there, everywhere, satisfy p\n"
    assert fretc("import", write("list.csv", text)).status == 0
    assert [r.id for r in requirements()] == ["R1"]


def test_rows_of_other_lengths_are_read(fretc: Fretc) -> None:
    path = write("list.csv", "id,text\nR1,the sw shall satisfy p,more,and more\nR2\n")
    run = fretc("import", path)
    assert run.status == 0
    assert "requirement 2 (R2) has no text: it is left out" in run.err
    assert [r.id for r in requirements()] == ["R1"]


@pytest.mark.parametrize("options", [(), ("--text-column", "sentence")])
def test_a_long_first_row_and_no_text_column_is_told(fretc: Fretc, options: tuple[str]) -> None:
    run = fretc("import", write("list.csv", "a,b\n1,2,3\n"), *options)
    assert run.status == 2
    assert run.err.startswith("F505 `list.csv` cannot be imported: ")


def test_a_csv_of_windows_is_read(fretc: Fretc) -> None:
    path = write("list.CSV", "\ufeffid,text\r\nR1,the sw shall satisfy p\r\n")
    assert fretc("import", path).status == 0
    assert requirements()[0].wording.text == "the sw shall satisfy p"


# Hostile texts --------------------------------------------------------------------------------

HOSTILE = [
    'say "hello"',
    "back\\slash \\u0041 \\",
    "\"\"\"three\"\"\" '''quotes'''",
    "+++",
    "before\n+++\nafter",
    '+++\nid = "evil"\n+++\nthe sw shall always satisfy evil',
    "\u0000\u0001\u001b[31m\u007f\u0085\u2028",
    "tab\tand\rreturn",
    "[table]\nkey = 1",
    "# no comment",
    "\u00e4\u65e5\U0001f916",
    "x" * 10_000,
    "</script><!-- {{ 7 * 7 }} {% raw %}",
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_any_text_survives_in_a_header(fretc: Fretc, text: str) -> None:
    project = text[:99]  # it names the file
    fields = {"rationale": text, "comments": text, "project": project, "_id": text}
    (found,) = imported(fretc, [record(**fields)])
    assert (found.rationale, found.fret["comments"], found.fret["_id"]) == (text, text, text)
    assert found.fret["project"] == project
    assert found.wording.text == "the sw shall always satisfy p"


def moved(text: str) -> str:
    """A line `+++` would end the requirement: all that such a line gets is a space before it."""
    return text.replace("\n+++", "\n +++")


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_any_text_survives_as_a_variable(fretc: Fretc, text: str) -> None:
    variable = {"variable_name": text, "description": text, "assignment": text}
    fretc("import", export({"requirements": [record()], "variables": [variable]}))
    declarations = project().declarations
    assert declarations is not None
    assert declarations.variables[text].text == text
    assert declarations.variables[text].fret == {"assignment": text}


@pytest.mark.parametrize(
    "text", [t for t in HOSTILE if '"' not in t], ids=lambda text: repr(text)[:12]
)
def test_any_text_survives_as_free_text(fretc: Fretc, text: str) -> None:
    """And no text becomes a requirement of its own."""
    (found, last) = imported(fretc, [record("R1", f'"{text}"'), record("R2")])
    assert found.is_free_text
    assert found.wording.text == moved(f'"{text}"')
    assert last.wording.text == "the sw shall always satisfy p"


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_no_text_becomes_a_requirement_of_its_own(fretc: Fretc, text: str) -> None:
    assert fretc("import", export([record("R1", text), record("R2")])).status == 0
    found, mistakes = documents.requirements(Source("r.fret", written()["requirements.fret"]))
    assert mistakes == ()
    assert [(r.id, r.wording.text == moved(text.strip())) for r in found] == [
        ("R1", True),
        ("R2", False),
    ]


def test_free_text_keeps_its_paragraphs(fretc: Fretc) -> None:
    (found,) = imported(fretc, [record("R1", '"First.\n\n  - second\n  - third"')])
    assert found.wording.text == '"First.\n\n  - second\n  - third"'


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_any_text_of_a_csv_is_one_requirement(fretc: Fretc, text: str) -> None:
    cell = '"' + text.replace('"', '""') + '"'
    run = fretc("import", write("list.csv", f"id,text,more\nR1,{cell},{cell}\n"))
    assert run.status == 0, run.err
    (found,) = requirements()
    assert found.id == "R1"
    assert found.is_free_text


@pytest.mark.parametrize("place", ["reqid", "project", "rationale", "comments", "fulltext"])
def test_half_of_a_character_is_no_internal_error(fretc: Fretc, place: str) -> None:
    """JSON can hold what UTF-8 cannot."""
    run = fretc("import", export([record(**{**record(), place: '"\ud83e"'})]))
    assert run.status in (0, 2)


@pytest.mark.slow
def test_a_long_sentence_is_read_whole(fretc: Fretc) -> None:
    sentence = f"the sw shall always satisfy {' & '.join(f'p{n}' for n in range(1500))}"
    assert len(sentence) > 10_000
    (found,) = imported(fretc, [record("R1", sentence)])
    assert found.wording.text == sentence


def test_many_spaces_take_no_time(fretc: Fretc) -> None:
    start = time.perf_counter()
    imported(fretc, [record("R1", f"the sw shall always{' ' * 20_000}satisfy p")])
    assert time.perf_counter() - start < 2
