"""The headline: what is violated, what is out of date, and which change made it so."""

from pathlib import Path
from typing import Any

import pytest

from compiler.project.project import Project
from tests.fretc.report.cases import BINDINGS as DECLARED
from tests.fretc.report.cases import R1, content_of, project, requirement, result, violation

ALWAYS = "the robot shall always satisfy stopped"
OLD = {"bindings": "0" * 64}
OTHER = {"sentence": "0" * 64}


def red(known: Project, id: str, **changes: Any) -> dict[str, Any]:
    return result(known, "violated", id, violations=[violation(1, 2)], **changes)


def overall(folder: Path, *cases: tuple[str, dict[str, str]]) -> dict[str, Any]:
    """Of R1, R2, ...: the verdict of each, and which hashes are not those of now."""
    texts = [requirement(f"R{n}", ALWAYS) for n, _ in enumerate(cases, 1)]
    known = project(folder, *texts)
    results = [
        result(known, word, f"R{n}", hashes=hashes)
        if word != "violated"
        else red(known, f"R{n}", hashes=hashes)
        for n, (word, hashes) in enumerate(cases, 1)
    ]
    outcome: dict[str, Any] = content_of(known, folder, *results)["overall"]
    return outcome


T1, T2, T3 = (f"Title of R{n} (R{n})" for n in (1, 2, 3))
NAME = "Stop when something is near (R1)"
BINDINGS = "the bindings have changed since the audit"
SENTENCE = "the sentence has changed since the audit"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cases", "headline", "suspect"),
    [
        ([("violated", {})], f"{T1} is violated.", False),
        ([("violated", OLD)], f"{T1} was violated, and {BINDINGS}.", True),
        ([("violated", {})] * 2, f"{T1} and {T2} are violated.", False),
        ([("violated", OLD)] * 2, f"{T1} and {T2} were violated, and {BINDINGS}.", True),
        (
            [("violated", OLD), ("violated", {}), ("violated", OTHER)],
            f"{T2} is violated; {T1} was violated, and {BINDINGS}; "
            f"{T3} was violated, and {SENTENCE}.",
            False,
        ),
        ([("violated", {}), ("satisfied", OLD)], f"{T1} is violated.", False),
        (
            [("satisfied", OLD), ("vacuous", {})],
            f"None of the claimed requirements is shown: {T1} was satisfied, and {BINDINGS}.",
            False,
        ),
        (
            [("satisfied", {}), ("satisfied", OLD), ("vacuous", OTHER)],
            f"Not all claimed requirements are shown: {T3} was vacuous, and {SENTENCE}; "
            f"{T2} was satisfied, and {BINDINGS}.",
            False,
        ),
        (
            [("satisfied", {**OLD, **OTHER})],
            f"None of the claimed requirements is shown: {T1} was satisfied, "
            f"and {SENTENCE} and {BINDINGS}.",
            False,
        ),
    ],
)
def test_it_says_what_is_violated_what_is_stale_and_why(
    tmp_path: Path, cases: list[tuple[str, dict[str, str]]], headline: str, suspect: bool
) -> None:
    outcome = overall(tmp_path, *cases)
    assert outcome["headline"] == headline
    assert outcome["mark"]["suspect"] is suspect


def test_beside_a_violation_what_else_is_stale_comes_next(tmp_path: Path) -> None:
    outcome = overall(tmp_path, ("violated", {}), ("satisfied", OLD))
    assert outcome["sentences"][0] == f"{T2} was satisfied, and {BINDINGS}."


def test_red_stays_red_where_the_sentence_cannot_be_read_any_more(tmp_path: Path) -> None:
    before = project(tmp_path)
    broken = red(before, "R1")
    now = project(tmp_path, R1.replace("eventually", "evntually"))
    content = content_of(now, tmp_path, broken)
    assert content["overall"]["headline"] == (
        f"{NAME} was violated, "
        "and the sentence could be formalized at the audit, but cannot be formalized now."
    )
    assert content["requirements"][0]["reasons"][0].startswith("a: violated, ")
    assert content["requirements"][0]["reasons"][1].startswith("F107: ")


def test_a_sentence_that_could_never_be_read_is_not_called_one_that_could_be(
    tmp_path: Path,
) -> None:
    known = project(tmp_path, R1.replace("eventually", "evntually"))
    content = content_of(known, tmp_path, red(known, "R1"))
    assert content["overall"]["headline"] == (
        f"{NAME} was violated, and the sentence cannot be formalized now, and could not be "
        "formalized at the audit."
    )


def test_one_current_violation_is_enough_for_a_current_verdict(tmp_path: Path) -> None:
    known = project(tmp_path)
    old = red(known, "R1", run="old.mcap", hashes=OLD)
    content = content_of(known, tmp_path, old, red(known, "R1", run="new.mcap"))
    assert content["overall"]["headline"] == f"{NAME} is violated."
    assert [reason.split(",")[0] for reason in content["requirements"][0]["reasons"]] == [
        "new: violated",
        "old: violated",
    ]


def test_a_new_good_run_of_another_log_does_not_hide_an_old_violation(tmp_path: Path) -> None:
    known = project(tmp_path)
    old = red(known, "R1", run="old.mcap", hashes=OLD)
    content = content_of(known, tmp_path, old, result(known, "satisfied", run="new.mcap"))
    assert content["overall"]["headline"] == f"{NAME} was violated, and {BINDINGS}."


def test_runs_with_errors_come_first_and_are_named(tmp_path: Path) -> None:
    known = project(tmp_path)
    kinds = [("F401", "note"), ("F405", "error"), ("F402", "warning")]
    findings = [
        {"code": code, "severity": kind, "message": "m", "file": "f", "line": 1, "column": 1}
        | {"help": None}
        for code, kind in kinds
    ]
    good = result(known, "satisfied", run="a.mcap")
    wrong = result(known, "no data", run="b.mcap", health={"findings": findings})
    content = content_of(known, tmp_path, good, wrong)
    assert [run["file"] for run in content["runs"]] == ["b.mcap", "a.mcap"]
    assert [finding["code"] for finding in content["runs"][0]["findings"]] == [
        "F405",
        "F402",
        "F401",
    ]
    sentences = content["overall"]["sentences"]
    assert "b (F405) has an error: read them before the verdicts." in sentences
    other = result(known, "no data", run="c.mcap", health={"findings": findings})
    sentences = content_of(known, tmp_path, wrong, other)["overall"]["sentences"]
    assert any(each.endswith("have errors: read them before the verdicts.") for each in sentences)


def test_values_are_in_the_declared_unit_and_bounds_are_exact(tmp_path: Path) -> None:
    known = project(tmp_path, bindings=DECLARED.replace('unit = "m/s"', 'unit = "km/h"'))
    broken = red(known, "R1", thresholds=[near(5 / 3.6, 4.99999999 / 3.6)])
    broken["violations"][0]["values"] = {"vx": 4.99999999 / 3.6}
    content = content_of(known, tmp_path, broken)
    (view,) = content["requirements"][0]["results"]
    assert view["violations"][0]["values"] == [["vx", "4.99999999 km/h"]]
    (threshold,) = view["thresholds"]
    assert threshold["comparison"] == "vx < 5 km/h"
    assert threshold["values"] == "0 km/h to 4.99999999 km/h"


def near(bound: float, greatest: float) -> dict[str, Any]:
    return {
        "proposition": "stopped",
        "signal": "vx",
        "operator": "<",
        "bound": bound,
        "unit": "m/s",
        "least": 0.0,
        "greatest": greatest,
        "comparison": "true",
        "margin": 0.0,
        "nearest": None,
    }
