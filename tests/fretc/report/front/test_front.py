"""The front page: each requirement is counted once, and each sentence follows from the runs."""

import re
from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compiler.project.project import Project
from fretc.report.front.speech import days, duration
from tests.effort import FULL
from tests.fretc.report.cases import content_of, project, requirement, result

ALWAYS = "the robot shall always satisfy stopped"
VERDICTS = ("satisfied", "violated", "inconclusive", "vacuous", "no data")
DAMAGED: dict[str, Any] = {"health": {"intact": False}}
OLD: dict[str, Any] = {"hashes": {"sentence": "0" * 64}}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("front")


@pytest.fixture(scope="module")
def known(folder: Path) -> Project:
    texts = [
        requirement("R1", ALWAYS),
        requirement("R2", ALWAYS),
        requirement("R3", "the robot shall alwys satisfy stopped"),
        requirement("R4", ALWAYS, status="retired"),
        requirement("R5", ALWAYS, parents=[], status="draft"),
    ]
    return project(folder, *texts)


def front(known: Project, folder: Path, *results: Mapping[str, Any]) -> dict[str, Any]:
    page: dict[str, Any] = content_of(known, folder, *results)["front"]
    return page


def figures(page: Mapping[str, Any]) -> dict[str, int]:
    return {figure["name"]: figure["count"] for figure in page["figures"]}


def lines(page: Mapping[str, Any], name: str) -> dict[str, list[str]]:
    """The lines of a figure, with the names that each has."""
    (figure,) = [figure for figure in page["figures"] if figure["name"] == name]
    return {line["text"]: [link["name"] for link in line["names"]] for line in figure["lines"]}


@pytest.mark.slow
@given(
    cells=st.lists(
        st.tuples(
            st.sampled_from(["R1", "R2", "R5"]),
            st.sampled_from(VERDICTS),
            st.sampled_from([{}, DAMAGED, OLD]),
        ),
        max_size=8,
    )
)
@settings(
    max_examples=200 if FULL else 8, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_each_requirement_in_force_is_shown_violated_or_not_shown_for_a_cause(
    cells: list[tuple[str, str, dict[str, Any]]], known: Project, folder: Path
) -> None:
    runs = [
        result(known, word, id, run=f"{n}.mcap", **changes)
        for n, (id, word, changes) in enumerate(cells)
    ]
    report = content_of(known, folder, *runs)
    page = report["front"]
    count = figures(page)
    assert count["claimed"] == 4
    assert count["shown"] + count["violated"] + count["not shown"] == 4
    active = [view for view in report["requirements"] if view["status"] != "retired"]
    red = {view["id"] for view in active if view["mark"]["word"] == "violated"}
    good = {view["id"] for view in active if view["mark"]["word"] == "satisfied"}
    good -= {view["id"] for view in active if view["mark"]["suspect"]}
    assert set(lines(page, "violated").get("", [])) == red
    assert set(lines(page, "shown").get("", [])) == good
    because = lines(page, "not shown")
    named = {id for names in because.values() for id in names}
    by_damage = any(text.startswith("damaged log") for text in because)
    hurt = {id for id, word, changes in cells if changes is DAMAGED and word != "violated"}
    unshown = {view["id"] for view in active} - red - good
    assert unshown - named <= (hurt if by_damage else set())
    assert named <= unshown


def test_causes_are_told_apart(known: Project, folder: Path) -> None:
    page = front(
        known,
        folder,
        result(known, "vacuous", "R1", "a.mcap", triggers=[]),
        result(known, "inconclusive", "R2", "a.mcap"),
        result(known, "no data", "R1", "b.mcap", triggers=[], **DAMAGED),
        result(known, "no data", "R2", "b.mcap", **DAMAGED),
    )
    assert lines(page, "not shown") == {
        "damaged log: 1 run, 2 requirements": [],
        "not formalized": ["R3"],
        "never triggered": ["R1"],
        "open at the end": ["R2"],
        "not audited": ["R5"],
    }
    assert lines(page, "claimed") == {
        "under 1 hazard": [],
        "under no hazard": ["R5"],
        "draft": ["R5"],
        "retired": ["R4"],
    }
    assert page["trust"][0] == "1 of 2 logs damaged or not readable: b."


def test_a_violated_requirement_is_not_counted_among_those_without_a_verdict(
    known: Project, folder: Path
) -> None:
    page = front(
        known,
        folder,
        result(known, "violated", "R1", "a.mcap"),
        result(known, "no data", "R1", "b.mcap", **DAMAGED),
        result(known, "no data", "R2", "b.mcap", **DAMAGED),
    )
    assert "damaged log: 1 run, 1 requirement" in lines(page, "not shown")


RUNS = ("walk-1", "walk-2", "stop-1", "stop-2")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("verdicts", "headline", "sentences"),
    [
        (
            {"R1": "vvss", "R2": "vvss"},
            "Title of R1 (R1) and Title of R2 (R2) are violated in two of four runs.",
            [
                "Title of R1 (R1) [HAZ-1, catastrophic] fails only in walk (2 of 2 runs).",
                "Title of R2 (R2) [HAZ-1, catastrophic] fails only in walk (2 of 2 runs).",
            ],
        ),
        (
            {"R1": "vsss", "R2": "ssss"},
            "Title of R1 (R1) is violated in one of four runs.",
            ["Title of R1 (R1) [HAZ-1, catastrophic] fails only in walk (1 of 2 runs)."],
        ),
        (
            {"R1": "vsnn"},
            "Title of R1 (R1) is violated in one of four runs.",
            [
                "Title of R1 (R1) [HAZ-1, catastrophic] fails only in walk (1 of 2 runs); "
                "undecided in 2 other runs: stop-1 and stop-2."
            ],
        ),
        (
            {"R1": "vvvv", "R2": "vsvs", "R5": "vvvs"},
            "Three requirements are violated: none of four runs keeps all of them; the most "
            "severe: Title of R1 (R1), HAZ-1, catastrophic.",
            [
                "Title of R1 (R1) [HAZ-1, catastrophic] fails in every run.",
                "Title of R2 (R2) [HAZ-1, catastrophic] fails in 2 of 4 runs: walk-1 and stop-1.",
                "Title of R5 (R5) fails in 3 of 4 runs, all but stop-2.",
            ],
        ),
    ],
)
def test_the_decisive_sentence_says_where_each_violation_is_and_where_only(
    known: Project, folder: Path, verdicts: dict[str, str], headline: str, sentences: list[str]
) -> None:
    words = {"v": "violated", "s": "satisfied", "n": "no data"}
    results = [
        result(known, words[letter], id, f"{run}.mcap")
        for id, letters in verdicts.items()
        for run, letter in zip(RUNS, letters, strict=True)
    ]
    page = front(known, folder, *results)
    without_interval = [re.sub(_INTERVAL, "", text) for text in page["sentences"]]
    assert (page["headline"], without_interval) == (headline, sentences)


