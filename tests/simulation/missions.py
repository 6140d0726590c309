"""Missions with the emitted interceptor."""

from pathlib import Path
from typing import Any

from fretc.campaigns.campaign import intercepted
from simulation import mission
from simulation.world.scenario import Scenario


def record(out: Path, scenario: Scenario, seed: int = 1, **more: Any) -> mission.Mission:
    return mission.record(out, scenario, intercepted(scenario.interceptor), seed, **more)
