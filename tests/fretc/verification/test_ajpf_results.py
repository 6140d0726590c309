"""Results of AJPF as evidence: only about the present texts, and never more than AJPF says."""

import hashlib
import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from compiler.agents import checking
from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimOutcome, ClaimResult, Layer, Proof, not_checked, vacuous
from compiler.targets.ajpf.bundle import emit
from compiler.targets.target import TargetOptions
from fretc.verification.ajpf_results import ajpf_proofs, merged, read
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from tests.command import Fretc
from tests.compiler.targets.ajpf.test_bundle import R1, requirement
from tests.compiler.targets.ajpf.test_runner import ENDING, RECORDED, Mcapl
from tests.effort import some
from tests.proofs import outcome

FILE = f"""+++
id = "R1"
verify = ["audit", "ajpf"]
+++
{R1}
"""
PLACE = "build/r1_ajpf/result.json"
Change = Callable[[dict[str, Any]], None]


@pytest.fixture(autouse=True)
def explored_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is found of the texts of an agent is found once for all tests."""
    monkeypatch.setattr(checking, "_checked", _checked)


@cache
def _checked(
    agent: Source, properties: Source, percepts: Sequence[str], limit: int, mutant: Source | None
) -> tuple[Proof, ...] | Diagnostic:
    return _CHECKED(agent, properties, percepts, limit, mutant)


_CHECKED = checking._checked


@pytest.fixture(scope="module")
def ran_once(tmp_path_factory: pytest.TempPathFactory) -> Mcapl:
    """A bundle with logs in the forms that AJPF prints."""
    mcapl = Mcapl(tmp_path_factory.mktemp("bundle"))
    broken = dict.fromkeys(("R1_reach.jpf", "R1_resp.jpf", "R1_mutant.jpf"), (RECORDED, 0))
    mcapl.says({"R1.jpf": (ENDING, 0), **broken})
    assert mcapl.run().returncode == 0
    return mcapl


@pytest.fixture
def ran(ran_once: Mcapl, tmp_path: Path) -> Mcapl:
    """A copy of it below `build/`."""
    return ran_once.copied(tmp_path / "build")


def only(mcapl: Mcapl, other: FormalizedRequirement | None = None) -> Proof:
    (proof,), diagnostics = ajpf_proofs(
        [other or requirement(R1)], [str(mcapl.bundle / "result.json")]
    )
    assert not diagnostics
    return proof


def changed(mcapl: Mcapl, change: Change) -> None:
    content = mcapl.result()
    change(content)
    (mcapl.bundle / "result.json").write_text(json.dumps(content))


@pytest.mark.slow
def test_what_ajpf_shows_of_what_is_made_now_is_shown(ran: Mcapl) -> None:
    line = only(ran)
    assert (line.requirement, line.layer) == ("R1", Layer.AJPF)
    assert line.result is ClaimResult.PROVED
    assert "(303, 303, 303, 303 states, " in line.detail
    assert line.claim == (
        "AJPF: every run of the agent of its bundle keeps R1: "
        "[] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))"
    )
    assert line.engine == "AJPF, MCAPL abababababab, Java 11.0.22"
    assert "r1_ajpf/SIF.gwen" in line.artefacts
    assert "r1_ajpf/README.md" not in line.artefacts


@pytest.mark.slow
def test_what_ajpf_refutes_is_refuted_with_its_run(ran: Mcapl) -> None:
    ran.says({"R1.jpf": (RECORDED, 0)})
    ran.run()
    result = outcome(only(ran))
    assert result.result is ClaimResult.COUNTEREXAMPLE
    assert result.detail == "AJPF found a run of 5 states that violates it"
    assert result.trace is not None
    assert result.trace.actions == ("", "", "", "drive_on", "")
    assert result.trace.cycle == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("outputs", "expected"),
    [
        ({"R1_reach.jpf": (ENDING, 0)}, vacuous("its control R1_reach holds")),
        (
            {"R1_mutant.jpf": (ENDING, 0)},
            vacuous("the agent without the response satisfies it too"),
        ),
        ({"R1.jpf": ("", 0)}, not_checked("R1.jpf: no verdict in the output, exit status 0")),
    ],
)
def test_what_is_not_as_expected_shows_nothing(
    ran: Mcapl, outputs: dict[str, tuple[str, int]], expected: ClaimOutcome
) -> None:
    ran.says(outputs)
    ran.run()
    assert outcome(only(ran)) == expected


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    some(["SIF.gwen", "SIF.psl", "SIF_mutant.gwen", "Env.java", "SIF.ail", "R1.jpf", "run.py"], 3),
)
def test_a_result_about_other_texts_is_stale(ran: Mcapl, name: str) -> None:
    changed(ran, lambda content: content["files"].update({name: "0" * 64}))
    reason = f"{name} is out of date: run AJPF again"
    assert outcome(only(ran)) == not_checked(reason)
    changed(ran, lambda content: content["files"].pop(name))
    assert only(ran).result is ClaimResult.NOT_CHECKED


@pytest.mark.slow
def test_a_result_of_the_requirement_as_it_was_is_stale(ran: Mcapl) -> None:
    now = requirement(R1.replace("whenever", "upon"))
    result = outcome(only(ran, now))
    assert result.result is ClaimResult.NOT_CHECKED
    assert "SIF.psl" in result.detail
    gone = requirement(R1.replace("eventually", "always"))
    result = outcome(only(ran, gone))
    assert result.result is ClaimResult.NOT_CHECKED
    assert result.detail.startswith("R1 can no longer be exported as a bundle: F614 ")


@pytest.mark.slow
def test_a_stale_refutation_is_told_as_one(ran: Mcapl) -> None:
    ran.says({"R1.jpf": (RECORDED, 0)})
    ran.run()
    changed(ran, lambda content: content["files"].update({"SIF.gwen": "0" * 64}))
    result = outcome(only(ran))
    assert result.result is ClaimResult.NOT_CHECKED
    assert result.detail.startswith("it was refuted; SIF.gwen is out of date")


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.update(checks=content["checks"][:1]),
        lambda content: content["checks"].append(content["checks"][1]),
        lambda content: content["checks"][3].update(expected="HOLDS", told="HOLDS"),
        lambda content: content["checks"][0].update(property="[] (T)"),
    ],
)
def test_a_result_without_its_controls_shows_nothing(ran: Mcapl, change: Change) -> None:
    changed(ran, change)
    line = only(ran)
    assert outcome(line) == not_checked(
        "its checks are not those of the present bundle: run AJPF again"
    )


def test_the_conclusion_of_the_file_is_not_believed(ran: Mcapl) -> None:
    def lie(content: dict[str, Any]) -> None:
        content["verdict"] = "shown"
        content["checks"][0]["told"] = "VIOLATED"

    changed(ran, lie)
    assert only(ran).result is ClaimResult.COUNTEREXAMPLE


@pytest.mark.slow
@pytest.mark.parametrize("name", some(["R1", "R1_reach", "R1_resp", "R1_mutant"], 3))
def test_a_result_is_held_against_the_logs_that_lie_beside_it(ran: Mcapl, name: str) -> None:
    log = ran.bundle / f"logs/{name}.jpf.txt"
    printed = log.read_bytes()
    log.write_bytes(printed + b"\n")
    assert outcome(only(ran)) == not_checked(
        f"logs/{name}.jpf.txt was changed since AJPF printed it: run AJPF again"
    )
    other = RECORDED if name == "R1" else ENDING
    log.write_text(other, encoding="utf-8")

    def rehash(content: dict[str, Any]) -> None:
        (check,) = (c for c in content["checks"] if c["jpf"] == f"{name}.jpf")
        check["log_sha256"] = hashlib.sha256(log.read_bytes()).hexdigest()

    changed(ran, rehash)
    result = outcome(only(ran))
    assert result.result is ClaimResult.NOT_CHECKED
    assert result.detail.endswith(f"but logs/{name}.jpf.txt does not")
    log.unlink()
    assert only(ran).result is ClaimResult.PROVED


@pytest.mark.slow
def test_an_agent_of_ones_own_counts_while_it_is_as_it_was(ran: Mcapl) -> None:
    own = ran.folder / "mine.gwen"
    own.write_text((ran.bundle / "SIF.gwen").read_text().replace("do_stopped", "brake"))
    assert ran.run("--agent", str(own)).returncode == 0
    line = only(ran)
    assert line.result is ClaimResult.PROVED
    assert line.claim.startswith("AJPF: every run of the agent of mine.gwen (SHA-256 ")
    assert "mine.gwen" in line.artefacts
    assert "r1_ajpf/SIF.gwen" not in line.artefacts
    own.write_text("GWENDOLEN")
    assert outcome(only(ran)) == not_checked(f"the agent {own} was changed since: run AJPF again")
    own.unlink()
    assert only(ran).result is ClaimResult.NOT_CHECKED


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "is not JSON"),
        ("[]", "is not what `run.py` writes"),
        ('{"schema": "fretc-ajpf-bundle-1"}', "is not what `run.py` writes"),
    ],
)
def test_a_file_that_is_no_result_is_refused(tmp_path: Path, text: str, what: str) -> None:
    (tmp_path / "result.json").write_text(text)
    result = read(str(tmp_path / "result.json"))
    assert isinstance(result, Diagnostic)
    assert result.code is Code.BAD_AJPF_RESULT
    assert what in result.message


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content["checks"][3]["trace"].update(cycle=9),
        lambda content: content["checks"][3]["trace"]["rows"].pop(),
        lambda content: content["checks"][0].update(told="PERHAPS"),
        lambda content: content.pop("files"),
    ],
)
def test_a_wrong_shape_within_is_refused(ran: Mcapl, change: Change) -> None:
    changed(ran, change)
    result = read(str(ran.bundle / "result.json"))
    assert isinstance(result, Diagnostic)
    assert result.code is Code.BAD_AJPF_RESULT


def test_a_result_about_another_requirement_is_told_and_does_not_count(ran: Mcapl) -> None:
    lines, (diagnostic,) = ajpf_proofs(
        [requirement(R1, id="R2")], [str(ran.bundle / "result.json")]
    )
    assert lines == ()
    assert diagnostic.code is Code.FOREIGN_AJPF_RESULT
    assert not diagnostic.is_error


def test_what_a_file_of_proofs_says_of_ajpf_gives_way_to_the_result_itself(ran: Mcapl) -> None:
    line = only(ran)
    old = replace(line, result=ClaimResult.VACUOUS, detail="before")
    other = replace(old, layer=Layer.MONITOR, result=ClaimResult.PROVED)
    assert [(p.layer, p.result) for p in merged([old, other], [line])] == [
        ("monitor", "proved"),
        ("ajpf", "proved"),
    ]
    green = replace(old, result=ClaimResult.PROVED)
    (left,) = merged([green], [])
    assert (left.result, left.detail[:11]) == ("not checked", "it was prov")
    red = replace(old, result=ClaimResult.COUNTEREXAMPLE)
    assert merged([red], []) == (red,)


@pytest.mark.slow
def test_a_weaker_property_does_not_show_the_requirement(ran: Mcapl) -> None:
    formalized = requirement("whenever too_close agilex_agent shall within 3 ticks satisfy stopped")
    for artifact in emit([formalized], TargetOptions(weaken=True)):
        ran.write(ran.folder / artifact.path, artifact.text)
    assert ran.run().returncode == 0
    result = outcome(only(ran, formalized))
    assert result.result is ClaimResult.NOT_CHECKED
    assert result.detail.startswith("what AJPF shows is weaker than R1: `within 3 ticks` has lost")
    ran.says({"R1.jpf": (RECORDED, 0)})
    ran.run()
    assert only(ran, formalized).result is ClaimResult.COUNTEREXAMPLE


# The commands ----------------------------------------------------------------------------------


def project(folder: Path) -> None:
    (folder / "requirements").mkdir()
    (folder / "requirements/r1.fret").write_text(FILE)


def planned(folder: Path) -> tuple[bool, str]:
    report = json.loads((folder / "report.json").read_text())
    (plan,) = (plan for plan in report["planned"] if plan["method"] == "ajpf")
    return plan["has_result"], plan["result"]


@pytest.mark.slow
def test_verify_and_report_read_it_as_the_planned_method(
    ran: Mcapl, fretc: Fretc, tmp_path: Path
) -> None:
    project(tmp_path)
    done = fretc("verify", "requirements/r1.fret", "--layer", "ajpf")
    assert done.status == 0
    assert done.out.startswith("✔ R1  ajpf  proved under (1-2): AJPF: every run of the agent")
    (line,) = json.loads((tmp_path / "build/verification.json").read_text())["evidence"]
    assert (line["layer"], line["result"]) == ("ajpf", "proved")
    fretc("report", "--html", "out.html", "--json", "report.json")
    assert planned(tmp_path) == (True, "1 claim proved")
    (tmp_path / PLACE).unlink()
    fretc("report", "--html", "out.html", "--json", "report.json")
    assert not planned(tmp_path)[0]


@pytest.mark.slow
def test_a_refutation_of_ajpf_is_red_in_both(ran: Mcapl, fretc: Fretc, tmp_path: Path) -> None:
    project(tmp_path)
    ran.says({"R1.jpf": (RECORDED, 0)})
    ran.run()
    done = fretc("verify", "requirements/r1.fret", "--layer", "ajpf")
    assert done.status == 1
    assert "drive_on" in done.out
    report = fretc("report", "--html", "out.html", "--json", "report.json", "--strict")
    assert report.status == 1
    assert planned(tmp_path)[1].startswith("counterexample: AJPF: ")


@pytest.mark.slow
def test_a_stale_result_is_said_and_does_not_count(
    ran: Mcapl, fretc: Fretc, tmp_path: Path
) -> None:
    project(tmp_path)
    changed(ran, lambda content: content["files"].update({"SIF.psl": "0" * 64}))
    done = fretc("verify", "requirements/r1.fret", "--layer", "ajpf")
    assert done.status == 3
    assert "SIF.psl is out of date" in done.out
    fretc("report", "--html", "out.html", "--json", "report.json")
    has_result, text = planned(tmp_path)
    assert not has_result
    assert "SIF.psl is out of date" in text


def test_without_a_result_the_layer_says_so(fretc: Fretc, tmp_path: Path) -> None:
    project(tmp_path)
    done = fretc("verify", "requirements/r1.fret", "--layer", "ajpf")
    assert done.status == 3
    assert "there is no result of AJPF" in done.out


def test_a_damaged_result_is_bad_input(ran: Mcapl, fretc: Fretc, tmp_path: Path) -> None:
    project(tmp_path)
    (tmp_path / PLACE).write_text("{")
    for command in (("verify", "requirements/r1.fret", "--layer", "ajpf"), ("report",)):
        done = fretc(*command)
        assert done.status == 2
        assert "F616" in done.err
