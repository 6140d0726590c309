"""The page as a browser shows it: alone, by keyboard and ear, on paper, without its script."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.browsing import Visits, serious
from tests.effort import some
from tests.fretc.report.cases import (
    BINDINGS,
    HAZARDS,
    R1,
    as_html,
    moment,
    project,
    report_of,
    requirement,
    result,
    violation,
)

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.slow
LONG = "x" * 10_000
HOSTILE = (
    "<script>document.title = 'broken'</script>",
    "\"' onmouseover='document.title = 1' &amp;",
    "\u202egnp.exe\u202c",
    LONG,
)
Open = Callable[..., "Page"]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three requirements in nine runs, some of them violated, with texts that try to break out."""
    folder = tmp_path_factory.mktemp("report")
    hazards = HAZARDS.replace('"A drum can break."', json.dumps(HOSTILE[0]))
    known = project(
        folder,
        R1.replace('"The robot must stop."', json.dumps(HOSTILE[2] + LONG)),
        requirement("R2", "when near the robot shall within 3 ticks satisfy stopped"),
        requirement("R3", "the robot shall always satisfy stopped", text=HOSTILE[0] + HOSTILE[1]),
        requirement("R4", "the robot shall never satisfy near", verify=["audit", "proof"]),
        bindings=BINDINGS,
        hazards=hazards,
    )
    runs = [
        result(
            known,
            "violated" if run in (2, 5) else "satisfied",
            id,
            run=f"{run}.mcap",
            reason=HOSTILE[run % 3],
            hashes={"log": f"{run:064x}", **({"sentence": 64 * "0"} if run == 5 else {})},
            violations=[violation(14, 20, 11)] if run in (2, 5) else [],
            latencies_s=[run / 10, 0.3],
            triggers=[moment(tick) for tick in range(10, 20 - run)],
        )
        for id in ("R1", "R2", "R3")
        for run in range(9)
    ]
    html = as_html(report_of(known, folder, *runs))
    path = folder / "report.html"
    path.write_text(html, encoding="utf-8")
    return path


@pytest.fixture
def opened(visits: Visits, report: Path) -> Iterator[Open]:
    """Opens the report; at the end nothing else was asked for."""

    def open_it(*size: int, **options: Any) -> Page:
        return visits.open(report, *size, **options)

    yield open_it
    assert set(visits.asked) == {report.as_uri()}


def rows(page: Page) -> list[str]:
    """The ids in the matrix that are to be seen, in their order by number."""
    heads = page.locator("#matrix tr[data-order]:visible > th small")
    return sorted(text.split(",")[0] for text in heads.all_inner_texts())


def unfolded(page: Page, section: str) -> Any:
    """A section with all its parts open."""
    page.evaluate(f"document.querySelectorAll('{section} details').forEach(e => e.open = true)")
    return page.locator(section)


def test_a_filter_leaves_the_rows_that_hold_its_text_and_says_how_many(opened: Open) -> None:
    page = opened()
    matrix = page.locator("#matrix")
    assert rows(page) == ["R1", "R2", "R3", "R4"]
    matrix.get_by_role("searchbox", name="Filter").fill("title of r3")
    assert rows(page) == ["R3"]
    status = "1 of 4 rows, 9 of 9 runs shown; hidden: 4 violated"
    assert matrix.get_by_role("status").inner_text() == status


def test_a_table_is_filtered_by_verdict(opened: Open) -> None:
    page = opened()
    page.locator("#matrix").get_by_label("Verdict", exact=True).select_option("not exercised")
    assert rows(page) == ["R4"]


def test_a_filter_by_verdict_hides_no_suspect_one(opened: Open) -> None:
    runs = unfolded(opened(), "#req-R2")
    for verdict, logs in (("violated", ["2", "5"]), ("suspect", ["5"])):
        runs.get_by_label("Verdict", exact=True).select_option(verdict)
        heads = runs.locator("table.sortable tbody tr:visible > th").all_inner_texts()
        assert [text.split()[-1] for text in heads] == logs


