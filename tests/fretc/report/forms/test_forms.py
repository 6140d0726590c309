"""The report in the forms of other tools."""

import csv
import io
import json
import re
from dataclasses import replace
from itertools import takewhile
from math import isfinite
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema  # type: ignore[import-untyped]
import pytest
import yaml
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.report.forms.csv_rows import _harmless
from fretc.report.forms.markdown import markdown
from fretc.report.model.changes import RequirementChanges
from fretc.report.model.marks import verdict_mark
from fretc.report.model.views import Remark, ReportView
from fretc.report.sections.details import Details
from tests.command import Fretc, made_once, write
from tests.fretc.report import junit_schema
from tests.fretc.report.cases import (
    moment,
    project,
    report_of,
    requirement,
    result,
    violation,
    write_evidence,
)
from tests.fretc.report.sarif_schema import SARIF

HOSTILE = "=cmd|' /C calc'!A0 <script>alert(1)</script> | * _x_ @team \u202e [a](b)"
TEXTS = (
    requirement("R1", "whenever near the robot shall eventually satisfy stopped"),
    requirement("R2", "the robot shall always satisfy stopped", title=HOSTILE),
    requirement("R3", "whenever near the robot shall satisfy stopped", parents=[]),
    requirement("R4", "whenever near the robot shal satisfy stopped"),
    requirement("R5", "the robot shall never satisfy near", status="retired"),
)
WAIVER = (
    '[R3]\nverdict = "not exercised"\nreason = "later"\nby = "A"\nrole = "B"\n'
    'granted = "2000-01-01"\nexpires = "2099-01-01"\n'
)


@pytest.fixture
def reported(fretc: Fretc) -> Fretc:
    """Four requirements and a retired one: satisfied, violated, waived, not FRETish."""

    def make() -> None:
        known = project(Path("requirements"), *TEXTS)
        write("requirements/waivers.toml", WAIVER)
        results = [
            result(known, "satisfied", "R1"),
            result(known, "satisfied", "R1", run="logs/b.mcap", hashes={"log": "cd" * 32}),
            result(known, "violated", "R2", violations=[violation(14, 20, 11)]),
        ]
        write_evidence(known, Path("build"), *results)

    made_once("a project for all forms", make)
    return fretc


def form(fretc: Fretc, name: str, *options: str) -> str:
    run = fretc("report", f"--{name}", f"out.{name}", *options)
    assert run.status == 2  # R4 is an error, and the report tells it
    return Path(f"out.{name}").read_text(encoding="utf-8")


def test_csv_has_a_row_for_each_requirement_and_run(reported: Fretc) -> None:
    rows = list(csv.DictReader(io.StringIO(form(reported, "csv"))))
    cells = [(row["requirement"], row["verdict"], row["run"], row["run_verdict"]) for row in rows]
    assert cells == [
        ("R1", "satisfied", "logs/a.mcap", "satisfied"),
        ("R1", "satisfied", "logs/b.mcap", "satisfied"),
        ("R2", "violated", "logs/a.mcap", "violated"),
        ("R3", "waived", "", ""),
        ("R4", "unformalized", "", ""),
        ("R5", "retired", "", ""),
    ]
    assert rows[0]["hazards"] == "HAZ-1"
    assert rows[0]["log_sha256"] == "ab" * 32
    assert rows[2]["violations"] == "1"


NUMBERS = (
    "triggers", "answers", "open", "violations", "latency_median_s", "latency_longest_s",
)  # fmt: skip


def test_csv_has_numbers_as_numbers_and_units_in_its_head(fretc: Fretc) -> None:
    known = project(Path("requirements"))
    late: dict[str, Any] = {
        "latencies_s": [0.25, 39.8004, 0.25],
        "triggers": [moment(1), moment(2), moment(400)],
    }
    none: dict[str, Any] = {"latencies_s": [], "triggers": [], "open": []}
    results = [
        result(known, "satisfied", run="a.mcap", **late, open=[moment(500)]),
        result(known, "satisfied", run="b.mcap", hashes={"log": "cd" * 32}, **none),
    ]
    write_evidence(known, Path("build"), *results)
    assert fretc("report", "--csv", "out.csv").status == 0
    text = Path("out.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [[row[name] for name in NUMBERS] for row in rows] == [
        ["3", "3", "1", "0", "0.25", "39.8004"],
        ["0", "0", "0", "0", "", ""],
    ]
    # What is no number is in quotes: a reader that turns all others into numbers reads the file.
    typed: list[Any] = list(csv.reader(io.StringIO(text), quoting=csv.QUOTE_NONNUMERIC))
    assert typed[1][-6:] == [3.0, 3.0, 1.0, 0.0, 0.25, 39.8004]


