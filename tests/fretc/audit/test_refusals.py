"""An audit judges every requirement that it can, and loses sight of no other one."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.command import Fretc, write
from tests.effort import by_turns, some
from tests.fretc.logs.logs import MS, S, said
from tests.fretc.logs.logs import write as write_log
from tests.json_schemas import validate

BINDINGS = """\
[clock]
tick = "100 ms"
[signal.x]
path = "/a.x"
[proposition.p]
expr = "x > 0"
"""
REFUSED = {
    "an unbound proposition": ("the sw shall always satisfy nowhere", "", "", "F304"),
    "another comparison": (
        "the sw shall always satisfy speed <= 1.5",
        "",
        '[proposition."(speed <= 1.5)"]\nexpr = "x <= 15"\n',
        "F524",
    ),
    "a mistake in a proposition": (
        "the sw shall always satisfy q",
        "",
        '[proposition.q]\nexpr = "x >"\n',
        "F308",
    ),
    "a mistake in a signal": (
        "the sw shall always satisfy p & q",
        "",
        '[signal.y]\npath = "/a.y"\nunit = "parsec"\n[proposition.q]\nexpr = "y > 0"\n',
        "F306",
    ),
    "no FRETish": ("the sw must satisfy p", "", "", "F107"),
    "a bad header": ("the sw shall always satisfy p", 'status = "aproved"\n', "", "F105"),
    "a header that is no TOML": ("the sw shall always satisfy p", "status = \n", "", "F102"),
    "an unknown field": ("the sw shall always satisfy p", 'titel = "a"\n', "", "F103"),
    "params without a binding": (
        "the sw shall always satisfy p",
        'params = { q = "5 cm" }\n',
        "",
        "F309",
    ),
    "a look ahead": ("the sw shall always satisfy persists(2, p)", "", "", "F601"),
    "half a tick": ("the sw shall within 50 milliseconds satisfy p", "", "", "F307"),
}  # fmt: skip


def log(path: str, values: list[float]) -> str:
    """A value of `/a.x` every 100 ms."""
    messages = [said("/a", S + i * 100 * MS, x=value) for i, value in enumerate(values)]
    return str(write_log(Path(path), messages))


def project(sentence: str, header: str, bindings: str) -> None:
    """R1, which can be judged, and R2."""
    write("requirements/r1.fret", '+++\nid = "R1"\n+++\nthe sw shall always satisfy p\n')
    write("requirements/r2.fret", f'+++\nid = "R2"\n{header}+++\n{sentence}\n')
    write("requirements/bindings.toml", BINDINGS + bindings)


def rows(out: str) -> dict[str, str]:
    return {row["requirement"]: row["verdict"] for row in json.loads(out)}


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "verdict"), by_turns(REFUSED, "satisfied", "violated"))
def test_what_cannot_be_judged_is_no_data_beside_what_can(
    fretc: Fretc, kind: str, verdict: str
) -> None:
    values = [1.0, 1.0 if verdict == "satisfied" else 0.0, 1.0]
    sentence, header, bindings, code = REFUSED[kind]
    project(sentence, header, bindings)
    run = fretc("audit", log("l.mcap", values), "--format", "json")
    assert (run.status, rows(run.out)) == (2, {"R1": verdict, "R2": "no data"})
    assert f"{code} " in run.err
    evidence = json.loads(Path("build/evidence.json").read_text())
    validate("evidence.schema.json", evidence)
    assert [each["id"] for each in evidence["requirements"]] == ["R1", "R2"]
    (row,) = (row for row in evidence["results"] if row["requirement"] == "R2")
    assert row["reason"].startswith(f"not judged: {code} ")
    assert row["health"]["intact"], "the log itself is whole"
    check = fretc("check")
    assert (check.status, f"{code} " in check.err) == (2, True)


@pytest.mark.slow
@pytest.mark.parametrize("kind", some(REFUSED, 4))
def test_no_form_of_the_audit_and_of_the_report_loses_it(fretc: Fretc, kind: str) -> None:
    sentence, header, bindings, code = REFUSED[kind]
    project(sentence, header, bindings)
    log("l.mcap", [1, 1])
    suite = ElementTree.fromstring(fretc("audit", "l.mcap", "--format", "junit").out)[0]
    assert [(case.get("name"), [child.tag for child in case]) for case in suite] == [
        ("R1", []),
        ("R2", ["error"]),
    ]
    assert (
        "title=R2 no data::l.mcap: not judged" in fretc("audit", "l.mcap", "--format", "github").out
    )
    (sarif,) = json.loads(fretc("audit", "l.mcap", "--format", "sarif").out)["runs"]
    assert [result["ruleId"] for result in sarif["results"]] == ["R2"]  # findings alone
    assert not sarif["invocations"][0]["executionSuccessful"]
    notes = sarif["invocations"][0]["toolExecutionNotifications"]
    assert code in [note["descriptor"]["id"] for note in notes]
    assert fretc("audit", "l.mcap", "--annotate", "--parquet", "t.parquet").status == 2
    assert "R2" in fretc("audit", "t.parquet", "--summary").out
    run = fretc("report", "--junit", "j.xml", "--sarif", "s.sarif", "--csv", "c.csv", "--strict")
    assert run.status in (2, 3)
    cases = next(each for each in ElementTree.parse("j.xml").getroot() if len(each))
    assert [(case.get("name"), [child.tag for child in case]) for case in cases] == [
        ("R1", []),
        ("R2", ["error"]),
    ]
    for name in ("s.sarif", "c.csv", "build/report.html"):
        assert "R2" in Path(name).read_text("utf-8")


@pytest.mark.slow
def test_a_run_that_cannot_be_read_has_a_row_for_it_too(fretc: Fretc) -> None:
    project("the sw shall always satisfy nowhere", "", "")
    log("l.mcap", [1])
    run = fretc("audit", "l.mcap", write("broken.mcap", "x"), "--format", "json")
    rows = [(row["run"], row["requirement"], row["verdict"]) for row in json.loads(run.out)]
    assert rows == [
        ("l.mcap", "R1", "satisfied"),
        ("l.mcap", "R2", "no data"),
        ("broken.mcap", "R1", "no data"),
        ("broken.mcap", "R2", "no data"),
    ]


def test_two_requirements_of_one_id_are_one_row_without_a_verdict(fretc: Fretc) -> None:
    project("the sw shall always satisfy p", "", "")
    write("requirements/r3.fret", '+++\nid = "R2"\n+++\nthe sw shall never satisfy p\n')
    run = fretc("audit", log("l.mcap", [1]), "--format", "json")
    assert (run.status, rows(run.out)) == (2, {"R1": "satisfied", "R2": "no data"})
    assert len(json.loads(run.out)) == 2


@pytest.mark.parametrize(
    ("text", "id"),
    [
        ("+++\nid = R7\n+++\nthe sw shall always satisfy p\n", "r2"),
        ("+++\ntitle = 3\n+++\nthe sw shall always satisfy p\n", "r2"),
        ('+++\nid = "R7"\nthe sw shall always satisfy p\n', "r2"),
        ("the sw shall satisfy p\n+++\nid = 7\n+++\nthe sw shall satisfy p\n", "r2-line-5"),
    ],
)
def test_a_requirement_whose_id_cannot_be_read_is_called_by_its_file(
    fretc: Fretc, text: str, id: str
) -> None:
    project("the sw shall always satisfy p", "", "")
    write("requirements/r2.fret", text)
    run = fretc("audit", log("l.mcap", [1]), "--format", "json")
    assert run.status == 2
    assert rows(run.out)["R1"] == "satisfied"
    assert rows(run.out)[id] == "no data"


def test_a_retired_requirement_is_not_missed(fretc: Fretc) -> None:
    project("the sw shall always satisfy nowhere", 'status = "retired"\n', "")
    run = fretc("audit", log("l.mcap", [1]), "--format", "json")
    assert (run.status, rows(run.out)) == (0, {"R1": "satisfied"})
    assert fretc("check").status == 0


def test_where_nothing_can_be_judged_the_evidence_of_before_stays(fretc: Fretc) -> None:
    project("the sw shall always satisfy p", "", "")
    log("l.mcap", [1])
    assert fretc("audit", "l.mcap").status == 0
    before = Path("build/evidence.json").read_bytes()
    for bindings in (
        BINDINGS.replace("x > 0", "x >"),
        BINDINGS.replace("proposition.p", "proposition.q"),
    ):
        write("requirements/bindings.toml", bindings)
        assert fretc("audit", "l.mcap").status == 2
        assert Path("build/evidence.json").read_bytes() == before


def test_bindings_that_are_not_there_are_told_once(fretc: Fretc) -> None:
    project("the sw shall always satisfy p", "", "")
    Path("requirements/bindings.toml").unlink()
    check, audit = fretc("check"), fretc("audit", log("l.mcap", [1]))
    assert (check.status, audit.status) == (2, 2)
    assert check.err.count("no bindings map") == audit.err.count("no bindings map") == 1


def test_evidence_is_not_verified_by_a_project_that_cannot_be_judged(fretc: Fretc) -> None:
    project("the sw shall always satisfy nowhere", "", "")
    log("l.mcap", [1])
    assert fretc("audit", "l.mcap").status == 2
    assert fretc("verify-evidence").status == 2


@pytest.mark.parametrize("name", ["p_near", "(p >= 3)", "P", "pp", "q"])
def test_no_other_proposition_is_proposed(fretc: Fretc, name: str) -> None:
    """`too_near` for `too_far` would be another safety claim, `(p >= 3)` for `(p >= 2)` too."""
    bound = f"[proposition.'{name}']\nexpr = \"x >= 3\"\n"
    sentence = "the sw shall always satisfy p_neat & pq & p >= 2"
    project(sentence, 'params = { pq = "5 cm" }\n', bound)
    run = fretc("check")
    assert run.status == 2
    assert "did you mean" not in run.err
    assert name == "q" or f"[proposition.{name}]" not in run.err
    assert "`[signal.p]`" in run.err
