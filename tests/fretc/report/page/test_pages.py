"""Pages of every size in Chromium: first screen, keyboard, filters, paper, without the script."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import pytest

from compiler.project.folder import load
from fretc.report.make import make
from fretc.report.page import html as page_html
from fretc.report.page.matrix import MOST, picture
from tests.browsing import Visits, serious
from tests.effort import FULL, some
from tests.fretc.report.cases import project, report_of, requirement, result, violation
from tests.fretc.report.page.large import MARKS, mostly_satisfied, small
from tests.fretc.report.page.large import page as page_of

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.slow
SCREENS = [(1440, 900), (1024, 768), (390, 844)]
Visit = Callable[..., "Page"]


def empty(folder: Path) -> str:
    """A project without a requirement."""
    return make(load([], None, None), str(folder / "evidence.json")).html or ""


def nothing_audited(folder: Path) -> str:
    return report_of(project(folder), folder).html or ""


def mission(folder: Path, requirements: int = 15, seeds: int = 2) -> str:
    """15 requirements below three hazards in 16 runs of eight scenarios, with every mark."""
    hazards = "".join(f'[HAZ-{n}]\ntitle = "Hazard {n}"\n' for n in (1, 2, 3))
    known = project(
        folder,
        *(
            requirement(
                f"R{n}",
                "when near the robot shall within 3 ticks satisfy stopped",
                title=f"The robot stops in time, case {n}",
                parents=[f"HAZ-{n % 3 + 1}", *(["HAZ-1"] if n == 4 else [])],
            )
            for n in range(1, requirements + 1)
        ),
        hazards=hazards,
    )
    words = ["satisfied"] * 8 + ["violated", "vacuous", "no data", "inconclusive"]
    scenarios = "nominal walker obstacle log-cut scan-lost no-release safety-off lidar".split()
    runs = []
    for s, scenario in enumerate(scenarios):
        for seed in range(1, seeds + 1):
            for n in range(1, requirements + 1):
                word = words[(s * 7 + seed * 3 + n * 5) % len(words)]
                broken = [violation(14, 20, 11)] if word == "violated" else []
                name = f"logs/{scenario}-{seed}.mcap"
                old = (
                    {"sentence": "0" * 64} if n == requirements * 9 // 15 and seed == seeds else {}
                )
                hashes = {"log": f"{s * 2 + seed:064x}", **old}
                runs.append(
                    result(known, word, f"R{n}", run=name, violations=broken, hashes=hashes)
                )
    return report_of(known, folder, *runs).html or ""


def sized(requirements: int, groups: int, runs: int, share: float = 0.03) -> Callable[[Path], str]:
    def make(folder: Path) -> str:
        names = [(f"scenario-{n}", runs) for n in range(groups)]
        return page_of(small(folder), requirements, names, mostly_satisfied(1, share))

    return make


PAGES: dict[str, Callable[[Path], str]] = {
    "empty": empty,
    "nothing audited": nothing_audited,
    "small": lambda folder: small(folder).html or "",
    "mission": mission,
    "marks": mission if FULL else lambda folder: mission(folder, 3, 1),
    "56 runs": lambda folder: mission(folder, 3, 7),
    "50 x 100": sized(50, 10, 10),
    "aggregated": sized(230, 12, 25) if FULL else sized(12, 3, 4, 0.3),
}
MOST_CELLS = {} if FULL else {"aggregated": 100}
"""More are aggregated: the browser takes seconds for ten thousand."""


@cache
def html(name: str) -> str:
    """Of a page; it is made once in each worker, by the first who visits it."""
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(page_html, "picture", partial(picture, most=MOST_CELLS.get(name, MOST)))
        return PAGES[name](Path(folder))


@pytest.fixture
def visit(visits: Visits, tmp_path: Path) -> Visit:
    """Opens a page by its name."""

    def open_it(name: str, width: int = 1440, height: int = 900, **options: Any) -> Page:
        path = tmp_path / f"{name}.html"
        path.write_text(html(name), encoding="utf-8")
        return visits.open(path, width, height, **options)

    return open_it


@pytest.mark.parametrize(
    ("name", "size"),
    [
        pytest.param(name, size, id=f"{size[0]}-{name}")
        for first, size in enumerate(SCREENS)
        for name in some(PAGES, len(SCREENS), first)
    ],
)
def test_the_first_screen_decides_and_the_page_is_never_wider_than_the_screen(
    visit: Visit, name: str, size: tuple[int, int]
) -> None:
    page = visit(name, *size)
    assert page.evaluate("document.documentElement.scrollWidth") == size[0]
    headline = page.locator(".headline").bounding_box()
    assert headline is not None
    assert headline["y"] + headline["height"] < size[1] / 2
    assert page.locator(".figures > li").count() == 5
    if size[0] > 1000:
        figures = page.locator(".figures").bounding_box()
        assert figures is not None
        assert figures["y"] + figures["height"] < size[1]
        nav = page.locator("nav").bounding_box()
        assert nav is not None
        assert nav["y"] + nav["height"] <= size[1]


@pytest.mark.parametrize(
    ("name", "scheme", "width"),
    some(
        [
            ("mission", "light", 1440),
            ("marks", "dark", 390),
            ("mission", "dark", 1440),
            ("aggregated", "light", 1440),
            ("small", "light", 390),
        ],
        2,
        1,
    ),
)
def test_axe_finds_nothing_serious(visit: Visit, name: str, scheme: str, width: int) -> None:
    page = visit(name, width, scheme=scheme)
    if name == "aggregated":
        page.locator("table.small a").first.click()
    assert serious(page, "header, nav, #matrix, .controls") == []


def test_fifteen_requirements_in_sixteen_runs_fit_one_screen(visit: Visit) -> None:
    page = visit("mission")
    page.locator("nav").get_by_role("link", name="Matrix").click()
    frame = page.locator(".grid").bounding_box()
    assert frame is not None
    assert frame["y"] + frame["height"] <= 900
    table = page.evaluate(
        "(e => [e.scrollWidth - e.clientWidth, e.scrollHeight - e.clientHeight])"
        "(document.querySelector('.grid'))"
    )
    assert table == [0, 0]
    sizes = page.evaluate(
        "[...document.querySelectorAll('.matrix td > a')].map(e => parseFloat(getComputedStyle(e)"
        ".fontSize))"
    )
    assert 14 <= min(sizes) <= max(sizes) <= 18


def test_the_heads_of_a_matrix_stay_in_sight_while_it_is_scrolled(visit: Visit) -> None:
    page = visit("50 x 100")
    page.locator("nav").get_by_role("link", name="Matrix").click()
    page.evaluate("document.querySelector('.grid').scrollTo(400, 500)")
    frame = page.locator(".grid").bounding_box()
    head = page.locator(".matrix thead").bounding_box()
    first = page.locator("#row-R30 > th").bounding_box()
    assert frame is not None
    assert head is not None
    assert first is not None
    assert head["y"] == pytest.approx(frame["y"], abs=2)
    assert first["x"] == pytest.approx(frame["x"], abs=2)


def test_with_the_keyboard_alone_from_a_cell_to_its_details_and_back(visit: Visit) -> None:
    page = visit("mission")
    link = page.locator('.matrix td > a[aria-label^="violated: "]').first
    page.locator("nav a").last.focus()
    for _ in range(400):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.matches('[aria-label^=\"violated: \"]')"):
            break
    target = page.evaluate("document.activeElement.getAttribute('href')")
    assert target == link.get_attribute("href")
    assert "in " in str(page.evaluate("document.activeElement.title"))
    page.keyboard.press("ArrowRight")
    assert page.evaluate("document.activeElement.matches('.matrix td > a')")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("Enter")
    details = page.locator(f"[id='{target.removeprefix('#')}']")
    details.wait_for(state="visible")
    back = page.locator("nav").get_by_role("link", name="Matrix")
    assert back.is_visible()
    back.focus()
    page.keyboard.press("Enter")
    assert page.evaluate("document.querySelector('#matrix').getBoundingClientRect().y") < 60


def test_filters_leave_what_is_asked_for_and_say_what_red_they_hide(visit: Visit) -> None:
    page = visit("mission")
    matrix = page.locator("#matrix")
    status = matrix.get_by_role("status")
    cells = matrix.locator("td > a:visible")
    every, red = cells.count(), matrix.locator('td > a[aria-label^="violated"]').count()
    assert every == 16 * 16
    assert status.inner_text() == "16 of 16 rows, 16 of 16 runs shown"
    matrix.get_by_label("Run", exact=True).select_option("walker")
    assert cells.count() == 16 * 2
    hidden = red - matrix.locator('td > a[aria-label^="violated"]:visible').count()
    assert status.inner_text() == f"16 of 16 rows, 2 of 16 runs shown; hidden: {hidden} violated"
    matrix.get_by_label("Verdict", exact=True).select_option("violated")
    for row in matrix.locator("tr[data-order]:visible").all():
        assert row.locator('td > a[aria-label^="violated"]:visible').count() > 0
    matrix.get_by_label("Run", exact=True).select_option("all")
    matrix.get_by_label("Verdict", exact=True).select_option("suspect")
    matrix.get_by_label("Verdict", exact=True).select_option("all")
    matrix.get_by_label("Hazard", exact=True).select_option("HAZ-2")
    assert matrix.locator("tbody:visible").count() == 1
    matrix.get_by_label("Hazard", exact=True).select_option("all")
    assert cells.count() == every
    matrix.get_by_label("Order", exact=True).select_option("as numbered")
    heads = matrix.locator("tbody").first.locator("tr[data-order] > th small").all_inner_texts()
    numbers = [int(re.sub(r"\D", "", text)) for text in heads]
    assert numbers == sorted(numbers)


@pytest.mark.parametrize("name", some(["mission", "50 x 100"], 2))
def test_without_the_script_each_cell_is_there_and_leads_somewhere(visit: Visit, name: str) -> None:
    page = visit(name, scripts=False)
    assert page.locator(".controls").count() == 0
    red = page.locator('.matrix td > a[aria-label^="violated"]:visible').first
    target = str(red.get_attribute("href")).removeprefix("#")
    red.click()
    page.locator(f"[id='{target}']").wait_for(state="visible")


def test_an_aggregated_matrix_opens_its_parts_and_they_say_the_same(visit: Visit) -> None:
    page = visit("aggregated")
    assert page.locator("#part").is_hidden()
    tally = page.locator("table.small a").first
    said = {
        word: int(number)
        for number, word in re.findall(
            r"(\d+) ([a-z ]+(?:, suspect)?)(?:, (?=\d)|$)", str(tally.get_attribute("aria-label"))
        )
    }
    tally.focus()
    page.keyboard.press("Enter")
    labels = page.locator("#part td > a").evaluate_all("e => e.map(a => a.ariaLabel)")
    assert {word: labels.count(word) for word in dict.fromkeys(labels)} == said
    hrefs = page.locator("#part td > a").evaluate_all("e => e.map(a => a.hash.slice(1))")
    assert page.evaluate("ids => ids.every(id => document.getElementById(id))", hrefs)
    assert page.evaluate("document.activeElement.id") == "part"


def test_an_aggregated_matrix_lists_what_is_not_satisfied_without_the_script(visit: Visit) -> None:
    page = visit("aggregated", scripts=False)
    red = page.locator("table.small a.violated").first
    target = str(red.get_attribute("href"))
    red.click()
    assert target.startswith("#list-")
    assert "violated in" in page.locator(target).inner_text()


def test_a_telephone_shows_a_card_for_each_requirement(visit: Visit) -> None:
    page = visit("mission", 390, 844)
    assert page.locator(".matrix thead").is_hidden()
    boxes = page.locator(".matrix td > a").evaluate_all(
        "e => e.map(a => a.getBoundingClientRect()).map(b => [b.left, b.right, b.width])"
    )
    assert len(boxes) == 16 * 16
    assert all(left >= 0 and right <= 390 and width >= 24 for left, right, width in boxes)


@pytest.mark.parametrize(("name", "most"), some([("mission", 19), ("small", 8)], 2))
def test_what_is_folded_is_left_out_of_print(visit: Visit, name: str, most: int) -> None:
    page = visit(name)
    page.locator("#matrix").get_by_role("searchbox").fill("nothing") if name == "mission" else None
    printed = page.pdf(prefer_css_page_size=True)
    assert 2 <= printed.count(b"/Type /Page\n") <= most
    page.emulate_media(media="print")
    shown = page.locator('.matrix td > a[aria-label^="violated"]:visible').count()
    assert shown == page.locator('.matrix td > a[aria-label^="violated"]').count()


@pytest.mark.parametrize("name", ["mission", "56 runs", "50 x 100"])
def test_on_paper_every_mark_of_the_matrix_is_on_the_sheet(visit: Visit, name: str) -> None:
    """At the width of the text on A4: 180 mm are 680 pixels. Else a browser shrinks all texts."""
    page = visit(name, 680, 979)
    page.emulate_media(media="print")
    ends = page.locator(".matrix td > a").evaluate_all(
        "e => e.map(a => a.getBoundingClientRect()).map(b => [b.left, b.right, b.height])"
    )
    assert len(ends) > 100
    assert all(left >= 0 and right <= 680 and height >= 7 for left, right, height in ends)


def test_every_mark_has_a_sign_and_a_word(visit: Visit) -> None:
    page = visit("mission")
    cells = page.locator(".matrix td > a").evaluate_all(
        "e => e.map(a => [a.text, a.ariaLabel.split(': ')[0]])"
    )
    signs = {mark.text: mark.glyph for mark in MARKS}
    assert {word: sign for sign, word in cells}.items() <= signs.items()
    assert "satisfied, suspect" in {word for _, word in cells}
