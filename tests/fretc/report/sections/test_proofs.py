import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from compiler.emit import TARGETS
from compiler.files.text_files import sha256
from compiler.project.project import Project
from compiler.targets.python import monitor
from compiler.targets.target import TargetOptions
from fretc.cli import cli
from fretc.report.forms.junit import junit
from fretc.report.make import ReportBuild, make
from fretc.report.sections.argument import ElementKind, argument
from fretish.diagnostics.diagnostic import Code
from tests.command import Fretc, write
from tests.each import each
from tests.effort import some
from tests.fretc.report.cases import (
    BINDINGS,
    HAZARDS,
    as_html,
    as_json,
    project,
    requirement,
    result,
    words,
    write_evidence,
)
from tests.json_schemas import validate

SENTENCE = "whenever near the robot shall within 30 ticks satisfy stopped"


def proof(known: Project, outcome: str = "proved", **changes: Any) -> dict[str, Any]:
    """A line of `fretc verify` about the monitor of R1 as it is made now."""
    return {
        "requirement": "R1",
        "layer": "monitor",
        "claim": "the monitor means what the sentence says",
        "result": outcome,
        "detail": "12 states",
        "assumptions": [],
        "engine": "fretc",
        "artefacts": {"r1_monitor.py": sha256(monitor.text(known.formalized[0]))},
        **changes,
    }


def reported(
    folder: Path, *lines: dict[str, Any], verify: list[str], beside: Sequence[str] = ()
) -> ReportBuild:
    """The report about R1, satisfied in one run, and what was proved of it.

    Args:
        folder: for its files.
        lines: what differs in each proof.
        verify: the planned methods.
        beside: further requirements.
    """
    known = project(folder, requirement("R1", SENTENCE, verify=verify), *beside)
    audited = write_evidence(known, folder, result(known, "satisfied", latencies_s=[]))
    proofs = folder / "verification.json"
    document = {"schema": "fretc-verification-1", "fretc": "0.1.0"}
    records = [proof(known, **line) for line in lines]
    proofs.write_text(json.dumps({**document, "evidence": records}), encoding="utf-8")
    return make(known, audited, verification=str(proofs))


def plan(report: ReportBuild) -> tuple[str, bool, bool]:
    (method,) = as_json(report)["planned"]
    return method["result"], method["has_result"], method["refuted"]


@pytest.mark.slow
@pytest.mark.parametrize("method", ["verify", "proof", "monitor"])
def test_a_proof_is_the_result_of_its_method(tmp_path: Path, method: str) -> None:
    report = reported(tmp_path, {}, verify=[method])
    assert plan(report) == ("1 claim proved", True, False)
    content = as_json(report)
    assert content["overall"]["headline"] == "All claimed requirements are shown."
    assert content["manifest"][-2]["kind"] == "verification"
    validate("report.schema.json", content)
    assert "<h4>Proofs</h4>" in as_html(report)


def test_the_worst_claim_decides(tmp_path: Path) -> None:
    lines = [{}, {"layer": "loop", "claim": "it keeps R1", "outcome": "counterexample"}]
    report = reported(tmp_path, *lines, verify=["verify"])
    assert plan(report) == ("counterexample: it keeps R1 (12 states)", True, True)
    overall = as_json(report)["overall"]
    assert overall["mark"]["word"] == "not all shown"
    assert (
        overall["headline"]
        == "All audited requirements held, but verification found counterexamples."
    )
    assert overall["sentences"][1] == (
        "Verification found a counterexample to Title of R1 (R1); their sections list the claims."
    )


def test_the_argument_rests_on_proofs_and_on_nothing_that_is_refuted(tmp_path: Path) -> None:
    report = reported(tmp_path, {}, {"layer": "loop"}, verify=[]).report
    assert report is not None
    claim = "the monitor means what the sentence says (by fretc)"
    assert [each.text for each in argument(report) if each.kind is ElementKind.SOLUTION] == [
        "R1 is satisfied in 1 audited run",
        f"Proved: {claim}",
        f"Proved: {claim}",
    ]
    refuted = reported(tmp_path, {"outcome": "counterexample"}, verify=[]).report
    assert refuted is not None
    (goal,) = [each for each in argument(refuted) if each.undeveloped]
    assert goal.text == "The monitor of R1 gives the verdicts that the sentence demands"
    assert goal.defeated


