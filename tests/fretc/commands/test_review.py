"""`fretc lock` and `fretc diff`: what they print, write, and exit with."""

import json
import tomllib
from pathlib import Path

import pytest

from compiler.project.folder import load
from fretc.traceability.artefacts import shared_products
from fretc.traceability.chain import Chain
from fretc.traceability.lock import unnamed_violations
from tests.command import Fretc, write
from tests.fretc.report import cases

BY = ("--reviewer", "A. Meier", "--role", "safety engineer", "--comment", "first review")
ON = ("--date", "2026-11-22")


@pytest.fixture
def folder(fretc: Fretc) -> Path:
    """A requirement that was audited, in `requirements`."""
    project = cases.project(Path("requirements"))
    found = cases.evidence(project, cases.result(project, "satisfied"))
    write("build/evidence.json", json.dumps(found))
    return Path("requirements")


def test_nothing_has_changed_right_after_a_review(fretc: Fretc, folder: Path) -> None:
    run = fretc("lock", *BY, *ON)
    assert (run.status, run.out) == (0, "")
    assert run.err == (
        "wrote requirements/fretc.lock\naccepted R1: satisfied in 1 run\n"
        "accepted 1 requirement: 0 violated, 0 not shown\n"
    )
    run = fretc("diff")
    assert (run.status, run.out, run.err) == (0, "R1  as it was reviewed\n", "")


def test_two_reviews_of_one_state_give_the_same_bytes(fretc: Fretc, folder: Path) -> None:
    lock = folder / "fretc.lock"
    assert fretc("lock", *BY, *ON).status == 0
    first = lock.read_bytes()
    assert fretc("lock", *BY, *ON).status == 0
    assert lock.read_bytes() == first


def test_a_changed_threshold_is_told_with_the_links_below_it(fretc: Fretc, folder: Path) -> None:
    assert fretc("lock", *BY, *ON).status == 0
    bindings = folder / "bindings.toml"
    bindings.write_text(bindings.read_text().replace("< 5 cm", "< 90 cm"))
    run = fretc("diff")
    assert run.status == 3
    assert run.out == (
        "R1  changed since the review of 2026-11-22 by A. Meier\n"
        "  near: clearance < 5 cm → 90 cm\n"
        "  1 verdict is from before the change: audit again\n"
        "  2 links are suspect: near changed\n"
    )


def test_bindings_and_hazards_of_another_folder_are_reviewed(fretc: Fretc, folder: Path) -> None:
    options = []
    for name in ("bindings", "hazards"):
        (folder / f"{name}.toml").rename(f"{name}.toml")
        options += [f"--{name}", f"{name}.toml"]
    run = fretc("lock", *BY, *ON, *options)
    assert (run.status, "accepted R1: satisfied in 1 run" in run.err) == (0, True)
    assert fretc("diff", *options).out == "R1  as it was reviewed\n"
    bindings = Path("bindings.toml")
    bindings.write_text(bindings.read_text().replace("< 5 cm", "< 90 cm"))
    run = fretc("diff", *options)
    assert run.status == 3
    assert "near: clearance < 5 cm → 90 cm" in run.out


def test_another_verdict_is_told(fretc: Fretc, folder: Path) -> None:
    assert fretc("lock", *BY, *ON).status == 0
    project = cases.project(folder)
    broken = cases.result(project, "violated", violations=[cases.violation(40, 42)])
    write("build/evidence.json", json.dumps(cases.evidence(project, broken)))
    run = fretc("diff", "--format", "json")
    assert run.status == 3
    (told,) = json.loads(run.out)
    assert told["verdicts"] == [{"run": "logs/a.mcap", "before": "satisfied", "now": "violated"}]
    assert told["changes"] == [
        {
            "thing": "verdict:R1 logs/a.mcap",
            "what": "verdict of logs/a.mcap",
            "before": "satisfied",
            "after": "violated",
            "text": "verdict of logs/a.mcap: satisfied → violated",
        }
    ]
    assert told["consequences"] == ["1 verdict became violated"]
    assert told["suspect_links"] == [
        {
            "from": "verdict:R1 logs/a.mcap",
            "to": "review:R1",
            "because_of": ["verdict:R1 logs/a.mcap"],
        }
    ]


def test_one_requirement_is_accepted_and_the_review_of_the_other_stays(
    fretc: Fretc, folder: Path
) -> None:
    write("requirements/b.fret", cases.requirement("B", "the robot shall always satisfy stopped"))
    assert fretc("lock", *BY, *ON).status == 0
    other = ("--reviewer", "B. Okoye", "--role", "assessor", "--comment", "again")
    assert fretc("lock", "B", *other, "--date", "2026-11-21").status == 0
    text = (folder / "fretc.lock").read_text()
    assert text.count("A. Meier") == 1
    assert text.count("B. Okoye") == 1
    assert fretc("diff").status == 0


