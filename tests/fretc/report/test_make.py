import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest

from compiler.project.folder import load
from fretc.audit.many_logs import AuditOutcome, audit_logs
from fretc.audit.plan import Plan, planned
from fretc.report.make import make
from fretish.diagnostics.diagnostic import Code, Severity
from tests.fretc.report.cases import (
    BINDINGS,
    R1,
    as_html,
    as_json,
    content_of,
    evidence,
    moment,
    project,
    report_of,
    requirement,
    result,
    violation,
    word,
    words,
    write_evidence,
)
from tests.json_schemas import validate

TRACE = "traces/mission-seed15.mcap"


# Each verdict ----------------------------------------------------------------------------------

NAME = "Stop when something is near (R1)"
VERDICTS: list[tuple[str, dict[str, Any], str, str, str]] = [
    (
        "satisfied",
        {"triggers": [moment(10)], "latencies_s": [0.0]},
        "all shown",
        "All claimed requirements are shown.",
        f"The one requirement, {NAME}, held in the audited run.",
    ),
    (
        "violated",
        {"violations": [violation(14, 20, 11)], "latencies_s": []},
        "violated",
        f"{NAME} is violated.",
        f"The one requirement, {NAME}, was not shown to hold in the audited run.",
    ),
    (
        "inconclusive",
        {"open": [moment(90)], "latencies_s": []},
        "nothing shown",
        "None of the claimed requirements is shown.",
        f"The one requirement, {NAME}, was not shown to hold in the audited run.",
    ),
    (
        "vacuous",
        {"triggers": [], "latencies_s": []},
        "nothing shown",
        "None of the claimed requirements is shown.",
        f"The one requirement, {NAME}, was not shown to hold in the audited run.",
    ),
    (
        "no data",
        {"unknown": [[0, 99]], "triggers": [], "latencies_s": []},
        "nothing shown",
        "None of the claimed requirements is shown.",
        f"The one requirement, {NAME}, was not shown to hold in the audited run.",
    ),
]


UNVIOLABLE = (
    "No run can violate R1: it sets no bound, so an answer that has not come may always come later."
)


@pytest.mark.slow
@pytest.mark.parametrize(("verdict", "changes", "word", "headline", "sentence"), VERDICTS)
def test_each_verdict_has_its_overall_result(
    tmp_path: Path, verdict: str, changes: dict[str, Any], word: str, headline: str, sentence: str
) -> None:
    known = project(tmp_path)
    report = report_of(known, tmp_path, result(known, verdict, **changes))
    content = as_json(report)
    overall = content["overall"]
    assert (overall["mark"]["word"], overall["headline"]) == (word, headline)
    limit = [UNVIOLABLE] if verdict == "satisfied" else []
    assert overall["sentences"] == [sentence, *limit, "No damage was found in the run."]
    assert words(content["requirements"]) == [verdict]
    assert words(content["requirements"][0]["results"]) == [verdict]
    listed = {name: [line["requirement"] for line in content[name]] for name in PARTS}
    assert listed["violated"] == (["R1"] if verdict == "violated" else [])
    assert listed["not_shown"] == ([] if verdict in ("satisfied", "violated") else ["R1"])
    assert report.diagnostics == ()
    validate("report.schema.json", content)
    assert f"</span>{verdict}</span>" in as_html(report)


PARTS = ("violated", "not_shown")


def test_the_worst_run_decides_and_every_reason_is_reported(tmp_path: Path) -> None:
    known = project(tmp_path)
    content = content_of(
        known,
        tmp_path,
        result(known, "satisfied", run="a.mcap"),
        result(known, "vacuous", run="b.mcap", hashes={"log": "cd" * 32}),
        result(known, "inconclusive", run="c.mcap", hashes={"log": "ef" * 32}),
    )
    assert words(content["requirements"]) == ["inconclusive"]
    assert content["not_shown"][0]["reasons"] == [
        "c: inconclusive, reason of R1",
        "b: vacuous, reason of R1",
        "it holds in 1 of 3 runs",
    ]
    assert [(c["mark"]["word"], c["requirements"], c["results"]) for c in content["counts"]] == [
        ("violated", 0, 0),
        ("no data", 0, 0),
        ("inconclusive", 1, 1),
        ("vacuous", 0, 1),
        ("not exercised", 0, 0),
        ("satisfied", 0, 1),
    ]


