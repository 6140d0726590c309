"""The page within a report: opened at a requirement, judged there, and alone as ever."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.browsing import Visits
from tests.command import Fretc
from tests.play_pages import expected_to
from tests.simulation.missions import Missions, cut_off

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

ROOT = Path(__file__).parents[3]
WITHIN = "whenever near the robot shall within 2 ticks satisfy stopped"
PROBABLE = "whenever near the robot shall with probability > 0.9 within 2 ticks satisfy stopped"


@pytest.mark.slow
def test_a_report_opens_the_page_at_a_requirement(fretc: Fretc, visits: Visits) -> None:
    Path("requirements").mkdir()
    for name, sentence in (
        ("a", WITHIN),
        ("b", "the robot shall always satisfy q"),
        ("c", PROBABLE),
    ):
        Path(f"requirements/{name}.fret").write_text(sentence, encoding="utf-8")
    fretc("report", "-o", "without.html")
    fretc("report", "--play", "-o", "report.html")
    assert 'id="inset"' not in Path("without.html").read_text("utf-8")
    page = visits.open(Path("report.html"))
    buttons = page.locator("button.inset")
    assert buttons.count() == 2
    buttons.nth(1).click()
    inset = page.frame_locator("iframe.inset")
    inset.locator("#which").wait_for()
    assert inset.locator("#which").input_value() == "1"
    assert "b, satisfied" in inset.locator("#status").inner_text()
    first = inset.locator("td[aria-label^='q at tick 0']")
    until_reached(page, first)
    first.click()
    verdict = inset.locator("td[aria-label^='b at this tick at tick 0']")
    violated = "b at this tick at tick 0: violated"
    expected_to(verdict).to_have_attribute("aria-label", violated)
    with page.expect_download() as download:
        inset.get_by_role("button", name="Save CSV").click()
    assert download.value.suggested_filename == "b.csv"


def until_reached(page: Page, place: Locator) -> None:
    """Wait until the pointer reaches a place in a frame: at first the page itself may have it."""
    for _ in range(100):
        page.mouse.move(0, 0)
        place.hover()
        if place.evaluate("cell => cell.matches(':hover')"):
            return
        page.wait_for_timeout(50)


@pytest.mark.slow
def test_a_report_opens_the_violations_of_its_runs(fretc: Fretc, missions: Missions) -> None:
    """As long as their logs are those that were audited."""
    log = Path("off.mcap")
    shutil.copy(missions(cut_off("safety-silent")).path, log)
    folder = ("--requirements", str(ROOT / "requirements/mission"))
    assert fretc("audit", str(log), *folder).status == 1
    page = played(fretc, *folder)
    first = page["starts"][0]
    assert first["requirements"]
    assert "violation 1 of off.mcap: ticks " in first["about"]
    log.write_bytes(log.read_bytes() + b" ")
    assert not [each for each in played(fretc, *folder)["starts"] if "violation" in each["about"]]
    log.unlink()
    text = inset(fretc, *folder)
    assert "violations of off.mcap are left out: " in text


def inset(fretc: Fretc, *options: str) -> str:
    assert fretc("report", "--play", *options, "-o", "report.html").status == 0
    whole = Path("report.html").read_text("utf-8")
    return str(json.loads(whole.split('id="inset">')[1].split("</script>")[0]))


def played(fretc: Fretc, *options: str) -> Any:
    return json.loads(inset(fretc, *options).split('id="data">')[1].split("</script>")[0])
