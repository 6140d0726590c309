import json
import re
from pathlib import Path

import pytest

from benchmarks.report import evidence, project
from fretc.report.make import ReportBuild, make
from fretc.report.model.views import ReportView
from fretc.report.page import selection as choosing
from fretc.report.page.selection import DETAILED, PICTURES, PageContent
from fretc.report.page.selection import selection as chosen_of
from tests.effort import some
from tests.fretc.report.cases import as_html, moment, report_of, result
from tests.fretc.report.cases import project as small_project


def reported(folder: Path, requirements: int, runs: int, share: float) -> tuple[ReportBuild, str]:
    known = project(folder, requirements)
    path = folder / "evidence.json"
    path.write_text(json.dumps(evidence(known, runs, share)), encoding="utf-8")
    build = make(known, str(path))
    return build, as_html(build)


def whole(build: ReportBuild) -> ReportView:
    assert build.report is not None
    return build.report


def selection(build: ReportBuild) -> PageContent:
    assert build.report is not None
    assert build.details is not None
    return chosen_of(build.report, build.details)


@pytest.mark.slow
@pytest.mark.parametrize(("count", "share"), some([(5, 0.2), (50, 0.05)], 2))
def test_fifty_requirements_in_twenty_runs_are_at_most_two_megabytes(
    tmp_path: Path, count: int, share: float
) -> None:
    """By default five."""
    build, html = reported(tmp_path, count, 20, share)
    assert len(html.encode()) <= 2_000_000
    chosen = selection(build)
    assert all(len(section.rows) == 20 for section in chosen.by_anchor.values())
    rows = [row for view in whole(build).requirements for row in view.results]
    violated = {row.anchor for row in rows if row.violations_total}
    assert {r.anchor for section in chosen.by_anchor.values() for r in section.details} == violated


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "most", "drawn"), some([(3, 16, 4), (12, DETAILED, PICTURES)], 2)
)
def test_when_all_is_violated_each_requirement_gets_a_share_of_the_details(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int, most: int, drawn: int
) -> None:
    monkeypatch.setattr(choosing, "DETAILED", most)
    monkeypatch.setattr(choosing, "PICTURES", drawn)
    build, html = reported(tmp_path, count, 10, 1.0)
    chosen = selection(build)
    counts = [len(section.details) for section in chosen.by_anchor.values()]
    assert sum(counts) == most
    assert max(counts) - min(counts) <= 1
    pictures = [len(r.timelines) for s in chosen.by_anchor.values() for r in s.details]
    assert sum(pictures) == drawn
    assert f"Details below: {most // count} of 10 runs that are not satisfied." in html


@pytest.mark.slow
def test_a_few_satisfied_runs_can_be_opened_in_the_page(tmp_path: Path) -> None:
    build, html = reported(tmp_path, 2, 3, 0.0)
    chosen = selection(build)
    assert [len(section.folded) for section in chosen.by_anchor.values()] == [3, 3]
    assert html.count('<details class="run">') == 6


@pytest.mark.slow
def test_a_compact_page_lists_what_is_not_satisfied_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choosing, "COMPACT", 20)
    monkeypatch.setattr(choosing, "_RUN_ROWS", 7)
    build, html = reported(tmp_path, 3, 10, 0.5)
    chosen = selection(build)
    assert chosen.is_compact
    rows = [row for section in chosen.by_anchor.values() for row in section.rows]
    assert {row.result.mark.word for row in rows} == {"violated"}
    assert len(rows) < sum(len(view.results) for view in whole(build).requirements)
    assert "This page is compact, because 30 results are more than 20" in html
    assert "Left out here: 3 runs without a row. The evidence file has them all." in html
    links = set(re.findall(r'href="#([^"]+)"', html))
    assert links <= set(re.findall(r'id="([^"]+)"', html))


@pytest.mark.slow
def test_with_very_many_requirements_their_sections_are_short(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choosing, "COMPACT", 5)
    monkeypatch.setattr(choosing, "_WHOLE", 1)
    _, html = reported(tmp_path, 2, 3, 0.5)
    assert "<h4>Formulas</h4>" not in html
    assert "With more than 1 requirements, their formulas" in html


def test_the_worst_run_of_a_requirement_gets_its_details_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choosing, "DETAILED", 1)
    known = small_project(tmp_path)
    verdicts = ("satisfied", "inconclusive", "violated")
    results = [result(known, word, run=f"{word}.mcap") for word in verdicts]
    build = report_of(known, tmp_path, *results)
    (section,) = selection(build).by_anchor.values()
    assert [each.run_file for each in section.details] == ["violated.mcap"]
    assert [row.has_details for row in section.rows] == [True, False, True]


def test_a_run_in_which_unknown_values_decided_is_drawn_before_runs_with_open_demands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choosing, "PICTURES", 1)
    known = small_project(tmp_path)
    unknown = {
        "proposition": "near", "first_tick": 20, "last_tick": 29, "start_ns": 3 * 10**9,
        "end_ns": 39 * 10**8, "start_s": 2.0, "end_s": 2.9, "signal": "clearance", "cause": "lost",
    }  # fmt: skip
    runs = [
        result(known, "no data", run="a.mcap", open=[moment(90)]),
        result(known, "no data", run="b.mcap", triggers=[], unknown_inputs=[unknown]),
    ]
    details = selection(report_of(known, tmp_path, *runs)).by_anchor["req-R1"].details
    assert {each.run_file: len(each.timelines) for each in details} == {"a.mcap": 0, "b.mcap": 1}


def test_a_reason_is_told_once_where_all_unsatisfied_runs_have_details(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = small_project(tmp_path)
    verdicts = ("satisfied", "inconclusive", "violated")
    runs = [result(known, word, run=f"{word}.mcap", reason="why") for word in verdicts]
    build = report_of(known, tmp_path, *runs)
    (section,) = selection(build).by_anchor.values()
    (view,) = whole(build).requirements
    assert view.reasons == (
        "violated: violated, why",
        "inconclusive: inconclusive, why",
        "it holds in 1 of 3 runs",
    )
    assert section.repeated == {0, 1}
    monkeypatch.setattr(choosing, "DETAILED", 1)
    (section,) = selection(build).by_anchor.values()
    assert section.repeated == frozenset()