def test_several_requirements_are_counted_in_words(tmp_path: Path) -> None:
    known = project(tmp_path, R1, requirement("R2", "the robot shall always satisfy stopped"))
    overall = content_of(
        known, tmp_path, result(known, "satisfied"), result(known, "vacuous", "R2")
    )["overall"]
    assert overall["headline"] == "Not all claimed requirements are shown."
    assert overall["sentences"][0] == "1 of 2 requirements held in the audited run."


def test_a_requirement_that_one_run_left_out_is_not_said_to_hold_in_all(tmp_path: Path) -> None:
    known = project(tmp_path, R1, requirement("R2", "the robot shall always satisfy stopped"))
    overall = content_of(
        known,
        tmp_path,
        result(known, "satisfied"),
        result(known, "satisfied", "R2"),
        result(known, "satisfied", "R2", run="b.mcap"),
    )["overall"]
    assert overall["sentences"][0] == (
        "2 of 2 requirements held in each run in which they were audited."
    )


# Without evidence ------------------------------------------------------------------------------


def test_without_evidence_every_requirement_is_not_exercised(tmp_path: Path) -> None:
    report = make(project(tmp_path), "nowhere/evidence.json")
    content = as_json(report)
    assert content["overall"]["headline"] == "None of the claimed requirements is shown."
    assert words(content["not_shown"]) == ["not exercised"]
    assert content["not_shown"][0]["reasons"] == ["no run has been audited"]
    assert [(d.code, d.severity) for d in report.diagnostics] == [
        (Code.NO_SUCH_FILE, Severity.NOTE)
    ]
    assert "Not exercised: no run has been audited." in as_html(report)
    validate("report.schema.json", content)


def test_a_requirement_that_the_audit_left_out_is_not_exercised(tmp_path: Path) -> None:
    known = project(tmp_path, R1, requirement("R2", "the robot shall always satisfy stopped"))
    content = content_of(known, tmp_path, result(known, "satisfied"))
    assert words(content["requirements"]) == ["satisfied", "not exercised"]
    assert content["not_shown"][0]["reasons"] == ["the audit did not cover it"]


def test_a_project_without_a_requirement_shows_nothing(tmp_path: Path) -> None:
    project(tmp_path)
    known = load([], str(tmp_path / "bindings.toml"), str(tmp_path / "hazards.toml"))
    assert known.requirements == ()
    content = content_of(known, tmp_path)
    assert content["overall"]["mark"]["word"] == "nothing shown"
    assert content["overall"]["sentences"] == [
        "There is no requirement in force.",
        "1 hazard has no requirement in force.",
    ]
    validate("report.schema.json", content)


# What is suspect, what has errors --------------------------------------------------------------


