"""`--emit fret-json`: what FRET imports, and what comes back from it."""

import json
import shutil
import uuid
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compiler.project.folder import load
from tests.command import Fretc, write
from tests.effort import FULL


def emitted(fretc: Fretc, *files: str) -> dict[str, Any]:
    run = fretc(*files, "--emit", "fret-json", "-o", "-")
    assert run.status == 0, run.err
    content: dict[str, Any] = json.loads(run.out)
    return content


def only(fretc: Fretc, text: str) -> dict[str, Any]:
    """FRET's record of the one requirement of a text."""
    (record,) = emitted(fretc, write("r.fret", text))["requirements"]
    assert isinstance(record, dict)
    return record


# One requirement ------------------------------------------------------------------------------

WRITTEN = """\
+++
id = "R-1"
title = "Stop"
parents = ["HAZ-1", "SYS-2"]
rationale = "Obstacles are hard."
status = "approved"

[fret]
project = "Rover"
comments = "reviewed"
status = "completed"
_id = "1f-2e"
reqid = "R 1"
+++
in m mode, when p the rover shall within 3 ticks satisfy q & x > 3
"""


def test_a_requirement_is_a_record_of_fret(fretc: Fretc) -> None:
    record = only(fretc, WRITTEN)
    semantics = record.pop("semantics")
    assert semantics.pop("description").startswith("In every stretch of ticks on which `m` is true")
    assert record == {
        "reqid": "R 1",
        "parent_reqid": "HAZ-1, SYS-2",
        "project": "Rover",
        "fretc": {"title": "Stop"},
        "rationale": "Obstacles are hard.",
        "comments": "reviewed",
        "status": "completed",
        "fulltext": "in m mode, when p the rover shall within 3 ticks satisfy q & x > 3",
        "input": {},
        "_id": "1f-2e",
    }
    assert {key: semantics[key] for key in semantics if "TextRange" not in key} == {
        "type": "nasa",
        "scope": {"type": "in"},
        "condition": "regular",
        "probability": "null",
        "timing": "within",
        "response": "satisfaction",
        "variables": ["m", "p", "q", "x"],
        "scope_mode": "m",
        "qualifier_word": "when",
        "pre_condition": "(p)",
        "regular_condition": "(p)",
        "post_condition": "(q & x > 3)",
        "duration": "3",
        "timingText": "within 3 ticks",
        "component_name": "rover",
        "component": "rover",
        "ft": FINITE,
        "ftExpanded": FINITE,
        "ftInfAUExpanded": "G(m & !p & !X !m & X p -> X(F[0,3](q & (x > 3)) | F[0,2] X !m))"
        " & G(!m & X m -> X(p -> F[0,3](q & (x > 3)) | F[0,2] X !m))"
        " & (m -> p -> F[0,3](q & (x > 3)) | F[0,2] X !m)",
        "pt": PAST,
        "ptExpanded": PAST,
    }


FINITE = (
    "LAST V (m & !p & !(LAST | X !m) & X p -> X(F[0,3](q & (x > 3)) | F[0,2](LAST | X !m)))"
    " & LAST V (!LAST & !m & X m -> X(p -> F[0,3](q & (x > 3)) | F[0,2](LAST | X !m)))"
    " & (m -> p -> F[0,3](q & (x > 3)) | F[0,2](LAST | X !m))"
)
PAST = (
    "H(m & O[3,3](m & p & ((m & Z !m) | Y !p) & !(q & (x > 3)))"
    " -> O[0,2]((m & Z !m) | (q & (x > 3))))"
)


@pytest.mark.parametrize(
    ("sentence", "fields"),
    [
        ("the sw shall satisfy q", {"timing": "null", "condition": "null"}),
        ("only after m the sw shall never satisfy q", {"scope": {"type": "onlyAfter"}}),
        ("whenever p the sw shall until s satisfy q", {"stop_condition": "(s)"}),
        ("whenever p the sw shall before s | r satisfy q", {"stop_condition": "(s | r)"}),
        ("whenever p sw shall for 2 hours satisfy q", {"duration": "2", "timing": "for"}),
        ("unless p sw shall always satisfy q", {"qualifier_word": "unless"}),
        (
            "the sw shall with probability >= 0.95 eventually satisfy q",
            {"probability": "bound", "pctlExpanded": "P>=1 [ P>=0.95 [ (F q) ] ]"},
        ),
    ],
)
def test_a_sentence_has_the_keys_of_fret(
    fretc: Fretc, sentence: str, fields: dict[str, Any]
) -> None:
    semantics = only(fretc, sentence)["semantics"]
    assert {key: semantics[key] for key in fields} == fields