def test_a_requirement_that_was_deleted_and_one_that_is_new_are_told(
    fretc: Fretc, folder: Path
) -> None:
    assert fretc("lock", *BY, *ON).status == 0
    write("requirements/r1.fret", cases.requirement("R2", "the robot shall always satisfy stopped"))
    run = fretc("diff")
    assert run.status == 3
    assert "R2  not reviewed\n" in run.out
    assert "R1  in the review of 2026-11-22 by A. Meier, but no longer in the project\n" in run.out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("lock", *BY, "--date", "22.11.2026"), "F907 `22.11.2026` is no date"),
        (("lock", *BY, "r1"), "F907 there is no requirement `r1`\nhelp: did you mean `R1`?"),
        (("lock", "--reviewer", " ", *BY[2:]), "F907 `--reviewer` says nothing"),
        (("lock", "--reviewer", "A"), "F907 missing option '--role'"),
        (("diff",), "F901 no requirement is reviewed: there is no `requirements/fretc.lock`"),
        (("diff", "other.lock"), "F901 no requirement is reviewed: there is no `other.lock`"),
        (("lock", *BY, "--requirements", "no"), "F901 there is no folder `no`"),
    ],
)
def test_wrong_use_is_told_and_nothing_is_written(
    fretc: Fretc, folder: Path, arguments: tuple[str, ...], told: str
) -> None:
    run = fretc(*arguments)
    assert run.status == 2
    assert told in run.err
    assert not (folder / "fretc.lock").exists()


def test_a_lock_that_cannot_be_read_is_not_written_over(fretc: Fretc, folder: Path) -> None:
    path = write("requirements/fretc.lock", "<<<<<<< ours\n")
    run = fretc("lock", *BY, *ON)
    assert run.status == 2
    assert run.err.startswith("F510 the lock is not TOML")
    assert Path(path).read_text() == "<<<<<<< ours\n"


def test_requirements_with_mistakes_are_not_accepted(fretc: Fretc, folder: Path) -> None:
    write("requirements/b.fret", "the robot shal always satisfy stopped")
    assert fretc("lock", "b", *BY, *ON).status == 2
    assert not (folder / "fretc.lock").exists()
    run = fretc("lock", *BY, *ON)
    assert run.status == 2
    assert "accepted 1 requirement: " in run.err
    assert "left out because of errors: 1 of 2 requirements\n  F107 " in run.err
    lock = tomllib.loads((folder / "fretc.lock").read_text())
    assert [*lock["review"]] == ["R1"]


def test_the_review_of_a_requirement_with_a_mistake_stays(fretc: Fretc, folder: Path) -> None:
    write("requirements/b.fret", "the robot shall always satisfy stopped")
    assert fretc("lock", *BY, *ON).status == 0
    before = tomllib.loads((folder / "fretc.lock").read_text())["review"]
    write("requirements/b.fret", "the robot shal always satisfy stopped")
    assert fretc("lock", *BY[:-1], "second review", *ON).status == 2
    after = tomllib.loads((folder / "fretc.lock").read_text())["review"]
    assert after["b"] == before["b"]
    assert after["R1"]["comment"] == "second review"


# Proofs -----------------------------------------------------------------------------------------


def proved(claim: str, result: str = "proved", **artefacts: str) -> dict[str, object]:
    return {
        "requirement": "R1",
        "layer": "loop",
        "claim": claim,
        "result": result,
        "detail": "d",
        "assumptions": ["a"],
        "engine": "fretc",
        "artefacts": artefacts,
    }


def verified(*records: dict[str, object]) -> None:
    document = {"schema": "fretc-verification-1", "fretc": "0.1.0", "evidence": list(records)}
    write("build/verification.json", json.dumps(document))


def test_a_proof_that_turned_out_otherwise_is_told(fretc: Fretc, folder: Path) -> None:
    verified(proved("it holds"))
    assert fretc("lock", *BY, *ON).status == 0
    assert fretc("diff").status == 0
    verified(proved("it holds", "counterexample"))
    run = fretc("diff")
    assert run.status == 3
    assert "  proof of loop: it holds: proved → counterexample\n" in run.out
    assert "  1 link is suspect: proof of loop: it holds changed\n" in run.out


def test_another_assumption_makes_the_proof_below_it_suspect(fretc: Fretc, folder: Path) -> None:
    loop = '[interceptor]\nstop = "/s"\ncommand = "/c"\noutput = "/o"\nperiod = "50 ms"\n'
    assumed = '[assume]\nstands = "stopped"\nlatency = "100 ms"\nbraking = "200 ms"\n'
    bindings = folder / "bindings.toml"
    bindings.write_text(f"{bindings.read_text()}\n{loop}\n{assumed}")
    declared = load(["requirements/r1.fret"], str(bindings)).declarations
    shared = {product.file: product.sha256 for product in shared_products(declared)}
    verified(proved("it holds", **shared))
    assert fretc("lock", *BY, *ON).status == 0
    assert fretc("diff").status == 0
    bindings.write_text(bindings.read_text().replace('braking = "200 ms"', 'braking = "900 ms"'))
    run = fretc("diff")
    assert run.status == 3
    known = "shared:[interceptor] and [assume]"
    assert "  braking of [assume]: 200 ms → 900 ms\n" in run.out
    links = json.loads(fretc("diff", "--format", "json").out)[0]["suspect_links"]
    assert {"from": known, "to": "proof:R1 loop: it holds", "because_of": [known]} in links
    assert "verdict" not in run.out, "what logs show does not depend on it"