@pytest.mark.slow
def test_one_reason_for_many_requirements_is_one_message(tmp_path: Path) -> None:
    sentence = "whenever near the robot shall within 300 milliseconds satisfy stopped"
    ids = [f"R{number}" for number in range(1, 11)]
    known = project(tmp_path, *(requirement(id, sentence) for id in ids))
    old = {"bindings": "0" * 64}
    two = [result(known, "satisfied", "R3", run=run, hashes=old) for run in ("a", "b")]
    rest = [result(known, "satisfied", id, hashes=old) for id in ids if id != "R3"]
    messages = [d.message for d in report_of(known, tmp_path, *two, *rest).diagnostics]
    assert len(messages) == 2
    assert messages[0].startswith(
        "the evidence of R1, R2, R4, R5, R6, R7, R8, R9 and R10 is suspect in 1 run each: "
    )
    assert messages[1].startswith("the evidence of R3 is suspect in 2 runs: ")


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("sentence", "the sentence has changed since the audit"),
        ("bindings", "the bindings have changed since the audit"),
        ("monitor", "the generated monitor has changed since the audit"),
    ],
)
def test_evidence_of_something_else_is_suspect_and_never_satisfied(
    tmp_path: Path, name: str, why: str
) -> None:
    known = project(tmp_path)
    report = report_of(known, tmp_path, result(known, "satisfied", hashes={name: "0" * 64}))
    content = as_json(report)
    (view,) = content["requirements"][0]["results"]
    assert words([view]) == ["satisfied, suspect"]
    assert view["suspicions"] == content["requirements"][0]["suspicions"] == [why]
    assert content["overall"]["headline"] == (
        f"None of the claimed requirements is shown: {NAME} was satisfied, and {why}."
    )
    assert [word(c["mark"]) for c in content["counts"] if c["results"]] == ["satisfied, suspect"]
    (warning,) = report.diagnostics
    assert (warning.code, warning.severity) == (Code.STALE_EVIDENCE, Severity.WARNING)
    assert warning.message == f"the evidence of R1 is suspect in 1 run: {why}"
    assert '<section class="result satisfied suspect"' in as_html(report)


def test_a_changed_binding_makes_real_evidence_suspect(tmp_path: Path) -> None:
    before = project(tmp_path)
    old = write_evidence(before, tmp_path, result(before, "satisfied"))
    report = make(project(tmp_path, R1, bindings=BINDINGS.replace("5 cm", "90 cm")), old)
    assert words(as_json(report)["requirements"]) == ["satisfied, suspect"]


def test_a_damaged_log_never_shows_that_something_held(tmp_path: Path) -> None:
    known = project(tmp_path)
    content = content_of(known, tmp_path, result(known, "satisfied", health={"intact": False}))
    assert words(content["requirements"]) == ["satisfied, suspect"]
    assert content["overall"]["sentences"][-1] == "a is damaged or could not be read."


@pytest.mark.parametrize(
    ("verdict", "mark"),
    [
        ("satisfied", "violated, suspect"),
        ("vacuous", "violated"),
        ("inconclusive", "violated"),
        ("no data", "violated"),
    ],
)
def test_a_violation_that_is_listed_is_one_whatever_the_word_of_the_evidence(
    tmp_path: Path, verdict: str, mark: str
) -> None:
    known = project(tmp_path)
    content = content_of(known, tmp_path, result(known, verdict, violations=[violation(1, 2)]))
    assert words(content["requirements"]) == [mark]


def test_a_violation_on_a_damaged_log_counts(tmp_path: Path) -> None:
    known = project(tmp_path)
    bad = result(known, "violated", violations=[violation(1, 2)], health={"intact": False})
    assert words(content_of(known, tmp_path, bad)["requirements"]) == ["violated"]


def test_without_bindings_nothing_is_compared_and_nothing_counts(tmp_path: Path) -> None:
    before = project(tmp_path)
    old = write_evidence(before, tmp_path, result(before, "satisfied"))
    (tmp_path / "bindings.toml").unlink()
    content = as_json(make(project(tmp_path, R1, bindings=None), old))
    (view,) = content["requirements"][0]["results"]
    assert view["suspicions"] == ["the bindings have changed since the audit"]
    assert content["requirements"][0]["propositions"][0]["is_bound"] is False


