"""Kripke structures, and model checking of temporal formulas on them.

A state is a number, with the atoms that are true in it. A run begins in the initial state, follows
edges, and never ends: a state without edges is repeated for ever.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from itertools import pairwise
from typing import Generic, TypeVar

from compiler.logic import spot as automata
from compiler.logic.formula import Formula, Last, ProbabilityBound, children
from fretish.classes.frozen import dataclass

S = TypeVar("S", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Kripke:
    """A graph whose states are numbered from 0."""

    labels: tuple[frozenset[str], ...]
    """Shape (states,): the atoms that are true; every other one is false."""
    edges: tuple[tuple[int, ...], ...]
    """Shape (states,): the next states; if empty, the state itself."""
    initial: int = 0

    def __post_init__(self) -> None:
        assert len(self.labels) == len(self.edges)
        assert 0 <= self.initial < len(self.labels)

    def successors(self, state: int) -> tuple[int, ...]:
        """The next states; never empty."""
        return self.edges[state] or (state,)


@dataclass(frozen=True, slots=True)
class Lasso:
    """An endless run: the states of `prefix` once, then those of `cycle` for ever."""

    prefix: tuple[int, ...]
    cycle: tuple[int, ...]
    """The repeated states, at least one."""

    @property
    def states(self) -> tuple[int, ...]:
        """Each state of the run once, in order; the last one leads back to `len(prefix)`."""
        return self.prefix + self.cycle


class ModelTooLargeError(Exception):
    """The model has more states than was allowed."""

    def __init__(self, limit: int) -> None:
        super().__init__(f"more than {limit:,} states")
        self.limit = limit


@dataclass(frozen=True, slots=True)
class Explored(Generic[S]):
    """A Kripke structure with the states that its numbers stand for."""

    kripke: Kripke
    states: tuple[S, ...]
    """Shape (states,), nearest to the initial one first."""


def explore(
    initial: S,
    successors: Callable[[S], Iterable[S]],
    label: Callable[[S], frozenset[str]],
    limit: int,
) -> Explored[S]:
    """Every state that can be reached, breadth first.

    Args:
        initial: the only initial state.
        successors: the next states; none: the run stays in the state for ever.
        label: the atoms that are true in a state.
        limit: the maximum number of states.

    Raises:
        ModelTooLargeError: there are more states.
    """
    numbers = {initial: 0}
    states = [initial]
    edges: list[tuple[int, ...]] = []
    while len(edges) < len(states):
        following: dict[int, None] = {}
        for state in successors(states[len(edges)]):
            number = numbers.setdefault(state, len(states))
            if number == len(states):
                if number >= limit:
                    raise ModelTooLargeError(limit)
                states.append(state)
            following[number] = None
        edges.append(tuple(following))
    return Explored(Kripke(tuple(map(label, states)), tuple(edges)), tuple(states))


def check(kripke: Kripke, formula: Formula) -> Lasso | None:
    """A run that violates the formula; None if every run satisfies it.

    Args:
        kripke: the model.
        formula: future-time; an atom that no state has is false everywhere. Bounds are expanded, so
            they should be small.

    Raises:
        ValueError: the formula speaks of a last tick or of probabilities.
        ImportError: Spot is not installed.

    Source: Vardi, Wolper, An automata-theoretic approach to automatic program verification, LICS
    1986; Spot translates, builds the product and looks for the run.
    """
    if not _is_linear(formula):
        raise ValueError("only a formula about single endless runs can be checked")
    run = automata.violation(
        kripke.labels,
        [kripke.successors(state) for state in range(len(kripke.labels))],
        kripke.initial,
        formula,
    )
    if run is None:
        return None
    lasso = Lasso(*run)
    assert _is_run(kripke, lasso), "the counterexample is no run of the model"
    return lasso


def _is_linear(formula: Formula) -> bool:
    return not isinstance(formula, Last | ProbabilityBound) and all(
        map(_is_linear, children(formula))
    )


def _is_run(kripke: Kripke, lasso: Lasso) -> bool:
    states = (*lasso.states, lasso.cycle[0])
    steps = pairwise(states)
    return states[0] == kripke.initial and all(b in kripke.successors(a) for a, b in steps)
