from dataclasses import replace
from pathlib import Path

import pytest

from simulation.world.scenario import (
    Outage,
    Scenario,
    ScenarioError,
    Transport,
    load,
    names,
)


def write(path: Path, text: str) -> str:
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_scenario_of_a_file_has_what_is_written_and_else_the_defaults(tmp_path: Path) -> None:
    text = """
title = "All of it"
duration = 60
[store.moved]
barrel_1 = [1, 2.5]
[lidar]
outages = [{ at = 20, seconds = 2, says = "nan" }]
[safety]
dies_at = 3
[transport."/scan"]
loss = 0.5
[expect]
satisfied = ["R1"]
no_data = ["R2"]
"""
    scenario = load(write(tmp_path / "mine.toml", text))
    assert (scenario.name, scenario.title, scenario.duration) == ("mine", "All of it", 60.0)
    assert scenario.store.moved == {"barrel_1": (1.0, 2.5)}
    assert scenario.lidar.outages == (Outage(20.0, 2.0, "nan"),)
    assert scenario.safety.dies_at == 3.0
    assert scenario.transport == {"/scan": Transport(loss=0.5)}
    assert scenario.expect.verdicts == {"R1": "satisfied", "R2": "no data"}
    assert scenario.planner == Scenario("any").planner


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "`title` is missing"),
        ("title = 1", "`title` must be a text"),
        ('title = "a"\nname = "b"', "`name` cannot be set: a scenario is called by its file"),
        ('title = "a"\nduration = true', "`duration` must be a number"),
        ('title = "a"\nsafety = 1', "`safety` must be a table"),
        ('title = "a"\n[safety]\non = 1', "`safety.on` must be true or false"),
        ('title = "a"\n[operator]\nabsent = 1', "`operator` has no `absent`; it may have present"),
        ('title = "a"\n[store.moved]\nb = [1]', "`store.moved.b` must have 2 elements"),
        ('title = "a"\n[lidar]\noutages = 1', "`lidar.outages` must be a list"),
        ('title = "a"\nduration = nan', "`duration` must be finite"),
        ('title = "a"\nduration = 0', "`duration` must be above 0"),
        ('title = "a"\n[safety]\nlate = -1', "`safety.late` must not be below 0"),
        ('title = "a"\n[safety]\ndies_at = -1', "`safety.dies_at` must not be below 0"),
        ('title = "a"\n[planner]\nsilent = -0.1', "`planner.silent` must not be below 0"),
        (
            'title = "a"\n[lidar]\noutages = [{ at = 1, seconds = -1 }]',
            "`lidar.outages.seconds` must not be below 0",
        ),
        ('title = "a"\n[interceptor]\nhold = -1', "`interceptor.hold` must not be below 0"),
        (
            'title = "a"\n[interceptor]\nat_once = false',
            "`interceptor.at_once` must be true with a period above 0, and false without one",
        ),
        (
            'title = "a"\n[interceptor]\nat_once = false\nperiod = 0\nhold = 0',
            "`interceptor.command_timeout` must be 0 without a period: there is no timer",
        ),
        (
            'title = "a"\n[interceptor]\nhold = 0.01',
            "`interceptor.hold` must be 0, or not below the period",
        ),
        ('title = "a"\n[lidar]\nnearer = "x"', "`lidar.nearer` must be `near` or `lost`"),
        (
            'title = "a"\n[transport."/scan"]\nloss = 2',
            "`transport./scan.loss` must be between 0 and 1",
        ),
        (
            'title = "a"\n[store.walker]\nstart = [1, 1]\nend = [1, 1]\nnear = [1, 1]',
            "`store.walker` must not end where it starts",
        ),
        (
            'title = "a"\n[expect]\nvacuous = ["R1"]\nviolated = ["R1"]',
            "`expect` names R1 twice",
        ),
        ('title = "a"\n[lidar]\noutages = [{ at = 1 }]', "`lidar.outages.seconds` is missing"),
    ],
)
def test_what_is_no_scenario_is_refused_with_the_place(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        load(write(tmp_path / "bad.toml", text))
    assert str(refused.value) == why


def test_a_name_that_is_none_tells_those_that_are() -> None:
    with pytest.raises(ScenarioError, match="there is no scenario `nominul`; there are agent-"):
        load("nominul")


def test_lines_may_end_and_files_may_begin_as_on_windows(tmp_path: Path) -> None:
    text = 'title = "A"\ntext = "B"\n'
    plain = load(write(tmp_path / "one.toml", text))
    (tmp_path / "other.toml").write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert replace(load(str(tmp_path / "other.toml")), name="one") == plain


def test_no_toml_and_no_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="is no TOML"):
        load(write(tmp_path / "bad.toml", "title"))
    with pytest.raises(FileNotFoundError):
        load(str(tmp_path / "none.toml"))


@pytest.mark.parametrize("name", names())
def test_every_scenario_states_what_its_log_must_show(name: str) -> None:
    scenario = load(name)
    assert scenario.name == name
    assert scenario.title
    assert scenario.text
    assert scenario.expect.verdicts