def test_a_sentence_with_an_error_is_listed_as_unformalized(tmp_path: Path) -> None:
    known = project(tmp_path, R1, requirement("R2", "the robot shall alwys satisfy stopped"))
    report = report_of(known, tmp_path, result(known, "satisfied"))
    content = as_json(report)
    assert words(content["requirements"]) == ["satisfied", "unformalized"]
    assert content["requirements"][1]["error"] == {
        "code": "F107",
        "severity": "error",
        "message": "FRETish does not allow the word `alwys` here",
        "place": "r2.fret:7:17",
        "help": "did you mean `always`?",
        "accepted": "",
    }
    assert content["not_shown"][0]["reasons"] == [
        "F107: FRETish does not allow the word `alwys` here"
    ]
    assert content["overall"]["mark"]["word"] == "not all shown"
    as_html(report)
    validate("report.schema.json", content)


def test_a_retired_requirement_is_neither_claimed_nor_missing(tmp_path: Path) -> None:
    retired = requirement(
        "R2", "the robot shall never satisfy near", status="retired", verify=["inspection"]
    )
    known = project(tmp_path, R1, retired)
    broken = result(known, "violated", "R2", violations=[violation(1, 2)])
    content = content_of(known, tmp_path, result(known, "satisfied"), broken)
    assert words(content["requirements"]) == ["satisfied", "retired"]
    assert content["not_shown"] == []
    assert content["planned"] == [
        {
            "requirement": "R1",
            "anchor": "req-R1",
            "method": "audit",
            "has_result": True,
            "result": "1 run audited: satisfied",
            "refuted": False,
        }
    ]
    assert content["claims"] == "1 requirement in force, 1 retired, audited against 1 run."
    assert content["overall"]["headline"] == "All claimed requirements are shown."


def test_two_requirements_of_one_id_have_sections_of_their_own(tmp_path: Path) -> None:
    known = project(tmp_path, R1, R1.replace("eventually", "always"))
    content = content_of(known, tmp_path, result(known, "satisfied"))
    assert [view["anchor"] for view in content["requirements"]] == ["req-R1", "req-R1--2"]
    assert words(content["requirements"]) == ["satisfied", "satisfied, suspect"]


def test_a_project_with_errors_is_never_all_shown(tmp_path: Path) -> None:
    known = project(tmp_path, R1, "+++\nid = 1\n+++\nthe robot shall satisfy stopped\n")
    overall = content_of(known, tmp_path, result(known, "satisfied", latencies_s=[]))["overall"]
    assert overall["headline"] == "Not all claimed requirements are shown."
    assert overall["sentences"] == [
        "1 of 2 requirements held in the audited run.",
        "No run can violate R1: it sets no bound, so an answer that has not come may always come "
        "later.",
        "No damage was found in the run.",
        "The requirements, bindings or hazards have errors: this report is not complete.",
    ]


def test_bindings_with_an_error_make_a_report_of_what_is_not_known(tmp_path: Path) -> None:
    report = make(project(tmp_path, R1, bindings="[clock]\ntick = 1\n"), "nowhere/evidence.json")
    content = as_json(report)
    assert [remark["code"] for remark in content["remarks"]] == ["F303"]
    assert content["requirements"][0]["clock"] == "not declared"
    validate("report.schema.json", content)


# What was planned ------------------------------------------------------------------------------


def test_a_planned_method_without_a_result_is_reported(tmp_path: Path) -> None:
    sentence = "whenever near the robot shall eventually satisfy stopped"
    known = project(tmp_path, requirement("R1", sentence, verify=["audit", "ajpf", "inspection"]))
    overall = content_of(known, tmp_path, result(known, "satisfied", latencies_s=[0.0]))
    assert [(p["method"], p["has_result"], p["result"]) for p in overall["planned"]] == [
        ("audit", True, "1 run audited: satisfied"),
        (
            "ajpf",
            False,
            "no result is recorded; its file can be generated, but no check of it is recorded",
        ),
        ("inspection", False, "no result is recorded"),
    ]
    assert overall["overall"]["mark"]["word"] == "not all shown"
    assert overall["overall"]["headline"] == (
        "All audited requirements held, but some planned methods have no result."
    )
    assert overall["overall"]["sentences"][2] == (
        "No result is recorded for 2 planned methods: ajpf for Title of R1 (R1) and "
        "inspection for Title of R1 (R1)."
    )