def test_a_counterexample_counts_also_where_no_method_was_planned(tmp_path: Path) -> None:
    report = reported(tmp_path, {"outcome": "counterexample"}, verify=[])
    assert as_json(report)["overall"]["mark"]["word"] == "not all shown"
    assert report.report is not None
    (case,) = ElementTree.fromstring(junit(report.report))[0]
    assert [(child.tag, child.get("message")) for child in case] == [
        ("failure", "satisfied: monitor: counterexample: the monitor means what the sentence says")
    ]


@pytest.mark.parametrize("outcome", ["vacuous", "not checked"])
def test_what_says_nothing_is_no_result(tmp_path: Path, outcome: str) -> None:
    report = reported(tmp_path, {"outcome": outcome}, verify=["monitor"])
    assert plan(report)[1:] == (False, False)
    assert as_json(report)["overall"]["mark"]["word"] == "not all shown"


@pytest.mark.parametrize(
    ("artefacts", "why"),
    [
        ({"r1_monitor.py": "0" * 64}, "r1_monitor.py would be generated differently now"),
        ({"mine.py": "0" * 64}, "it is about another monitor than the one generated now"),
    ],
)
def test_a_proof_of_another_text_is_suspect(
    tmp_path: Path, artefacts: dict[str, str], why: str
) -> None:
    report = reported(tmp_path, {"artefacts": artefacts}, verify=["verify"])
    (view,) = as_json(report)["requirements"][0]["proofs"]
    assert words([view]) == ["proved, suspect"]
    assert view["suspicions"][0] == why
    assert plan(report)[1:] == (False, False)


@pytest.mark.slow
@each("kind", ["c", "rust", "js", "java"])
def test_a_proof_of_the_monitor_in_another_language_stands(
    tmp_path_factory: pytest.TempPathFactory, kind: str
) -> None:
    """If it is about the text that is made now; the same header says nothing."""
    folder = tmp_path_factory.mktemp(kind)
    (formalized,) = project(folder, requirement("R1", SENTENCE, verify=["verify"])).formalized
    made = reversed(TARGETS[kind].emit([formalized]))  # a crate of samples has a `lib.rs` as well
    files = {file.path.name: sha256(file.text) for file in made}
    (name,) = files.keys() & {"r1_monitor.c", "lib.rs", "r1_monitor.mjs", "R1Monitor.java"}
    for artefacts, doubts in ((files, 0), ({**files, name: "0" * 64}, 1)):
        report = reported(folder, {"artefacts": artefacts}, verify=["verify"])
        (view,) = as_json(report)["requirements"][0]["proofs"]
        assert len(view["suspicions"]) == doubts


PARTS = (("R1", "R2", "R3"), ("R1", "R2"), ("R1", "R3"), ("R2", "R1"), ("R1",))
KINDS = ("monitor", "c", "rust", "js", "java")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "part"),
    [
        (kind, part)
        for place, kind in enumerate(KINDS)
        for part in (some(PARTS, len(PARTS), place) if place else PARTS)
    ],
)
def test_a_proof_of_the_monitor_of_some_requirements_stands(
    tmp_path: Path, kind: str, part: tuple[str, ...]
) -> None:
    """A monitor of some files; its proof stands until one of its requirements changes."""
    own = requirement("R1", SENTENCE, verify=["verify"])
    beside = [requirement(id, SENTENCE.replace("30", n)) for id, n in (("R2", "5"), ("R3", "7"))]
    requirements = {
        formalized.id: formalized for formalized in project(tmp_path, own, *beside).formalized
    }
    made = TARGETS[kind].emit([requirements[id] for id in part], TargetOptions(one_file=True))
    files = {file.path.name: sha256(file.text) for file in reversed(made)}
    lines = [{"requirement": id, "artefacts": files} for id in part]
    for place in (None, 0, 1):
        others = [each.replace("satisfy", "satisfy !") if number == place else each
                  for number, each in enumerate(beside)]  # fmt: skip
        report = reported(tmp_path, *lines, verify=["verify"], beside=others)
        (view,) = as_json(report)["requirements"][0]["proofs"]
        changed = place is not None and f"R{place + 2}" in part
        assert len(view["suspicions"]) == changed, (place, view["suspicions"])


