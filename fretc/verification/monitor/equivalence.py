"""Proof that a monitor has the meaning of its sentence, or a shortest counterexample.

The monitor and the reference automaton of the sentence (`compiler.formalization.reference`) run in
lock step over all valuations until no new pair of states appears. Both are finite, so the result is
exact: for traces of any length and the original bound. Source: Hopcroft, Karp, A linear algorithm
for testing equivalence of finite automata, Cornell TR 71-114 (1971).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

from compiler.formalization.letters import (
    MOST_ATOMS,
    Valuation,
    letters_by_valuation,
    temporal_predicate,
)
from compiler.formalization.reference import (
    Automaton,
    Letter,
    TooManyStatesError,
    accepts,
    explore,
    template,
)
from compiler.logic.orders import Exclusion, only_possible
from fretish import syntax as s
from fretish.classes.frozen import dataclass

V = TypeVar("V")
Judgement = tuple[str, bool]
"""Verdict (`violated`, `satisfied` or `pending`, for infinite traces), and FRET's finite verdict if
the trace ends here."""


class Machine(Protocol):
    """A monitor whose state can be saved, restored and stepped."""

    def save(self) -> Hashable:
        """Everything on which further steps depend, and nothing else."""

    def load(self, state: Hashable) -> None:
        """Restore a saved state."""

    def step(self, letter: Valuation) -> Judgement:
        """The judgement after one more tick."""


@dataclass(frozen=True, slots=True)
class Equivalence:
    """Both give the same judgement at every tick of every trace, up to the first violation."""

    states: int
    """Number of compared pairs of an automaton state and a monitor state."""
    steps: int
    """Number of compared monitor steps."""


@dataclass(frozen=True, slots=True)
class DifferingTrace:
    """A trace at whose last tick the judgements differ."""

    word: tuple[Valuation, ...]
    expected: Judgement
    actual: Judgement
    shortest: bool = True
    """Whether no shorter trace shows the difference; False if there were too many pairs."""
    note: str = ""
    """Note about the numbers of the trace."""


def compare(
    machine: Machine,
    sentence: s.Sentence,
    ticks: int,
    atoms: Sequence[str],
    limit: int = 10**6,
    excluded: Sequence[Exclusion] = (),
) -> Equivalence | DifferingTrace | str:
    """Compare a monitor with the reference automaton of its sentence; or why that is impossible.

    After a violation nothing is compared, because a monitor's verdict is then final.

    Args:
        machine: the monitor before its first tick; its state afterwards is arbitrary.
        sentence: a checked sentence.
        ticks: duration of the sentence in ticks; ignored if it has none.
        atoms: order of the values in a valuation, by their names in formulas; at least every atom
            of the sentence.
        limit: maximum number of automaton states, and of pairs of states.
        excluded: combinations of atoms that cannot occur; the verdicts are those of free atoms, but
            no trace contains such a valuation.

    Raises:
        KeyError: an atom of the sentence is not among `atoms`.
    """
    predicate = temporal_predicate(sentence)
    if predicate is not None:
        return f"`{predicate}` refers to other ticks, and the automaton reads one tick at a time"
    if len(atoms) > MOST_ATOMS:
        return f"{len(atoms)} propositions, more than {MOST_ATOMS}"
    letters = letters_by_valuation(sentence, atoms)
    try:
        automaton = explore(template(sentence, ticks), letters.values(), limit)
    except TooManyStatesError:
        return f"the automaton has more than {limit} states"
    possible = {each: letters[each] for each in only_possible(tuple(letters), atoms, excluded)}
    return _compared(machine, _Reference.of(automaton, possible), limit)


# Lock step ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Reference:
    """The automaton over valuations of the atoms."""

    valuations: tuple[Valuation, ...]
    """Possible valuations."""
    moves: tuple[tuple[int, ...], ...]
    """Next state for each state and each letter of the automaton."""
    letters: tuple[int, ...]
    """Letter of the automaton for each valuation."""
    judgements: tuple[Judgement, ...]
    """Judgement of each state; the last one, at index `BROKEN`, is that of a violation."""

    @classmethod
    def of(cls, automaton: Automaton, letters: Mapping[Valuation, Letter]) -> _Reference:
        numbers = {letter: number for number, letter in enumerate(automaton.letters)}
        broken: Judgement = ("violated", False)
        judgements = (
            (verdict, accepts(automaton.template, state))
            for state, verdict in zip(automaton.states, automaton.verdicts, strict=True)
        )
        return cls(
            tuple(letters),
            automaton.moves,
            tuple(numbers[letter] for letter in letters.values()),
            (*judgements, broken),
        )


def _compared(
    machine: Machine, reference: _Reference, limit: int
) -> Equivalence | DifferingTrace | str:
    """Whether both are equal, by classes of states; if not, a shortest word, by all pairs."""
    start = machine.save()
    result = _in_lock_step(machine, reference, Classes(), limit)
    if not isinstance(result, DifferingTrace):
        return result
    machine.load(start)
    shortest = _in_lock_step(machine, reference, Pairs(), limit)
    return shortest if isinstance(shortest, DifferingTrace) else replace(result, shortest=False)


class Visited(Protocol):
    """The pairs of states that need not be examined again."""

    def add(self, left: Hashable, right: Hashable) -> bool:
        """Whether the pair is new; adds it."""


class Pairs:
    """Visited pairs, each by itself."""

    def __init__(self) -> None:
        """No pair is known."""
        self._pairs: set[tuple[Hashable, Hashable]] = set()

    def add(self, left: Hashable, right: Hashable) -> bool:
        """Whether the pair is new; adds it."""
        before = len(self._pairs)
        self._pairs.add((left, right))
        return len(self._pairs) > before


class Classes:
    """Sets of states that must be equal if all pairs are, so that implied pairs are not examined.

    The number of new pairs is at most the number of states of both sides, while the reachable pairs
    may be as many as their product. Two states of one class give the same values on every trace if
    no pair that formed the class leads to a difference.
    """

    def __init__(self) -> None:
        """Each state in a class of its own."""
        self._parents: list[int] = []
        self._sides: tuple[dict[Hashable, int], dict[Hashable, int]] = ({}, {})

    def add(self, left: Hashable, right: Hashable) -> bool:
        """Whether the pair is new; adds it."""
        roots = [
            self._root(self._number(side, state))
            for side, state in zip(self._sides, (left, right), strict=True)
        ]
        self._parents[roots[0]] = roots[1]
        return roots[0] != roots[1]

    def _number(self, side: dict[Hashable, int], state: Hashable) -> int:
        number = side.setdefault(state, len(self._parents))
        if number == len(self._parents):
            self._parents.append(number)
        return number

    def _root(self, number: int) -> int:
        parents = self._parents
        while parents[number] != number:
            parents[number] = parents[parents[number]]
            number = parents[number]
        return number


def _in_lock_step(
    machine: Machine, reference: _Reference, visited: Visited, limit: int
) -> Equivalence | DifferingTrace | str:
    """Breadth-first search through new pairs, from the present state of the machine."""
    start = (0, machine.save())
    visited.add(*start)
    pairs = [start]
    origins: list[tuple[int, Valuation] | None] = [None]
    steps = 0
    for index, (state, saved) in enumerate(pairs):  # The list grows during the loop.
        row = reference.moves[state]
        for valuation, letter in zip(reference.valuations, reference.letters, strict=True):
            machine.load(saved)
            judgement = machine.step(valuation)
            steps += 1
            after = row[letter]
            expected = reference.judgements[after]
            if judgement != expected:
                return DifferingTrace((*word(origins, index), valuation), expected, judgement)
            if expected[0] == "violated":
                continue
            reached = machine.save()
            if visited.add(after, reached):
                pairs.append((after, reached))
                origins.append((index, valuation))
        if len(pairs) > limit:
            return f"the automaton and the monitor have more than {limit} states"
    return Equivalence(len(pairs), steps)


def word(origins: Sequence[tuple[int, V] | None], index: int) -> tuple[V, ...]:
    """The valuations that led to a pair, from the first tick on.

    Args:
        origins: the place of the pair before each pair, and the valuation after it.
        index: the place of a pair.
    """
    valuations: list[V] = []
    origin = origins[index]
    while origin is not None:
        index, valuation = origin
        valuations.append(valuation)
        origin = origins[index]
    return tuple(reversed(valuations))
