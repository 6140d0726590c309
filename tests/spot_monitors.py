"""Three-valued monitors from Spot's automata: the oracle of when a verdict is certain.

Source: Bauer, Leucker, Schallhart, Runtime verification for LTL and TLTL, TOSEM 20 (2011): a
prefix violates a formula for certain when the deterministic monitor of the formula has no move,
and satisfies it for certain when that of the negation has none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import spot  # isort: split

import buddy  # found only once spot has been imported

from compiler.logic import printing
from compiler.logic.formula import Formula


class Ltl3:
    """The verdict after each letter of a word."""

    def __init__(self, formula: Formula) -> None:
        text = printing.future(formula)
        parsed = spot.formula(text)
        self._machines = [_table(str(f)) for f in (parsed, spot.formula.Not(parsed))]

    def verdicts(self, word: Sequence[Mapping[str, bool]]) -> list[str]:
        """One of violated, satisfied, pending after each letter."""
        states: list[int | None] = [0, 0]
        found = []
        for letter in word:
            for i, machine in enumerate(self._machines):
                state = states[i]
                states[i] = None if state is None else machine.move(state, letter)
            found.append(_verdict(states))
        return found


def _verdict(states: Sequence[int | None]) -> str:
    if states[0] is None:
        return "violated"
    return "satisfied" if states[1] is None else "pending"


class _Table:
    """A deterministic monitor; the initial state is 0."""

    def __init__(self, text: str) -> None:
        automaton = spot.translate(spot.formula(text), "monitor", "det")
        self.variables = {str(p): automaton.register_ap(p) for p in automaton.ap()}
        self.automaton = automaton
        self.start = automaton.get_init_state_number()
        self.moves: dict[tuple[int, tuple[bool, ...]], int | None] = {}

    def move(self, state: int, letter: Mapping[str, bool]) -> int | None:
        """The next state; None: no word of the language begins so."""
        state = self.start if state == 0 else state - 1
        key = state, tuple(letter[name] for name in self.variables)
        if key not in self.moves:
            self.moves[key] = self._found(state, letter)
        return self.moves[key]

    def _found(self, state: int, letter: Mapping[str, bool]) -> int | None:
        cube = buddy.bddtrue
        for name, variable in self.variables.items():
            one = buddy.bdd_ithvar(variable) if letter[name] else buddy.bdd_nithvar(variable)
            cube = cube & one
        edges: Any = self.automaton.out(state)
        for edge in edges:
            if (edge.cond & cube) != buddy.bddfalse:
                return int(edge.dst) + 1
        return None


@cache
def _table(text: str) -> _Table:
    return _Table(text)
