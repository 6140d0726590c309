"""The report as ReqIF, read back by other readers: a ReqIF library, the schema, and our own."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import pytest
import reqif
from hypothesis import given
from hypothesis import strategies as st
from reqif.parser import ReqIFParser

from compiler.files.settings import Settings
from compiler.project.parents import Parent, parents
from fretc.report.forms.reqif import reqif as form
from fretc.report.model.marks import verdict_mark
from fretc.report.model.views import HazardView, ReportView
from fretish.diagnostics import extras
from tests.command import Fretc, made_once, write
from tests.effort import FULL, examples
from tests.fretc.report.cases import (
    HAZARDS,
    project,
    report_of,
    requirement,
    result,
    violation,
    write_evidence,
)

if TYPE_CHECKING:
    from xmlschema import XMLSchema

TEXT = '<script>alert(1)</script> & "quotes" \'\u202eturned\u200f\n\n]]> {x} \\u <!-- é ✔\ta'
TEXTS = (
    requirement(
        "R1",
        "whenever near the robot shall eventually satisfy stopped",
        parents=["HAZ-1", "HAZ-2"],
        text=TEXT,
        title=TEXT,
    ),
    requirement("R2", "the robot shall always satisfy stopped", parents=["R1"], text="Stand."),
    requirement("R3", "whenever near the robot shall satisfy stopped", parents=[]),
    requirement("R4", "whenever near the robot shal satisfy stopped", parents=["HAZ-1", "NO-1"]),
    requirement("R_5.a-b", "the robot shall never satisfy near", status="retired"),
)
MORE = f'{HAZARDS}\n[HAZ-2]\ntitle = "It tips <over>"\n\n[HAZ-3]\ntitle = "Nothing is below"\n'
WAIVER = (
    '[R3]\nverdict = "not exercised"\nreason = "later"\nby = "A"\nrole = "B"\n'
    'granted = "2000-01-01"\nexpires = "2099-01-01"\n'
)
IDS = ("HAZ-1", "HAZ-2", "HAZ-3", "R1", "R2", "R3", "R4", "R_5.a-b")


@pytest.fixture(scope="module")
def schema() -> XMLSchema:
    """OMG's, as the library carries it."""
    import xmlschema  # a quarter of a second

    return xmlschema.XMLSchema(Path(reqif.__file__).parent / "reqif_schema/reqif.xsd")


@dataclass(frozen=True)
class Content:
    """What the library's parser finds: objects by their foreign id, and attributes by name."""

    objects: dict[str, dict[str, Any]]
    relations: list[tuple[str, str]]
    places: list[tuple[int, str]]


def read(text: str) -> Content:
    bundle = ReqIFParser.parse_from_string(text)
    assert bundle.exceptions == []
    content = bundle.core_content.req_if_content
    types = {one.identifier: one for one in content.spec_types}
    words = {
        value.identifier: value.long_name
        for one in content.data_types
        for value in getattr(one, "values", None) or ()
    }
    objects: dict[str, dict[str, Any]] = {}
    names: dict[str, str] = {}
    for one in content.spec_objects:
        values = {}
        for attribute in one.attributes:
            definition = types[one.spec_object_type].attribute_map[attribute.definition_ref]
            value = attribute.value
            if isinstance(value, list):
                (value,) = (words[each] for each in value)
            elif attribute.attribute_type.name == "XHTML":
                value = "".join(attribute.xml_node.find("THE-VALUE").itertext())
            values[definition.long_name] = value
        names[one.identifier] = values["ReqIF.ForeignID"]
        objects[names[one.identifier]] = values
    assert len(objects) == len(content.spec_objects)
    return Content(
        objects,
        [(names[one.source], names[one.target]) for one in content.spec_relations],
        [
            (place.level, names[place.spec_object])
            for place in bundle.iterate_specification_hierarchy(content.specifications[0])
        ],
    )


@pytest.fixture
def exported(fretc: Fretc) -> Callable[[], str]:
    """Requirements that are satisfied, violated, waived, not FRETish and retired."""

    def make() -> None:
        known = project(Path("requirements"), *TEXTS, hazards=MORE)
        write("requirements/waivers.toml", WAIVER)
        results = [
            result(known, "satisfied", "R1"),
            result(known, "satisfied", "R1", run="logs/b.mcap"),
            result(known, "satisfied", "R2"),
            result(known, "violated", "R2", run="logs/b.mcap", violations=[violation(14, 20, 11)]),
        ]
        write_evidence(known, Path("build"), *results)

    def export() -> str:
        run = fretc("report", "--reqif", "out.reqif")
        assert run.status == 2  # R4 is an error, and the report tells it
        return Path("out.reqif").read_text(encoding="utf-8")

    made_once("a project for ReqIF", make)
    return export


@pytest.fixture
def text(request: pytest.FixtureRequest) -> str:
    """The export, made once for all who change nothing before."""
    if not _exports:
        _exports.append(request.getfixturevalue("exported")())
    return _exports[0]


