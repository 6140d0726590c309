"""What the report says of reviews, changes, waivers, and how far each requirement has come."""

from pathlib import Path
from typing import Any

import pytest

from compiler.project.project import Project
from fretc.report.make import make
from fretish.diagnostics.diagnostic import Code
from tests.fretc.report.cases import (
    BINDINGS,
    R1,
    as_json,
    project,
    requirement,
    result,
    violation,
    write_evidence,
    write_lock,
)

WAIVER = """\
[R1]
verdict = "violated"
reason = "the brake is being replaced"
by = "A. Meier"
role = "safety engineer"
granted = "2026-01-01"
expires = "2026-12-31"
"""


@pytest.fixture(autouse=True)
def _day(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")  # 2026-09-21


def lock(known: Project, folder: Path) -> None:
    """Everything as it is now, accepted; the evidence is in the folder."""
    write_lock(known, folder, str(folder / "evidence.json"), "2026-09-01")


def reported(known: Project, folder: Path, *results: dict[str, Any]) -> dict[str, Any]:
    """The report about these results, with the lock and the waivers of the folder."""
    audited = write_evidence(known, folder, *results)
    paths = [folder / name for name in ("fretc.lock", "waivers.toml")]
    locked, waived = [str(path) if path.exists() else None for path in paths]
    return as_json(make(known, audited, lock=locked, waivers=waived))


def only(report: dict[str, Any]) -> dict[str, Any]:
    (view,) = report["requirements"]
    assert isinstance(view, dict)
    return view


def test_a_review_that_stands_is_named(tmp_path: Path) -> None:
    known = project(tmp_path)
    reported(known, tmp_path, result(known, "satisfied"))
    lock(known, tmp_path)
    report = reported(known, tmp_path, result(known, "satisfied"))
    assert report["reviewed"] == (
        "1 of 1 requirement reviewed, all reviews are current. 1 of 1 is unauthenticated."
    )
    assert only(report)["review"] == {
        "mark": {"word": "reviewed", "glyph": "◔", "kind": "inconclusive", "suspect": False},
        "by": "A, B, 2026-09-01",
        "comment": "c",
        "changes": [],
        "signature": {
            "mark": {
                "word": "unauthenticated",
                "glyph": "◔",
                "kind": "inconclusive",
                "suspect": False,
            },
            "text": "nobody signed it",
            "is_good": False,
        },
    }
    assert report["changes"] == []
    assert only(report)["coverage"] == "exercised and shown"


def test_what_changed_since_the_review_makes_the_requirement_suspect(tmp_path: Path) -> None:
    known = project(tmp_path)
    reported(known, tmp_path, result(known, "satisfied"))
    lock(known, tmp_path)
    now = project(tmp_path, bindings=BINDINGS.replace("clearance < 5 cm", "clearance < 90 cm"))
    report = reported(now, tmp_path, result(now, "satisfied"))  # audited again after the change
    view = only(report)
    assert (view["mark"]["word"], view["mark"]["suspect"]) == ("satisfied", True)
    assert view["coverage"] == "suspect"
    text = "near: clearance < 5 cm → 90 cm"
    why = f"something has changed since the review of 2026-09-01: {text}"
    assert view["suspicions"] == view["results"][0]["suspicions"] == view["reasons"] == [why]
    assert report["requirements"][0]["results"][0]["mark"]["suspect"]
    assert report["matrix"][0]["review"]["word"] == "changed since the review"
    assert [c["results"] for c in report["counts"] if c["mark"]["word"] == "satisfied"] == [1, 0]
    assert view["review"]["changes"] == [text]
    (change,) = report["changes"]
    assert change["lines"] == [text]
    assert change["suspicion"] == "2 links are suspect: near changed"
    (group,) = report["change_groups"]
    assert group["change"] == change["texts"][0]
    assert group["change"]["segments"] == [
        ["same", "clearance < "],
        ["before", "5 cm"],
        ["after", "90 cm"],
    ]
    assert (group["requirements"], group["links"]) == ([["R1", "req-R1"]], 2)
    assert f"Changed since the review: R1: {text}." in report["overall"]["sentences"]
    assert report["overall"]["mark"]["word"] == "nothing shown"
    assert (
        "1 of these reviews is suspect: the requirement or a result changed since"
        in report["reviewed"]
    )


def test_a_run_after_the_review_is_reported_and_makes_nothing_suspect(tmp_path: Path) -> None:
    known = project(tmp_path)
    reported(known, tmp_path, result(known, "satisfied"))
    lock(known, tmp_path)
    later = result(known, "satisfied", run="logs/b.mcap", hashes={"log": "cd" * 32})
    report = reported(known, tmp_path, result(known, "satisfied"), later)
    assert only(report)["mark"]["word"] == "satisfied"
    assert "R1 was audited against 1 run after its review." in report["reservations"]


def test_a_violation_is_reported_whatever_the_review_says(tmp_path: Path) -> None:
    known = project(tmp_path)
    reported(known, tmp_path, result(known, "satisfied"))
    lock(known, tmp_path)
    broken = result(known, "violated", violations=[violation(14, 20, 11)])
    report = reported(known, tmp_path, broken)
    assert only(report)["mark"]["word"] == "violated"
    (change,) = report["changes"]
    assert change["verdicts"] == [["logs/a.mcap", "satisfied", "violated"]]


def test_a_waiver_covers_a_verdict_and_does_not_hide_it(tmp_path: Path) -> None:
    known = project(tmp_path)
    (tmp_path / "waivers.toml").write_text(WAIVER)
    broken = result(known, "violated", violations=[violation(14, 20, 11)])
    report = reported(known, tmp_path, broken)
    view = only(report)
    assert (view["mark"]["word"], view["coverage"]) == ("waived", "waived")
    assert view["waiver"]["covers"]["word"] == "violated"
    assert view["waiver"]["by"] == "A. Meier, safety engineer, 2026-01-01"
    assert report["waivers"] == [view["waiver"]]
    assert (
        "1 requirement is waived, and not shown: Stop when something is near (R1): violated."
        in report["overall"]["sentences"]
    )
    assert report["overall"]["mark"]["word"] == "nothing shown"


def test_a_waiver_of_what_is_shown_covers_nothing(tmp_path: Path) -> None:
    known = project(tmp_path)
    (tmp_path / "waivers.toml").write_text(WAIVER)
    assert (
        only(reported(known, tmp_path, result(known, "satisfied")))["mark"]["word"] == "satisfied"
    )


@pytest.mark.slow
@pytest.mark.parametrize("verdict", ["no data", "inconclusive", "vacuous", "violated"])
@pytest.mark.parametrize("waived", ["no data", "inconclusive", "vacuous", "violated"])
def test_a_waiver_covers_the_verdict_that_it_names_and_no_other(
    tmp_path: Path, verdict: str, waived: str
) -> None:
    known = project(tmp_path)
    (tmp_path / "waivers.toml").write_text(WAIVER.replace("violated", waived))
    broken = [violation(14, 20, 11)] if verdict == "violated" else []
    audited = write_evidence(known, tmp_path, result(known, verdict, violations=broken))
    build = make(known, audited, waivers=str(tmp_path / "waivers.toml"))
    idle = [d.message for d in build.diagnostics if d.code is Code.IDLE_WAIVER]
    if verdict == waived:
        assert (only(as_json(build))["mark"]["word"], idle) == ("waived", [])
    else:
        assert only(as_json(build))["mark"]["word"] == verdict
        assert idle == [
            f"the waiver of R1 is for `{waived}`, but the verdict is `{verdict}`: the waiver has "
            "no effect"
        ]


def test_a_waiver_that_has_ended_covers_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")  # 2027-01-15
    known = project(tmp_path)
    (tmp_path / "waivers.toml").write_text(WAIVER)
    assert only(reported(known, tmp_path, result(known, "vacuous")))["mark"]["word"] == "vacuous"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "verdict", "state"),
    [
        (R1, "satisfied", "exercised and shown"),
        (R1, "violated", "exercised and violated"),
        (R1, "vacuous", "not exercised"),
        (R1, "inconclusive", "exercised, not decided"),
        (R1, "no data", "exercised, not decided"),
        (R1, None, "not exercised"),
        (R1.replace("eventually satisfy stopped", "eventually satisfy gone"), None, "unbound"),
        (R1.replace("shall eventually", "shal eventually"), None, "unformalized"),
        (R1.replace('"approved"', '"retired"'), None, "retired"),
        (
            requirement("R1", f"whenever {70 * '!'}near the robot shall satisfy stopped"),
            None,
            "not generated",
        ),
    ],
)
def test_how_far_a_requirement_has_come(
    tmp_path: Path, text: str, verdict: str | None, state: str
) -> None:
    known = project(tmp_path, text)
    broken = [violation(14, 20, 11)] if verdict == "violated" else []
    asked: dict[str, Any] = {"triggers": [], "latencies_s": []} if verdict == "vacuous" else {}
    results = [result(known, verdict, violations=broken, **asked)] if verdict else []
    assert only(reported(known, tmp_path, *results))["coverage"] == state


def test_two_reports_of_one_state_are_the_same_bytes(tmp_path: Path) -> None:
    known = project(tmp_path)
    (tmp_path / "waivers.toml").write_text(WAIVER)
    reported(known, tmp_path, result(known, "vacuous"))
    lock(known, tmp_path)
    path = str(tmp_path / "evidence.json")
    first, second = (make(known, path, lock=str(tmp_path / "fretc.lock")) for _ in range(2))
    assert (first.html, first.json) == (second.html, second.json)


def test_where_nothing_is_reviewed_the_summary_says_so(tmp_path: Path) -> None:
    known = project(tmp_path)
    report = reported(known, tmp_path, result(known, "satisfied"))
    assert "No requirement has been reviewed." in str(report)


def test_new_violations_since_the_review_are_counted(tmp_path: Path) -> None:
    known = project(tmp_path)
    reported(known, tmp_path, result(known, "satisfied"))
    lock(known, tmp_path)
    assert "new since the review" not in str(reported(known, tmp_path, result(known, "satisfied")))
    broken = result(known, "violated", violations=[violation(1, 2)])
    assert "1 violation is new since the review." in str(reported(known, tmp_path, broken))