def test_no_cell_is_a_formula_for_a_spreadsheet(reported: Fretc) -> None:
    rows = list(csv.reader(io.StringIO(form(reported, "csv"))))
    cells = [cell for row in rows for cell in row]
    assert any(cell.startswith("'=cmd") for cell in cells)
    assert not [cell for cell in cells if cell[:1] in ("=", "+", "-", "@")]


@given(st.sampled_from(["", *"=+-@\t\r\n", "\uff1d"]), st.text() | st.floats().map(str))
@example("-", "1")
@example("-", "1+cmd|' /C calc'!A0")
def test_of_texts_only_plain_numbers_begin_like_a_formula(start: str, rest: str) -> None:
    cell = _harmless(start + rest)
    assert isinstance(cell, str)
    assert cell in (start + rest, f"'{start}{rest}")
    if cell[:1] in ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d"):
        assert cell[0] in "+-"
        assert isfinite(float(cell)) or "e" in cell.lower()
    assert _harmless(-1.5) == -1.5


def test_markdown_names_the_worst_first_and_takes_texts_as_text(reported: Fretc) -> None:
    text = form(reported, "markdown")
    assert re.fullmatch(r"## ✘ .* \\\(R2\\\) is violated\.", text.splitlines()[0])
    assert figures(text) == {
        "claimed": 4, "shown": 1, "violated": 1, "not shown": 2, "changed since the review": 0
    }  # fmt: skip
    listed = [line[:50] for line in text.splitlines() if line.startswith(("###", "- "))]
    assert listed == [
        "### Violated: 1",
        "- ✘ violated **=cmd\\|' /C calc'\\!A0 \\<script\\>aler",
        "### Not shown: 2",
        "- ! unformalized **Title of R4 \\(R4\\)**: F107\\: a ",
        "- w waived **Title of R3 \\(R3\\)** (later): the aud",
    ]
    assert "in logs/a.mcap: reason of R2; at 1.4 s" in text
    assert "<script>" not in text
    assert not re.search(r"(?<!\\)@team", text)


def figures(text: str) -> dict[str, int]:
    """The five figures by their names."""
    names, _, numbers = (line.strip("| ").split(" | ") for line in text.splitlines()[2:5])
    return dict(zip(names, map(int, numbers), strict=True))


MARKS = ("violated", "refuted", "no data", "inconclusive", "vacuous", "satisfied", "retired")