@pytest.mark.parametrize(
    "sentence",
    [
        "in m mode, when p the rover shall within 3 ticks satisfy q",
        "in   m   mode,\n  when p\n  the rover\tshall   within 3   ticks satisfy q",
    ],
)
def test_the_ranges_are_about_the_text_as_it_is_written_there(fretc: Fretc, sentence: str) -> None:
    """First and last character of each part, both included."""
    record = only(fretc, f'+++\nid = "R1"\n+++\n{sentence}\n')
    semantics, text = record["semantics"], record["fulltext"]
    parts = {}
    for name in ("scope", "condition", "component", "timing"):
        start, end = semantics[f"{name}TextRange"]
        parts[name] = " ".join(text[start : end + 1].split())
    assert parts == {
        "scope": "in m mode",
        "condition": "when p",
        "component": "rover",
        "timing": "within 3 ticks",
    }


@pytest.mark.parametrize(
    ("ours", "frets"),
    [
        ("within 500 ms", "within 500 milliseconds"),
        ("for  0.5 s", "for  500 milliseconds"),
        ("after 1.5 minutes", "after 90 seconds"),
        ("within 2min", "within 2 minutes"),
        ("within 2.0 ticks", "within 2 ticks"),
        ("within 2   SECS", "within 2   SECS"),
    ],
)
def test_a_duration_has_frets_words(fretc: Fretc, ours: str, frets: str) -> None:
    record = only(fretc, f'when  h the  sw shall {ours} satisfy "T" & s')
    assert record["fulltext"] == f'when  h the  sw shall {frets} satisfy "T" & s'
    start, end = record["semantics"]["timingTextRange"]
    assert record["fulltext"][start : end + 1] == frets


def test_fret_has_no_bounded_since(fretc: Fretc) -> None:
    record = only(fretc, "in m mode whenever occurred(1,3,p) the sw shall immediately satisfy q")
    for name in ("pt", "ptExpanded"):
        assert " S " in record["semantics"][name]
        assert "S[" not in record["semantics"][name]


def test_a_name_keeps_its_spaces(fretc: Fretc) -> None:
    record = only(fretc, 'the sw  shall always satisfy "two  words"')
    assert record["fulltext"] == 'the sw  shall always satisfy "two  words"'


def test_free_text_has_no_meaning(fretc: Fretc) -> None:
    record = only(fretc, '+++\nid = "R1"\n+++\n"It should\nlook nice."\n')
    assert record["fulltext"] == '"It should\nlook nice."'
    assert record["semantics"] == {"type": "freeForm"}


@pytest.mark.parametrize(
    ("ours", "kept", "theirs"),
    [
        ("draft", "", ""),
        ("draft", "paused", "paused"),
        ("draft", "completed", ""),  # it is no longer so
        ("approved", "completed", "completed"),
        ("approved", "paused", "completed"),
        ("approved", "", "completed"),
        ("retired", "", "deprecated"),
        ("retired", "deprecated", "deprecated"),
    ],
)
def test_the_status_is_that_of_the_header(fretc: Fretc, ours: str, kept: str, theirs: str) -> None:
    fret = f'\n[fret]\nstatus = "{kept}"' if kept else ""
    record = only(fretc, f'+++\nstatus = "{ours}"{fret}\n+++\nthe sw shall always satisfy p\n')
    assert record["status"] == theirs


def test_a_requirement_that_fret_has_not_seen_always_has_the_same_id_there(fretc: Fretc) -> None:
    text = '+++\nid = "{}"\n+++\nthe sw shall always satisfy p\n'
    first, again, other = (only(fretc, text.format(id))["_id"] for id in ("R1", "R1", "R2"))
    assert first == again != other
    assert str(uuid.UUID(first)) == first


# Variables ------------------------------------------------------------------------------------

BINDINGS = """\
[variable.p]
component = "rover"
type = "boolean"
role = "output"
text = "the wheels stand"

[variable.p.fret]
assignment = "speed = 0.0"
project = "Rover"

[variable.unused]
component = "arm"
type = "integer"
role = "mode"
"""


