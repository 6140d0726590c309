"""CPU time of one process."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable


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
