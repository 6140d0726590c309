"""`fretc lock`, `diff` and `check` of requirements that were analyzed together."""

import json
from pathlib import Path

import pytest

from tests.command import Fretc, made_once, write

BY = ("--reviewer", "A. Meier", "--role", "safety engineer", "--comment", "looked at it")
SENTENCES = {
    "R1": "whenever start the line shall within 2 ticks satisfy run",
    "R2": "upon stop the line shall for 3 ticks satisfy !run",
    "R3": "whenever start the line shall immediately satisfy lamp",
}
ROLES = {"start": "input", "stop": "input", "run": "output", "lamp": "output", "bell": "output"}
ASSUMED = "the operator shall never satisfy start & stop"


def project(assumed: str = ASSUMED, **sentences: str) -> None:
    """The three requirements, but for those that have another sentence."""
    for id, sentence in (SENTENCES | sentences).items():
        write(f"requirements/{id}.fret", f'+++\nid = "{id}"\n+++\n{sentence}\n')
    tables = "".join(f'[variable.{name}]\nrole = "{role}"\n' for name, role in ROLES.items())
    promise = f'[[assume.requirement]]\nid = "A1"\nsentence = "{assumed}"\n' if assumed else ""
    write("requirements/bindings.toml", f'[clock]\ntick = "100 ms"\n{tables}{promise}')


@pytest.fixture
def locked(fretc: Fretc) -> Fretc:
    """R1 and R2 conflict, R3 is apart, and all of that was accepted."""

    def make() -> None:
        project()
        assert fretc("analyze", "requirements").status == 1
        assert fretc("lock", *BY, "--accept-violations").status == 0
        assert fretc("diff").status == 0

    made_once("a set that was reviewed", make)
    return fretc


def suspect(fretc: Fretc) -> dict[str, list[str]]:
    """Each requirement whose analysis is suspect → because of what."""
    found = json.loads(fretc("diff", "--format", "json").out)
    return {
        each["requirement"]: sorted(
            {
                cause
                for link in each["suspect_links"]
                if link["to"] == f"analysis:{each['requirement']}"
                for cause in link["because_of"]
            }
        )
        for each in found
        if any(link["from"].startswith("analysis:") for link in each["suspect_links"])
    }


@pytest.mark.slow
def test_a_conflict_is_accepted_by_its_name_only_and_stays_red(fretc: Fretc) -> None:
    project()
    assert fretc("analyze", "requirements").status == 1
    run = fretc("lock", *BY)
    assert run.status == 2
    fight = f"unrealizable with the others (conflict of R1, R2; assumed A1: {ASSUMED})"
    assert f"F529 R1 is {fight}\n" in run.err
    assert "R3" not in run.err
    assert not Path("requirements/fretc.lock").exists()
    run = fretc("lock", *BY, "--accept-violations")
    assert run.status == 0
    assert f"accepted R2: not audited in any run; {fight}\n" in run.err
    assert "accepted R3: not audited in any run; realizable with the others" in run.err
    assert "0 violated, 3 not shown, 2 unrealizable with the others\n" in run.err
    assert "F561" in fretc("check", "--analyze").err
    fretc("report", "-o", "build/report.json", "--format", "json")
    overall = json.loads(Path("build/report.json").read_text())["overall"]
    assert overall["mark"]["word"] == "cannot be satisfied together"


@pytest.mark.slow
def test_an_accepted_question_without_an_answer_is_visible(fretc: Fretc) -> None:
    project("", R3="whenever start the line shall immediately satisfy persists(2, lamp)")
    fretc("analyze", "requirements")
    run = fretc("lock", "R3", *BY)
    assert run.status == 0
    assert "accepted R3: not audited in any run; not checked with the others\n" in run.err
    assert run.err.endswith("1 not shown, 1 not checked with the others\n")
    json_ = json.loads(fretc("lock", "R3", *BY, "--format", "json").out)
    assert json_["together"] == {"R3": ["not checked"]}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "because"),
    [
        ({"R2": "upon stop the line shall for 4 ticks satisfy !run"}, {"R1": ["member:R2"]}),
        ({"R3": "whenever stop the line shall immediately satisfy lamp"}, {}),
        ({"R9": "whenever stop the line shall immediately satisfy bell"}, {}),
        (
            {"R9": "the line shall always satisfy lamp | run"},
            {"R1": ["member:R9"], "R2": ["member:R9"], "R3": ["member:R9"]},
        ),
        (
            {"assumed": "the operator shall never satisfy start"},
            {"R1": ["member:A1"], "R2": ["member:A1"], "R3": ["member:A1"]},
        ),
    ],
)
def test_a_change_of_a_member_makes_the_analysis_suspect(
    locked: Fretc, change: dict[str, str], because: dict[str, list[str]]
) -> None:
    project(**change)
    found = suspect(locked)
    assert {id: causes for id, causes in found.items() if id not in change} == because
    run = locked("diff")
    if because:
        assert "is from before the change: analyze again" in run.out
        assert "F541" in locked("lock", *BY, "--accept-violations").err
    locked("analyze", "requirements")
    assert not [each for causes in suspect(locked).values() for each in causes if "member" in each]


def test_a_requirement_that_went_makes_the_analysis_suspect(locked: Fretc) -> None:
    Path("requirements/R2.fret").unlink()
    assert suspect(locked) == {"R1": ["member:R2"]}


@pytest.mark.slow
def test_another_answer_has_a_before_and_an_after(locked: Fretc) -> None:
    project(R2="upon stop the line shall for 0 ticks satisfy !run", assumed="")
    assert locked("analyze", "requirements").status == 0
    run = locked("diff")
    assert "  analysis: unrealizable → realizable\n" in run.out
    assert "  findings of the analysis: conflict of R1, R2; assumed A1" in run.out
    assert "F512" in locked("check").err


def test_an_analysis_that_is_gone_is_told(locked: Fretc) -> None:
    Path("build/analysis.json").unlink()
    run = locked("diff")
    assert run.status == 3
    assert "analysis: unrealizable → none\n" in run.out


@pytest.mark.slow
def test_the_answer_to_another_question_is_another_answer(locked: Fretc) -> None:
    assert locked("analyze", "requirements", "--as-fret").status == 1
    run = locked("diff")
    assert run.status == 3
    assert "FRET's question" in run.out


def test_a_file_that_is_no_analysis_is_told(locked: Fretc) -> None:
    write("build/analysis.json", "{}")
    for command in (("lock", *BY), ("diff",), ("check",)):
        run = locked(*command)
        assert run.status == 2
        assert "F503 `build/analysis.json` is not what `fretc analyze` writes" in run.err


@pytest.mark.slow
def test_the_changed_requirement_is_named_and_not_those_that_are_analyzed_with_it(
    locked: Fretc,
) -> None:
    project(R2="upon stop the line shall for 4 ticks satisfy !run")
    locked("report", "-o", "build/report.json", "--format", "json")
    content = json.loads(Path("build/report.json").read_text())
    (changed,) = [figure for figure in content["front"]["figures"] if figure["name"] == "changed"]
    assert changed["count"] == 1
    assert changed["lines"][0]["text"].startswith("R2: sentence: ")
    assert [link["name"] for link in changed["lines"][1]["names"]] == ["R1"]
    assert [(one["requirement"], one["is_root"]) for one in content["changes"]] == [
        ("R2", True),
        ("R1", False),
    ]