def variables(fretc: Fretc, *sentences: str, bindings: str = "") -> dict[str, dict[str, Any]]:
    if bindings:
        write("bindings.toml", bindings)
    pairs = [f'+++\nid = "R{i}"\n+++\n{sentence}\n' for i, sentence in enumerate(sentences)]
    content = emitted(fretc, write("r.fret", "\n".join(pairs)))
    ids = {record["_id"]: record["reqid"] for record in content["requirements"]}
    found = {}
    for record in content["variables"]:
        record["reqs"] = [ids[id] for id in record["reqs"]]
        found[record["variable_name"]] = record
    assert len(found) == len(content["variables"])
    return found


def test_a_variable_is_a_record_of_fret(fretc: Fretc) -> None:
    found = variables(
        fretc,
        "whenever p the rover shall always satisfy q",
        "the rover shall always satisfy p",
        bindings=BINDINGS,
    )
    assert list(found) == ["p", "q", "unused"]
    assert found["p"] == {
        "project": "",
        "component_name": "rover",
        "variable_name": "p",
        "reqs": ["R0", "R1"],
        "dataType": "boolean",
        "idType": "Output",
        "moduleName": "",
        "description": "the wheels stand",
        "assignment": "speed = 0.0",
        "modeRequirement": "",
        "modeldoc": False,
        "completed": False,
        "_id": "roverp",
    }
    assert (found["q"]["reqs"], found["q"]["idType"]) == (["R0"], "")
    unused = found["unused"]
    assert (unused["reqs"], unused["component_name"], unused["dataType"], unused["idType"]) == (
        [],
        "arm",
        "integer",
        "Mode",
    )


def test_the_same_name_of_two_components_is_two_variables(fretc: Fretc) -> None:
    first = write("a.fret", "the arm shall always satisfy p")
    second = write("b.fret", "the leg shall always satisfy p")
    found = emitted(fretc, first, second)["variables"]
    assert [(v["component_name"], v["_id"], len(v["reqs"])) for v in found] == [
        ("arm", "armp", 1),
        ("leg", "legp", 1),
    ]


def test_a_number_is_not_said_to_be_a_truth_value(fretc: Fretc) -> None:
    """Nothing declares x; the sentence compares it with a number."""
    found = variables(fretc, "the sw shall always satisfy x > 3")
    assert found["x"]["dataType"] != "boolean"


@pytest.mark.parametrize("sentence", ["way < gap", "way > 2 s * v - gap", "(gap - way) / 2 > 0"])
def test_fret_does_not_compare_metres_with_centimetres(fretc: Fretc, sentence: str) -> None:
    signals = {"way": "m", "gap": "cm", "v": "m/s"}
    bindings = '[clock]\ntick = "100 ms"\n' + "".join(
        f'[signal.{name}]\npath = "/{name}.data"\nunit = "{unit}"\n'
        for name, unit in signals.items()
    )
    write("bindings.toml", bindings)
    write("r.fret", f"the rover shall always satisfy {sentence}\n")
    run = fretc("r.fret", "--emit", "fret-json")
    assert run.status == 2
    assert "F601 FRET cannot express a comparison of signals in several units of r" in run.err


def test_a_bound_proposition_tells_its_role_and_its_text(fretc: Fretc) -> None:
    bindings = (
        '[clock]\ntick = "1 s"\n'
        '[signal.v]\npath = "/v.data"\nunit = "m/s"\n'
        '[proposition.p]\nexpr = "v > 1 m/s"\nrole = "output"\ntext = "moving"\n'
    )
    found = variables(fretc, "the sw shall always satisfy p", bindings=bindings)
    assert (found["p"]["idType"], found["p"]["description"]) == ("Output", "moving")


# There and back -------------------------------------------------------------------------------

