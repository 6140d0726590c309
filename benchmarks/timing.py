"""CPU time of one process."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass


def seconds(run: Callable[[], object], runs: int = 5) -> float:
    """The median, after one run to warm up."""
    run()
    times = []
    for _ in range(runs):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return statistics.median(times)


def least(run: Callable[[], object], runs: int = 5) -> float:
    """The least, after one run to warm up: what other work on the machine adds is left out."""
    run()
    times = []
    for _ in range(runs):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times)


@dataclass(frozen=True)
class Cost:
    """Seconds that something takes."""

    cpu: float
    """CPU time of the process, all its threads."""
    main: float
    """CPU time of its first thread."""
    wall: float


def costs(runs: Mapping[str, Callable[[], object]], rounds: int = 7) -> dict[str, Cost]:
    """The medians, where each round runs all of them in turn, after one round to warm up."""
    times: dict[str, list[tuple[float, ...]]] = {name: [] for name in runs}
    for _ in range(rounds + 1):
        for name, run in runs.items():
            clocks = time.process_time, time.thread_time, time.perf_counter
            starts = [clock() for clock in clocks]
            run()
            ends = [clock() for clock in clocks]
            times[name].append(tuple(b - a for a, b in zip(starts, ends, strict=True)))
    return {
        name: Cost(*map(statistics.median, zip(*some[1:], strict=True)))
        for name, some in times.items()
    }
