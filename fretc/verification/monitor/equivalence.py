"""A proof that a monitor means what its sentence means, or a shortest trace that it misjudges.

The monitor and the reference automaton of the sentence (`compiler.formalization.reference`) run in
lock step over all letters until no new pair of states appears. Both are finite, so this is exact:
for traces of any length and at the bound as it is. Source: Hopcroft, Karp, A linear algorithm for
testing equivalence of finite automata, Cornell TR 71-114 (1971).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from compiler.formalization.letters import (
    MOST_ATOMS,
    Valuation,
    meanings,
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

Judgement = tuple[str, bool]
"""A verdict (`violated`, `satisfied` or `pending`, as of infinite traces), and whether the trace
satisfies the sentence, as FRET judges finite traces, if it ends here."""


class Machine(Protocol):
    """A monitor whose state can be saved, restored and stepped."""

    def save(self) -> Hashable:
        """Everything that its further steps depend on, and nothing else."""

    def load(self, state: Hashable) -> None:
        """Go back to a state that was saved."""

    def step(self, letter: Valuation) -> Judgement:
        """The judgement after one more tick."""


@dataclass(frozen=True, slots=True)
class Equivalence:
    """Both judge every tick of every trace alike, up to the first violation."""

    states: int
    """Compared pairs of a state of the automaton and one of the monitor."""
    steps: int
    """Steps of the monitor that were compared."""


@dataclass(frozen=True, slots=True)
class Difference:
    """A trace at whose last tick they differ."""

    word: tuple[Valuation, ...]
    expected: Judgement
    actual: Judgement
    shortest: bool = True
    """Whether no shorter trace shows the difference; False where there were too many pairs."""
    note: str = ""
    """What is to be known of the numbers that make it."""


def compare(
    machine: Machine,
    sentence: s.Sentence,
    ticks: int,
    atoms: Sequence[str],
    limit: int = 10**6,
    excluded: Sequence[Exclusion] = (),
) -> Equivalence | Difference | str:
    """Compare a monitor with the reference automaton of its sentence; or why they cannot be.

    After a violation nothing is compared: a monitor's verdict is then final.

    Args:
        machine: the monitor, before its first tick; its state afterwards is arbitrary.
        sentence: a checked sentence.
        ticks: what its duration counts; without meaning where it has none.
        atoms: the order of the values in a letter, by the names that formulas have for them;
            at least every atom of the sentence.
        limit: the most states of the automaton, and the most pairs of states.
        excluded: what the atoms cannot be together; the verdicts are those of free atoms, but no
            trace comes by such a valuation.

    Raises:
        KeyError: an atom of the sentence is not among `atoms`.
    """
    predicate = temporal_predicate(sentence)
    if predicate is not None:
        return f"`{predicate}` refers to other ticks, and the automaton reads one tick at a time"
    if len(atoms) > MOST_ATOMS:
        return f"{len(atoms)} propositions, more than {MOST_ATOMS}"
    letters = meanings(sentence, atoms)
    try:
        automaton = explore(template(sentence, ticks), letters.values(), limit)
    except TooManyStatesError:
        return f"the automaton has more than {limit} states"
    possible = {each: letters[each] for each in only_possible(tuple(letters), atoms, excluded)}
    return _compared(machine, _Reference.of(automaton, possible), limit)


# Lock step ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Reference:
    """The automaton, read by valuations of the atoms."""

    valuations: tuple[Valuation, ...]
    """Those that can occur."""
    moves: tuple[tuple[int, ...], ...]
    """For each state and each letter of the automaton: the next state."""
    letters: tuple[int, ...]
    """For each valuation: the letter of the automaton."""
    judgements: tuple[Judgement, ...]
    """For each state, and at the end, so with the index `BROKEN`, for a broken demand."""

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
) -> Equivalence | Difference | str:
    """Whether they are equal, by classes of states; if not, a shortest word, by all pairs."""
    start = machine.save()
    result = _in_lock_step(machine, reference, Classes(), limit)
    if not isinstance(result, Difference):
        return result
    machine.load(start)
    shortest = _in_lock_step(machine, reference, Pairs(), limit)
    return shortest if isinstance(shortest, Difference) else replace(result, shortest=False)


class Visited(Protocol):
    """The pairs of states that need not be looked at again."""

    def add(self, left: Hashable, right: Hashable) -> bool:
        """Whether the pair is new; it is known from now on."""


class Pairs:
    """Every pair for itself."""

    def __init__(self) -> None:
        """No pair is known."""
        self._pairs: set[tuple[Hashable, Hashable]] = set()

    def add(self, left: Hashable, right: Hashable) -> bool:
        """Whether the pair is new; it is known from now on."""
        before = len(self._pairs)
        self._pairs.add((left, right))
        return len(self._pairs) > before


class Classes:
    """Sets of states that must be equal if all pairs are: a pair that follows from others is known.

    There are no more new pairs than states on both sides together, where the pairs that can be
    reached may be as many as their product. Two states of one class give the same values on every
    trace if each pair that made the class has no difference behind it.
    """

    def __init__(self) -> None:
        """Each state is alone."""
        self._parents: list[int] = []
        self._sides: tuple[dict[Hashable, int], dict[Hashable, int]] = ({}, {})

    def add(self, left: Hashable, right: Hashable) -> bool:
        """Whether the pair is new; it is known from now on."""
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
) -> Equivalence | Difference | str:
    """Breadth first through the pairs that are new, from the present state of the machine."""
    start = (0, machine.save())
    visited.add(*start)
    pairs = [start]
    origins: list[tuple[int, Valuation] | None] = [None]
    steps = 0
    for place, (state, saved) in enumerate(pairs):  # grows while it is read
        row = reference.moves[state]
        for valuation, letter in zip(reference.valuations, reference.letters, strict=True):
            machine.load(saved)
            judgement = machine.step(valuation)
            steps += 1
            after = row[letter]
            expected = reference.judgements[after]
            if judgement != expected:
                return Difference((*_word(origins, place), valuation), expected, judgement)
            if expected[0] == "violated":
                continue
            reached = machine.save()
            if visited.add(after, reached):
                pairs.append((after, reached))
                origins.append((place, valuation))
        if len(pairs) > limit:
            return f"the automaton and the monitor have more than {limit} states"
    return Equivalence(len(pairs), steps)


def _word(origins: Sequence[tuple[int, Valuation] | None], place: int) -> tuple[Valuation, ...]:
    """The letters that led to a pair, from the first tick on."""
    word: list[Valuation] = []
    origin = origins[place]
    while origin is not None:
        place, valuation = origin
        word.append(valuation)
        origin = origins[place]
    return tuple(reversed(word))
