"""What has changed since the review, as the page shows it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from compiler.project.project import Project
from fretc.report.make import make
from tests.browsing import Visits, serious
from tests.effort import some
from tests.fretc.report.cases import (
    BINDINGS,
    HAZARDS,
    R1,
    as_html,
    project,
    requirement,
    result,
    violation,
    write_evidence,
    write_lock,
)

HOSTILE = "<script>document.title = 'broken'</script></del>\u202egnp.exe\u202c " + "x" * 3000


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bound, a title, a hazard and a rationale have changed, and verdicts with them."""
    folder = tmp_path_factory.mktemp("changes")
    other = requirement("R2", "the robot shall always satisfy stopped", rationale=HOSTILE)
    runs = [f"logs/{n}.mcap" for n in range(9)]

    def judged(known: Project, word: str) -> list[dict[str, Any]]:
        broken = [violation(14, 20, 11)] if word == "violated" else []
        return [
            result(known, word if id == "R1" else "satisfied", id, run=run, violations=violations)
            for run in runs
            for id, violations in (("R1", broken), ("R2", []))
        ]

    before = project(folder, R1, other)
    audited = write_evidence(before, folder, *judged(before, "satisfied"))
    lock = write_lock(before, folder, audited)
    now = project(
        folder,
        R1.replace("Stop when something is near", "Stop when something is within 5 cm"),
        other.replace("gnp.exe", "exe.png"),
        bindings=BINDINGS.replace("< 5 cm", "< 9 cm"),
        hazards=HAZARDS.replace("A drum can break.", "A drum can leak."),
    )
    html = as_html(make(now, write_evidence(now, folder, *judged(now, "violated")), lock=lock))
    path = folder / "report.html"
    path.write_text(html, encoding="utf-8")
    return path


def section(page: Path) -> str:
    found = re.search(r'<section id="changes">.*?</section>', page.read_text("utf-8"), re.DOTALL)
    assert found is not None
    return found[0]


@pytest.mark.slow
def test_a_change_is_marked_word_by_word_with_what_follows_from_it(page: Path) -> None:
    changes = section(page)
    assert "clearance &lt; <del>5 cm</del><ins>9 cm</ins>" in changes
    assert "A drum can <del>break.</del><ins>leak.</ins>" in changes
    assert "9 verdicts became violated" in changes
    assert "its title says 5 cm" in changes
    assert changes.count("<tr><th scope=") == 9 + 1, "each run, and the head of the table"


def test_the_requirement_has_its_own_changes(page: Path) -> None:
    own = page.read_text("utf-8").partition('id="req-R1"')[2].partition("</article>")[0]
    assert "<dt>Changed since</dt>" in own
    assert "clearance &lt; <del>5 cm</del><ins>9 cm</ins>" in own
    assert re.search(r"\d+ links are suspect: near, title, text of HAZ-1 changed", own)


def test_texts_of_a_lock_are_shown_and_not_followed(page: Path) -> None:
    changes = section(page)
    assert "<script>" not in changes
    assert "&lt;script&gt;" in changes
    assert "\u202e" not in changes
    assert changes.count("<del>") == changes.count("</del>") == 4
    assert len(changes) < 20_000, "of a long text only what is around the difference"


@pytest.mark.slow
def test_of_many_runs_the_violated_ones_come_first_and_the_rest_is_counted(tmp_path: Path) -> None:
    known = project(tmp_path)
    runs = [f"logs/{n:02}.mcap" for n in range(30)]
    audited = write_evidence(
        known, tmp_path, *(result(known, "satisfied", run=run) for run in runs)
    )
    lock = write_lock(known, tmp_path, audited)
    now = [
        result(known, "violated", run=run, violations=[violation(14, 20, 11)])
        if run >= "logs/05"
        else result(known, "vacuous", run=run)
        for run in runs
    ]
    html = make(known, write_evidence(known, tmp_path, *now), lock=lock).html
    (tmp_path / "report.html").write_text(html or "", encoding="utf-8")
    changes = section(tmp_path / "report.html")
    assert "25 verdicts became violated" in changes
    assert "5 verdicts became vacuous" in changes
    assert changes.count("<td>violated</td>") == 20
    assert "And 10 more runs, 5 of them violated" in changes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "scheme"), some([(390, "dark"), (1440, "dark"), (390, "light"), (1440, "light")], 3)
)
def test_the_section_fits_and_is_accessible(
    visits: Visits, page: Path, width: int, scheme: str
) -> None:
    shown = visits.open(page, width, scheme=scheme)
    assert shown.evaluate("document.documentElement.scrollWidth") == width
    shown.locator("#changes summary").first.click()
    assert shown.locator("#changes tbody tr").first.is_visible()
    assert serious(shown, "#changes") == []
