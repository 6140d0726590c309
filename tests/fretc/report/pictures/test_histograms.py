import re
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiler.files.templating import render
from fretc.report.model.pictures import Bin, Histogram
from fretc.report.pictures.plots import histogram as layout
from fretc.report.pictures.scales import step
from tests.fretc.report.cases import THRESHOLDS, content_of, moment, project, requirement, result

WITHIN = requirement("R1", "whenever near the robot shall within 30 ticks satisfy stopped")


def view(folder: Path, *changes: dict[str, Any], text: str = WITHIN) -> dict[str, Any]:
    known = project(folder, text)
    runs = [
        result(known, "satisfied", run=f"{i}.mcap", **{"hashes": {"log": f"{i:064x}"}, **each})
        for i, each in enumerate(changes)
    ]
    requirement_view: dict[str, Any] = content_of(known, folder, *runs)["requirements"][0]
    return requirement_view


def margin(distance: float | None) -> list[dict[str, Any]]:
    kept = "crossed" if distance is None else "false"
    return [{**THRESHOLDS[0], "margin": distance, "comparison": kept}]


def test_all_latencies_are_counted_and_the_bound_is_marked(tmp_path: Path) -> None:
    section = view(tmp_path, {"latencies_s": [0.1, 0.3]}, {"latencies_s": [0.3, 3.2]})
    (late,) = [each for each in section["histograms"] if each["unit"] == "s"]
    assert {(b["low"], b["high"]): b["count"] for b in late["bins"] if b["count"]} == {
        (0.0, 0.2): 1,
        (0.2, 0.4): 2,
        (3.0, 3.2): 1,
    }
    assert (late["bound"], late["bound_label"]) == (3.0, "bound 3 s")
    assert late["text"] == (
        "4 answers in 2 runs: median 300 ms, longest 3.2 s; bound 3 s, 1 later. "
        "1 from 0 up to 0.2 s, 2 above 0.2 up to 0.4 s and 1 above 3 up to 3.2 s. "
        "Without an answer: 2 triggers whose deadline or scope ended."
    )


def test_an_answer_at_the_border_of_two_bars_counts_below_it(tmp_path: Path) -> None:
    section = view(tmp_path, {"latencies_s": [i / 10 for i in range(10)]})
    bins = section["histograms"][0]["bins"]
    assert sum(each["count"] for each in bins) == 10
    assert [each["count"] for each in bins[:5]] == [3, 2, 2, 2, 1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("allowed", "late"), [(3, [0.1, 0.3, 0.3]), (7, [0.0, 0.7]), (30, [3.0, 1.4, 2.9])]
)
def test_no_answer_in_time_stands_beyond_the_bound(
    tmp_path: Path, allowed: int, late: list[float]
) -> None:
    text = WITHIN.replace("30 ticks", f"{allowed} ticks")
    (histogram,) = view(tmp_path, {"latencies_s": late}, text=text)["histograms"]
    beyond = [each for each in histogram["bins"] if each["high"] > histogram["bound"] + 1e-9]
    assert sum(each["count"] for each in beyond) == 0
    (later,) = view(tmp_path, {"latencies_s": [*late, allowed / 10 + 0.1]}, text=text)["histograms"]
    beyond = [each for each in later["bins"] if each["high"] > later["bound"] + 1e-9]
    assert sum(each["count"] for each in beyond) == 1


def test_each_trigger_is_counted_answered_or_not(tmp_path: Path) -> None:
    """Ten triggers: three answers, five whose time ran out, two that wait when the log ends."""
    triggers = [moment(tick) for tick in range(10)]
    section = view(
        tmp_path, {"triggers": triggers, "latencies_s": [0.1, 0.2, 0.2], "open": triggers[8:]}
    )
    (histogram,) = section["histograms"]
    assert (histogram["unanswered"], histogram["open"]) == (5, 2)
    assert sum(each["count"] for each in histogram["bins"]) + 5 + 2 == 10
    assert histogram["text"].endswith(
        " Without an answer: 5 triggers whose deadline or scope ended and "
        "2 triggers open at the end of a run."
    )
    assert section["exercise"] == (
        "1 run, 10 triggers, 3 answered, 5 without an answer, 2 open at the end, 0 violations"
    )


