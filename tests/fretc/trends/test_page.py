"""The page of trends: complete alone, readable without colours, safe against what logs say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fretc.audit.evidence.reader import EvidenceFile
from fretc.trends.changes import RoundOutcome
from fretc.trends.charts import chart, heat_map, strip
from fretc.trends.known_requirements import KnownRequirements, known_requirements
from fretc.trends.page import html
from fretc.trends.trends import Trends
from fretc.trends.trends import trends as trends_of
from tests.browsing import Visits, serious
from tests.effort import some
from tests.fretc.audit.results import SHA
from tests.fretc.report.cases import project, requirement
from tests.fretc.trends.nights import document, judged

HOSTILE = "</style><script>document.title = 'broken'</script>\u202egnp.exe\x1b" + "x" * 100


def nights(scenario: str = "door") -> Trends:
    """Six of them: something new, something fixed, something gone, and answers that are late."""
    sources = []
    for night in range(6):
        results = [
            judged(
                f"{night}-{run}.mcap",
                verdict,
                id,
                night=night,
                late=[0.2 + run / 100 + (0.2 if night > 3 else 0)],
                margin=0.1 + run / 100,
                scenario=scenario if run else f"hall {night // 5}",
                version="2" if night > 3 else "1",
            )
            for run in range(6)
            for id, verdict in (
                ("R1", "violated" if night == 5 else "satisfied"),
                ("R2", "satisfied" if night == 5 else "violated"),
                ("R3", "violated" if night % 2 else "satisfied"),
                ("R4", "no data" if night == 5 else "satisfied"),
            )
        ]
        sources.append(EvidenceFile(f"{night}.json", SHA, document(results)))
    found = trends_of(sources)
    assert isinstance(found, Trends)
    return found


def test_each_change_has_its_list_with_its_requirements() -> None:
    page = html(nights())
    for anchor, id in (("new", "R1"), ("fixed", "R2"), ("flaky", "R3"), ("lost", "R4")):
        section = page.split(f'<section id="{anchor}"')[1].split("</section>")[0]
        assert f'<th scope="row">{id}</th>' in section
    assert "scenario hall 0" in page.split('<section id="gone"')[1].split("</section>")[0]
    assert page.count("<figure ") >= 2


def test_a_requirement_that_several_scenarios_violate_is_counted_once() -> None:
    sources = []
    for night in range(2):
        results = [
            judged(f"{night}-{scenario}.mcap", verdict, id, night=night, scenario=scenario)
            for scenario in ("door", "hall")
            for id, verdict in (("R1", "violated"), ("R2", "satisfied"))
        ]
        sources.append(EvidenceFile(f"{night}.json", SHA, document(results)))
    found = trends_of(sources)
    assert isinstance(found, Trends)
    page = html(found)
    assert "<title>Trends: 1 requirement still violated in 2 scenarios.</title>" in page
    assert "nothing is worse, and some are still violated" in page
    assert (
        "Of 4 pairs of requirement and scenario, 2 are shown as before, 0 were never shown." in page
    )


def test_it_is_the_same_again() -> None:
    assert html(nights()) == html(nights())


def test_texts_of_a_log_stay_texts() -> None:
    page = html(nights(HOSTILE))
    assert "<script" not in page
    assert page.count("</style>") == 1
    assert not {*"\u202e\x1b"} & {*page}
    assert "\\u202egnp.exe\\x1b" in page


def test_it_asks_nothing_of_anybody() -> None:
    page = html(nights())
    assert "default-src 'none'" in page
    assert not re.search(r"(?:src|href)=\"(?!#)", page)


def test_a_requirement_has_a_cell_for_each_round_with_its_worst_outcome() -> None:
    found = heat_map(nights())
    assert [column["name"] for column in found["columns"]] == [
        f"2025-11-{day:02}" for day in range(8, 14)
    ]
    texts = {row["id"]: [cell["text"] for cell in row["cells"]] for row in found["rows"]}
    assert texts["R1"][4:] == [
        "R1 on 2025-11-12: shown",
        "R1 on 2025-11-13: violated in 2 scenarios",
    ]
    assert texts["R4"][5] == "R4 on 2025-11-13: open"


def test_a_cell_leads_to_its_requirement_in_the_report_of_its_round() -> None:
    found = heat_map(nights(), "../{name}/report.html")
    assert found["columns"][2]["report"] == "../2/report.html"
    assert found["rows"][0]["cells"][2]["report"] == "../2/report.html#req-R1"
    assert 'href="../2/report.html#req-R1"' in html(nights(), "../{name}/report.html")


def test_each_scenario_has_a_panel_and_a_margin_has_its_bound() -> None:
    trends = nights()
    (margin, *_) = [c for c in trends.comparisons if c.measure.is_better_larger]
    drawn = chart(margin, ["a", "b", "c", "d", "e", "f"], trends.is_after, "id")
    assert [panel["name"] for panel in drawn["panels"]] == ["door", "hall 0", "hall 1"]
    assert drawn["worse"] == "worse ↓"
    assert all(panel["bound"] is not None for panel in drawn["panels"])
    dots = [len(panel["dots"]) for panel in drawn["panels"]]
    assert sum(dots) == len(margin.values)


STOPS = "when near the robot shall within {} milliseconds satisfy stopped"


def known(folder: Path, allowed: int) -> KnownRequirements:
    """A project whose R1 allows so many milliseconds, beside evidence of 300 ms."""
    one = project(folder, requirement("R1", STOPS.format(allowed)))
    return known_requirements(one, {"R1": STOPS.format(300)})


def test_a_latency_has_its_bound_if_the_sentence_is_still_that_of_the_evidence(
    tmp_path: Path,
) -> None:
    trends = nights()
    (late, *_) = [c for c in trends.comparisons if c.measure.ids == "R1"]
    changed = known(tmp_path, 400)
    assert (changed.titles, changed.limits) == ({"R1": "Title of R1"}, {})
    drawn = chart(late, [*"abcdef"], trends.is_after, "id", changed)
    assert [panel["bound"] for panel in drawn["panels"]] == [None, None, None]
    same = known(tmp_path, 300)
    assert same.limits == {"R1": 0.3}
    drawn = chart(late, [*"abcdef"], trends.is_after, "id", same)
    assert drawn["worse"] == "worse \N{UPWARDS ARROW}"
    assert "; allowed 0.3 s; " in drawn["text"]
    door = drawn["panels"][0]
    # Five runs of each night: 0.21 s to 0.25 s in four nights, 0.2 s later in the other two.
    assert [dot["y"] < door["bound"] for dot in door["dots"]] == [False] * 20 + [True] * 10


def test_a_requirement_has_its_title(tmp_path: Path) -> None:
    page = html(nights(), known=known(tmp_path, 300))
    assert page.count("Title of R1") >= 3
    assert "Title of R1 (R1): longest latency" in page


def test_a_strip_is_read_without_colours() -> None:
    round_outcomes = [
        None,
        RoundOutcome.SHOWN,
        RoundOutcome.SHOWN,
        RoundOutcome.VIOLATED,
        RoundOutcome.OPEN,
    ]
    found = strip(round_outcomes)
    assert found["text"] == "rounds 1 not judged, 2 to 3 shown, 4 violated, 5 open"
    heights = {cell["kind"]: cell["height"] for cell in found["cells"]}
    assert len({*heights.values()}) == len(heights) == 4
    assert strip([RoundOutcome.SHOWN] * 100)["text"] == "rounds 41 to 100 shown"


# In a browser -----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scheme", "width"), some([(s, w) for w in (1440, 390) for s in ("light", "dark")], 3)
)
def test_axe_finds_nothing_serious_and_nothing_is_too_wide(
    visits: Visits, tmp_path: Path, scheme: str, width: int
) -> None:
    path = tmp_path / "trends.html"
    text = html(nights(HOSTILE), "../{name}/report.html", known(tmp_path, 300))
    path.write_text(text, encoding="utf-8")
    page = visits.open(path, width, scheme=scheme)
    assert page.title().startswith("Trends: ")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert page.locator("svg.strip:visible").count() > 5
    page.evaluate("document.querySelectorAll('details').forEach(e => e.open = true)")
    assert page.locator("#numbers figure:visible").count() >= 2
    assert page.evaluate("document.documentElement.scrollWidth") == width
    page.locator(".heat td a").last.focus()
    cell = page.locator(".heat td a").last.bounding_box()
    assert cell is not None
    assert 0 <= cell["x"] < width
    assert serious(page) == []