@pytest.mark.slow
@given(
    st.lists(st.tuples(st.sampled_from(MARKS), st.booleans()), max_size=60),
    st.integers(0, 60),
    st.integers(0, 60),
    st.sampled_from(["", "x" * 10_000]),
)
def test_markdown_is_one_screen_and_what_it_leaves_out_is_counted_and_never_worse(
    plain: tuple[ReportView, Details],
    marks: list[tuple[str, bool]],
    changes: int,
    accepted: int,
    long: str,
) -> None:
    plain_report, details = plain
    (view,) = plain_report.requirements
    views = [
        replace(view, id=f"R{n}", title=f"T{n}{long}", mark=verdict_mark(word, suspect=suspect))
        for n, (word, suspect) in enumerate(marks)
    ]
    flip = (("a.mcap", "satisfied", "violated"),)
    change = RequirementChanges("R0", "", "", "", "", (), (long,) * 9, (long,), (), "", flip, True)
    remark = Remark("F203", "warning", long, accepted=long or "meant")
    text = markdown(
        replace(
            plain_report,
            requirements=tuple(views),
            changes=(change,) * changes,
            remarks=(remark,) * accepted,
        ),
        details,
    )
    lines = text.splitlines()
    assert len(lines) <= 40
    assert len(text) < 30_000
    red = [one for one in views if one.mark.word in ("violated", "refuted")]
    gaps = [
        one for one in views
        if one not in red and not one.mark.shows and one.mark.word != "retired"
    ]  # fmt: skip
    for heading, some, most in (("Violated", red, 8), ("Not shown", gaps, 4)):
        listed = [line for line in lines if f"### {heading}: {len(some)}" == line]
        assert len(listed) == (1 if some else 0)
        if not some:
            continue
        start = lines.index(listed[0]) + 1
        entries = list(takewhile(lambda line: line.startswith("- "), lines[start:]))
        words = [entry.removeprefix("- ").split(" ", 1)[1].split("**")[0] for entry in entries]
        expected = sorted((one.mark for one in some), key=lambda mark: mark.severity)[:most]
        assert [word.split(",")[0].strip() for word in words[:most]] == [
            mark.word for mark in expected
        ]
        left = len(some) - most
        assert len(entries[most:]) == (left > 0)
        named = [name for entry in entries[most:] for name in entry.split(": ")[1].split(", ")]
        assert entries[most:] == ([f"- … and {left} more: {', '.join(named)}"] if left > 0 else [])
        assert len({*named}) == max(0, left)
    numbers = figures(text)
    assert (numbers["violated"], numbers["not shown"]) == (len(red), len(gaps))
    assert numbers["claimed"] == numbers["shown"] + len(red) + len(gaps)
    assert numbers["changed since the review"] == changes


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> tuple[ReportView, Details]:
    folder = tmp_path_factory.mktemp("plain")
    known = project(folder)
    build = report_of(known, folder, result(known, "violated", violations=[violation(14, 20, 11)]))
    assert build.report is not None
    assert build.details is not None
    return build.report, build.details


def cases(suite: ElementTree.Element) -> list[tuple[str, list[str]]]:
    """The id of each case, and the elements of its outcome."""
    return [
        (case.attrib["name"].split("(")[-1][:-1], [child.tag for child in case]) for case in suite
    ]


def test_junit_has_a_suite_for_each_run_and_one_for_what_no_run_says(reported: Fretc) -> None:
    root = ElementTree.fromstring(form(reported, "junit"))
    assert [(suite.attrib["name"], cases(suite)) for suite in root] == [
        ("requirements", [("R3", ["skipped"]), ("R4", ["error"]), ("R5", ["skipped"])]),
        ("logs/a.mcap", [("R1", []), ("R2", ["failure"])]),
        ("logs/b.mcap", [("R1", [])]),
    ]
    names = ("tests", "failures", "errors", "skipped")
    assert [[suite.attrib[name] for name in names] for suite in root] == [
        ["3", "0", "1", "2"],
        ["2", "1", "0", "0"],
        ["1", "0", "0", "0"],
    ]
    assert root[1][0].attrib["name"] == "Title of R1 (R1)"
    assert root[1][1][0].attrib["message"] == "violated: reason of R2"


def test_two_runs_of_one_name_are_two_suites(fretc: Fretc) -> None:
    known = project(Path("requirements"))
    results = [
        result(known, "satisfied", run="/one/a.mcap"),
        result(known, "satisfied", run="/two/a.mcap", hashes={"log": "cd" * 32}),
    ]
    write_evidence(known, Path("build"), *results)
    assert fretc("report", "--junit", "out.junit").status == 0
    suites = [one.attrib["name"] for one in ElementTree.parse("out.junit").getroot()]
    assert suites == ["requirements", "a.mcap (one/a)", "a.mcap (two/a)"]


def test_a_waiver_covers_what_its_runs_show(fretc: Fretc) -> None:
    known = project(Path("requirements"))
    broken: dict[str, Any] = {"verdict": "violated", "violations": [violation(14, 20, 11)]}
    results = [result(known, id="R1", run=run, **broken) for run in ("a.mcap", "b.mcap")]
    write_evidence(known, Path("build"), *results)
    write(
        "requirements/waivers.toml", WAIVER.replace("R3", "R1").replace("not exercised", "violated")
    )
    assert fretc("report", "--junit", "out.junit", "--strict").status == 0
    _, first, second = ElementTree.parse("out.junit").getroot()
    assert cases(first) == cases(second) == [("R1", ["skipped"])]
    assert first[0][0].attrib["message"] == "waived, later: violated: reason of R1"


