"""Pictures of violations in a browser: values at a cursor, zoom, keys, small screens and paper."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.browsing import Visits, serious
from tests.fretc.report.cases import as_html, project, report_of, requirement, result, violation

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

pytestmark = pytest.mark.slow
TENTH = 10**8
START = 1_700_000_000 * 10**9
"""2023-11-14 22:13:20 UTC."""
VIEWER = "https://logs.example.org/?log={log}&t={ns}"
SAMPLES = {
    # In tenths of a second of the run; a value counts for 300 ms.
    "clearance": [(0, 0.4), (2, 0.4), (6, 0.3), (9, 0.3), (10, 0.04), (13, 0.04), (16, 0.02)],
}
WINDOW = {
    "start_ns": START,
    "end_ns": START + 20 * TENTH,
    "samples": {
        name: {
            "times_ns": [START + tenth * TENTH for tenth, _ in some],
            "values": [value for _, value in some],
        }
        for name, some in SAMPLES.items()
    },
}


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three requirements in one run: two violations of R1, one of R2, and R3 is satisfied."""
    folder = tmp_path_factory.mktemp("explored")
    (folder / "fretc.toml").write_text(f'viewer = "{VIEWER}"\n', encoding="utf-8")
    sentence = "when near the robot shall within 3 ticks satisfy stopped"
    known = project(folder, *(requirement(f"R{n}", sentence) for n in (1, 2, 3)))
    events = [
        violation(first, last, trigger) | {"window": WINDOW, "start_ns": START + first * TENTH}
        for first, last, trigger in ((14, 16, 11), (18, 18, 15))
    ]
    runs = [
        result(known, "violated", "R1", violations=events),
        result(known, "violated", "R2", violations=events[:1]),
        result(known, "satisfied", "R3"),
    ]
    path = folder / "report.html"
    path.write_text(as_html(report_of(known, folder, *runs)), encoding="utf-8")
    return path


@pytest.fixture
def picture(visits: Visits, report: Path) -> Callable[..., Locator]:
    """Opens the report at the first violation of R1."""

    def open_it(*size: int, **options: Any) -> Locator:
        page = visits.open(report, *size, **options)
        page.evaluate("document.querySelectorAll('details').forEach(e => e.open = true)")
        figure = page.locator("figure.event").first
        figure.scroll_into_view_if_needed()
        figure.locator(".explore").wait_for()
        return figure

    return open_it


def said(figure: Locator, tenths: float) -> str:
    """What the picture says with the cursor at a time; it shows two seconds."""
    figure.get_by_role("slider", name="Time of the cursor").fill(f"{tenths * 50:g}")
    return figure.locator(".explore output").inner_text()


def labels(figure: Locator) -> list[float]:
    """The times on the axis."""
    texts = figure.locator(".ticks:not([hidden]) text").all_text_contents()
    return [float(text.removesuffix(" s")) for text in texts]


def focused(page: Page) -> str:
    """The id, the label or the text of the element that has the focus."""
    names = "['id', 'ariaLabel', 'textContent']"
    return str(page.evaluate(f"{names}.map(of => document.activeElement[of]).find(Boolean)"))


def test_the_cursor_tells_time_date_and_values_and_what_is_unknown(
    picture: Callable[..., Locator],
) -> None:
    figure = picture()
    at = "2023-11-14 22:13:21.000 UTC"
    assert said(figure, 10) == f"1 s \N{MIDDLE DOT} {at} \N{MIDDLE DOT} clearance 0.04 m"
    assert said(figure, 1).endswith("clearance 0.4 m")
    assert said(figure, 17).endswith("clearance 0.02 m")
    assert said(figure, 5.5).endswith("clearance unknown")
    slider = figure.get_by_role("slider")
    assert slider.get_attribute("aria-valuetext") == figure.locator("output").inner_text()


def test_a_picture_is_zoomed_and_moved_and_says_the_same(picture: Callable[..., Locator]) -> None:
    figure = picture()
    whole = labels(figure)
    assert (whole[0], whole[-1]) == (0, 2)
    before = said(figure, 12)
    figure.get_by_role("button", name="Zoom in").click()
    near = labels(figure)
    assert near[-1] - near[0] <= 1
    assert near[0] > 0
    assert said(figure, 12) == before
    drawing, mouse = figure.locator("svg"), figure.page.mouse
    drawing.hover()
    box = drawing.bounding_box()
    assert box is not None
    mouse.down()
    mouse.move(box["x"] + box["width"] * 0.8, box["y"] + box["height"] / 2)
    mouse.up()
    assert labels(figure)[0] < near[0]
    figure.get_by_role("button", name="Zoom out").click()
    assert labels(figure) == whole


def test_the_keys_n_and_p_go_from_violation_to_violation_and_type_elsewhere(
    picture: Callable[..., Locator],
) -> None:
    page = picture().page
    page.locator("figure.event").first.focus()
    ids = page.locator("figure.event").evaluate_all("e => e.map(each => each.id)")
    assert len(ids) == 3
    for key, place in (("n", 1), ("n", 2), ("n", 0), ("p", 2), ("p", 1)):
        page.keyboard.press(key)
        assert focused(page) == ids[place]
    search = page.get_by_role("searchbox").first
    search.focus()
    page.keyboard.press("n")
    assert search.input_value() == "n"


def test_every_control_of_a_picture_is_reached_by_keyboard(picture: Callable[..., Locator]) -> None:
    figure = picture()
    page = figure.page
    figure.focus()
    found = []
    for _ in range(7):
        page.keyboard.press("Tab")
        found.append(focused(page))
    assert found == [
        "Time of the cursor",
        "Zoom out",
        "Zoom in",
        "Copy the time of the cursor",
        "Previous violation (key p)",
        "Next violation (key n)",
        "Open the log at this time in logs.example.org",
    ]
    assert page.evaluate("document.activeElement.href") == (
        "https://logs.example.org/?log=logs/a.mcap&t=1700000001400000000"
    )


@pytest.mark.parametrize(("scheme", "width"), [("light", 1440), ("dark", 390)])
def test_axe_finds_nothing_serious_in_pictures(
    picture: Callable[..., Locator], scheme: str, width: int
) -> None:
    figure = picture(width, 900, scheme=scheme)
    assert serious(figure.page, "#requirements") == []
    box = figure.locator("svg").bounding_box()
    assert box is not None
    assert box["x"] + box["width"] <= width


def test_on_paper_each_violated_requirement_has_its_first_violation(
    picture: Callable[..., Locator], visits: Visits, report: Path
) -> None:
    page = visits.open(report)
    page.emulate_media(media="print")
    shown = [
        page.locator(f"#req-{id} figure.event:visible").evaluate_all("e => e.map(f => f.id)")
        for id in ("R1", "R2", "R3")
    ]
    assert shown == [["picture-result-R1.1.1"], ["picture-result-R2.1.1"], []]