EXPORT: dict[str, Any] = {
    "requirements": [
        {
            "reqid": "R 1",
            "parent_reqid": "HAZ-1",
            "project": "Rover",
            "rationale": 'Say "no".\n+++\nBack\\slash',
            "comments": "to be reviewed",
            "fulltext": "Whenever too_close the rover shall within 3 ticks satisfy stopped.",
            "status": "completed",
            "semantics": {"type": "nasa", "ft": "(G stale)"},
            "input": {},
            "_id": "u-1",
        },
        {
            "reqid": "R2",
            "parent_reqid": "R 1",
            "project": "Rover",
            "rationale": "",
            "comments": "",
            "fulltext": '"It should look nice."',
            "status": "paused",
            "semantics": {"type": "freeForm"},
            "input": {},
            "_id": "u-2",
        },
        {
            "reqid": "R3",
            "parent_reqid": "",
            "project": "Rover",
            "rationale": "",
            "comments": "",
            "fulltext": "when p the rover shall always satisfy stopped",
            "status": "",
            "semantics": {},
            "input": {},
            "_id": "u-3",
        },
    ],
    "variables": [
        {
            "_id": f"Roverrover{name}",
            "project": "Rover",
            "component_name": "rover",
            "variable_name": name,
            "reqs": reqs,
            "dataType": "boolean",
            "idType": kind,
            "moduleName": "",
            "description": f"about {name}",
            "assignment": "",
            "copilotAssignment": "a && b",
            "modeRequirement": "",
            "modeldoc": False,
            "modeldoc_id": "",
            "completed": False,
        }
        for name, kind, reqs in (
            ("too_close", "Input", ["u-1"]),
            ("stopped", "Output", ["u-1", "u-3"]),
            ("p", "Internal", ["u-3"]),
        )
    ],
}


def there_and_back(fretc: Fretc, content: Any) -> tuple[dict[str, str], Any, dict[str, str]]:
    """The files of an import, the export made of them, and the files of its import."""

    def files(folder: str) -> dict[str, str]:
        return {path.name: path.read_text("utf-8") for path in Path(folder).iterdir()}

    assert fretc("import", write("first.json", json.dumps(content)), "-o", "first").status == 0
    again = emitted(fretc, *sorted(str(path) for path in Path("first").glob("*.fret")))
    assert fretc("import", write("second.json", json.dumps(again)), "-o", "second").status == 0
    return files("first"), again, files("second")


@pytest.mark.parametrize(
    "order", [(0, 1, 2), (0, 2, 1)], ids=["free text between", "free text last"]
)
def test_import_emit_import_gives_the_same_files(fretc: Fretc, order: tuple[int, ...]) -> None:
    ordered = [EXPORT["requirements"][i] for i in order]
    first, _, second = there_and_back(fretc, {**EXPORT, "requirements": ordered})
    assert set(first) == {"rover.fret", "bindings.toml"}
    assert second == first


def test_each_requirement_comes_back_with_its_own_fields(fretc: Fretc) -> None:
    """All but the formulas, which are made anew."""

    def known(records: Any) -> dict[str, Any]:
        plain = [{k: v for k, v in record.items() if k != "semantics"} for record in records]
        return {record["_id"]: record for record in plain}

    _, again, _ = there_and_back(fretc, EXPORT)
    assert known(again["requirements"]) == known(EXPORT["requirements"])


def test_the_requirements_come_back_in_their_order(fretc: Fretc) -> None:
    _, again, _ = there_and_back(fretc, EXPORT)
    assert [record["_id"] for record in again["requirements"]] == ["u-1", "u-2", "u-3"]


def test_each_variable_comes_back_with_its_requirements(fretc: Fretc) -> None:
    _, again, _ = there_and_back(fretc, EXPORT)
    fields = ("_id", "reqs", "dataType", "idType", "description", "copilotAssignment")
    expected = [{key: v[key] for key in fields} for v in EXPORT["variables"]]
    found = [{key: v[key] for key in fields} for v in again["variables"]]
    assert sorted(found, key=str) == sorted(expected, key=str)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("assignmentVariables", ["a", "b"]),
        ("modeldoc_vectorIndex", 3),
        ("smvAssignment", "a & b"),
        ("tool", "Simulink"),
        ("moduleName", "Arm"),
        ("dataType", "fixdt(1,16,4)"),
        ("completed", True),
        ("dataType", ""),
        ("idType", "Function"),
        ("idType", ""),
    ],
)
def test_a_field_of_a_variable_comes_back_as_it_was(
    fretc: Fretc, field: str, value: object
) -> None:
    variable = {**EXPORT["variables"][0], field: value}
    _, again, _ = there_and_back(fretc, {**EXPORT, "variables": [variable]})
    (found,) = [v for v in again["variables"] if v["variable_name"] == "too_close"]
    assert found[field] == value