def test_without_spot_the_file_of_a_planned_bundle_is_not_at_hand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("compiler.logic.spot.is_installed", lambda: False)
    sentence = "whenever near the robot shall eventually satisfy stopped"
    known = project(tmp_path, requirement("R1", sentence, verify=["ajpf-bundle"]))
    (planned,) = content_of(known, tmp_path)["planned"]
    assert planned["result"] == (
        "no result is recorded, and its file cannot be generated here: the agent of a bundle is "
        "checked before it is emitted, which needs Spot, which is not installed"
    )


def test_what_a_target_cannot_say_is_not_expressible(tmp_path: Path) -> None:
    sentence = "when near the robot shall within 3 ticks satisfy stopped"
    known = project(tmp_path, requirement("R1", sentence, verify=["ajpf"]))
    content = content_of(known, tmp_path)
    (section,) = content["requirements"]
    artefacts = {view["target"]: view for view in section["artefacts"]}
    assert list(artefacts) == ["monitor", "ltl", "ajpf", "json"]
    assert artefacts["ajpf"]["sha256"] == ""
    assert artefacts["ajpf"]["refusal"].startswith(
        "F601 AJPF cannot express the timing `within 3 ticks`"
    )
    assert content["planned"][0]["result"] == (
        "no result is recorded, and none is possible: ajpf cannot express the requirement"
    )


def test_a_response_without_a_bound_is_shown_with_a_reservation(tmp_path: Path) -> None:
    known = project(tmp_path)
    content = content_of(known, tmp_path, result(known, "satisfied"))
    latency = content["requirements"][0]["results"][0]["latency"]
    assert latency == {
        "answered": 3,
        "at_once": 1,
        "answers": "3 triggers, 1 of them at the same tick",
        "median": "2.4 s",
        "longest": "2.5 s, after the trigger at 1 s",
        "longest_s": 2.5,
        "is_bounded": False,
        "bound": "No bound was required: the sentence says `eventually`, so a response at any "
        "time satisfies it.",
        "waits": ["1 s to 3.5 s: 2 triggers, the first waited 2.5 s"],
        "median_s": 2.4,
    }
    line = f"The longest answer of {NAME} took 2.5 s, after the trigger at 1 s, in a."
    assert content["reservations"] == [UNVIOLABLE, line]
    assert content["overall"]["sentences"][1:3] == [UNVIOLABLE, line]


def test_where_the_end_of_a_log_violates_the_reservation_is_the_missing_bound(
    tmp_path: Path,
) -> None:
    ends = BINDINGS.replace('end = "inconclusive"', 'end = "violated"')
    known = project(tmp_path, bindings=ends)
    content = content_of(known, tmp_path, result(known, "satisfied"))
    assert content["reservations"] == [
        f"{NAME} sets no bound on its response. The longest answer of {NAME} took 2.5 s, after the "
        "trigger at 1 s, in a."
    ]


def test_a_bound_is_reported_beside_the_latency(tmp_path: Path) -> None:
    known = project(
        tmp_path, requirement("R1", "whenever near the robot shall within 30 ticks satisfy stopped")
    )
    content = content_of(known, tmp_path, result(known, "satisfied"))
    latency = content["requirements"][0]["results"][0]["latency"]
    assert latency["bound"] == "The sentence allows 30 ticks (3 s)."
    assert content["reservations"] == []


