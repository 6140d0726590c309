import os
from dataclasses import replace
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from fretc.campaigns.campaign import (
    MissionResult,
    assessed,
    campaign,
    recorded,
    share,
    simulated,
    table,
)
from simulation.world.scenario import Scenario, load, without_agent
from tests.effort import FULL, some
from tests.simulation.missions import Missions, cut_off

SEEDS = int(os.environ.get("FRETC_SEEDS", "1"))
"""How many seeds each scenario is tried with; 20 take some twenty minutes on two cores."""
ALL = FULL or SEEDS > 1
WHOLE = "obstacle-moved"
"""The one whole mission of quick tests: to the last goal, with stops on the way."""
OF_THE_END = {"R9", "R10", "R11", "R12"}
"""Requirements of what the mission comes to."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, SEEDS + 1))
@pytest.mark.parametrize("name", without_agent() if ALL else [WHOLE])
def test_every_verdict_is_the_stated_one(
    missions: Missions, name: str, seed: int, tmp_path: Path
) -> None:
    scenario = load(name)
    mission = recorded(scenario, seed, tmp_path / "m.mcap") if seed > 1 else missions(scenario)
    run = assessed(mission)
    assert (run.scenario, run.seed) == (name, seed)
    assert run.wrong == {}, run.verdicts


@pytest.mark.slow
@pytest.mark.parametrize("name", some(without_agent(), 4))
def test_when_the_fault_has_shown_all_is_as_stated_but_what_the_mission_comes_to(
    missions: Missions, name: str
) -> None:
    run = assessed(missions(cut_off(name)))
    assert run.wrong.keys() <= OF_THE_END, run.verdicts
    assert {run.verdicts[id] for id in run.wrong} <= {"inconclusive", "no data"}


@pytest.mark.slow
def test_two_runs_with_one_seed_are_the_same_to_the_last_byte(tmp_path: Path) -> None:
    scenario = replace(load("scan-swapped"), duration=40.0 if FULL else 6.0)
    first = simulated(scenario, 5, tmp_path / "first.mcap")
    again = simulated(scenario, 5, tmp_path / "again.mcap")
    assert first == again
    assert (tmp_path / "first.mcap").read_bytes() == (tmp_path / "again.mcap").read_bytes()
    other = simulated(scenario, 6, tmp_path / "other.mcap")
    assert other != first


@pytest.mark.slow
def test_a_verdict_that_is_not_the_stated_one_is_told(tmp_path: Path) -> None:
    scenario = replace(load("nominal"), duration=10.0)
    run = simulated(scenario, 1, tmp_path / "a.mcap")
    assert run.wrong == dict.fromkeys(("R6", "R9", "R10", "R11", "R12"), "satisfied")
    assert run.verdicts["R12"] == "inconclusive"
    assert "not as expected: nominal, seed 1: R6 is vacuous, not satisfied, R9 is inc" in table(
        [run]
    )


@pytest.mark.slow
def test_the_logs_of_a_campaign_stay_where_they_are_wanted(tmp_path: Path) -> None:
    counts: list[int] = []
    short = [replace(load(name), duration=2.0) for name in ("nominal", "walker")]
    runs = campaign(short, [3, 4], 2, tmp_path, counts.append)
    assert [(run.scenario, run.seed) for run in runs] == [
        ("nominal", 3),
        ("nominal", 4),
        ("walker", 3),
        ("walker", 4),
    ]
    assert counts == [1, 2, 3, 4]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "nominal-3.mcap",
        "nominal-4.mcap",
        "walker-3.mcap",
        "walker-4.mcap",
    ]
    with AnyReader([tmp_path / "walker-4.mcap"]) as reader:
        decoded = [reader.deserialize(data, c.msgtype) for c, _, data in reader.messages()]
    assert len(decoded) > 300


@pytest.mark.parametrize(
    ("count", "runs", "low", "high"),
    [  # R: binom.test(count, runs)$conf.int
        (0, 20, 0.0, 0.1684335),
        (1, 20, 0.001265089, 0.2487328),
        (10, 20, 0.2719578, 0.7280422),
        (20, 20, 0.8315665, 1.0),
        (1, 1, 0.025, 1.0),
    ],
)
def test_the_interval_is_that_of_clopper_and_pearson(
    count: int, runs: int, low: float, high: float
) -> None:
    interval = share(count, runs)
    assert (interval.low, interval.high) == pytest.approx((low, high), abs=1e-6)


def test_the_table_has_a_line_for_each_scenario_and_the_violations() -> None:
    one = MissionResult(
        scenario="walker",
        seed=1,
        duration=90.0,
        complete=True,
        stops=2,
        measured_clearance=0.021,
        true_clearance=0.032,
        contacts=0,
        latencies=(0.1, 0.12),
        distances=(0.004, 0.005),
        verdicts={"R1": "satisfied", "R2": "violated"},
        wrong={},
    )
    other = replace(
        one,
        seed=2,
        complete=False,
        stops=4,
        contacts=1,
        true_clearance=-0.001,
        verdicts={"R1": "satisfied", "R2": "satisfied"},
        wrong={"R2": "violated"},
    )
    assert table([one, other]) == (
        "scenario  as stated  complete  contact in    stops  seen cm  true cm  stop s  stop cm\n"
        "walker    1/2        1/2       1/2 (1-99 %)  2-4    2.1      -0.1     0.12    0.5\n"
        "\n"
        "violated in, with 95 % intervals (Clopper-Pearson):\n"
        "  walker: R2 1/2 (1-99 %)\n"
        "not as expected: walker, seed 2: R2 is satisfied, not violated\n"
    )


def test_a_scenario_that_is_not_named_is_its_own() -> None:
    assert Scenario("mine").expect.verdicts == {}
