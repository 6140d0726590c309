"""Assumptions in an audit: judged like requirements, and shown apart from them."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.command import Fretc, untimed, write
from tests.fretc.logs import logs

BINDINGS = """\
[clock]
tick = "100 ms"
[signal.charge]
path = "/x.data"
unit = "%"
[proposition.charged]
expr = "charge > 5 %"
[proposition.some]
expr = "charge >= 0 %"
[proposition.full]
expr = "charge > 90 %"
"""
SOME = "the robot shall always satisfy some"
WORD = "assumption broken"


def requirement(id: str, sentence: str, kind: str = "assumption") -> None:
    write(f"requirements/{id}.fret", f'+++\nid = "{id}"\nkind = "{kind}"\n+++\n{sentence}\n')


@pytest.fixture
def robot(fretc: Fretc) -> Fretc:
    """A project about a percentage; its log has 0 % to 11 %, so that A1 does not hold."""
    requirement("R1", SOME, "requirement")
    requirement("A1", "the charger shall always satisfy charged")
    write("requirements/bindings.toml", BINDINGS)
    charges = [logs.number(i, 1000 * logs.S + i * 100 * logs.MS) for i in range(12)]
    logs.write(Path("run.mcap"), charges)
    return fretc


def test_a_broken_assumption_is_no_violation_and_not_lost(robot: Fretc) -> None:
    run = robot("audit", "run.mcap")
    assert run.status == 3
    assert f"  ! A1  {WORD}  " in run.out
    assert "worst: A1 (`the charger shall always satisfy charged`) assumption broken" in run.out
    assert "  demanded: charged; recorded: charge = 0 %\n" in run.out
    assert (
        "! The assumption A1 does not hold in run.mcap. The results of R1, which shares its "
        "signals, rest on it.\n"
    ) in run.out
    assert untimed(run.out).endswith("2 requirements: 1 assumption broken, 1 satisfied\n")


def test_a_violation_stays_one_beside_a_broken_assumption(robot: Fretc) -> None:
    requirement("R1", "the robot shall always satisfy full", "requirement")
    run = robot("audit", "run.mcap")
    assert run.status == 1
    assert untimed(run.out).endswith("2 requirements: 1 violated, 1 assumption broken\n")


def test_a_kept_assumption_is_satisfied(robot: Fretc) -> None:
    requirement("A1", SOME)
    run = robot("audit", "run.mcap")
    assert run.status == 0
    assert untimed(run.out).endswith("2 requirements: 2 satisfied\n")
    assert "rest on it" not in run.out


def test_every_output_says_it_apart(robot: Fretc) -> None:
    (suite,) = ElementTree.fromstring(robot("audit", "run.mcap", "--format", "junit").out)
    assert (suite.get("failures"), suite.get("errors"), suite.get("tests")) == ("0", "1", "2")
    sarif = json.loads(robot("audit", "run.mcap", "--format", "sarif").out)
    levels = {each["ruleId"]: each["level"] for each in sarif["runs"][0]["results"]}
    assert levels["A1"] == "warning"
    assert "::error" not in robot("audit", "run.mcap", "--format", "github").out
    table = robot("audit", "run.mcap", "--parquet", "runs.parquet")
    assert table.status == 3
    summary = robot("audit", "--summary", "runs.parquet", "--format", "json")
    assert summary.status == 3
    row = json.loads(summary.out)["by_requirement"][0]
    assert (row["requirement"], row["violated"], row["assumption_broken"]) == ("A1", 0, 1)
    assert f"! {WORD}" in robot("audit", "--summary", "runs.parquet").out


@pytest.mark.slow
def test_a_report_shows_it_and_a_change_of_kind_makes_it_a_violation(robot: Fretc) -> None:
    """The kind of the present project decides: evidence cannot hide a violation."""
    robot("audit", "run.mcap")
    run = robot("report", "--strict", "--format", "json")
    assert run.status == 3
    made = json.loads(run.out)
    words = {view["id"]: view["mark"]["word"] for view in made["requirements"]}
    assert words == {"A1": WORD, "R1": "satisfied"}
    assert "The assumption A1 does not hold in run.mcap." in " ".join(made["overall"]["sentences"])
    requirement("A1", "the charger shall always satisfy charged", "requirement")
    run = robot("report", "--strict", "--format", "json")
    assert run.status == 1
    words = {view["id"]: view["mark"]["word"] for view in json.loads(run.out)["requirements"]}
    assert words["A1"] == "violated"


@pytest.mark.slow
def test_a_store_a_trend_and_a_repeated_audit_agree(robot: Fretc) -> None:
    assert robot("audit", "run.mcap", "-o", "runs.store").status == 3
    assert robot("audit", "run.mcap", "-o", "runs.store").status == 3
    assert robot("verify-evidence", "runs.store").status == 0
    trends = robot("trends", "runs.store")
    assert trends.status != 1
    assert "violated" not in trends.out


def test_a_watch_gives_the_verdict_of_the_audit(robot: Fretc) -> None:
    write("requirements/bindings.toml", BINDINGS.replace("[signal", 'lateness = "0 s"\n[signal', 1))
    run = robot("watch", "run.mcap", "--on-violation", "touch ran")
    assert run.status == 3
    assert f"A1 {WORD}" in run.out
    assert not Path("ran").exists()