_exports: list[str] = []


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> ReportView:
    """One hazard, one requirement, one run."""
    folder = tmp_path_factory.mktemp("small")
    known = project(folder)
    report = report_of(known, folder, result(known, "satisfied")).report
    assert report is not None
    return report


@pytest.mark.slow
def test_it_fits_the_schema(text: str, schema: XMLSchema) -> None:
    schema.validate(text)


@pytest.mark.slow
def test_the_schema_notices_what_does_not_fit(text: str, schema: XMLSchema) -> None:
    for right, wrong in (
        ("<xhtml:br/>", "<xhtml:nothing/>"),
        ('IDENTIFIER="requirement-R2"', 'IDENTIFIER="requirement-R1"'),
        ('IDENTIFIER="requirement-R2"', 'IDENTIFIER="2"'),
        ("1970-01-01T00:00:00+00:00", "today"),
    ):
        assert right in text
        assert not schema.is_valid(text.replace(right, wrong, 1))


def test_every_reference_has_what_it_refers_to(text: str) -> None:
    root = ElementTree.fromstring(text)
    known = {node.get("IDENTIFIER") for node in root.iter()}
    referred = {node.text for node in root.iter() if node.tag.endswith("-REF")}
    assert len(referred) > 40
    assert referred <= known


def test_each_object_has_what_is_known_of_it(text: str) -> None:
    objects = read(text).objects
    assert tuple(objects) == IDS
    fingerprint = objects["R2"].pop("Fingerprint SHA-256")
    assert re.fullmatch("[0-9a-f]{64}", fingerprint)
    meaning = objects["R2"].pop("Meaning")
    assert "`stopped` must be true" in meaning
    assert objects["R2"] == {
        "ReqIF.ForeignID": "R2",
        "ReqIF.Name": "Title of R2",
        "ReqIF.Text": "Stand.",
        "Parents": "R1",
        "Sentence": "the robot shall always satisfy stopped",
        "FT": "G stopped",
        "FT finite": "LAST R stopped",
        "PT": "H stopped",
        "Status": "approved",
        "Coverage": "exercised and violated",
        "Verdict": "violated",
        "Currency": "current",
        "Reasons": "b: violated, reason of R2\nit holds in 1 of 2 runs",
        "Runs": "violated in 1 run; satisfied in 1 run\n"
        "logs/b.mcap: violated: reason of R2\n"
        "logs/a.mcap: satisfied: reason of R2",
        "Review": "not reviewed",
    }
    assert objects["HAZ-1"] == {
        "ReqIF.ForeignID": "HAZ-1",
        "ReqIF.Name": "The robot hits something",
        "ReqIF.Text": "A drum can break.",
        "Severity": "catastrophic",
        "Source": "hazard analysis",
    }


def test_the_verdicts_are_those_of_the_report(text: str) -> None:
    objects = read(text).objects
    verdicts = {id: values["Verdict"] for id, values in objects.items() if "Verdict" in values}
    assert verdicts == {
        "R1": "satisfied",
        "R2": "violated",
        "R3": "waived",
        "R4": "unformalized",
        "R_5.a-b": "retired",
    }
    assert objects["R3"]["Reasons"].startswith(
        "waived until 2099-01-01 by A, B, 2000-01-01: later\nwithout the waiver: not exercised\n"
    )
    assert "F107" in objects["R4"]["Reasons"]


def test_suspect_evidence_is_reported_as_such(exported: Callable[[], str]) -> None:
    path = Path("requirements/bindings.toml")
    path.write_text(path.read_text().replace("< 5 cm", "< 6 cm"))
    values = read(exported()).objects["R1"]
    assert (values["Verdict"], values["Currency"]) == ("satisfied", "suspect")
    assert values["Runs"].splitlines()[:2] == [
        "satisfied, suspect in 2 runs",
        "logs/a.mcap: satisfied, suspect: reason of R1; the bindings have changed since the audit",
    ]


def test_relations_go_from_the_child_to_each_parent_that_is_there(text: str) -> None:
    assert read(text).relations == [
        ("R1", "HAZ-1"),
        ("R1", "HAZ-2"),
        ("R2", "R1"),
        ("R4", "HAZ-1"),
        ("R_5.a-b", "HAZ-1"),
    ]


def test_an_object_stands_once_below_its_first_hazard(text: str) -> None:
    assert read(text).places == [
        (1, "HAZ-1"),
        (2, "R1"),
        (2, "R2"),
        (2, "R4"),
        (2, "R_5.a-b"),
        (1, "HAZ-2"),
        (1, "HAZ-3"),
        (1, "R3"),
    ]


def test_texts_come_back_as_they_were(text: str) -> None:
    values = read(text).objects["R1"]
    assert values["ReqIF.Text"] == TEXT
    assert values["ReqIF.Name"] == " ".join(TEXT.split())


def ours(text: str) -> Mapping[str, Parent]:
    """As the parents of another project, which no ReqIF library reads."""
    write("exported/back.reqif", text)
    objects, mistakes = parents(Settings(Path("exported"), ("back.reqif",)))
    assert mistakes == ()
    return objects