def test_what_waits_for_no_answer_lacks_none(tmp_path: Path) -> None:
    text = requirement("R1", "whenever near the robot shall immediately satisfy stopped")
    section = view(tmp_path, {"latencies_s": []}, text=text)
    assert section["exercise"] == "1 run, 3 triggers, 0 violations"


def test_what_has_no_value_stands_apart_and_no_condition_in_the_colour_of_violations() -> None:
    bins = (Bin(0.0, 1.0, 4), Bin(1.0, 2.0, 1))
    late = layout(Histogram("t", "s", bins, 1.0, "bound 1 s", "", unanswered=8, open=2), "h")
    kinds = [(each["kind"], each["name"], each["label"]) for each in late["columns"]]
    assert kinds == [
        ("column", "", "4"),
        ("column", "", "1"),
        ("unanswered", "none", "8"),
        ("open", "open", "2"),
    ]
    assert all(each["x"] > late["right"] for each in late["columns"][2:])
    assert max(each["height"] for each in late["columns"]) == late["columns"][2]["height"]
    (*_, crossed) = layout(Histogram("t", "m", bins, 0.0, "", "", crossed=3), "h")["columns"]
    assert (crossed["kind"], crossed["label"]) == ("crossed", "3")
    style = render("report/style.css.j2")
    (requirement,) = re.findall(r"svg \.crossed \{ fill: var\((.*?)\)", style)
    assert requirement != "--bad"


def test_without_a_bound_none_is_marked(tmp_path: Path) -> None:
    text = requirement("R1", "whenever near the robot shall eventually satisfy stopped")
    late = view(tmp_path, {"latencies_s": [0.1, 0.3]}, text=text)["histograms"][0]
    assert late["bound"] is None
    assert "no bound in seconds" in late["text"]


@pytest.mark.slow
@example([0.0, 1e-10])
@settings(deadline=None, max_examples=15)
@given(st.lists(st.floats(0, 1e9) | st.floats(0, 1e-8), min_size=2, max_size=5))
def test_any_margins_are_all_counted_in_bars_with_a_width(margins: list[float]) -> None:
    with TemporaryDirectory() as folder:
        runs = [{"thresholds": margin(each), "latencies_s": []} for each in margins]
        bins = view(Path(folder), *runs)["histograms"][0]["bins"]
    assert sum(each["count"] for each in bins) == len(margins)
    assert all(each["low"] < each["high"] for each in bins)


def test_the_least_margin_of_each_run_is_counted_and_crossed_ones_apart(tmp_path: Path) -> None:
    section = view(
        tmp_path,
        *({"thresholds": margin(distance), "latencies_s": []} for distance in (0.1, 0.2, None)),
    )
    (histogram,) = section["histograms"]
    assert (histogram["unit"], histogram["bound"], histogram["crossed"]) == ("m", 0.0, 1)
    assert sum(each["count"] for each in histogram["bins"]) == 2
    assert histogram["text"].startswith(
        "2 runs with a margin: least 0.1 m, median 0.15 m; in 1 run the threshold was crossed."
    )


def test_suspect_runs_are_left_out_and_counted(tmp_path: Path) -> None:
    good = {"latencies_s": [0.1, 0.2], "open": []}
    section = view(tmp_path, good, {**good, "hashes": {"bindings": "0" * 64}})
    assert section["exercise"] == (
        "1 run, 3 triggers, 2 answered, 1 without an answer, 0 violations, 1 suspect run left out"
    )
    assert section["histograms"][0]["text"].startswith("2 answers in 1 run")


@pytest.mark.parametrize(
    ("least", "width"), [(0.0, 1.0), (0.03, 0.05), (0.2, 0.2), (3.0, 5.0), (10.0, 10.0), (11, 20)]
)
def test_a_step_is_one_two_or_five_times_a_power_of_ten(least: float, width: float) -> None:
    assert step(least) == pytest.approx(width)
