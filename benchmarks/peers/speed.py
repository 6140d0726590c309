"""Ticks per second of CPU."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.peers.peer import Evaluation, Peer, Step
from benchmarks.peers.workloads import WORKLOADS, rows

STEPS = 100_000
"""Of how many ticks the rate of single steps is taken at most."""


@dataclass(frozen=True)
class Speed:
    """Millions of ticks per second of CPU; None where the peer has no such way."""

    ticks: int
    alone: float
    from_numpy: float
    steps: float | None


def rate(evaluation: Evaluation, ticks: int, runs: int = 5) -> float:
    """Millions of ticks per second of CPU: the median of `runs`, after one to warm up."""
    evaluation()
    return ticks / statistics.median(_seconds(evaluation) for _ in range(runs)) / 1e6


def _seconds(evaluation: Evaluation) -> float:
    """Of one run, the garbage collector off as in `timeit`."""
    monitor = evaluation.fresh()
    gc.collect()
    gc.disable()
    try:
        start = time.process_time()
        evaluation.run(monitor)
        return time.process_time() - start
    finally:
        gc.enable()


def stepping(peer: Peer, workload: str, inputs: Sequence[Mapping[str, bool]]) -> Evaluation:
    """One call a tick, from Python."""

    def run(step: Step) -> None:
        for row in inputs:
            step(row)

    return Evaluation(lambda: peer.prepare_steps(workload), run)


def speed(peer: Peer, workload: str, ticks: int, runs: int = 5, seed: int = 0) -> Speed:
    """The three rates of a peer, on as many ticks as its cost allows."""
    ticks = min(ticks, peer.most or ticks)
    columns = WORKLOADS[workload].columns(ticks, seed)
    alone = rate(peer.prepare(workload, columns), ticks, runs)
    from_numpy = rate(peer.prepare_from_numpy(workload, columns), ticks, runs)
    steps = None
    if peer.prepare_steps(workload):
        inputs = rows({name: column[:STEPS] for name, column in columns.items()})
        steps = rate(stepping(peer, workload, inputs), len(inputs), runs)
    return Speed(ticks, alone, from_numpy, steps)
