"""Runs of a graph that repeat themselves, and whether they satisfy a formula."""

from __future__ import annotations

from collections.abc import Iterator

from compiler.logic import formula as f
from compiler.logic.definition import holds_on_lasso
from compiler.logic.kripke import Kripke, Lasso


def keeps(formula: f.Formula, kripke: Kripke, lasso: Lasso) -> bool:
    prefix, loop = (
        [{name: name in kripke.labels[state] for name in f.atoms(formula)} for state in states]
        for states in (lasso.prefix, lasso.cycle)
    )
    return holds_on_lasso(formula, prefix, loop)


def lassos(kripke: Kripke, longest: int) -> Iterator[Lasso]:
    """Every run that repeats itself after that many states or fewer."""
    ways: list[tuple[int, ...]] = [(kripke.initial,)]
    for _ in range(longest):
        for way in ways:
            for back, state in enumerate(way):
                if state in kripke.successors(way[-1]):
                    yield Lasso(way[:back], way[back:])
        ways = [(*way, state) for way in ways for state in kripke.successors(way[-1])]
