"""Scenarios by chance are scenarios, and a file says the same as what it was made of."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from random import Random

from hypothesis import given
from hypothesis import strategies as st

from fretc.testing.log_synthesis.scenarios import text
from fretc.testing.log_synthesis.variation import varied
from fretc.testing.suite import Polarity
from simulation.mission import possible
from simulation.world.scenario import Expectations, Scenario, load


@given(st.integers(0, 10**6))
def test_a_variation_can_be_written_read_and_run(seed: int) -> None:
    chance = Random(seed)
    scenario = load("nominal")
    for _ in range(3):
        scenario = varied(scenario, chance)
    aim = ("R1", "never-triggered", Polarity.KEPT)
    written = text(scenario, {"R1": "no data", "R2": "violated"}, [aim], {aim: "nothing"})
    again = read(written)
    possible(again)
    assert again.expect == Expectations(violated=("R2",), no_data=("R1",))
    assert as_run(again) == as_run(scenario)


def as_run(scenario: Scenario) -> Scenario:
    """Only what a mission depends on."""
    told = replace(scenario, title="", text="", name="", expect=Expectations())
    return replace(told, transport=dict(scenario.transport))


def read(written: str) -> Scenario:

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "again.toml"
        path.write_text(written)
        return load(str(path))