def test_a_proof_after_the_review_changes_nothing_that_was_reviewed(
    fretc: Fretc, folder: Path
) -> None:
    assert fretc("lock", *BY, *ON).status == 0
    verified(proved("it holds"))
    run = fretc("diff")
    assert "suspect" not in run.out
    assert "  proof of loop: it holds: none → proved\n" in run.out


# What is accepted ------------------------------------------------------------------------------


def audited(folder: Path, **verdicts: str) -> None:
    """Evidence of runs, each with its verdict."""
    project = cases.project(folder)
    results = [
        cases.result(
            project,
            verdict,
            run=f"{run}.mcap",
            violations=[cases.violation(40, 42)] if verdict == "violated" else [],
        )
        for run, verdict in verdicts.items()
    ]
    write("build/evidence.json", json.dumps(cases.evidence(project, *results)))


def test_a_violation_is_accepted_by_name_only(fretc: Fretc, folder: Path) -> None:
    audited(folder, a="satisfied", b="violated", c="violated")
    run = fretc("lock", *BY, *ON)
    assert (run.status, run.out) == (2, "")
    assert run.err == (
        "F529 R1 is violated in b.mcap, c.mcap; satisfied in 1 run\n"
        "help: fix it, or accept the violation: add `--accept-violations`\n"
    )
    assert not (folder / "fretc.lock").exists()
    run = fretc("lock", *BY, *ON, "--accept-violations")
    assert run.status == 0
    assert "accepted R1: violated in b.mcap, c.mcap; satisfied in 1 run\n" in run.err
    assert run.err.endswith("accepted 1 requirement: 1 violated, 0 not shown\n")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("verdicts", "violated", "not_shown"),
    [
        ({}, [], ["R1"]),
        ({"a": "satisfied", "b": "satisfied"}, [], []),
        ({"a": "satisfied", "b": "no data"}, [], ["R1"]),
        ({"a": "vacuous"}, [], ["R1"]),
        ({"a": "inconclusive", "b": "violated"}, ["R1"], []),
    ],
)
def test_what_is_accepted_though_it_is_not_shown_is_counted(
    fretc: Fretc,
    folder: Path,
    verdicts: dict[str, str],
    violated: list[str],
    not_shown: list[str],
) -> None:
    audited(folder, **verdicts)
    run = fretc("lock", *BY, *ON, "--accept-violations", "--format", "json")
    assert run.status == 0
    assert json.loads(run.out) == {
        "accepted": {"R1": {f"{name}.mcap": verdict for name, verdict in verdicts.items()}},
        "violated": violated,
        "not_shown": not_shown,
        "together": {},
        "left_out": [],
    }
    run = fretc("lock", *BY, *ON, "--accept-violations")
    assert run.err.endswith(
        f"accepted 1 requirement: {len(violated)} violated, {len(not_shown)} not shown\n"
    )


def test_of_others_than_the_chosen_ones_nothing_is_asked(fretc: Fretc, folder: Path) -> None:
    audited(folder, a="violated")
    write("requirements/r2.fret", '+++\nid = "R2"\n+++\nthe sw shall always satisfy near\n')
    run = fretc("lock", "R2", *BY, *ON)
    assert run.status == 0
    assert "accepted R2: not audited in any run\n" in run.err


def test_the_verdicts_are_named_the_worst_first(fretc: Fretc, folder: Path) -> None:
    audited(folder, a="satisfied", b="no data", c="inconclusive", d="no data")
    run = fretc("lock", *BY, *ON)
    assert run.status == 0
    told = "no data in 2 runs; inconclusive in 1 run; satisfied in 1 run"
    assert f"accepted R1: {told}\n" in run.err


def test_of_many_violated_runs_some_are_named(fretc: Fretc, folder: Path) -> None:
    audited(folder, **dict.fromkeys("abcde", "violated"))
    told = "F529 R1 is violated in a.mcap, b.mcap, c.mcap and 2 more runs\n"
    assert told in fretc("lock", *BY, *ON).err


def test_what_all_runs_refute_is_accepted_by_name_only() -> None:
    chain = Chain("R1", {}, ())
    (wrong,) = unnamed_violations([chain], {"R1"})
    assert wrong.message == "R1 is refuted by all runs"
    assert unnamed_violations([chain], {"R2"}) == ()