def test_free_text_comes_back_letter_by_letter(fretc: Fretc) -> None:
    text = '"First.\n\n  - second,   \\ third\n"'
    record = {**EXPORT["requirements"][1], "fulltext": text}
    _, again, _ = there_and_back(fretc, {"requirements": [record], "variables": []})
    assert again["requirements"][0]["fulltext"] == text


def test_free_text_alone_can_be_emitted(fretc: Fretc) -> None:
    _, again, _ = there_and_back(fretc, [EXPORT["requirements"][1]])
    assert [record["reqid"] for record in again["requirements"]] == ["R2"]


def test_title_and_text_survive_an_export_and_an_import(fretc: Fretc) -> None:
    fields = 'title = "Stop: \\"near\\" things"\ntext = "It stops.\\nAt once."\n'
    sentence = "the robot shall always satisfy stopped"
    write("r1.fret", f'+++\nid = "R1"\n{fields}status = "approved"\n+++\n{sentence}\n')
    assert fretc("r1.fret", "--emit", "fret-json", "-o", "out").status == 0
    assert fretc("import", "out/fret.json", "-o", "back").status == 0
    (back,) = Path("back").glob("*.fret")
    (known,) = load([str(back)]).requirements
    assert known.title == 'Stop: "near" things'
    assert known.text == "It stops.\nAt once."


# FRET's variables, there and back -------------------------------------------------------------

ASSIGNMENTS = (
    "",
    "1",
    "0.5",
    "a2 and not a3",
    "a2  and  a3",
    "a3 + 1.0",
    "0.0 -> pre x",
    "if a then b else c",
    "a1",
    "not a == b",
    "preReal(0.0, x) < 3",
)
TEXTS = st.sampled_from(["", "plain", 'say "no"', "two\nlines"])
VARIABLE = st.fixed_dictionaries(
    {
        "project": st.sampled_from(["Rover", "Rover", "Other"]),
        "variable_name": st.sampled_from(["a0", "a1", "other", "not_used"]),
        "component_name": st.sampled_from(["rover", "arm"]),
        "dataType": st.sampled_from(
            ["", "boolean", "integer", "unsigned integer", "single", "double", "enum"]
        ),
        "idType": st.sampled_from(["", "Input", "Output", "Internal", "Mode", "Function"]),
        "description": TEXTS,
        "assignment": st.sampled_from(ASSIGNMENTS),
        "modeRequirement": st.sampled_from(ASSIGNMENTS),
        "copilotAssignment": TEXTS,
        "smvAssignment": TEXTS,
        "assignmentVariables": st.sampled_from([[], ["a", "b"]]),
        "moduleName": TEXTS,
        "modeldoc": st.sampled_from([False, False, True]),
        "modeldoc_id": st.sampled_from(["", "block 3"]),
        "modelComponent": st.sampled_from([[], ["m/n"], {"path": "m/n", "ports": [1, 2]}]),
        "_id": st.sampled_from(["", "", "an id of its own"]),
        "modeldoc_vectorIndex": st.sampled_from(["", 3]),
        "completed": st.booleans(),
        "smvCompleted": st.booleans(),
    }
)


def variables_of(records: list[dict[str, Any]]) -> Any:
    """All that they say, in no order; what is empty says nothing."""
    said = [
        {key: v for key, v in record.items() if key != "reqs" and v not in ("", [], None, False)}
        for record in records
    ]
    return sorted(json.dumps(record, sort_keys=True) for record in said)


@pytest.mark.slow
@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40 if FULL else 15
)
@given(st.lists(VARIABLE, max_size=4))
def test_what_fret_says_of_its_variables_comes_back(
    fretc: Fretc, variables: list[dict[str, Any]]
) -> None:
    for each in variables:
        names = (each["project"], each["component_name"], each["variable_name"])
        if each["variable_name"] == "other":  # of the sentences
            each |= {"dataType": "boolean", "assignment": "", "modeRequirement": ""}
        each["_id"] = each["_id"] or "".join(names)
    sentences = [
        {**EXPORT["requirements"][0], "fulltext": f"the {component} shall always satisfy other",
         "project": project, "reqid": f"R-{project}-{component}", "parent_reqid": "",
         "_id": f"u-{project}-{component}"}
        for component, project in (("rover", "Rover"), ("arm", "Rover"), ("rover", "Other"))
    ]  # fmt: skip
    content = {"requirements": sentences, "variables": variables}
    for folder in (Path("first"), Path("second"), Path("requirements")):
        shutil.rmtree(folder, ignore_errors=True)
    first, again, second = there_and_back(fretc, content)
    back, there = variables_of(again["variables"]), set(variables_of(variables))
    assert there <= {*back}
    made = [json.loads(text) for text in back if text not in there]
    assert {each["variable_name"] for each in made} <= {"other"}  # FRET had not declared it there
    assert {each["_id"] for each in again["requirements"]} == {each["_id"] for each in sentences}
    assert first["rover.fret"] == second["rover.fret"]


