"""The matrix as values: each requirement and run has one mark, in either picture."""

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any, cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fretc.report.make import ReportBuild
from fretc.report.model.front import RunGroup
from fretc.report.model.marks import Mark
from fretc.report.model.views import ReportView
from fretc.report.page.matrix import Picture, picture
from tests.fretc.report.cases import as_json, project, report_of, requirement, result
from tests.fretc.report.page.large import MARKS, enlarged, mostly_satisfied, page, small

ALL, NONE = 10**9, 0
_CELL = re.compile(r'<td[^>]*>(?:<a href="#([^"]+)" aria-label="([^"]+)"[^>]*>(.*?)</a>)?</td>')


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> ReportBuild:
    return small(tmp_path_factory.mktemp("small"))


@pytest.fixture(scope="module")
def base(build: ReportBuild) -> ReportView:
    assert build.report is not None
    return build.report


@st.composite
def reports(draw: st.DrawFn) -> list[list[int | None]]:
    """The number of the mark of each requirement in each run; None: no result."""
    runs = draw(st.integers(1, 5))
    one = st.lists(st.none() | st.integers(0, len(MARKS) - 1), min_size=runs, max_size=runs)
    return draw(st.lists(one, min_size=1, max_size=12))


def made(base: ReportView, table: list[list[int | None]]) -> ReportView:
    def choose(requirement: int, run: int) -> Mark | None:
        number = table[requirement][run]
        return None if number is None else MARKS[number]

    runs = len(table[0])
    groups = [("even", (runs + 1) // 2), ("odd", runs // 2)]
    return enlarged(base, len(table), groups, choose)


def columns(groups: tuple[RunGroup, ...]) -> list[str]:
    return [run.anchor for group in groups for run in group.runs]


@given(reports())
@settings(max_examples=30)
def test_each_requirement_has_one_mark_in_each_run_and_it_is_its_verdict(
    base: ReportView, table: list[list[int | None]]
) -> None:
    report = made(base, table)
    shown = picture(report, frozenset(), ALL)
    lines = [line for block in shown.blocks for line in block.lines]
    assert len(lines) == len(report.matrix)
    views = {view.anchor: view for view in report.requirements}
    for line in lines:
        known = {result.run: result.mark for result in views[line.row.anchor].results}
        marks = [cell.mark if cell else None for cell in line.cells]
        assert marks == [known.get(run) for run in columns(shown.groups)]


@given(reports())
@settings(max_examples=30)
def test_the_small_picture_counts_each_cell_once_and_lists_all_that_is_red(
    base: ReportView, table: list[list[int | None]]
) -> None:
    report = made(base, table)
    shown = picture(report, frozenset(), NONE)
    tallies = [tally for block in shown.blocks for tally in block.tallies]
    counted = Counter[Mark]()
    for tally in tallies:
        counted.update(dict(tally.marks))
        assert [m.severity for m, _ in tally.marks] == sorted(m.severity for m, _ in tally.marks)
    results = [result for view in report.requirements for result in view.results]
    assert counted == Counter(result.mark for result in results)
    listed = {one.row.anchor for block in shown.blocks for one in block.unsatisfied}
    red = {v.anchor for v in report.requirements if any(not r.mark.shows for r in v.results)}
    assert listed >= red
    assert decoded(shown) == whole(report)


def decoded(shown: Picture) -> dict[str, list[str]]:
    """What the script makes of its data."""
    data = cast(Any, shown.data)
    words = {"-": "", **{letter: word for letter, (_, word) in data["marks"].items()}}
    return {
        row[2]: [
            words[letter]
            for letter, times in re.findall(r"([a-z-])(\d*)", row[5])
            for _ in range(int(times or 1))
        ]
        for row in data["rows"]
    }


def whole(report: ReportView) -> dict[str, list[str]]:
    runs = [run.anchor for group in report.front.groups for run in group.runs]
    known = {v.anchor: {r.run: r.mark.text for r in v.results} for v in report.requirements}
    return {anchor: [words.get(run, "") for run in runs] for anchor, words in known.items()}


@pytest.mark.slow
def test_a_cell_costs_about_sixty_bytes_and_the_page_one_and_a_half_megabytes(
    build: ReportBuild,
) -> None:
    groups = [(f"scenario-{n}", 10) for n in range(10)]
    text = page(build, 50, groups, mostly_satisfied(1, 0.05))
    cells = [match[0] for match in _CELL.finditer(text, text.index('<table class="matrix'))]
    assert len(cells) == 5_000
    assert sum(map(len, cells)) / len(cells) <= 62
    assert len(text.encode()) <= 1_500_000


def test_a_requirement_below_two_hazards_has_a_row_below_each(tmp_path: Path) -> None:
    hazards = '[HAZ-1]\ntitle = "One"\n[HAZ-2]\ntitle = "Two"\n'
    known = project(
        tmp_path,
        requirement("R1", "the robot shall always satisfy stopped", parents=["HAZ-1", "HAZ-2"]),
        requirement("R2", "the robot shall never satisfy near", parents=["HAZ-2"]),
        hazards=hazards,
    )
    runs = [result(known, "satisfied"), result(known, "violated", "R2")]
    report = report_of(known, tmp_path, *runs).report
    assert report is not None
    shown = picture(report, frozenset())
    assert [(b.hazard, [line.row.requirement for line in b.lines]) for b in shown.blocks] == [
        ("HAZ-1", ["R1"]),
        ("HAZ-2", ["R2", "R1"]),
    ]
    assert [line.id for block in shown.blocks for line in block.lines] == ["row-R1", "row-R2", ""]


def test_two_results_of_one_run_have_one_mark_the_worst(tmp_path: Path) -> None:
    known = project(tmp_path)
    build = report_of(known, tmp_path, result(known, "satisfied"), result(known, "violated"))
    assert build.report is not None
    ((line,),) = [block.lines for block in picture(build.report, frozenset()).blocks]
    assert [cell.mark.word for cell in line.cells if cell] == ["violated"]


@pytest.mark.slow
def test_a_mark_leads_to_its_details_or_to_its_requirement(build: ReportBuild) -> None:
    text = page(build, 3, [("", 40)], mostly_satisfied(2, 0.9))
    places = set(re.findall(r'id="([^"]+)"', text))
    cells = [match for match in _CELL.finditer(text) if match[1]]
    assert len(cells) == 120
    assert {match[1] for match in cells} <= places
    detailed = set(re.findall(r'<section class="result[^>]* id="([^"]+)"', text))
    assert detailed
    assert detailed <= {match[1] for match in cells}


@pytest.mark.slow
def test_the_page_and_its_json_say_the_same_of_each_run(tmp_path: Path) -> None:
    known = project(tmp_path)
    words = ("satisfied", "violated", "vacuous", "no data", "inconclusive")
    runs = [result(known, word, run=f"{word}.mcap") for word in words]
    stale = result(known, "satisfied", run="old.mcap", hashes={"sentence": "0" * 64})
    build = report_of(known, tmp_path, *runs, stale)
    (view,) = as_json(build)["requirements"]
    text = build.html or ""
    row = text[text.index('<tr id="row-R1"') :]
    cells = _CELL.findall(row[: row.index("</tr>")])
    assert [label.split(": ")[0] for _, label, _ in cells] == [
        f"{each['mark']['word']}{', suspect' if each['mark']['suspect'] else ''}"
        for each in view["results"]
    ]
    assert json.dumps(build.html) == json.dumps(report_of(known, tmp_path, *runs, stale).html)


def test_a_hazard_has_no_verdict_but_says_what_its_requirements_show(tmp_path: Path) -> None:
    sentence = "the robot shall always satisfy stopped"
    known = project(tmp_path, requirement("R1", sentence), requirement("R2", sentence))

    def summary(*words: str) -> str:
        results = [result(known, word, f"R{n}") for n, word in enumerate(words, 1)]
        build = report_of(known, tmp_path, *results)
        assert build.report is not None
        (block,) = picture(build.report, (), ALL).blocks
        return block.summary

    assert summary("satisfied", "satisfied") == "all 2 requirements hold in these runs"
    assert summary("satisfied", "violated") == "1 of 2 requirements is violated"
    assert summary("violated", "violated") == "2 of 2 requirements are violated"
    assert summary("vacuous", "violated") == "1 of 2 requirements is violated, 1 is not shown"
    assert summary("satisfied", "no data") == "1 of 2 requirements is not shown"