_INTERVAL = r"; 95 % interval of the share of failing runs: \S+ % to \S+ %"


def test_the_interval_of_failing_runs_is_that_of_clopper_and_pearson(
    known: Project, folder: Path
) -> None:
    """One of two: 1 - 0.975 ** 0.5 is 0.0126, and 0.975 ** 0.5 is 0.9874."""
    results = [result(known, word, "R1", f"{word}.mcap") for word in ("violated", "satisfied")]
    (sentence,) = front(known, folder, *results)["sentences"]
    assert sentence.endswith("; 95 % interval of the share of failing runs: 1.3 % to 99 %.")


def test_a_violation_of_before_a_change_is_never_said_to_be_one_of_now(
    known: Project, folder: Path
) -> None:
    page = front(known, folder, result(known, "violated", "R1", **OLD))
    since = "was violated, and the sentence has changed since the audit."
    assert page["headline"] == f"Title of R1 (R1) {since}"
    assert figures(page)["violated"] == 1


def test_nothing_audited_and_nothing_reviewed_are_said(known: Project, folder: Path) -> None:
    page = front(known, folder)
    assert page["facts"][:3] == ["4 requirements", "no run", "not reviewed"]
    assert figures(page) == {
        "claimed": 4, "shown": 0, "violated": 0, "not shown": 4, "changed": None,
    }  # fmt: skip
    assert page["groups"] == page["trust"] == []


def test_dates_and_durations_are_said_as_a_person_says_them() -> None:
    first, last = date(2026, 10, 2), date(2026, 11, 21)
    assert days(first, last) == "2 October to 21 November 2026"
    assert days(last, last) == "21 November 2026"
    assert days(date(2026, 11, 3), last) == "3 to 21 November 2026"
    assert days(date(2025, 1, 3), last) == "3 January 2025 to 21 November 2026"
    spoken = {
        4.26: "4.26 s",
        45.4: "45 s",
        3480: "58 min",
        12000: "3 h 20 min",
        86400 * 3: "3 days",
    }
    assert {seconds: duration(seconds) for seconds in spoken} == spoken
