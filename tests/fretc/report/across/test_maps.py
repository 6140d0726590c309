"""Each violation is marked where it began, or counted among those of an unknown place."""

from pathlib import Path
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from compiler.files.records import decoded
from fretc.audit.evidence.schema import RobotPath
from fretc.report.across.layout import drawn_map
from fretc.report.across.maps import MapResult, run_map
from tests.effort import examples
from tests.fretc.audit.results import result as record
from tests.fretc.report.cases import R1, as_html, project, report_of, result, row, violation

PLAIN: dict[str, Any] = {
    "times_ns": [10**9, 5 * 10**9, 7 * 10**9, 11 * 10**9],
    "x": [0.0, 4.0, 6.0, 6.0],
    "y": [0.0, 0.0, 1.0, 3.0],
    "starts": [0, 2],
    "error": 0.01,
    "lines_left_out": 0,
}
WAY = decoded(PLAIN, RobotPath)


def of_run(*seconds: float) -> MapResult:
    ns = [10**9 + round(s * 1e9) for s in seconds]
    broken = [{"start_ns": n, "start_s": s} for n, s in zip(ns, seconds, strict=True)]
    found = record(violations=broken)
    return MapResult(row(1, "violated", place=0, violations_total=len(broken)), found)


@given(st.lists(st.floats(0, 12).map(lambda number: round(number, 3)), max_size=30).map(sorted))
@examples(25)
def test_each_violation_is_in_one_mark_or_its_place_is_unknown(seconds: list[float]) -> None:
    found = run_map(WAY, [of_run(*seconds)])
    assert found is not None
    between = [s for s in seconds if 4.0 < s < 6.0 or s > 10.1]
    assert found.unplaced == len(between)
    assert sum(mark.count for mark in found.marks) == len(seconds) - len(between)


def test_a_metre_is_as_long_upwards_as_to_the_right() -> None:
    found = run_map(WAY, [of_run(0.0, 2.0, 8.0)])
    assert found is not None
    assert [(mark.x, mark.y) for mark in found.marks] == [(0, 0), (2, 0), (6, 2)]
    drawn = drawn_map(found, "map", frozenset())
    places = [(p["x"], p["y"]) for p in drawn["places"]]
    right, up = places[1][0] - places[0][0], places[0][1] - places[2][1]
    assert round(right / 2, 1) == round(up / 2, 1)
    assert drawn["bar_label"] == "1 m"
    assert abs(drawn["bar"] - right / 2) < 0.2


def test_the_page_has_the_map_with_links_and_says_it_in_words(tmp_path: Path) -> None:
    known = project(tmp_path, R1)
    bad: Any = {"violations": [violation(10, 12), violation(60, 60)]}
    course = {"way": PLAIN, "words": {"mode": {"times_ns": [], "words": [], "changes_left_out": 0}}}
    build = report_of(known, tmp_path, result(known, "violated", **bad, course=course))
    assert build.report is not None
    (drawn,) = build.report.across.maps
    assert drawn.text == (
        "The path of the robot from (0, 0) to (6, 3) in metres, drawn to within "
        "0.01 m. It has 2 parts: between them the position is unknown. 2 violations, marked where "
        "each began."
    )
    assert '<a href="#picture-result-R1.1.1"><title>R1: violated, at 1 s</title>' in as_html(build)