def test_each_threshold_is_shown_with_its_values_and_its_margin(tmp_path: Path) -> None:
    known = project(tmp_path)
    report = report_of(known, tmp_path, result(known, "satisfied"))
    (view,) = as_json(report)["requirements"][0]["results"]
    assert view["thresholds"] == [
        {
            "proposition": "near",
            "comparison": "clearance < 0.05 m",
            "values": "0.0318 m to +inf",
            "margin": "crossed",
            "nearest": "0 s",
        },
        {
            "proposition": "stopped",
            "comparison": "abs(vx) < 0.01 m/s",
            "values": "0 m/s to 0.0075 m/s",
            "margin": "0.0025 m/s",
            "nearest": "-0.1 s",
        },
    ]
    assert "abs(vx) &lt; 0.01 m/s" in as_html(report)


def test_violations_open_demands_and_unknown_ticks_are_listed(tmp_path: Path) -> None:
    known = project(tmp_path)
    bad = result(
        known,
        "violated",
        violations=[violation(14, 20, 11), violation(60, 60)],
        open=[moment(tick) for tick in (90, 91, 92, 95)],
        unknown=[[3, 5], [9, 9]],
    )
    (view,) = content_of(known, tmp_path, bad)["requirements"][0]["results"]
    assert view["violations"][0] == {
        "start": "1.4 s",
        "end": "2.1 s",
        "lasts": "700 ms",
        "ticks": "14 to 20",
        "trigger": "1.1 s (tick 11)",
        "deadline": "1.4 s (tick 14)",
        "missing": "stopped",
        "values": [
            ["clearance", "unknown: 0.0318 m is 400 ms old, and valid for 300 ms"],
            ["vx", "unknown"],
        ],
        "causes": [],
    }
    assert (view["violations"][1]["ticks"], view["violations"][1]["trigger"]) == ("60", "none")
    assert view["open"] == {
        "lines": [
            "triggered from 9 s to 9.2 s (ticks 90 to 92): 3 demands",
            "triggered at 9.5 s (tick 95)",
        ],
        "total": 4,
    }
    assert view["unknown"] == {"lines": ["ticks 3 to 5", "tick 9"], "total": 4}


def test_what_is_uncertain_among_answers_and_open_demands_is_named(tmp_path: Path) -> None:
    known = project(tmp_path)
    bad = result(
        known,
        "inconclusive",
        open=[moment(tick) for tick in (90, 91, 92, 95, 97)],
        uncertain=[10, 40, 91, 92, 95],
    )
    (view,) = content_of(known, tmp_path, bad)["requirements"][0]["results"]
    assert view["open"]["lines"] == [
        "triggered from 9 s to 9.2 s (ticks 90 to 92): 3 demands, 2 of them uncertain because "
        "propositions are unknown",
        "triggered at 9.5 s (tick 95), uncertain because propositions are unknown",
        "triggered at 9.7 s (tick 97)",
    ]
    assert view["latency"]["answers"] == (
        "3 triggers, 1 of them at the same tick, 2 of them uncertain because propositions are "
        "unknown"
    )


@pytest.mark.slow
def test_thousands_of_violations_keep_the_report_small(tmp_path: Path) -> None:
    known = project(tmp_path)
    many = [violation(tick, tick) for tick in range(5000)]
    report = report_of(known, tmp_path, result(known, "violated", ticks=5000, violations=many))
    (view,) = as_json(report)["requirements"][0]["results"]
    assert (len(view["violations"]), view["violations_total"]) == (100, 5000)
    page = as_html(report)
    assert "Violations: 5000, of which the first 100 are listed" in page
    assert len(page) < 150_000


# The runs --------------------------------------------------------------------------------------


