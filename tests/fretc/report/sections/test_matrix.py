from collections.abc import Mapping
from pathlib import Path
from typing import Any

from compiler.project.project import Project
from fretish.diagnostics.diagnostic import Code, Severity
from tests.fretc.report.cases import (
    HAZARDS,
    R1,
    as_json,
    content_of,
    moment,
    project,
    report_of,
    requirement,
    result,
)

ALWAYS = "the robot shall always satisfy stopped"


def test_a_row_leads_from_hazard_to_verdict(tmp_path: Path) -> None:
    known = project(tmp_path)
    (row,) = content_of(known, tmp_path, result(known, "satisfied"))["matrix"]
    assert (row["hazard"], row["requirement"], row["via"]) == ("HAZ-1", "R1", "")
    mark = {"word": "satisfied", "glyph": "✔", "kind": "satisfied", "suspect": False}
    assert (row["mark"], row["runs"], row["proof"]) == (mark, 1, None)
    assert row["review"] == {"word": "not reviewed", "glyph": "", "kind": "", "suspect": False}


def test_a_requirement_below_another_traces_to_its_hazard(tmp_path: Path) -> None:
    known = project(
        tmp_path,
        R1,
        requirement("R2", ALWAYS, parents=["R1"]),
        requirement("R3", ALWAYS, parents=["R2"]),
    )
    content = content_of(known, tmp_path)
    assert [(row["requirement"], row["hazard"], row["via"]) for row in content["matrix"]] == [
        ("R1", "HAZ-1", ""),
        ("R2", "HAZ-1", "R1"),
        ("R3", "HAZ-1", "R2 and R1"),
    ]
    assert content["orphans"]["requirements"] == []


def test_parents_in_a_circle_end(tmp_path: Path) -> None:
    known = project(
        tmp_path,
        requirement("R1", ALWAYS, parents=["R2"]),
        requirement("R2", ALWAYS, parents=["R1"]),
    )
    content = content_of(known, tmp_path)
    assert [(row["requirement"], row["hazard"]) for row in content["matrix"]] == [
        ("R1", ""),
        ("R2", ""),
    ]
    assert content["orphans"]["hazards"] == ["HAZ-1 (The robot hits something) has no requirement"]
    assert content["orphans"]["requirements"] == [
        "the parents of R1 lead to no hazard",
        "the parents of R2 lead to no hazard",
    ]


def test_every_missing_link_is_listed(tmp_path: Path) -> None:
    known = project(
        tmp_path,
        R1,
        requirement("R2", ALWAYS, parents=[]),
        requirement("R3", ALWAYS, parents=["HAZ-7"]),
        requirement("R4", ALWAYS, parents=["HAZ-3"], status="retired"),
        hazards=f'{HAZARDS}[HAZ-2]\ntitle = "Fire"\n[HAZ-3]\ntitle = "Flood"\n',
    )
    stranger = result(known, "satisfied", "R9")
    report = report_of(known, tmp_path, result(known, "satisfied"), stranger)
    assert as_json(report)["orphans"] == {
        "hazards": [
            "HAZ-2 (Fire) has no requirement",
            "HAZ-3 (Flood) has only retired requirements",
        ],
        "requirements": ["R2 names no parent"],
        "parents": ["R3 names HAZ-7, which is not declared"],
        "evidence": ["R9 has evidence, but is not among the requirements"],
    }
    assert "2 hazards have no requirement in force." in as_json(report)["overall"]["sentences"]
    (warning,) = report.diagnostics
    assert (warning.code, warning.severity) == (Code.STALE_EVIDENCE, Severity.WARNING)
    assert warning.message == "there is evidence for R9, which is not among the requirements"


def test_a_row_counts_the_runs_that_have_its_verdict(tmp_path: Path) -> None:
    known = project(tmp_path)
    runs = [result(known, "satisfied", run=f"{i}.mcap") for i in range(20)]
    bad = [result(known, "vacuous", run=f"bad{i}.mcap", triggers=[]) for i in range(2)]
    (row,) = content_of(known, tmp_path, *runs[:10], *bad, *runs[10:])["matrix"]
    assert (row["mark"]["word"], row["runs"]) == ("vacuous", 2)


def test_without_hazards_the_requirements_are_still_in_the_matrix(tmp_path: Path) -> None:
    known = project(tmp_path, hazards=None)
    content = content_of(known, tmp_path)
    assert [(row["hazard"], row["requirement"]) for row in content["matrix"]] == [("", "R1")]
    assert content["orphans"]["parents"] == ["R1 names HAZ-1, which is not declared"]


def shown(known: Project, folder: Path, *results: Mapping[str, Any]) -> list[Any] | None:
    """What the matrix and the section of R1 say of situations."""
    content = content_of(known, folder, *results)
    (row,) = content["matrix"]
    (section,) = content["requirements"]
    assert row["situations"] == section["situations"]
    return row["situations"] and [*row["situations"].values()]


def situations(*seen: str, perhaps: str = "") -> dict[str, Any]:
    return {
        "seen": dict.fromkeys(seen, moment(1)),
        "perhaps": {perhaps: moment(2)} if perhaps else {},
    }


def test_a_row_says_which_situations_current_results_have_shown(tmp_path: Path) -> None:
    known = project(tmp_path)
    late = result(known, "satisfied", run="a", situations=situations("late", perhaps="at-once"))
    old = result(
        known, "satisfied", run="b", situations=situations("at-once"), hashes={"bindings": "0" * 64}
    )
    one = ["1/3", "1 of 3 situations seen", ["at-once <b>it</b>"], ["while-open <b>it</b>"]]
    none = ["", "situations not measured", [], []]
    assert shown(known, tmp_path, late, old) == one
    assert shown(known, tmp_path, old) == none
    assert shown(known, tmp_path, result(known, "satisfied")) == none
    assert shown(known, tmp_path) is None


def test_the_words_of_a_strangers_evidence_are_text_in_the_page(tmp_path: Path) -> None:
    known = project(tmp_path)
    page = report_of(
        known, tmp_path, result(known, "satisfied", situations=situations("late"))
    ).html
    assert page is not None
    assert "1 of 3 situations seen" in page
    assert "&lt;b&gt;it" in page
    assert "<b>it" not in page