def test_junit_has_the_elements_of_the_schema_that_jenkins_has(reported: Fretc) -> None:
    root = ElementTree.fromstring(form(reported, "junit"))
    assert list(junit_schema.complaints(root)) == []
    assert {element.tag for element in root.iter()} == set(junit_schema.MAY)


def test_a_suspect_requirement_fails_whatever_its_verdict(reported: Fretc) -> None:
    path = Path("requirements/bindings.toml")
    path.write_text(path.read_text().replace("< 0.01 m/s", "< 0.02 m/s"))
    suite = ElementTree.fromstring(form(reported, "junit"))[1]
    messages = [(child.tag, child.attrib["message"]) for case in suite for child in case]
    why = "the bindings have changed since the audit"
    assert messages == [
        ("failure", f"satisfied, suspect: reason of R1; {why}"),
        ("failure", f"violated, suspect: reason of R2; {why}"),
    ]


@pytest.mark.slow
def test_sarif_marks_suspect_evidence(reported: Fretc) -> None:
    log = json.loads(form(reported, "sarif"))
    jsonschema.validate(log, SARIF)
    levels = [(one["ruleId"], one["level"]) for one in log["runs"][0]["results"]]
    assert levels == [("R2", "error")]
    path = Path("requirements/bindings.toml")
    path.write_text(path.read_text().replace("< 0.01 m/s", "< 0.02 m/s"))
    log = json.loads(form(reported, "sarif"))
    jsonschema.validate(log, SARIF)
    first = log["runs"][0]["results"][0]
    assert (first["ruleId"], first["level"]) == ("R1", "warning")
    assert first["properties"]["verdict"] == "satisfied"
    assert first["properties"]["currency"] == "suspect"
    red = log["runs"][0]["results"][2]
    assert (red["ruleId"], red["level"]) == ("R2", "error")
    assert red["properties"]["currency"] == "suspect"
    assert "the bindings have changed since the audit" in first["message"]["text"]


# GSN, by the rules of gsn2x -------------------------------------------------------------------

PREFIXES = ("CSn", "Sn", "G", "A", "J", "S", "C")
"""Of an id, the longest first: `CSn` is a counter-solution, `Sn` no strategy."""
SUPPORTS, AROUND = ("G", "Sn", "S"), ("J", "A", "C")


def kind(id: str) -> str:
    return next((prefix for prefix in PREFIXES if id.startswith(prefix)), "")


def complaints(elements: dict[str, dict[str, Any]]) -> list[str]:
    """V01 to V06 and V10 of gsn2x, C01 to C04, and goals that nobody refers to."""
    errors = []
    attributes = {"text", "supportedBy", "inContextOf", "undeveloped", "challenges", "defeated"}
    challenged = [e["challenges"] for e in elements.values() if "challenges" in e]
    for id, element in elements.items():
        below, around = element.get("supportedBy", []), element.get("inContextOf", [])
        if not kind(id) or not element["text"] or element.keys() - attributes:
            errors.append(id)
        if (below or around) and kind(id) not in ("S", "G"):
            errors.append(f"{id} refers")
        errors += [f"{id} {n}" for n in below if kind(n) not in SUPPORTS or n not in elements]
        errors += [f"{id} {n}" for n in around if kind(n) not in AROUND or n not in elements]
        if len({*below, *around}) < len(below) + len(around) or id in (*below, *around):
            errors.append(f"{id} twice")
        developed = bool(below) or kind(id) not in ("S", "G")
        if developed == element.get("undeveloped", False):
            errors.append(f"{id} undeveloped")
        if (kind(id) == "CSn") != (element.get("challenges", id) in elements.keys() - {id}):
            errors.append(f"{id} challenges")
        if element.get("defeated") and id not in challenged:
            errors.append(f"{id} defeated")
    referred = {
        n for e in elements.values() for k in ("supportedBy", "inContextOf") for n in e.get(k, [])
    }
    alone = {id for id in elements if kind(id) != "CSn"} - referred
    errors += [f"{id} alone" for id in alone - {"G_top"}]
    below = {id: element.get("supportedBy", []) for id, element in elements.items()}
    errors += [f"{id} in a circle" for id in below if id in _reached(below, id)]
    return errors


