"""All runs in a report: every violation and unknown stretch, and links that lead somewhere."""

import re
from pathlib import Path
from typing import Any

import pytest

from fretc.report.model.pictures import Lanes
from tests.fretc.report.cases import (
    R1,
    as_html,
    moment,
    project,
    report_of,
    requirement,
    result,
    violation,
)

TEXTS = (R1, requirement("R2", "whenever near the robot shall within 3 ticks satisfy stopped"))


def spans(lanes: Lanes | None, kind: str) -> list[tuple[str, float, float, int]]:
    assert lanes is not None
    return [
        (lane.file, mark.start, mark.end, mark.count)
        for lane in lanes.lanes
        for mark in lane.marks
        if mark.kind == kind
    ]


def test_lanes_have_what_the_evidence_has(tmp_path: Path) -> None:
    known = project(tmp_path, *TEXTS)
    bad: Any = {"violations": [violation(10, 12), violation(60, 60)], "unknown": [[30, 33]]}
    build = report_of(
        known,
        tmp_path,
        result(known, "violated", run="a.mcap", **bad),
        result(known, "satisfied", "R2", run="a.mcap"),
        result(known, "inconclusive", run="b.mcap", open=[moment(80)]),
        result(known, "violated", "R2", run="b.mcap", violations=[violation(40, 41)]),
    )
    assert build.report is not None
    everything = build.report.across
    assert spans(everything.lanes, "violated") == [
        ("a.mcap", 1.0, 1.3, 1),
        ("a.mcap", 6.0, 6.1, 1),
        ("b.mcap", 4.0, 4.2, 1),
    ]
    assert spans(everything.lanes, "unknown") == [("a.mcap", 3.0, 3.4, 1)]
    assert spans(everything.lanes, "open") == [("b.mcap", 8.0, 10.0, 1)]
    first, second = everything.requirements
    assert spans(first.lanes, "violated") == [("a.mcap", 1.0, 1.3, 1), ("a.mcap", 6.0, 6.1, 1)]
    assert spans(second.lanes, "violated") == [("b.mcap", 4.0, 4.2, 1)]
    assert second.lanes is not None
    assert second.lanes.left_out == "1 run without such a tick: not drawn."


@pytest.mark.slow
def test_every_link_of_a_picture_leads_somewhere(tmp_path: Path) -> None:
    known = project(tmp_path, *TEXTS)
    build = report_of(
        known,
        tmp_path,
        *(
            result(known, "violated", id, run=f"{n}.mcap", violations=[violation(n, n)])
            for n in range(30)
            for id in ("R1", "R2")
        ),
    )
    page = as_html(build)
    ids = set(re.findall(r' id="([^"]+)"', page))
    figures = re.findall(r'<figure class="across".*?</figure>', page, re.DOTALL)
    assert len(figures) == 3 + 2
    links = [link for figure in figures for link in re.findall(r'href="#([^"]+)"', figure)]
    assert len(links) > 100
    assert {*links} <= ids
    assert any(link.startswith("picture-") for link in links)