@pytest.mark.parametrize("table", ["[variable.p.fret]\n{}", "[[fret.variable]]\n{}"])
@pytest.mark.parametrize("value", ["1979-05-27", "[[1], 07:32:00]", "{ a = nan }", "-inf"])
def test_what_json_has_not_is_refused_where_it_is_kept_for_fret(
    fretc: Fretc, table: str, value: str
) -> None:
    write("bindings.toml", table.format(f"field = {value}\n"))
    run = fretc(write("r.fret", "the sw shall satisfy p"), "--emit", "fret-json")
    assert run.status == 2
    assert "F303 FRET cannot store `" in run.err


def test_a_constant_stays_a_name_in_what_fret_reads(fretc: Fretc) -> None:
    bindings = '[variable.limit]\ntype = "double"\nvalue = "1.5"\n'
    found = variables(fretc, "the rover shall always satisfy speed < limit", bindings=bindings)
    assert (found["limit"]["assignment"], found["limit"]["idType"]) == ("1.5", "Internal")
    assert found["limit"]["reqs"] == ["R0"]
    (path,) = Path().glob("r.fret")
    (requirement,) = emitted(fretc, str(path))["requirements"]
    assert requirement["fulltext"] == "the rover shall always satisfy speed < limit"
    assert requirement["semantics"]["pt"] == "H(speed < limit)"


def test_a_constant_with_a_unit_is_a_number_in_what_fret_reads(fretc: Fretc) -> None:
    write(
        "bindings.toml",
        '[clock]\ntick = "1 s"\n[signal.speed]\npath = "/v.data"\nunit = "km/h"\nrole = "input"\n'
        '[variable.limit]\nvalue = "1.5 m/s"\n',
    )
    content = emitted(fretc, write("r.fret", "the rover shall always satisfy speed < limit"))
    (requirement,) = content["requirements"]
    assert requirement["fulltext"] == "the rover shall always satisfy speed < 5.4"
    speed, limit = content["variables"]
    assert (speed["variable_name"], speed["idType"]) == ("speed", "Input")
    assert (limit["assignment"], limit["fretc"]) == ("", {"value": "1.5 m/s"})
    assert fretc("import", write("back.json", json.dumps(content)), "-o", "back").status == 0
    assert 'value = "1.5 m/s"' in Path("back/bindings.toml").read_text("utf-8")


def test_a_changed_value_is_what_fret_gets(fretc: Fretc) -> None:
    """The text of FRET's own assignment stays only while it says the same."""
    table = (
        '[variable.m]\nrole = "internal"\nvalue = "{}"\n'
        '[variable.m.fret]\nassignment = "a  and  b"\n'
    )
    same = variables(fretc, "the sw shall always satisfy m", bindings=table.format("a & b"))
    assert same["m"]["assignment"] == "a  and  b"
    other = variables(fretc, "the sw shall always satisfy m", bindings=table.format("a | b"))
    assert other["m"]["assignment"] == "a or b"


def test_assignments_that_lead_in_a_circle_are_kept_and_not_read(fretc: Fretc) -> None:
    both = [
        {**EXPORT["variables"][2], "variable_name": name, "assignment": text, "_id": name}
        for name, text in (("p", "q or p2"), ("q", "p and p2"))
    ]
    content = {"requirements": EXPORT["requirements"][2:], "variables": both}
    run = fretc("import", write("e.json", json.dumps(content)), "-o", "in")
    assert run.status == 0
    assert "F342 warning: assignments lead in a circle: p -> q -> p" in run.err
    again = emitted(fretc, *map(str, Path("in").glob("*.fret")))
    kept = {v["variable_name"]: v["assignment"] for v in again["variables"]}
    assert (kept["p"], kept["q"]) == ("q or p2", "p and p2")