def test_a_run_is_shown_with_its_health(tmp_path: Path) -> None:
    known = project(tmp_path)
    finding = {
        "code": "F404",
        "severity": "error",
        "message": "a part of the log is damaged",
        "file": "a.mcap",
        "line": 1,
        "column": 1,
        "help": "record again",
    }
    health = {
        "intact": False,
        "gaps": [{"start_ns": 2 * 10**9, "end_ns": 3 * 10**9}],
        "findings": [finding],
    }
    (run,) = content_of(known, tmp_path, result(known, "no data", health=health))["runs"]
    assert run == {
        "anchor": "run-1",
        "label": "a",
        "file": "logs/a.mcap",
        "sha256": "ab" * 32,
        "size": "1.23 MB (1\u202f234\u202f567 bytes)",
        "recorded": "1970-01-01 00:00:01.000 UTC",
        "duration": "10 s",
        "ticks": "100 ticks",
        "clock": "100 ms, by log_time",
        "intact": False,
        "health": {"word": "damaged", "glyph": "✘", "kind": "violated", "suspect": False},
        "checked": "4 of 9 chunks match their CRC; 2 of 9 chunks have a CRC that was not "
        "checked, because only their beginning was read; 3 of 9 chunks contain no bound topic and "
        "were not read; read by the index",
        "gaps": ["from 1 s to 2 s (1 s)"],
        "findings": [
            {
                "code": "F404",
                "severity": "error",
                "message": "a part of the log is damaged",
                "place": "",
                "help": "record again",
                "accepted": "",
            }
        ],
        "topics": [
            {
                "name": "/odom",
                "type": "nav_msgs/msg/Odometry",
                "count": "501",
                "rate": "50 Hz",
                "longest_gap": "40 ms",
                "out_of_order": "3",
                "read_for": ["vx"],
            }
        ],
    }


def test_a_log_that_could_not_be_read_is_a_run_without_hash(tmp_path: Path) -> None:
    known = project(tmp_path)
    unread = result(
        known,
        "no data",
        ticks=0,
        start_ns=None,
        end_ns=None,
        clock="",
        triggers=[],
        latencies_s=[],
        health={"intact": False, "size": None, "topics": {}},
    )
    del unread["hashes"]["log"]
    content = content_of(known, tmp_path, unread)
    assert content["runs"][0]["health"]["word"] == "not readable"
    assert content["runs"][0]["sha256"] == ""
    assert "run" not in [line["kind"] for line in content["manifest"]]


# The whole -------------------------------------------------------------------------------------


def everything(folder: Path) -> tuple[Any, Sequence[dict[str, Any]]]:
    """A project and results with every kind of verdict."""
    sentences = {
        "R2": "when near the robot shall within 3 ticks satisfy stopped",
        "R3": "the robot shall always satisfy stopped",
        "R4": "the robot shall alwys satisfy stopped",
        "R5": "when near the robot shall immediately satisfy stopped",
        "R6": "when near the robot shall for 2 seconds satisfy stopped",
    }
    known = project(folder, R1, *(requirement(id, text) for id, text in sentences.items()))
    return known, [
        result(known, "satisfied"),
        result(known, "violated", "R2", violations=[violation(14, 20, 11)]),
        result(known, "inconclusive", "R3", open=[moment(95)], unknown=[[3, 5]]),
        result(known, "vacuous", "R5", triggers=[], latencies_s=[]),
        result(known, "no data", "R6", run="b.mcap", unknown=[[0, 99]]),
        result(known, "satisfied", "R6", hashes={"sentence": "0" * 64}),
    ]


