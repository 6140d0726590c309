"""`verify-evidence --strict`: what is not signed, not reviewed or not listed does not stand."""

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from tests.command import Fretc, made_once, write
from tests.fretc.commands.test_sign import EVIDENCE, LOCK, SIGNERS, trust
from tests.fretc.commands.test_sign import project as project
from tests.fretc.commands.test_verify_evidence import manifested

REVIEW = ("--reviewer", "Ada", "--role", "b", "--comment", "c", "--accept-violations")
REPORT = "build/report.html"
STRICTLY = ("verify-evidence", "--strict", "--manifest", "logs.sha256", "--report", REPORT)


@pytest.fixture
def complete(project: Fretc) -> Fretc:
    """All that is demanded is there."""

    def make() -> None:
        trust("ada")
        manifested()
        assert project("lock", *REVIEW).status == 0
        for path in (EVIDENCE, LOCK):
            assert project("sign", path, "--key", "ada").status == 0
        assert project("report", "--html", REPORT).status == 0
        assert project("sign", REPORT, "--key", "ada").status == 0

    made_once("all that is demanded", make)
    return project


@pytest.mark.slow
def test_what_is_signed_reviewed_and_listed_stands(complete: Fretc) -> None:
    run = complete(*STRICTLY)
    assert (run.status, run.err) == (0, "")
    assert complete(*STRICTLY, "--signed-by", "ada.pub").status == 0


def _taken(path: str) -> Callable[[Fretc], None]:
    return lambda fretc: Path(path).unlink()


def _signed_by_bob(path: str) -> Callable[[Fretc], None]:
    def sign(fretc: Fretc) -> None:
        Path(f"{path}.intoto.jsonl").unlink()
        assert fretc("sign", path, "--key", "bob").status == 0

    return sign


def _without_a_review(fretc: Fretc) -> None:
    text = Path(LOCK).read_text()
    head, *reviews = text.split("[review.r2]")
    assert reviews
    write(LOCK, head)


def _without_a_run(fretc: Fretc) -> None:
    write("logs.sha256", Path("logs.sha256").read_text().splitlines()[0] + "\n")


def _reviewed_by_bob(fretc: Fretc) -> None:
    trust("ada", "bob")
    assert fretc("sign", EVIDENCE, REPORT, "--key", "ada").status == 0
    by = ("--reviewer", "Bob", "--role", "b", "--comment", "c", "--accept-violations")
    assert fretc("lock", "r1", *by).status == 0
    assert fretc("sign", LOCK, "--key", "ada", "--reviewer", "Bob").status == 0


MISSING: Mapping[str, tuple[Callable[[Fretc], None], str]] = {
    "the signature of the evidence": (
        _taken(f"{EVIDENCE}.intoto.jsonl"),
        "the evidence is not signed: nobody signed it",
    ),
    "the signature of the lock": (
        _taken(f"{LOCK}.intoto.jsonl"),
        "its review is not signed: nobody signed it",
    ),
    "the signature of the report": (
        _taken(f"{REPORT}.intoto.jsonl"),
        "(report) is not signed: nobody signed it",
    ),
    "a known key of the evidence": (_signed_by_bob(EVIDENCE), "the evidence is not signed"),
    "a known key of the lock": (_signed_by_bob(LOCK), "its review is not signed"),
    "a known key of the report": (_signed_by_bob(REPORT), "(report) is not signed"),
    "the reviewer's own signature": (_reviewed_by_bob, "who is not Bob"),
    "the list of signers": (_taken(SIGNERS), "but there is no list of signers"),
    "the lock": (_taken(LOCK), "it is not reviewed"),
    "a review": (_without_a_review, "it is not reviewed"),
    "a run in the manifest": (_without_a_run, "the manifest does not name it"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MISSING)
def test_each_thing_that_is_missing_is_a_difference(complete: Fretc, name: str) -> None:
    take, why = MISSING[name]
    take(complete)
    run = complete(*STRICTLY)
    assert run.status == 1
    assert why in run.out


def test_without_a_manifest_it_does_not_stand(complete: Fretc) -> None:
    run = complete("verify-evidence", "--strict")
    assert run.status == 1
    assert "differs: its runs are not listed in a `--manifest`" in run.out
