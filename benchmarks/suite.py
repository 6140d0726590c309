"""What the tests cost: CPU seconds of each function and room, and how long each worker waited.

`python -m benchmarks.suite [ARGUMENT ...]` runs pytest with these arguments and measures each test
from within, with the processes that it has waited for. A process that is still running when its
test ends is counted with the test that waits for it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

import pytest

FOLDER = "FRETC_SUITE_COSTS"
"""The environment variable that names the folder into which each worker writes."""


@dataclass(frozen=True)
class Cost:
    """One phase of one test: CPU seconds; when it ended on the wall clock, in seconds."""

    test: str
    phase: str
    seconds: float
    end: float


class Meter:
    """A plugin of pytest: the cost of each phase of each test, in a file of JSON lines."""

    def __init__(self, folder: Path) -> None:
        worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
        self.path = folder / f"{worker}.jsonl"

    @contextmanager
    def _measured(self, item: pytest.Item, phase: str) -> Iterator[None]:
        before = cpu_seconds()
        try:
            yield
        finally:
            cost = Cost(item.nodeid, phase, cpu_seconds() - before, time.time())
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(asdict(cost)) + "\n")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Iterator[None]:
        with self._measured(item, "setup"):
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        with self._measured(item, "call"):
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self, item: pytest.Item) -> Iterator[None]:
        with self._measured(item, "teardown"):
            return (yield)


def pytest_configure(config: pytest.Config) -> None:
    """Measure where a folder is named; `-p benchmarks.suite` reaches each worker."""
    if folder := os.environ.get(FOLDER):
        config.pluginmanager.register(Meter(Path(folder)))


def cpu_seconds() -> float:
    """CPU time of this process and of those that it has waited for."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


def room(test: str) -> str:
    """`tests/fretc/audit/store/test_law.py::test_x` → `fretc/audit`."""
    parts = test.partition("::")[0].split("/")[1:-1]
    return "/".join(parts[:2]) or "tests"


def function(test: str) -> str:
    """The test without its parameters."""
    return test.partition("[")[0]


def sums(costs: Iterable[Cost], key: str) -> list[tuple[float, str]]:
    """CPU seconds by `room`, `function` or `phase`, the dearest first."""
    names = {"room": lambda c: room(c.test), "function": lambda c: function(c.test)}
    total: dict[str, float] = defaultdict(float)
    for cost in costs:
        total[names[key](cost) if key in names else cost.phase] += cost.seconds
    return sorted(((seconds, name) for name, seconds in total.items()), reverse=True)


def costs_of(path: Path) -> list[Cost]:
    """What one worker has written."""
    return [Cost(**json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines()]


def table(workers: dict[str, list[Cost]], wall: float, most: int = 20) -> str:
    """The dearest functions, CPU by room and phase, and how long each worker waited at the end."""
    costs = [cost for each in workers.values() for cost in each]
    last = max(cost.end for cost in costs)
    waits = {name: last - max(c.end for c in each) for name, each in workers.items()}
    lines = [f"{wall:.0f} s wall time, {sum(c.seconds for c in costs):.0f} CPU seconds in tests"]
    for key, count in (("function", most), ("room", 100), ("phase", 3)):
        lines += ["", f"CPU s  {key}"]
        lines += [f"{seconds:6.1f}  {name}" for seconds, name in sums(costs, key)[:count]]
    lines += ["", "s waited at the end"]
    lines += [f"{wait:6.1f}  {name}" for name, wait in sorted(waits.items())]
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Run pytest, print the table, and return pytest's exit status."""
    with tempfile.TemporaryDirectory() as folder:
        begun = time.monotonic()
        command = [sys.executable, "-m", "pytest", "-q", "-p", "benchmarks.suite", *arguments]
        status = subprocess.run(command, env=os.environ | {FOLDER: folder}, check=False).returncode
        wall = time.monotonic() - begun
        workers = {path.stem: costs_of(path) for path in sorted(Path(folder).glob("*.jsonl"))}
        if workers:
            print(table(workers, wall))
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
