"""Whether two monitors have the same signals on every trace, also with unknown values.

A monitor consists of two runs of the same code, its approximations: an unknown counts as false in
one and as true in the other. Each approximation of one monitor runs in lock step with that of the
other over all valuations, including unknown values, until no new pair of states appears. At each
step all signals and all marks are compared.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import product
from typing import Any, Protocol

from compiler.logic.orders import Exclusion, only_possible
from compiler.program.program import MARKS, SIGNALS
from fretc.verification.monitor.equivalence import Classes, Pairs, Visited, word
from fretc.verification.monitor.machine import ApproximationState
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Truth

MOST_PROPOSITIONS = 7
"""Maximum number of propositions; each has three values: 2 187 steps for each pair of states."""

Letter = tuple[Truth, ...]
"""The values of the propositions at one tick, in a given order; None: unknown."""


@dataclass(frozen=True, slots=True)
class Equivalent:
    """The monitors agree on every trace."""

    states: int
    """Number of compared pairs of states of both approximations."""


@dataclass(frozen=True, slots=True)
class Distinguished:
    """A trace of one approximation at whose last tick the monitors differ.

    A shortest one, unless there are too many pairs of states.
    """

    word: tuple[Letter, ...]
    signal: str
    """Name of the differing signal or mark."""


def compared(
    machine: Monitor,
    index: int,
    reference: Monitor,
    atoms: Sequence[str],
    limit: int,
    excluded: Sequence[Exclusion] = (),
) -> Equivalent | Distinguished | None:
    """Compare a requirement of one monitor with the only one of the other.

    Args:
        machine: monitor in the layout that fretc writes.
        index: index of the requirement in the machine.
        reference: monitor of one requirement.
        atoms: order of the values in a valuation; the other propositions of the machine are false,
            and the requirement must not depend on them.
        limit: maximum number of pairs of states; with more the result is None.
        excluded: combinations of atoms that cannot occur.
    """
    every = tuple(product((False, True, None), repeat=len(atoms)))
    letters = only_possible(every, atoms, excluded)
    states = 0
    for is_possible in (False, True):
        left = _Approximation(machine, index, is_possible, atoms)
        right = _Approximation(reference, 0, is_possible, atoms)
        result = in_lock_step(left, right, letters, limit, _NAMES)
        if not isinstance(result, Equivalent):
            return result
        states += result.states
    return Equivalent(states)


_STARTS = (
    {"broken": -1, "violation_inevitable": -1, "last": -1, "open": -1},
    {"last": 1, "open": 2},
)
"""Values of marks before a step: none, and earlier ticks."""
_TICK = 5


class _Approximation:
    """An approximation that can be put into any state, always at the same tick."""

    def __init__(
        self, monitor: Monitor, index: int, is_possible: bool, atoms: Sequence[str]
    ) -> None:
        self._approximation: Any = monitor.APPROXIMATION(is_possible=is_possible)
        self._place = index
        self._cells = ApproximationState(self._approximation)
        self._order = tuple(
            atoms.index(name) if name in atoms else None for name in monitor.PROPOSITIONS
        )
        prefixes = tuple(
            n.removesuffix("_open") for n in self._approximation.__slots__ if _is_open(n)
        )
        self._marks = tuple((mark, f"{prefix}_{mark}") for prefix in prefixes for mark in MARKS)

    def save(self) -> Hashable:
        """Its cells."""
        return self._cells.save()

    def step(self, state: Hashable, letter: Letter) -> tuple[object, ...]:
        """Signals after one tick, and the marks from each of `_STARTS`."""
        row = tuple([False if i is None else letter[i] for i in self._order])
        marks: list[object] = []
        for start in _STARTS:
            self._cells.load(state)
            self._approximation.tick = _TICK
            for mark, name in self._marks:
                setattr(self._approximation, name, start.get(mark, -1))
            self._approximation.advance((row,))
            marks += self._approximation.marks()[self._place]
        return (*map(bool, self._approximation.signals()[self._place]), *marks)


def _is_open(name: str) -> bool:
    return name.endswith("_open")


_NAMES = (*SIGNALS, *(f"mark `{mark}`" for _ in _STARTS for mark in MARKS))


class Stepping(Protocol):
    """A machine that can be put into any earlier state, and stepped from there."""

    def save(self) -> Hashable:
        """Everything on which further steps depend, and nothing else."""

    def step(self, state: Any, letter: Any) -> tuple[object, ...]:
        """The values after a tick from the state."""


def in_lock_step(
    left: Stepping,
    right: Stepping,
    letters: Sequence[Any],
    limit: int,
    names: Sequence[str],
) -> Equivalent | Distinguished | None:
    """Whether both give the same values on every trace, from the present states; if not, where.

    By classes of states that must be equal if all pairs are (`equivalence.Classes`); in case of a
    difference, by all pairs for a shortest trace.

    Args:
        left: first machine.
        right: second machine.
        letters: all valuations of a tick.
        limit: maximum number of pairs; with more the result is None.
        names: names of the values of a step.
    """
    start = left.save(), right.save()
    result = _from(start, left, right, letters, limit, names, Classes())
    if not isinstance(result, Distinguished):
        return result
    shortest = _from(start, left, right, letters, limit, names, Pairs())
    return shortest if isinstance(shortest, Distinguished) else result


def _from(
    start: tuple[Any, Any],
    left: Stepping,
    right: Stepping,
    letters: Sequence[Any],
    limit: int,
    names: Sequence[str],
    visited: Visited,
) -> Equivalent | Distinguished | None:
    """Breadth-first search through new pairs, from the first one."""
    pairs = [start]
    origins: list[tuple[int, Any] | None] = [None]
    visited.add(*start)
    for index, (first, second) in enumerate(pairs):  # The list grows during the loop.
        for letter in letters:
            actual, expected = left.step(first, letter), right.step(second, letter)
            if actual != expected:
                signal = next(n for n, a, b in zip(names, actual, expected, strict=True) if a != b)
                return Distinguished((*word(origins, index), letter), signal)
            reached = left.save(), right.save()
            if visited.add(*reached):
                pairs.append(reached)
                origins.append((index, letter))
        if len(pairs) > limit:
            return None
    return Equivalent(len(pairs))