@pytest.mark.slow
def test_two_reports_are_the_same_byte_for_byte(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reports = []
    for place in ("here", "there"):
        (tmp_path / place).mkdir()
        monkeypatch.chdir(tmp_path / place)
        reports.append(report_of(*_args(everything(Path("req")), Path())))
    first, second = reports
    assert first.html == second.html
    assert first.json == second.json


def _args(case: tuple[Any, Sequence[dict[str, Any]]], folder: Path) -> tuple[Any, ...]:
    known, results = case
    return (known, folder, *results)


@pytest.mark.slow
def test_a_report_names_no_place_of_this_machine(tmp_path: Path) -> None:
    report = report_of(*_args(everything(tmp_path / "a"), tmp_path / "a"))
    assert str(tmp_path) not in as_html(report)
    assert str(tmp_path) not in json.dumps(as_json(report))


@pytest.mark.slow
def test_every_verdict_fits_the_schema(tmp_path: Path) -> None:
    content = content_of(*_args(everything(tmp_path), tmp_path))
    assert sorted(words(content["requirements"])) == [
        "inconclusive",
        "no data, suspect",
        "satisfied",
        "unformalized",
        "vacuous",
        "violated",
    ]
    validate("report.schema.json", content)


@pytest.mark.slow
def test_a_report_that_says_less_does_not_fit_the_schema(tmp_path: Path) -> None:
    content = content_of(*_args(everything(tmp_path), tmp_path))
    del content["requirements"][0]["reasons"]
    with pytest.raises(jsonschema.ValidationError, match="'reasons' is a required property"):
        validate("report.schema.json", content)


@pytest.mark.slow
def test_evidence_made_by_hand_fits_its_schema(tmp_path: Path) -> None:
    known, results = everything(tmp_path)
    validate("evidence.schema.json", evidence(known, *results))


@pytest.mark.slow
def test_the_evidence_of_the_recorded_run_fits_its_schema_and_is_reported(tmp_path: Path) -> None:
    known = load(["requirements/r1.fret"], hazards="requirements/hazards.toml")
    plan = planned(known)
    assert isinstance(plan, Plan)
    audit = audit_logs(plan, [TRACE, "traces/none.mcap"])
    assert isinstance(audit, AuditOutcome)
    validate("evidence.schema.json", json.loads(audit.evidence))
    file = tmp_path / "evidence.json"
    file.write_text(audit.evidence, encoding="utf-8")
    report = make(known, str(file))
    content = as_json(report)
    validate("report.schema.json", content)
    assert words(content["requirements"][0]["results"]) == ["satisfied", "no data"]
    assert [run["health"]["word"] for run in content["runs"]] == ["not readable", "no damage found"]
    assert not [each for each in report.diagnostics if not each.accepted]


def test_a_log_that_was_not_hashed_is_reported_as_such(tmp_path: Path) -> None:
    known = project(tmp_path)
    audited = result(known, "satisfied")
    hashes = {name: value for name, value in audited["hashes"].items() if name != "log"}
    hashes["log_summary"] = "cd" * 32
    (run,) = content_of(known, tmp_path, {**audited, "hashes": hashes})["runs"]
    assert run["sha256"] == ""
    assert run["checked"].endswith("; not hashed")


def test_a_violated_run_does_not_read_as_if_its_bound_were_kept(tmp_path: Path) -> None:
    sentence = "when near the robot shall within 300 milliseconds satisfy stopped"
    known = project(tmp_path, requirement("R1", sentence))
    late = violation(14, 17, trigger=11)
    runs: dict[str, Any] = {"violations": [late], "latencies_s": [0.3, 0.1]}
    (view,) = content_of(known, tmp_path, result(known, "violated", **runs))["requirements"]
    (row,) = view["results"]
    assert row["unanswered"] == "> 300 ms (1 unanswered); overdue up to 700 ms after the trigger"
    held = content_of(known, tmp_path, result(known, "satisfied"))["requirements"][0]
    assert held["results"][0]["unanswered"] == ""


def test_damaged_logs_are_named_once_with_what_they_leave_open(tmp_path: Path) -> None:
    known = project(tmp_path)
    hurt = {"intact": False, "findings": []}
    runs = [result(known, "satisfied", run="a.mcap")]
    runs += [result(known, "no data", run=f"{name}.mcap", health=hurt) for name in "bc"]
    content = content_of(known, tmp_path, *runs)
    assert content["violated"] == []
    assert content["not_shown"][0]["reasons"] == [
        "no data from 2 damaged logs: b and c",
        "it holds in 1 of 3 runs",
    ]
    assert content["damaged"] == [
        f"{name}: the log is damaged: 1 requirement has no verdict from it. Record it again."
        for name in "bc"
    ]
