from pathlib import Path
from typing import Any

import pytest

from compiler.report.histograms import step
from tests.compiler.report.cases import THRESHOLDS, made, project, requirement, result, said

WITHIN = requirement("R1", "whenever near the robot shall within 30 ticks satisfy stopped")


def view(folder: Path, *changes: dict[str, Any], text: str = WITHIN) -> dict[str, Any]:
    known = project(folder, text)
    runs = [
        result(known, "satisfied", run=f"{i}.mcap", **{"hashes": {"log": f"{i:064x}"}, **each})
        for i, each in enumerate(changes)
    ]
    found: dict[str, Any] = said(made(known, folder, *runs))["requirements"][0]
    return found


def margin(distance: float | None) -> list[dict[str, Any]]:
    kept = "crossed" if distance is None else "false"
    return [{**THRESHOLDS[0], "margin": distance, "comparison": kept}]


def test_all_latencies_are_counted_and_the_bound_is_marked(tmp_path: Path) -> None:
    section = view(tmp_path, {"latencies_s": [0.1, 0.3]}, {"latencies_s": [0.3, 3.2]})
    (late,) = [each for each in section["histograms"] if each["unit"] == "s"]
    assert {(b["low"], b["high"]): b["count"] for b in late["bins"] if b["count"]} == {
        (0.0, 0.2): 1,
        (0.2, 0.4): 2,
        (3.2, 3.4): 1,
    }
    assert (late["bound"], late["bound_label"]) == (3.0, "bound 3 s")
    assert late["text"] == (
        "4 answers in 2 runs: median 0.3 s, longest 3.2 s; bound 3 s, 1 later. "
        "1 from 0 to below 0.2 s, 2 from 0.2 to below 0.4 s and 1 from 3.2 to below 3.4 s."
    )


def test_an_answer_at_the_border_of_two_bars_counts_above_it(tmp_path: Path) -> None:
    section = view(tmp_path, {"latencies_s": [i / 10 for i in range(10)]})
    bins = section["histograms"][0]["bins"]
    assert sum(each["count"] for each in bins) == 10
    assert [each["count"] for each in bins[:5]] == [2, 2, 2, 2, 2]


def test_without_a_bound_none_is_marked(tmp_path: Path) -> None:
    text = requirement("R1", "whenever near the robot shall eventually satisfy stopped")
    late = view(tmp_path, {"latencies_s": [0.1, 0.3]}, text=text)["histograms"][0]
    assert late["bound"] is None
    assert "no bound in seconds" in late["text"]


def test_the_least_margin_of_each_run_is_counted_and_crossed_ones_apart(tmp_path: Path) -> None:
    section = view(
        tmp_path,
        *({"thresholds": margin(distance), "latencies_s": []} for distance in (0.1, 0.2, None)),
    )
    (found,) = section["histograms"]
    assert (found["unit"], found["bound"], found["crossed"]) == ("m", 0.0, 1)
    assert sum(each["count"] for each in found["bins"]) == 2
    assert found["text"].startswith(
        "2 runs with a margin: least 0.1 m, median 0.15 m; in 1 run the threshold was crossed."
    )


def test_suspect_runs_are_left_out_and_told(tmp_path: Path) -> None:
    good = {"latencies_s": [0.1, 0.2], "open": []}
    section = view(tmp_path, good, {**good, "hashes": {"bindings": "0" * 64}})
    assert section["exercise"] == (
        "1 run, 3 triggers, 2 answered, 0 violations, 1 suspect run left out"
    )
    assert section["histograms"][0]["text"].startswith("2 answers in 1 run")


@pytest.mark.parametrize(
    ("least", "found"), [(0.0, 1.0), (0.03, 0.05), (0.2, 0.2), (3.0, 5.0), (10.0, 10.0), (11, 20)]
)
def test_a_step_is_one_two_or_five_times_a_power_of_ten(least: float, found: float) -> None:
    assert step(least) == pytest.approx(found)
