"""RTAMT: signal temporal logic in discrete time, on-line and off-line, in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.peers.peer import Evaluation, PackagePeer, Step
from benchmarks.peers.workloads import Columns, letters

FORMULAS = {
    "W1": "not((not b) since (a and (not b)))",
    "W2": "historically((once[10:10] a) -> (once[0:10] b))",
    "W3": "historically(a -> (once[0:100] b))",
    "W4": "historically((a and (s_prev (not a))) -> ((not c) since b))",
}
ROBUSTNESS = (-1.0, 1.0)
"""Of false and of true: what is above 0 holds."""


def _parsed(kind: str, workload: str) -> Any:
    import rtamt

    specification = getattr(rtamt, kind)()
    for name in ("a", "b", "c", "out"):
        specification.declare_var(name, "float")
    specification.spec = f"out = {FORMULAS[workload]}"
    specification.parse()
    return specification


class RtamtOnline(PackagePeer):
    """`update`, once a tick."""

    name = "RTAMT on-line"
    package = module = "rtamt"
    formulas = FORMULAS
    most = 10_000

    def prepare(self, workload: str, columns: Columns) -> Evaluation:
        rows = _samples(columns)
        return Evaluation(lambda: _online(workload), lambda monitor: _run(monitor, rows))

    def prepare_from_numpy(self, workload: str, columns: Columns) -> Evaluation:
        return Evaluation(
            lambda: _online(workload), lambda monitor: _run(monitor, _samples(columns))
        )

    def prepare_steps(self, workload: str) -> Step:
        update, tick = _online(workload).update, iter(range(2**62))

        def step(row: Mapping[str, bool]) -> object:
            return update(next(tick), [(name, ROBUSTNESS[row[name]]) for name in row])

        return step

    def truths(self, results: Any) -> Sequence[bool]:
        return [robustness > 0 for robustness in results]


def _online(workload: str) -> Any:
    return _parsed("StlDiscreteTimeOnlineSpecification", workload)


def _samples(columns: Columns) -> Sequence[object]:
    """What `update` takes at each tick; equal ones are shared."""
    of = [
        [(name, ROBUSTNESS[letter >> "abc".index(name) & 1]) for name in columns]
        for letter in range(8)
    ]
    return [of[letter] for letter in letters(columns)]


def _run(specification: Any, rows: Sequence[object]) -> list[float]:
    update = specification.update
    return [update(tick, row) for tick, row in enumerate(rows)]


class RtamtOffline(PackagePeer):
    """`evaluate`, once for the trace."""

    name = "RTAMT off-line"
    package = module = "rtamt"
    formulas = FORMULAS
    most = 100_000

    def prepare(self, workload: str, columns: Columns) -> Evaluation:
        signals = _lists(columns)
        return Evaluation(lambda: _offline(workload), lambda monitor: monitor.evaluate(signals))

    def prepare_from_numpy(self, workload: str, columns: Columns) -> Evaluation:
        return Evaluation(
            lambda: _offline(workload), lambda monitor: monitor.evaluate(_lists(columns))
        )

    def truths(self, results: Any) -> Sequence[bool]:
        return [robustness > 0 for _, robustness in results]


def _offline(workload: str) -> Any:
    return _parsed("StlDiscreteTimeOfflineSpecification", workload)


def _lists(columns: Columns) -> dict[str, list[float]]:
    ticks = len(columns["a"])
    signals = {name: np.where(column, 1.0, -1.0).tolist() for name, column in columns.items()}
    return {"time": list(range(ticks)), **signals}
