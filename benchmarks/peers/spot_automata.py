"""Spot: its deterministic automaton as a table, stepped in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.peers.peer import Evaluation, PackagePeer, Step
from benchmarks.peers.workloads import Columns, letters

RISE = "(!a & X(a & !b))"
"""a rises at the next tick, where b is false."""
FORMULAS = {
    "W1": "G(a -> F b)",
    "W2": "G(a -> F[0:10] b)",
    "W4": f"(b | !(X!b U {RISE})) & G((c & !b) -> !(X!b U {RISE})) & G!(!a & X(a & c & !b))",
}
"""W4 has no past operators here: no c may be followed by a rise of a without a b between, nor the
start."""


@dataclass(frozen=True)
class Table:
    """States are multiples of 8, so that state + letter is an index; so is the truth there."""

    after: Sequence[int]
    holds: Sequence[bool]
    first: int


class Spot(PackagePeer):
    """The automaton of the future formula. The translator does not reach W3's bound of 100."""

    name = "Spot, table in Python"
    package, module = "spottl", "spot"
    formulas = FORMULAS

    def prepare(self, workload: str, columns: Columns) -> Evaluation:
        table, word = self._table(workload), letters(columns)
        return Evaluation(lambda: table, lambda monitor: _run(monitor, word))

    def prepare_from_numpy(self, workload: str, columns: Columns) -> Evaluation:
        table = self._table(workload)
        return Evaluation(lambda: table, lambda monitor: _run(monitor, letters(columns)))

    def prepare_steps(self, workload: str) -> Step:
        table = self._table(workload)
        after, holds, state = table.after, table.holds, table.first
        place = {"a": 1, "b": 2, "c": 4}

        def step(row: Mapping[str, bool]) -> object:
            nonlocal state
            state = after[state + sum(place[name] for name in row if row[name])]
            return holds[state]

        return step

    def truths(self, results: Any) -> Sequence[bool]:
        return list(results)

    def _table(self, workload: str) -> Table:
        """W1 is no safety formula: it holds where the Büchi automaton accepts."""
        import spot

        formula = self.formulas[workload]
        if workload == "W1":
            automaton = spot.translate(formula, "buchi", "det", "complete", "sbacc")
            return _read(automaton, [automaton.state_is_accepting(s) for s in _states(automaton)])
        automaton = spot.translate(formula, "monitor", "det")
        return _read(automaton, [True for _ in _states(automaton)])


def _states(automaton: Any) -> range:
    return range(automaton.num_states())


def _read(automaton: Any, holds: Sequence[bool]) -> Table:
    """The table; where no edge leads on the formula is violated for good."""
    bad = automaton.num_states()
    after = [
        8 * _successor(automaton, state, letter, bad)
        for state in _states(automaton)
        for letter in range(8)
    ]
    truths = [truth for truth in (*holds, False) for _ in range(8)]
    return Table(after + [8 * bad] * 8, truths, 8 * automaton.get_init_state_number())


def _successor(automaton: Any, state: int, letter: int, bad: int) -> int:
    import buddy  # after spot

    here = buddy.bddtrue
    for place, name in enumerate("abc"):
        variable = automaton.register_ap(name)
        here &= (buddy.bdd_ithvar if letter >> place & 1 else buddy.bdd_nithvar)(variable)
    return next((e.dst for e in automaton.out(state) if e.cond & here != buddy.bddfalse), bad)


def _run(table: Table, word: bytes) -> list[bool]:
    after, holds, state = table.after, table.holds, table.first
    return [holds[state := after[state + letter]] for letter in word]
