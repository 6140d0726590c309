"""`fretc sign` and `fretc verify-evidence` of what `fretc analyze` has found."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests import keys
from tests.command import Fretc, made_once, write
from tests.fretc.commands.test_sign import envelopes, payload, signed
from tests.fretc.commands.test_verify_evidence import BINDINGS, R1, log

ANALYSIS = "build/analysis.json"
Change = Callable[[dict[str, Any]], object]


@pytest.fixture
def analyzed(fretc: Fretc) -> Fretc:
    """One log, and three requirements that fight."""

    def make() -> None:
        sentences = (R1, "the sw shall always satisfy p", "the sw shall never satisfy q")
        for number, sentence in enumerate(sentences, 1):
            write(f"requirements/r{number}.fret", sentence)
        roles = BINDINGS.replace('path = "/x.data"', 'path = "/x.data"\nrole = "output"')
        write("requirements/bindings.toml", roles)
        log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0)
        fretc("audit", "logs", "-o", "build/evidence.json")
        assert fretc("analyze", "requirements").status == 1

    made_once("a set that was analyzed", make)
    return fretc


def changed(change: Change) -> None:
    """Another file than the one that was written, which does not contradict itself."""
    known = json.loads(Path(ANALYSIS).read_text())
    change(known["analysis"])
    write(ANALYSIS, json.dumps(known))


def together(fretc: Fretc) -> tuple[int, str]:
    """What is said of the analysis."""
    run = fretc("verify-evidence")
    return run.status, run.out.partition("all together\n")[2]


@pytest.mark.slow
def test_an_analysis_that_nobody_touched_stands(analyzed: Fretc) -> None:
    status, said = together(analyzed)
    assert status == 0, said
    assert said.startswith(
        "  ✔     stands: r1, r2, r3: unrealizable\n"
        "  ✔     stands: conflict of r1, r2, r3\n"
        "  ✔     stands: other results\n"
    )


def realizable(found: dict[str, Any]) -> None:
    found["verdict"], found["conflicts"] = "realizable", []
    for each in found["components"]:
        each["verdict"] = "realizable"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "said"),
    [
        (realizable, "✘     differs: r1, r2, r3: they are unrealizable now, and the file says"),
        (realizable, "✘     differs: conflict of r1, r2, r3: it is missing from the file\n"),
        (
            lambda found: found["conflicts"][0]["play"].append({}),
            "✘     differs: conflict of r1, r2, r3: its counterexample run differs\n",
        ),
        (
            lambda found: found["conflicts"].append(
                found["conflicts"][0] | {"requirements": ["r1", "r3"]}
            ),
            "✘     differs: conflict of r1, r3: this conflict does not exist now\n",
        ),
        (
            lambda found: found["conflicts"].append(found["conflicts"][0]),
            "✘     differs: a conflict appears twice\n",
        ),
        (
            lambda found: found["terms"].pop(),
            "✘     differs: other results: it differs in terms\n",
        ),
        (
            lambda found: found["roles"].update(p="input"),
            "✘     differs: other results: it differs in roles\n",
        ),
    ],
)
def test_an_analysis_that_was_changed_by_hand_is_found(
    analyzed: Fretc, change: Change, said: str
) -> None:
    changed(change)
    status, found = together(analyzed)
    assert status == 1
    assert said in found


@pytest.mark.slow
def test_an_analysis_of_other_requirements_differs(analyzed: Fretc) -> None:
    write("requirements/r2.fret", "the sw shall immediately satisfy p")
    write("requirements/r4.fret", "the sw shall never satisfy !p")
    status, found = together(analyzed)
    assert status == 1
    assert "differs: r2 has changed since\n" in found
    assert "? r4  not checked: it was not part of the set\n" in found


@pytest.mark.slow
def test_what_is_not_asked_again_is_not_checked(analyzed: Fretc) -> None:
    run = analyzed("verify-evidence", "--no-analysis")
    assert (run.status, "?     not checked: the analysis was not repeated" in run.out) == (3, True)
    run = analyzed("verify-evidence", "--only", "r1")
    assert (run.status, "not checked: the analysis was not repeated: `--only`" in run.out) == (
        3,
        True,
    )
    analyzed("analyze", "requirements", "--as-fret")
    run = analyzed("verify-evidence")
    assert (run.status, "not checked: it answers FRET's question" in run.out) == (3, True)


@pytest.mark.slow
def test_what_was_not_checked_is_not_checked(analyzed: Fretc) -> None:
    def unknown(found: dict[str, Any]) -> None:
        found["verdict"], found["conflicts"], found["complete"] = "not checked", [], False
        for each in found["components"]:
            each["verdict"] = "not checked"

    changed(unknown)
    status, found = together(analyzed)
    assert status == 1
    assert "they are unrealizable now, and the file says not checked\n" in found
    assert "?     not checked: conflict of r1, r2, r3: it is missing from the file\n" in found


@pytest.mark.slow
def test_an_analysis_is_signed_and_a_signature_is_demanded(analyzed: Fretc) -> None:
    for name in ("ada", "bob"):
        keys.written(name)
    run = analyzed("sign", ANALYSIS, "--key", "ada")
    assert run.status == 0
    assert run.err.startswith(
        "analysis build/analysis.json: unrealizable\n  conflict of r1, r2, r3\n"
    )
    said = payload(envelopes(ANALYSIS)[0])
    assert said["predicateType"] == "urn:fretc:analysis:1"
    assert [one["name"] for one in said["subject"]] == ["analysis:analysis.json"]
    assert said["predicate"]["conflicts"] == [["r1", "r2", "r3"]]
    assert analyzed("sign", "build/evidence.json", "--key", "ada").status == 0
    by = ("verify-evidence", "--analysis", ANALYSIS, "--no-analysis", "--signed-by")
    assert analyzed(*by, "ada.pub").status == 3
    write("requirements/allowed_signers", keys.line("Ada", "ada"))
    analyzed("report", "--json", "r.json")
    said = signed(json.loads(Path("r.json").read_text()))
    assert said["analysis build/analysis.json"][0] == "signed"
    changed(lambda found: found["terms"].pop())
    run = analyzed(*by, "ada.pub")
    assert (run.status, f"F558 `{ANALYSIS}` is not signed" in run.err) == (1, True)