def _reached(below: dict[str, list[str]], id: str) -> set[str]:
    visited: set[str] = set()
    waiting = list(below[id])
    while waiting:
        if (other := waiting.pop()) not in visited:
            visited.add(other)
            waiting += below.get(other, [])
    return visited


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        ({"X1": {"text": "x"}}, "X1"),
        ({"G_top": {"text": "g"}}, "G_top undeveloped"),
        ({"G_top": {"text": "g", "supportedBy": ["Sn"], "undeveloped": True}}, "G_top undeveloped"),
        ({"G_top": {"text": "g", "supportedBy": ["C"]}}, "G_top C"),
        ({"G_top": {"text": "g", "supportedBy": ["Sn", "Sn"]}}, "G_top twice"),
        ({"G_top": {"text": "g", "supportedBy": ["G_top"]}}, "G_top in a circle"),
        ({"G_top": {"text": "g", "supportedBy": ["Sn"], "defeated": True}}, "G_top defeated"),
        ({"CSn1": {"text": "x", "challenges": "G_none"}}, "CSn1 challenges"),
    ],
)
def test_each_rule_finds_what_it_is_about(wrong: dict[str, dict[str, Any]], complaint: str) -> None:
    right: dict[str, dict[str, Any]] = {
        "G_top": {"text": "g", "supportedBy": ["Sn"], "inContextOf": ["C"]},
        "Sn": {"text": "s"},
        "C": {"text": "c"},
    }
    assert complaints(right) == []
    assert complaint in complaints({**right, **wrong})


def test_gsn_is_an_argument_that_gsn2x_takes(reported: Fretc) -> None:
    elements = yaml.safe_load(form(reported, "gsn"))
    assert complaints(elements) == []
    assert elements["G_hazard_HAZ_2d_1"]["supportedBy"] == [
        "G_req_2d_R1",
        "G_req_2d_R2",
        "G_req_2d_R4",
        "G_req_2d_R5",
    ]
    assert elements["S_others"]["supportedBy"] == ["G_req_2d_R3"]


def test_gsn_claims_no_more_than_is_shown(reported: Fretc) -> None:
    elements = yaml.safe_load(form(reported, "gsn"))
    support = {id: element.get("supportedBy") for id, element in elements.items() if "req" in id}
    goals = {id: below for id, below in support.items() if id.startswith("G")}
    assert goals["G_req_2d_R1"] == ["Sn_req_2d_R1"]
    assert [goals[f"G_req_2d_R{n}"] for n in (2, 3, 4, 5)] == [None] * 4
    defeated = [id for id, element in elements.items() if element.get("defeated")]
    assert defeated == ["G_req_2d_R2"]
    assert elements["CSn_req_2d_R2"] == {
        "text": "R2 is violated in 1 of 1 audited run: logs/a.mcap: reason of R2",
        "challenges": "G_req_2d_R2",
    }
    assert elements["J_req_2d_R3"]["text"].startswith("Waived until 2099-01-01 by A, B")


def test_a_form_never_goes_where_another_goes(reported: Fretc) -> None:
    run = reported("report", "--csv", "x", "--gsn", "x")
    assert run.status == 2
    assert "F905 `x` cannot be written: two outputs would go there" in run.err
    assert not Path("x").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("verdict", "status"), [("satisfied", 0), ("violated", 1), ("vacuous", 3), (None, 3)]
)
def test_strict_exits_as_the_report_says(fretc: Fretc, verdict: str | None, status: int) -> None:
    known = project(Path("requirements"))
    results = [result(known, verdict)] if verdict else []
    write_evidence(known, Path("build"), *results)
    assert fretc("report").status == 0
    assert fretc("report", "--strict").status == status


def test_no_form_goes_where_a_log_is(reported: Fretc) -> None:
    write("logs/a.mcap", "a log")
    run = reported("report", "--html", "logs/a.mcap")
    assert run.status == 2
    assert "F905 `logs/a.mcap` cannot be written: it is `logs/a.mcap`, which is an input" in run.err
    assert Path("logs/a.mcap").read_text() == "a log"
