"""Results as SARIF: by the schema of OASIS, and with what code scanning on GitHub asks for."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.files.build_id import PACKAGE
from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.outputs.sarif import AllRuns, OneRun, sarif
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source
from tests.command import Fretc
from tests.fretc.audit import results as results_of
from tests.fretc.report.sarif_schema import SARIF
from tests.monitoring import requirement

ROOT = Path(__file__).parents[4]
RULES = [requirement(f"the sw shall\n always satisfy q{i}", f"R{i}") for i in range(1, 6)]


def result(verdict: str, id: str = "R1", run: str = "a.mcap", **more: Any) -> OneRun:
    hashes = {"log": "ab" * 32, "sentence": "cd" * 32}
    fields = {"hashes": hashes, **more}
    return OneRun.of(results_of.result(run=run, requirement=id, verdict=verdict, **fields))


ALL = [
    result("satisfied"),
    result("violated", "R2"),
    result("inconclusive", "R3"),
    result("vacuous", "R4"),
    result("no data", "R5", hashes={}, health={"size": None}),
    result("violated", run="folder/b c.mcap"),
]


def read(
    results: Sequence[OneRun],
    rules: Sequence[FormalizedRequirement] = RULES,
    diagnostics: Sequence[Diagnostic] = (),
) -> Any:
    """The only run of the file, which fits the schema."""
    content = json.loads(sarif(results, rules, diagnostics))
    format_checker = jsonschema.Draft4Validator.FORMAT_CHECKER
    jsonschema.Draft4Validator(SARIF, format_checker=format_checker).validate(content)
    (run,) = content["runs"]
    accepted_by_code_scanning(run)
    return run


def accepted_by_code_scanning(run: Any) -> None:
    """What GitHub demands beyond the schema.

    Source: GitHub documentation, SARIF support for code scanning.
    """
    rules = run["tool"]["driver"]["rules"]
    assert run["tool"]["driver"]["name"]
    for one in rules:
        assert one["id"]
        assert len(one["shortDescription"]["text"]) <= 1024
        assert len(one["fullDescription"]["text"]) <= 1024
        assert one["help"]["text"]
    for one in run["results"]:
        assert one["message"]["text"]
        assert rules[one["ruleIndex"]]["id"] == one["ruleId"]
        (location,) = one["locations"]
        place = location["physicalLocation"]
        assert not place["artifactLocation"]["uri"].startswith("..")
        region = place["region"]
        assert (region["startLine"], region["startColumn"]) <= (
            region["endLine"],
            region["endColumn"],
        )
        assert one["partialFingerprints"]["primaryLocationLineHash"]
    prints = [one["partialFingerprints"]["primaryLocationLineHash"] for one in run["results"]]
    assert len(set(prints)) == len(prints)


def test_the_schema_refuses_what_is_wrong() -> None:
    content = json.loads(sarif(ALL, RULES))
    mistakes: list[dict[str, Any]] = [
        {"level": "bad"},
        {"colour": "red"},
        {"message": {}},
        {"ruleIndex": -2},
    ]
    for wrong in mistakes:
        content["runs"][0]["results"][0] |= wrong
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.Draft4Validator(SARIF).validate(content)
        content = json.loads(sarif(ALL, RULES))


def test_what_is_not_shown_is_a_result_with_its_level_and_what_is_shown_is_none() -> None:
    kinds = [(one["ruleId"], one["kind"], one["level"]) for one in read(ALL)["results"]]
    assert kinds == [
        ("R2", "fail", "error"),
        ("R3", "fail", "warning"),
        ("R4", "fail", "warning"),
        ("R5", "fail", "warning"),
        ("R1", "fail", "error"),
    ]


def test_only_rules_and_logs_of_findings_occur() -> None:
    run = read([result("satisfied"), result("violated", "R2", "b.mcap")])
    assert [one["id"] for one in run["tool"]["driver"]["rules"]] == ["R2"]
    assert [one["location"]["uri"] for one in run["artifacts"]] == ["b.mcap", "r.fret"]
    none = read([result("satisfied")])
    assert (none["results"], none["artifacts"], none["tool"]["driver"]["rules"]) == ([], [], [])


def test_a_run_that_only_counts_is_no_finding_and_the_answer_of_all_is_one() -> None:
    trials: dict[str, Any] = {"trials": {"answered": 1, "failed": 1, "open": 0}}
    counted = result("inconclusive", **trials)
    lost = result("no data", "R2", **trials)
    content = json.loads(
        sarif([counted, lost], RULES, estimates=[AllRuns("R1", "refuted", "1 of 2")])
    )
    results = content["runs"][0]["results"]
    assert [(one["ruleId"], one["level"]) for one in results] == [
        ("R2", "warning"),
        ("R1", "error"),
    ]
    assert results[1]["message"]["text"] == "all runs: refuted: 1 of 2"


def test_a_result_stands_at_its_sentence_and_names_its_run() -> None:
    one = read(ALL)["results"][0]
    assert one["message"]["text"] == "a.mcap: violated: why"
    (location,) = one["locations"]
    assert location["physicalLocation"] == {
        "artifactLocation": {"uri": "r.fret", "uriBaseId": "%SRCROOT%", "index": 2},
        "region": {"startLine": 1, "startColumn": 1, "endLine": 2, "endColumn": 19},
    }
    assert one["properties"]["verdict"] == "violated"


def test_a_log_is_an_artifact_with_its_hash() -> None:
    run = read(ALL)
    assert run["artifacts"][0] == {
        "location": {"uri": "a.mcap", "uriBaseId": "%SRCROOT%"},
        "roles": ["analysisTarget"],
        "length": 1000,
        "hashes": {"sha-256": "ab" * 32},
    }
    assert [one["location"]["uri"] for one in run["artifacts"]] == [
        "a.mcap",
        "folder/b%20c.mcap",
        "r.fret",
    ]
    for one in run["results"]:
        target = one["analysisTarget"]
        assert run["artifacts"][target["index"]]["location"]["uri"] == target["uri"]


def test_a_requirement_is_a_rule_with_its_sentence_and_its_fingerprint() -> None:
    run = read(ALL)
    first, *_ = run["tool"]["driver"]["rules"]
    assert run["tool"]["driver"]["informationUri"] == PACKAGE
    assert first["id"] == "R1"
    assert first["fullDescription"]["text"] == "the sw shall always satisfy q1"
    assert first["help"]["text"] == (
        "Over the whole run: from its first tick on, `q1` must be true at that tick and at every "
        "later one until the run ends."
    )
    assert first["properties"]["sha256"] == RULES[0].fingerprint


def test_a_fingerprint_depends_on_the_requirement_and_the_run_and_on_nothing_else() -> None:
    def prints(*results: OneRun) -> list[Any]:
        return [one["partialFingerprints"] for one in read(results)["results"]]

    later = result("vacuous", reason="other", hashes={"log": "00" * 32})
    assert prints(result("violated")) == prints(later)
    one, other, third = prints(
        result("violated"), result("violated", "R2"), result("no data", run="b")
    )
    assert one != other != third != one


def test_what_there_is_to_say_of_a_log_is_a_notification() -> None:
    log = Source("a.mcap", "").span()
    cut = Diagnostic(Code.TRUNCATED_LOG, "it breaks off", log, severity=Severity.WARNING)
    placed = Diagnostic(Code.NO_TOPIC, "no /x", Source("b.toml", "[x]\npath").span(4, 8))
    run = read(ALL, RULES, [cut, placed])
    (invocation,) = run["invocations"]
    assert not invocation["executionSuccessful"]
    first, second = invocation["toolExecutionNotifications"]
    assert (first["descriptor"]["id"], first["level"]) == ("F403", "warning")
    assert second["locations"][0]["physicalLocation"]["region"] == {
        "startLine": 2,
        "startColumn": 1,
        "endLine": 2,
        "endColumn": 5,
    }
    assert [one["id"] for one in run["tool"]["driver"]["notifications"]] == ["F403", "F405"]
    assert read(ALL, RULES, [cut])["invocations"][0]["executionSuccessful"]


@given(
    st.text(),
    st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), min_size=1),
)
def test_any_text_gives_a_file_that_fits(reason: str, run: str) -> None:
    (one,) = read([result("violated", run=run, reason=reason)])["results"]
    assert one["message"]["text"] == f"{run}: violated: {reason}"


def test_a_path_elsewhere_is_absolute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    run = read([result("violated", run="../x.mcap"), result("violated", run=str(tmp_path / "y"))])
    uris = [one["analysisTarget"]["uri"] for one in run["results"]]
    assert uris == [(tmp_path / "x.mcap").as_uri(), (tmp_path / "y").as_uri()]
    assert (
        read([result("vacuous", run=str(tmp_path / "here" / "z"))])["artifacts"][0]["location"][
            "uri"
        ]
        == "z"
    )


def test_a_path_is_relative_to_the_root_of_its_repository(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / "robot").mkdir()
    monkeypatch.chdir(tmp_path / "robot")
    run = read([result("violated", run="a.mcap"), result("violated", run="../logs/b.mcap")])
    assert [one["location"] for one in run["artifacts"]] == [
        {"uri": uri, "uriBaseId": "%SRCROOT%"}
        for uri in ("robot/a.mcap", "logs/b.mcap", "robot/r.fret")
    ]
    assert [*run["originalUriBaseIds"]] == ["%SRCROOT%"]


def test_an_address_on_the_web_stays_as_it_is() -> None:
    (one,) = read([result("violated", run="https://a.b/c%20d.mcap?x=1&y=z e")])["results"]
    assert one["analysisTarget"] == {"uri": "https://a.b/c%20d.mcap?x=1&y=z%20e", "index": 0}


@pytest.mark.slow
def test_the_command_prints_it(fretc: Fretc) -> None:
    shutil.copytree(ROOT / "requirements", "requirements")
    shutil.copy(ROOT / "traces/mission-seed15.mcap", "run.mcap")
    good = fretc("audit", "run.mcap", "--format", "sarif")
    assert good.status == 0
    assert json.loads(good.out)["runs"][0]["results"] == []
    shutil.copy("run.mcap", "whole.mcap")
    Path("run.mcap").write_bytes(Path("whole.mcap").read_bytes()[:1_000_000])
    printed = fretc("audit", "run.mcap", "--format", "sarif")
    assert printed.status == 3
    run = json.loads(printed.out)["runs"][0]
    accepted_by_code_scanning(run)
    assert run["results"][0]["level"] == "warning"
    place = run["results"][0]["locations"][0]["physicalLocation"]
    line = Path("requirements/r1.fret").read_text("utf-8").splitlines()
    region = place["region"]
    assert place["artifactLocation"]["uri"] == "requirements/r1.fret"
    assert line[region["startLine"] - 1][region["startColumn"] - 1 : region["endColumn"] - 1] == (
        "whenever too_close agilex_agent shall eventually satisfy stopped"
    )
    again = fretc("audit", "run.mcap", "--format", "sarif")
    assert again.out == printed.out
