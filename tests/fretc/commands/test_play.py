"""`fretc play` writes one page of all that can be monitored, and starts from what others found."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.command import Fretc
from tests.fretc.logs.logs import MS, S, chunk_starts, damaged, number
from tests.fretc.logs.logs import write as log_of
from tests.simulation.missions import Missions, cut_off

ROOT = Path(__file__).parents[3]
NEAR = "whenever near the robot shall within 2 ticks satisfy stopped"
PROBABLE = "whenever near the robot shall with probability > 0.9 within 2 ticks satisfy stopped"


def write(path: str, text: str) -> None:
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text(text, encoding="utf-8")


def data(page: str) -> Any:
    return json.loads(page.split('id="data">')[1].split("</script>")[0])


def abouts(page: str) -> list[str]:
    return [start["about"] for start in data(page)["starts"]]


def test_a_page_starts_from_examples(fretc: Fretc) -> None:
    write("requirements/r1.fret", NEAR)
    run = fretc("play")
    assert (run.status, run.err) == (0, "wrote build/play.html\n")
    page = Path("build/play.html").read_text("utf-8")
    assert fretc("play", "requirements/r1.fret", "-o", "-").out == page
    assert {about.split(":")[0] for about in abouts(page)} == {"r1, satisfied", "r1, violated"}


def test_what_no_monitor_can_be_made_of_is_named_on_the_page(fretc: Fretc) -> None:
    write("requirements/a.fret", NEAR)
    write("requirements/b.fret", PROBABLE)
    run = fretc("play")
    assert run.status == 2
    assert run.err.startswith("F601 a monitor cannot express the probability of b")
    page = Path("build/play.html").read_text("utf-8")
    assert "<li><b>b</b>: a monitor cannot express the probability of b</li>" in page
    write("requirements/a.fret", PROBABLE)
    before = page
    assert fretc("play").status == 2
    assert Path("build/play.html").read_text("utf-8") == before


@pytest.mark.slow
def test_tests_and_conflicts_are_there_as_long_as_they_are_about_the_same(fretc: Fretc) -> None:
    write("requirements/a.fret", NEAR)
    write(
        "requirements/b.fret", "whenever near the robot shall immediately satisfy !stopped & !slow"
    )
    write("requirements/c.fret", "whenever near the robot shall immediately satisfy slow")
    roles = [
        f'[variable.{name}]\nrole = "{role}"\n'
        for name, role in (("near", "input"), ("stopped", "output"), ("slow", "output"))
    ]
    write("requirements/bindings.toml", "\n".join(roles))
    assert fretc("test").status in (0, 3)
    assert fretc("analyze").status == 1
    assert fretc("play").status == 0
    groups = Path("build/play.html").read_text("utf-8")
    assert [f'<optgroup label="{name}">' in groups for name in ("Examples", "Tests", "Conflicts")]
    assert any(about.startswith("b, c: ") for about in abouts(groups))
    assert any(about.startswith("a-") for about in abouts(groups))
    write("requirements/c.fret", "whenever near the robot shall immediately satisfy slow & near")
    run = fretc("play")
    assert run.status == 0
    for path in ("build/tests/suite.json", "build/analysis.json"):
        assert f"F503 warning: traces of `{path}` are left out: c changed since" in run.err
    later = abouts(Path("build/play.html").read_text("utf-8"))
    assert not any(about.startswith(("b, c: ", "c-")) for about in later)
    assert any(about.startswith("a-") for about in later)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON"),
        ("{}", "is not what `fretc test` writes"),
        ("[" * 100_000, "nested too deeply"),
        ('{"a": 1, "a": 2}', "`a` appears twice in one object"),
    ],
)
def test_a_file_of_something_else_is_refused(fretc: Fretc, text: str, message: str) -> None:
    write("requirements/r1.fret", NEAR)
    write("x.json", text)
    run = fretc("play", "--tests", "x.json")
    assert run.status == 2
    assert run.err.startswith("F503 ")
    assert message in run.err
    assert not Path("build").exists()


def test_a_file_that_is_read_is_never_written_over(fretc: Fretc) -> None:
    write("requirements/r1.fret", NEAR)
    assert fretc("play", "-o", "requirements/r1.fret").status == 2
    assert Path("requirements/r1.fret").read_text("utf-8") == NEAR


def test_a_page_against_what_requirements_were(fretc: Fretc) -> None:
    write("requirements/a.fret", NEAR)
    write("requirements/b.fret", NEAR)
    write("old/a.fret", NEAR.replace("2 ticks", "3 ticks"))
    write("old/b.fret", NEAR)
    run = fretc("play", "--against", "old")
    assert run.status == 0
    page = Path("build/play.html").read_text("utf-8")
    assert "<li>a: a shortest trace that distinguishes the two versions has 3 ticks</li>" in page
    assert "<li>b: unchanged</li>" in page
    found = data(page)
    assert abouts(page)[0] == "a: a shortest trace that distinguishes the two versions has 3 ticks"
    assert [each["before"] for each in found["requirements"]] == [1, None, None]
    missing = fretc("play", "--against", "none")
    assert missing.status == 2
    assert missing.err.startswith("F901")


BINDINGS = """
[clock]
tick = "100 ms"
[signal.gap]
path = "/gap.data"
[proposition.near]
expr = "gap < 5"
[proposition.stopped]
expr = "gap < 1"
"""


def run_of(path: str, count: int) -> Path:
    """An obstacle is near at the first tick, and the robot never stops."""
    sent = [number(9.0 if i else 3.0, 1000 * S + i * 100 * MS, "/gap") for i in range(count)]
    return log_of(Path(path), sent, per_chunk=5)


def test_a_violation_that_no_page_takes_is_no_run_without_one(fretc: Fretc) -> None:
    write("requirements/r.fret", NEAR.replace("2 ticks", "2500 ticks"))
    write("requirements/bindings.toml", BINDINGS)
    run_of("a.mcap", 2600)
    run_of("b.mcap", 20)
    run = fretc("play", "--log", "a.mcap", "--log", "b.mcap")
    assert (run.status, run.err) == (0, "wrote build/play.html\n")
    page = Path("build/play.html").read_text("utf-8")
    assert "<li>r: violation 1 of a.mcap is left out: what led to it takes more than" in page
    assert "a.mcap: no whole tick" not in page
    assert "<li>b.mcap: no tick violates a requirement</li>" in page


def test_what_a_damaged_run_has_lost_is_said(fretc: Fretc) -> None:
    write("requirements/r.fret", NEAR)
    write("requirements/bindings.toml", BINDINGS)
    log = run_of("<img src=x>.mcap", 40)
    damaged(log, chunk_starts(log)[1] + 60)
    run = fretc("play", "--log", str(log))
    assert run.status == 0
    assert run.err.startswith("F404 warning: the log is damaged near byte ")
    page = Path("build/play.html").read_text("utf-8")
    assert "mcap: messages may be lost; values that depend on them are unknown</li>" in page
    assert "<img" not in page


@pytest.mark.slow
def test_a_violation_of_a_recorded_run_is_a_start(fretc: Fretc, missions: Missions) -> None:
    log = missions(cut_off("safety-silent")).path
    folder = str(ROOT / "requirements/mission")
    run = fretc("play", folder, "--log", str(log))
    assert run.status == 0, run.err
    first = data(Path("build/play.html").read_text("utf-8"))["starts"][0]
    assert first["about"].startswith(f"R15, violation 1 of {log}: ticks ")
    assert {"moving", "alive"} & {*first["rows"][0][1]}
    missing = fretc("play", folder, "--log", "none.mcap")
    assert missing.status == 2
    assert missing.err.startswith("F901 ")
