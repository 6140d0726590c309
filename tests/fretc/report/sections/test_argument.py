"""What the argument rests on, and what stands against it."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from compiler.project.project import Project
from fretc.report.forms.gsn import gsn
from fretc.report.make import make
from fretc.report.model.views import ReportView
from fretc.report.sections.argument import Element, argument
from tests.fretc.report.cases import (
    BINDINGS,
    HAZARDS,
    moment,
    project,
    requirement,
    result,
    violation,
    write_evidence,
)
from tests.fretc.report.forms.test_forms import complaints
from tests.fretc.report.sections.test_proofs import proof

SENTENCE = "whenever near the robot shall within 30 ticks satisfy stopped"
R1 = requirement("R1", SENTENCE)
CLAIM = "the monitor means what the sentence says (by fretc)"


def reported(
    known: Project, folder: Path, *results: Mapping[str, Any], proofs: Any = None
) -> ReportView:
    """The report, with an argument that every requirement of gsn2x lets pass."""
    path = folder / "verification.json"
    if proofs is not None:
        document = {"schema": "fretc-verification-1", "fretc": "0.1.0", "evidence": proofs}
        path.write_text(json.dumps(document), "utf-8")
    waivers = folder / "waivers.toml"
    report = make(
        known,
        write_evidence(known, folder, *results),
        waivers=str(waivers) if waivers.exists() else None,
        verification=str(path) if proofs is not None else None,
    ).report
    assert report is not None
    assert complaints(yaml.safe_load(gsn(report))) == []
    return report


def elements(report: ReportView) -> dict[str, Element]:
    return {each.id: each for each in argument(report)}


def run(known: Project, number: int, verdict: str, **changes: Any) -> dict[str, Any]:
    """One of several runs, each of a log of its own."""
    broken = [violation(14, 20, 11)] * changes.pop("times", 1) if verdict == "violated" else []
    hashes = {"log": f"{number:064x}", **changes.pop("hashes", {})}
    return result(known, verdict, run=f"{number}.mcap", violations=broken, hashes=hashes, **changes)


def test_a_violated_goal_is_challenged_by_the_runs_that_violate_it_the_worst_first(
    tmp_path: Path,
) -> None:
    known = project(tmp_path, R1)
    runs = [
        run(known, 1, "satisfied"),
        run(known, 2, "violated", times=1, reason="once"),
        run(known, 3, "violated", times=5, reason="five times"),
    ]
    by_id = elements(reported(known, tmp_path, *runs))
    goal, against = by_id["G_req_2d_R1"], by_id["CSn_req_2d_R1"]
    assert (goal.defeated, goal.undeveloped, goal.supported_by) == (True, True, ())
    assert against.challenges == goal.id
    assert against.text == (
        "R1 is violated in 2 of 3 audited runs: 3.mcap: five times; 2.mcap: once"
    )


def test_of_many_violating_runs_the_others_are_counted(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    runs = [run(known, number, "violated") for number in range(1, 10)]
    text = elements(reported(known, tmp_path, *runs))["CSn_req_2d_R1"].text
    assert text.startswith("R1 is violated in 9 of 9 audited runs: ")
    assert text.endswith("; and 6 more runs")


def test_counter_evidence_of_an_older_text_challenges_and_does_not_defeat(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    old = run(known, 1, "violated", hashes={"bindings": "0" * 64}, reason="once")
    by_id = elements(reported(known, tmp_path, old))
    assert not by_id["G_req_2d_R1"].defeated
    assert by_id["CSn_req_2d_R1_older"].challenges == "G_req_2d_R1"
    assert by_id["CSn_req_2d_R1_older"].text == (
        "R1 is violated in 1 of 1 audited run, before a change (the bindings have changed since "
        "the audit): 1.mcap: once"
    )


def test_a_waiver_hides_no_counter_evidence(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    (tmp_path / "waivers.toml").write_text(
        '[R1]\nverdict = "violated"\nreason = "later"\nby = "A"\nrole = "B"\n'
        'granted = "2000-01-01"\nexpires = "2099-01-01"\n'
    )
    by_id = elements(reported(known, tmp_path, run(known, 1, "violated")))
    assert by_id["G_req_2d_R1"].defeated
    assert by_id["G_req_2d_R1"].in_context_of == ("C_req_2d_R1", "J_req_2d_R1")
    assert "CSn_req_2d_R1" in by_id


@pytest.mark.parametrize("verdict", ["inconclusive", "vacuous", "no data"])
def test_what_shows_nothing_is_no_evidence_against(tmp_path: Path, verdict: str) -> None:
    known = project(tmp_path, R1)
    by_id = elements(reported(known, tmp_path, run(known, 1, "satisfied"), run(known, 2, verdict)))
    assert by_id["G_req_2d_R1"].undeveloped
    assert not [each for each in by_id.values() if each.challenges or each.defeated]
    assert not [id for id in by_id if id.startswith("Sn")]


def test_a_requirement_with_two_hazards_stands_under_both(tmp_path: Path) -> None:
    hazards = f'{HAZARDS}\n[HAZ-2]\ntitle = "The robot stays"\ntext = "x"\n'
    text = requirement("R1", SENTENCE, parents=["HAZ-1", "HAZ-2"])
    known = project(tmp_path, text, hazards=hazards)
    by_id = elements(reported(known, tmp_path, run(known, 1, "satisfied")))
    goals = [by_id[f"G_hazard_HAZ_2d_{number}"] for number in (1, 2)]
    assert [goal.supported_by for goal in goals] == [("G_req_2d_R1",)] * 2
    assert by_id["G_req_2d_R1"].name == "R1 holds"


def test_runs_support_the_requirement_and_a_proof_what_it_is_about(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    loop: dict[str, Any] = {
        "layer": "loop",
        "claim": "the loop keeps R1",
        "assumptions": ["a latency of 1 tick"],
    }
    lines = [proof(known), proof(known, **loop)]
    by_id = elements(reported(known, tmp_path, run(known, 1, "satisfied"), proofs=lines))
    goal = by_id["G_req_2d_R1"]
    assert goal.supported_by == ("Sn_req_2d_R1", "G_req_2d_R1_monitor", "G_req_2d_R1_loop")
    support = {id: (by_id[id].text, by_id[id].supported_by) for id in goal.supported_by}
    assert support == {
        "Sn_req_2d_R1": ("R1 is satisfied in 1 audited run", ()),
        "G_req_2d_R1_monitor": (
            "The monitor of R1 gives the verdicts that the sentence demands",
            ("Sn_req_2d_R1_monitor",),
        ),
        "G_req_2d_R1_loop": (
            "Monitor and interceptor satisfy R1 in the modelled loop",
            ("Sn_req_2d_R1_loop",),
        ),
    }
    assert by_id["Sn_req_2d_R1_monitor"].text == f"Proved: {CLAIM}"
    assert by_id["A_req_2d_R1_loop"].text == "a latency of 1 tick"
    assert by_id["G_req_2d_R1_loop"].in_context_of == ("A_req_2d_R1_loop",)


def test_a_proof_about_the_monitor_shows_nothing_of_the_robot(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    by_id = elements(reported(known, tmp_path, proofs=[proof(known)]))
    goal = by_id["G_req_2d_R1"]
    assert goal.supported_by == ("G_req_2d_R1_runs", "G_req_2d_R1_monitor")
    assert by_id["G_req_2d_R1_runs"].text == "The audited runs show R1"
    assert by_id["G_req_2d_R1_runs"].undeveloped


def test_claims_of_one_layer_are_proved_refuted_and_left_open_apart(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    lines = [
        proof(known),
        proof(known, "counterexample", claim="it is quick"),
        proof(known, "not checked", claim="it is small"),
    ]
    by_id = elements(reported(known, tmp_path, run(known, 1, "satisfied"), proofs=lines))
    goal = by_id["G_req_2d_R1_monitor"]
    assert goal.defeated
    assert goal.supported_by == ("Sn_req_2d_R1_monitor", "G_req_2d_R1_monitor_rest")
    assert by_id["CSn_req_2d_R1_monitor"].text == "Counterexample to it is quick (by fretc)"
    assert by_id["G_req_2d_R1_monitor_rest"].text == "Not shown: it is small (by fretc)"
    assert by_id["G_req_2d_R1_monitor_rest"].undeveloped


@pytest.mark.parametrize("result", ["proved", "counterexample"])
def test_a_proof_of_another_text_neither_supports_nor_defeats(tmp_path: Path, result: str) -> None:
    known = project(tmp_path, R1)
    lines = [proof(known, result, artefacts={"r1_monitor.py": "0" * 64})]
    by_id = elements(reported(known, tmp_path, run(known, 1, "satisfied"), proofs=lines))
    goal = by_id["G_req_2d_R1_monitor"]
    assert (goal.undeveloped, goal.defeated, goal.supported_by) == (True, False, ())
    assert ("CSn_req_2d_R1_monitor" in by_id) is (result == "counterexample")


def test_what_all_requirements_share_stands_below_the_top_and_those_that_plan_it(
    tmp_path: Path,
) -> None:
    known = project(tmp_path, requirement("R1", SENTENCE, verify=["audit", "interceptor"]))
    line = proof(
        known, requirement="interceptor", layer="interceptor", claim="it stops", artefacts={}
    )
    by_id = elements(reported(known, tmp_path, run(known, 1, "satisfied"), proofs=[line]))
    assert by_id["G_top"].supported_by == ("S_hazards", "G_shared_interceptor")
    assert by_id["G_req_2d_R1"].supported_by == ("Sn_req_2d_R1", "G_shared_interceptor")
    assert by_id["G_shared_interceptor"].text == "The interceptor fulfils its contracts"
    assert by_id["Sn_shared_interceptor"].text == "Proved: it stops (by fretc)"


UNVIOLABLE = requirement("R1", "whenever near the robot shall eventually satisfy stopped")
LIMIT = (
    "No run can violate R1: it sets no bound, so an answer that has not come may always come later."
)


@pytest.mark.parametrize(
    ("text", "end", "limit"),
    [(UNVIOLABLE, "inconclusive", LIMIT), (UNVIOLABLE, "violated", ""), (R1, "inconclusive", "")],
)
def test_where_no_run_can_violate_it_satisfied_says_so(
    tmp_path: Path, text: str, end: str, limit: str
) -> None:
    bindings = BINDINGS.replace('end = "inconclusive"', f'end = "{end}"')
    known = project(tmp_path, text, bindings=bindings)
    report = reported(known, tmp_path, run(known, 1, "satisfied", triggers=[moment(3)]))
    (view,) = report.requirements
    assert (view.mark.word, view.limit, report.matrix[0].limit) == ("satisfied", limit, limit)
    (solution,) = [each for id, each in elements(report).items() if id.startswith("Sn")]
    assert solution.text == f"R1 is satisfied in 1 audited run{f'. {limit}' if limit else ''}"
    assert (limit in report.reservations) is bool(limit)
