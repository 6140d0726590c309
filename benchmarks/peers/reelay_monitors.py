"""Reelay: past metric temporal logic in discrete time, in C++, called from Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks.peers.peer import Evaluation, PackagePeer, Step
from benchmarks.peers.workloads import Columns, letters

Row = Mapping[str, bool]

FORMULAS = {
    "W1": "!((!{b}) since ({a} and (!{b})))",
    "W2": "historically((once[10:10]{a}) -> (once[0:10]{b}))",
    "W3": "historically({a} -> (once[0:100]{b}))",
    "W4": "historically(({a} and (pre(!{a}))) -> ((!{c}) since {b}))",
}
"""Parentheses throughout: after a syntax error Reelay monitors what it had read, or crashes."""


class Reelay(PackagePeer):
    """`update`, once a tick, with a mapping."""

    name = "Reelay"
    package = module = "reelay"
    formulas = FORMULAS
    most = 1_000_000

    def prepare(self, workload: str, columns: Columns) -> Evaluation:
        rows = _mappings(columns)
        return Evaluation(lambda: _monitor(workload), lambda monitor: _run(monitor, rows))

    def prepare_from_numpy(self, workload: str, columns: Columns) -> Evaluation:
        return Evaluation(
            lambda: _monitor(workload), lambda monitor: _run(monitor, _mappings(columns))
        )

    def prepare_steps(self, workload: str) -> Step:
        step: Step = _monitor(workload).update
        return step

    def truths(self, results: Any) -> Sequence[bool]:
        """Reelay says the truth where it changes, and at the other ticks an empty mapping."""
        truth, truths = False, []
        for result in results:
            truth = result.get("value", truth)
            truths.append(truth)
        return truths


def _monitor(workload: str) -> Any:
    import reelay

    return reelay.discrete_timed_monitor(FORMULAS[workload])


def _mappings(columns: Columns) -> Sequence[Row]:
    """What `update` takes at each tick; equal ones are shared."""
    of = [{name: bool(letter >> "abc".index(name) & 1) for name in columns} for letter in range(8)]
    return [of[letter] for letter in letters(columns)]


def _run(monitor: Any, rows: Sequence[Row]) -> list[object]:
    update = monitor.update
    return [update(row) for row in rows]