def test_a_prover_is_found_by_its_engine(tmp_path: Path) -> None:
    line = {"engine": "Dafny 4.9", "layer": "interceptor", "requirement": "interceptor"}
    report = reported(tmp_path, line, verify=["dafny"])
    assert plan(report) == ("1 claim proved", True, False)
    assert [each["layer"] for each in as_json(report)["proofs"]] == ["interceptor"]
    assert as_json(report)["requirements"][0]["proofs"] == []


def test_a_file_that_is_not_there_is_reported(tmp_path: Path) -> None:
    report = make(project(tmp_path), str(tmp_path / "e"), verification=str(tmp_path / "no.json"))
    assert report.report is None
    assert [diagnostic.code for diagnostic in report.diagnostics] == [Code.NO_SUCH_FILE]


def test_without_a_file_nothing_was_proved(tmp_path: Path) -> None:
    content = as_json(make(project(tmp_path), str(tmp_path / "none.json")))
    assert (content["verification"], content["proofs"]) == ("", [])


def test_the_command_takes_the_file_at_its_usual_place_and_exits_as_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    reported(tmp_path, {"outcome": "counterexample"}, verify=[])
    (tmp_path / "build").mkdir()
    command = ["report", "--requirements", str(tmp_path), "--evidence", "evidence.json", "--strict"]
    assert CliRunner().invoke(cli, command).exit_code == 0
    (tmp_path / "verification.json").rename("build/verification.json")
    assert CliRunner().invoke(cli, command).exit_code == 1
    assert "<h4>Proofs</h4>" in Path("build/report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON: expecting property name enclosed in double quotes"),
        ('{"schema": "x"}', "`$.schema`: invalid enum value 'x'"),
        (
            '{"schema": "fretc-verification-1", "fretc": "0", "evidence": [{"artefacts": []}]}',
            "`$.evidence[0].artefacts`: expected `object`, got `array`",
        ),
    ],
)
def test_a_file_of_another_shape_is_reported_and_no_report_is_made(
    tmp_path: Path, text: str, message: str
) -> None:
    (tmp_path / "verification.json").write_text(text, encoding="utf-8")
    report = make(
        project(tmp_path), str(tmp_path / "e"), verification=str(tmp_path / "verification.json")
    )
    assert report.report is None
    (diagnostic,) = report.diagnostics
    assert diagnostic.code is Code.BAD_EVIDENCE
    assert message in diagnostic.message


ASSUMING = """
[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
period = "50 ms"
hold = "200 ms"

[assume]
stands = "stopped"
latency = "100 ms"
braking = "200 ms"
"""


@pytest.mark.slow
@pytest.mark.confined
def test_another_assumption_makes_what_was_proved_of_the_loop_suspect(fretc: Fretc) -> None:
    write("requirements/r1.fret", requirement("R1", SENTENCE, verify=["loop"]))
    bindings = write("requirements/bindings.toml", BINDINGS + ASSUMING)
    write("requirements/hazards.toml", HAZARDS)
    assert fretc("verify", "requirements/r1.fret", "--layer", "loop").status == 0
    assert marks(fretc) == {"proved"}
    write(bindings, (BINDINGS + ASSUMING).replace('"100 ms"\nbraking', '"100 ms" # still\nbraking'))
    assert marks(fretc) == {"proved"}, "a comment is no change"
    write(bindings, (BINDINGS + ASSUMING).replace('braking = "200 ms"', 'braking = "900 ms"'))
    assert marks(fretc) == {"proved, suspect"}


def marks(fretc: Fretc) -> set[str]:
    fretc("report", "--json", "report.json")
    (view,) = json.loads(Path("report.json").read_text())["requirements"]
    return set(words(view["proofs"]))
