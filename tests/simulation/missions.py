"""Missions with the emitted interceptor: one of a kind is recorded once for all tests."""

import fcntl
import hashlib
import pickle
import shutil
from dataclasses import dataclass, fields, replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from fretc.campaigns.campaign import intercepted, recorded
from simulation import mission
from simulation.world.scenario import Scenario, load

ROOT = Path(__file__).parents[2]
MADE_OF = (
    "simulation", "fretc/campaigns", "fretc/logs", "fretish", "monitors", "compiler", "templates",
    "requirements", "tests/simulation/missions.py",
)  # fmt: skip
"""Whatever the log of a mission depends on."""
MOST = 3
"""How many states of `MADE_OF` have missions that are kept."""


SECONDS = {
    "clock-jump": 32.0,
    "far-threshold": 7.0,
    "lidar-invalid": 24.0,
    "lidar-silent": 24.0,
    "no-release": 33.0,
    "safety-silent": 23.0,
    "walker": 54.0,
    **dict.fromkeys(("blind-zone", "log-cut", "safety-late", "safety-off"), 15.0),
    **dict.fromkeys(("stop-lost", "zero-late"), 15.0),
}
"""By then the fault has shown, and no answer is awaited; in each other scenario after 22 s."""


def record(out: Path, scenario: Scenario, seed: int = 1, **more: Any) -> mission.Mission:
    """Stopped by hand: by the threshold of the scenario."""
    return mission.record(out, scenario, intercepted(scenario.interceptor), seed, **more)


def cut_off(name: str) -> Scenario:
    """A scenario without what comes after its fault."""
    return replace(load(name), duration=SECONDS.get(name, 22.0))


@dataclass(frozen=True)
class Missions:
    """Missions in a folder that later runs of tests have, too; no log of them is to be changed."""

    folder: Path

    def __call__(self, scenario: Scenario, *, by_hand: bool = False) -> mission.Mission:
        """The mission with seed 1, stopped by the compiled safety function or by hand."""
        mine = self._mine()
        key = hashlib.sha256(repr((scenario, by_hand)).encode()).hexdigest()[:16]
        log, summary = mine / f"{scenario.name}-{key}.mcap", mine / f"{scenario.name}-{key}.pickle"
        with (mine / f"{scenario.name}-{key}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # another worker may be recording it
            if not summary.exists():
                found = (record if by_hand else recorded)(out=log, scenario=scenario, seed=1)
                kept = {each.name: getattr(found, each.name) for each in fields(found)}
                kept = {name: kept[name] for name in kept.keys() - {"scenario", "path"}}
                partial = summary.with_suffix(".partial")
                partial.write_bytes(pickle.dumps(kept))
                partial.rename(summary)
            return mission.Mission(
                scenario=scenario, path=log, **pickle.loads(summary.read_bytes())
            )

    def _mine(self) -> Path:
        """The folder of the missions of this code; the oldest ones of other code are removed."""
        mine = self.folder / made_of()
        if not mine.is_dir():
            others = sorted(self.folder.iterdir(), key=lambda path: path.stat().st_mtime)
            for old in others[: max(0, len(others) + 1 - MOST)]:
                shutil.rmtree(old, ignore_errors=True)
            mine.mkdir(exist_ok=True)
        return mine


@cache
def made_of() -> str:
    """A SHA-256 of what all missions depend on, beside scenario and seed."""
    sha = hashlib.sha256()
    for package in ("mujoco", "numpy", "mcap", "rosbags"):
        sha.update(f"{package} {version(package)}\n".encode())
    for name in MADE_OF:
        top = ROOT / name
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            if path.is_file() and "__pycache__" not in path.parts:
                data = path.read_bytes()
                sha.update(f"{path.relative_to(ROOT)} {len(data)}\n".encode() + data)
    return sha.hexdigest()[:16]