def test_it_can_be_the_parents_of_another_project(exported: Callable[[], str]) -> None:
    objects = ours(exported())
    assert tuple(objects) == IDS
    assert objects["R2"] == Parent("R2", "Title of R2", "Stand.", "back.reqif")
    assert objects["R1"].text == TEXT


@pytest.mark.slow
def test_the_same_report_gives_the_same_bytes(
    exported: Callable[[], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    first = exported()
    assert exported() == first
    assert set(re.findall(r'LAST-CHANGE="(.*?)"', first)) == {"1970-01-01T00:00:00+00:00"}
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")
    dated = exported()
    assert dated.replace("2026-09-21T14:13:20+00:00", "1970-01-01T00:00:00+00:00") == first
    assert "<CREATION-TIME>2026-09-21T14:13:20+00:00</CREATION-TIME>" in dated


@pytest.mark.slow
def test_a_project_without_hazards_and_runs_fits_the_schema(
    fretc: Fretc, schema: XMLSchema
) -> None:
    project(Path("requirements"), hazards=None, bindings=None)
    fretc("report", "--reqif", "out.reqif")
    content = read(Path("out.reqif").read_text("utf-8"))
    schema.validate("out.reqif")
    assert content.places == [(1, "R1")]
    assert (content.objects["R1"]["Parents"], content.relations) == ("HAZ-1", [])
    assert "Runs" not in content.objects["R1"]


@pytest.mark.slow
def test_a_project_of_nothing_fits_the_schema(small: ReportView, schema: XMLSchema) -> None:
    schema.validate(form(replace(small, hazards=(), matrix=(), requirements=())))


@pytest.mark.slow
def test_requirements_that_share_an_id_are_two_objects(tmp_path: Path, schema: XMLSchema) -> None:
    same = requirement("R1", "the robot shall never satisfy near")
    report = report_of(project(tmp_path, same, same), tmp_path).report
    assert report is not None
    text = form(report)
    schema.validate(text)
    objects = re.findall(r'<SPEC-OBJECT IDENTIFIER="(.*?)"', text)
    assert objects == ["hazard-HAZ-1", "requirement-R1", "requirement-R1__2"]


LETTERS = st.characters(codec="utf-8", include_characters="<>&\"'\\]{}\u0000\u0085\u202e\ufffe")


def held(text: str) -> str:
    """Line ends are one character, and what XML cannot hold, or a terminal obeys, has no place."""
    lines = re.sub(r"\r\n|\r", "\n", text.strip())
    return "".join(
        "\ufffd"
        if c in "\ufffe\uffff" or (unicodedata.category(c) == "Cc" and c not in "\t\n")
        else c
        for c in lines
    )


@pytest.mark.slow
@examples(8)
@given(text=st.text(LETTERS, min_size=1))
def test_any_text_comes_back(small: ReportView, schema: XMLSchema, text: str) -> None:
    hazard = HazardView(f"{text}.", text, f".{text}.", "", "")
    exported = form(replace(small, hazards=(hazard,), project=text))
    schema.validate(exported)
    values = next(iter(read(exported).objects.values()))
    assert values["ReqIF.Text"] == held(f".{text}.")


@pytest.mark.slow
def test_a_thousand_requirements_are_all_there(small: ReportView) -> None:
    """By default a tenth of them."""
    count = 1000 if FULL else 100
    (view,), (row,) = small.requirements, small.matrix
    (one,) = view.results
    many = replace(view, results=(one,) * 30)
    views = [replace(many, id=f"R{n}", anchor=f"req-R{n}") for n in range(count)]
    rows = [replace(row, anchor=view.anchor) for view in views]
    text = form(replace(small, requirements=tuple(views), matrix=tuple(rows)))
    content = read(text)
    sizes = len(content.objects), len(content.relations), len(content.places)
    assert sizes == (count + 1, count, count + 1)


def test_of_many_runs_the_worst_are_listed(small: ReportView) -> None:
    (view,) = small.requirements
    (good,) = view.results
    bad = replace(good, mark=verdict_mark("violated"), run_file="logs/bad.mcap")
    report = replace(small, requirements=(replace(view, results=(*(good,) * 60, bad)),))
    lines = read(form(report)).objects["R1"]["Runs"].splitlines()
    assert lines[0] == "violated in 1 run; satisfied in 60 runs"
    assert lines[1] == "logs/bad.mcap: violated: reason of R1"
    assert len(lines) == 52
    assert lines[-1] == "… and 11 more runs"


def test_without_the_extra_the_line_that_installs_it_is_reported(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    project(Path("requirements"))
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    run = fretc("report", "--reqif", "out.reqif")
    assert (run.status, run.out) == (2, "")
    assert run.err == (
        "F908 a report as ReqIF needs `reqif`\n"
        "help: install the extra: pip install 'fretc[reqif]' "
        "(in a checkout: pip install '.[reqif]')\n"
    )
    assert not Path("build/report.html").exists()
    assert fretc("report").status == 0