def test_a_table_is_sorted_by_keyboard_and_says_so(opened: Open) -> None:
    page = opened()
    runs = unfolded(page, "#req-R2").locator("table.sortable")
    head = runs.get_by_role("columnheader", name="Triggers")
    head.get_by_role("button").focus()
    page.keyboard.press("Enter")
    assert head.get_attribute("aria-sort") == "ascending"
    assert runs.locator("tbody tr td:nth-child(3)").all_inner_texts() == [*"2345678"] + ["9", "10"]
    page.keyboard.press("Enter")
    assert head.get_attribute("aria-sort") == "descending"
    assert runs.locator("tbody tr td:nth-child(3)").first.inner_text() == "10"
    page.keyboard.press("Enter")
    assert head.get_attribute("aria-sort") is None
    assert runs.locator("tbody tr th").first.inner_text() == "0"


def test_a_link_to_a_filtered_row_shows_it_again(opened: Open) -> None:
    page = opened()
    unfolded(page, "#req-R2").get_by_label("Verdict", exact=True).select_option("violated")
    page.evaluate("location.hash = 'result-R2.1'")
    page.wait_for_function("document.getElementById('result-R2.1').checkVisibility()")


def test_without_its_script_all_is_there_and_nothing_offers_to_filter(opened: Open) -> None:
    page = opened(scripts=False)
    assert page.locator(".controls, button").count() == 0
    assert page.locator("#matrix tr[data-order]:visible").count() == 4
    assert page.locator("#matrix td > a:visible").count() == 27
    for summary in page.locator("#req-R2 > details > summary").all():
        summary.click()
    assert page.locator("#req-R2 table.sortable tbody tr:visible").count() == 9
    assert page.locator("#req-R2 figure:visible").count() >= 3


@pytest.mark.parametrize(("scheme", "width"), some(product(("light", "dark"), (1200, 400)), 4))
def test_axe_finds_nothing_serious(opened: Open, scheme: str, width: int) -> None:
    assert serious(opened(width, scheme=scheme)) == []


def test_the_page_is_never_wider_than_a_telephone(opened: Open) -> None:
    page = opened(400, 800)
    assert page.evaluate("document.documentElement.scrollWidth") == 400


def test_texts_from_outside_are_shown_and_not_followed(opened: Open) -> None:
    page = opened()
    assert page.title().startswith("Traceability report")
    text = page.locator("body").inner_text()
    for hostile in (HOSTILE[0], HOSTILE[1], "\\u202egnp.exe\\u202c", LONG):
        assert hostile in text


def test_on_paper_nothing_is_cut(opened: Open) -> None:
    """At the width of the text on A4, with what is only for the screen left out."""
    page = opened(665, 979)
    page.emulate_media(media="print")
    assert page.locator(".controls:visible, nav:visible").count() == 0
    wide = page.evaluate(
        "[...document.querySelectorAll('body, .scroll, figure, pre, td')]"
        ".filter(e => e.scrollWidth > e.clientWidth + 1).map(e => e.outerHTML.slice(0, 80))"
    )
    assert wide == []
    tall = page.evaluate(
        "[...document.querySelectorAll('figure, tr')]"
        ".map(e => [e.getBoundingClientRect().height, e.textContent])"
        ".filter(([height, text]) => height > 979 && text.length < 5000).length"
    )
    assert tall == 0
    printed = page.pdf(prefer_css_page_size=True)
    assert printed.startswith(b"%PDF-")
    assert printed.count(b"/Type /Page\n") > 5


def test_on_paper_no_chapter_is_a_heading_alone(opened: Open) -> None:
    page = opened(665, 979)
    page.emulate_media(media="print")
    assert page.locator("#means table .hash:visible").count() > 3
    assert page.locator("#runs dt:visible, #runs tbody tr:visible").count() > 3
    assert page.locator("#not-shown table:visible").count() > 0
