"""Do the peers say what the definition says? A speed of another answer would mean nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.peers.peer import Peer
from benchmarks.peers.workloads import VIOLATED_AT, WORKLOADS, Columns, Workload, rows

DENSITIES = (0.03, 0.1, 0.3, 0.6)
LENGTHS = (2, 11, 12, 150, 150)
"""RTAMT off-line refuses a trace of one tick."""
APART = (0, 1, 9, 10, 11, 99, 100, 101)
LATCHING = ("W2", "W3", "W4")
"""False for good after the first violation; W1 is false while a trigger is open."""
AS_TIMED = 400
"""Ticks of a short trace made as the timed ones are."""


def short(workload: Workload, seed: int) -> Iterator[Columns]:
    """Random traces with rare and frequent signals, one like the timed ones, and the edges."""
    rng = np.random.default_rng(seed)
    for ticks in LENGTHS:
        for _ in range(6):
            yield {name: rng.random(ticks) < rng.choice(DENSITIES) for name in workload.signals}
    yield workload.columns(AS_TIMED, seed)
    yield from edges(workload)


def edges(workload: Workload) -> Iterator[Columns]:
    """One a and one b, about as far apart as a bound allows, in either order."""
    for apart in APART:
        for first, second in ("ab", "ba"):
            columns = {name: np.zeros(120, dtype=np.bool_) for name in workload.signals}
            columns[first][3] = columns[second][3 + apart] = True
            yield columns


def disagreements(peer: Peer, workload: Workload, seed: int = 0) -> list[str]:
    """Where the peer's truth at some tick is not the definition's; each evaluation runs twice."""
    found = []
    for number, columns in enumerate(short(workload, seed)):
        expected = workload.truths(columns)
        for way, truths in _answers(peer, workload, columns):
            if truths != expected:
                found.append(f"{peer.name}, {workload.name}, {way}, trace {number}")
    return found


def _answers(
    peer: Peer, workload: Workload, columns: Columns
) -> Iterator[tuple[str, Sequence[bool]]]:
    for way, prepare in (("alone", peer.prepare), ("from NumPy", peer.prepare_from_numpy)):
        evaluate = prepare(workload.name, columns)
        for run in ("first", "second"):
            yield f"{way}, {run} run", peer.truths(evaluate())
    step = peer.prepare_steps(workload.name)
    if step:
        yield "steps", peer.truths([step(row) for row in rows(columns)])


def misplaced(workload: Workload, ticks: int = 2_000) -> list[str]:
    """Whether a timed trace is violated elsewhere than where it is meant to be."""
    columns = workload.columns(ticks)
    before, after = (int((VIOLATED_AT + by) * ticks) for by in (-0.1, 0.1))
    if workload.holds(columns, before) and not workload.holds(columns, after):
        return []
    return [f"{workload.name}: the violation is not at {VIOLATED_AT} of the trace"]


def faults(peers: Sequence[Peer]) -> list[str]:
    """All that would make a figure meaningless."""
    found = [line for name in LATCHING for line in misplaced(WORKLOADS[name])]
    for peer in peers:
        for name in peer.formulas:
            found += disagreements(peer, WORKLOADS[name])
    return found
