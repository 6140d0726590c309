"""Whether requirements can be satisfied together: what the report shows of an analysis."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.command import Fretc
from tests.json_schemas import validate

FIGHT = {
    "R1": "whenever start the line shall within 2 ticks satisfy run",
    "R2": "upon stop the line shall for 3 ticks satisfy !run",
}
FREE = {"R1": FIGHT["R1"], "R2": "upon stop the line shall within 3 ticks satisfy !run"}
ROLES = {"start": "input", "stop": "input", "run": "output"}


def write(sentences: Mapping[str, str]) -> None:
    Path("requirements").mkdir(exist_ok=True)
    texts = (f'+++\nid = "{id}"\n+++\n{text}\n' for id, text in sentences.items())
    Path("requirements/r.fret").write_text("\n".join(texts))
    tables = (f'[variable.{name}]\nrole = "{role}"\n' for name, role in ROLES.items())
    Path("requirements/bindings.toml").write_text("".join(tables))


def report(fretc: Fretc, *options: str) -> Any:
    """The report for programs; the page is made beside it."""
    run = fretc("report", "--json", "r.json", "-o", "r.html", *options)
    assert run.status == 0, run.err
    content = json.loads(Path("r.json").read_text())
    validate("report.schema.json", content)
    return content


def test_nothing_is_said_where_nobody_has_asked(fretc: Fretc) -> None:
    write(FIGHT)
    content = report(fretc)
    assert content["analysis"] is None
    assert 'id="together"' not in Path("r.html").read_text()


@pytest.mark.slow
def test_a_conflict_is_in_every_headline(fretc: Fretc) -> None:
    write(FIGHT)
    assert fretc("analyze").status == 1
    content = report(fretc)
    conflict = "R1 and R2 cannot be satisfied together."
    told = f"{conflict} This follows from the sentences, not from the runs."
    assert content["front"]["headline"].endswith(told)
    assert content["overall"]["headline"].endswith(told)
    assert content["overall"]["mark"]["word"] == "cannot be satisfied together"
    assert told in fretc("report", "--format", "markdown").out.splitlines()[0]
    assert fretc("report", "--strict").status == 1


@pytest.mark.slow
def test_the_play_is_drawn_and_stands_in_a_table(fretc: Fretc) -> None:
    write(FIGHT)
    fretc("analyze")
    (conflict,) = report(fretc)["analysis"]["conflicts"]
    assert [each["requirement"] for each in conflict["members"]] == ["R1", "R2"]
    assert conflict["play"]["ticks"] == ["0", "1", "2"]
    lanes = {each["name"]: each["values"] for each in conflict["play"]["lanes"]}
    assert lanes["run"][-1] == "1"
    assert lanes["stop"][0] == "1"
    html = Path("r.html").read_text()
    assert '<section id="together">' in html
    assert html.count('class="play"') >= 1
    assert "at tick 2 R1 demands" in html


@pytest.mark.slow
def test_a_conflict_without_a_run_is_still_one(fretc: Fretc) -> None:
    """The run of a conflict may take too long to find."""
    write(FIGHT)
    fretc("analyze")
    path = Path("build/analysis.json")
    content = json.loads(path.read_text())
    content["analysis"]["conflicts"][0]["play"] = []
    path.write_text(json.dumps(content))
    assert "R1 and R2 cannot be satisfied together." in report(fretc)["front"]["headline"]
    assert "No run is drawn" in Path("r.html").read_text()


@pytest.mark.slow
def test_a_set_that_can_be_kept_takes_nothing_from_the_headline(fretc: Fretc) -> None:
    write(FREE)
    headline = report(fretc)["front"]["headline"]
    assert fretc("analyze").status == 0
    content = report(fretc)
    assert content["front"]["headline"] == headline
    assert "All requirements can be satisfied together." in content["front"]["notes"]


@pytest.mark.slow
@pytest.mark.parametrize("now", [FIGHT, {"R1": FIGHT["R1"]}, {**FREE, "R3": FIGHT["R2"]}])
def test_an_analysis_of_other_requirements_is_suspect(fretc: Fretc, now: Mapping[str, str]) -> None:
    """A good answer about what was there before is no answer about what is there now."""
    write(FREE)
    assert fretc("analyze").status == 0
    write(now)
    content = report(fretc)
    assert content["analysis"]["mark"]["suspect"]
    assert "is suspect: R" in content["front"]["headline"]
    assert fretc("report", "--strict").status == 1


@pytest.mark.slow
def test_a_stale_conflict_stays_in_the_headline(fretc: Fretc) -> None:
    write(FIGHT)
    fretc("analyze")
    write(FREE)
    headline = report(fretc)["front"]["headline"]
    assert "R1 and R2 cannot be satisfied together." in headline
    assert "is suspect: R2 has changed since." in headline


@pytest.mark.slow
def test_what_is_not_known_is_in_the_headline(fretc: Fretc) -> None:
    write({**FREE, "R2": "the line shall always satisfy nextOcc(run, stop)"})
    assert fretc("analyze").status == 3
    content = report(fretc)
    assert (
        "Whether all requirements can be satisfied together is not known"
        in (content["front"]["headline"])
    )
    assert fretc("report", "--strict").status in (1, 3)


@pytest.mark.slow
def test_free_text_was_not_asked_about(fretc: Fretc) -> None:
    write({**FREE, "R3": '"It should look nice."'})
    assert fretc("analyze").status == 0
    content = report(fretc)
    assert content["analysis"]["left_out"] == ["R3"]
    assert (
        "Not analyzed: whether R3 can be satisfied together with the others."
        in (content["front"]["headline"])
    )


def test_a_retired_requirement_is_no_member(fretc: Fretc) -> None:
    write(FIGHT)
    text = Path("requirements/r.fret").read_text()
    Path("requirements/r.fret").write_text(
        text.replace('id = "R2"', 'id = "R2"\nstatus = "retired"')
    )
    assert fretc("analyze").status == 0
    assert report(fretc)["analysis"]["suspicions"] == []


def test_a_file_that_is_no_analysis_stops_the_report(fretc: Fretc) -> None:
    write(FREE)
    Path("a.json").write_text("{}")
    run = fretc("report", "--analysis", "a.json", "-o", "r.html")
    assert run.status == 2
    assert run.err.splitlines()[0].startswith("F503 `a.json` is not what `fretc analyze` writes")
    assert not Path("r.html").exists()
