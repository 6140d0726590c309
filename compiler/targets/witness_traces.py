"""Shortest runs to each verdict, from the reference automaton, for generated tests."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import (
    MOST_ATOMS,
    atoms_of,
    letters_by_valuation,
    temporal_predicate,
)
from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    TooManyStatesError,
    accepts,
    explore,
    template,
)
from fretish.classes.frozen import dataclass

_MOST_STATES = 2_000


@dataclass(frozen=True, slots=True)
class RepeatedTick:
    """Consecutive equal ticks, after each of which the verdicts are equal."""

    count: int
    values: dict[str, bool]
    verdict: str
    finite: bool


@dataclass(frozen=True, slots=True)
class WitnessTrace:
    """A run that ends with a verdict."""

    name: str
    ticks: tuple[RepeatedTick, ...]


def witness_traces(requirement: FormalizedRequirement) -> tuple[WitnessTrace, ...]:
    """The shortest run to each possible verdict, and to the state that takes longest to reach.

    Empty if the reference cannot express the sentence, or is too large.
    """
    atoms = atoms_of(requirement.sentence)
    if temporal_predicate(requirement.sentence) is not None or len(atoms) > MOST_ATOMS:
        return ()
    letter_of = letters_by_valuation(requirement.sentence, atoms)
    letters = {letter: values for values, letter in reversed([*letter_of.items()])}
    try:
        counted = explore(
            template(requirement.sentence, requirement.ticks or 0), letters, _MOST_STATES
        )
    except TooManyStatesError:
        return ()
    valuations = [letters[letter] for letter in counted.letters]
    return tuple(
        WitnessTrace(
            name, tuple(_ticks(counted, [(valuations[place], place) for place in run], atoms))
        )
        for name, run in _runs(counted)
    )


def _runs(counted: Automaton) -> Iterator[tuple[str, tuple[int, ...]]]:
    """For each verdict the indices of the letters of a shortest run, by breadth first search."""
    run_to: dict[int, tuple[int, ...]] = {0: ()}
    broken: tuple[int, ...] | None = None
    for state in range(len(counted.states)):  # in the order in which they were found
        for index, after in enumerate(counted.moves[state]):
            run = (*run_to[state], index)
            if after != BROKEN:
                run_to.setdefault(after, run)
            elif broken is None or len(run) < len(broken):
                broken = run
    yield from ([("soonest_violation", broken)] if broken else [])
    runs: dict[tuple[str, bool], tuple[int, ...]] = {}
    for state, run in run_to.items():
        if run:
            finite = accepts(counted.template, counted.states[state])
            runs.setdefault((counted.verdicts[state], finite), run)
    for (verdict, finite), run in runs.items():
        yield f"soonest_{verdict}{'' if finite else '_unmet'}", run
    latest = max(run_to.values(), key=len)
    if latest not in runs.values():
        yield "latest_state", latest


def _ticks(
    counted: Automaton, run: Sequence[tuple[tuple[bool, ...], int]], atoms: Sequence[str]
) -> Iterator[RepeatedTick]:
    """The run with the verdicts after each of its ticks."""
    state, ticks = 0, list[tuple[tuple[bool, ...], str, bool]]()
    for values, index in run:
        state = counted.moves[state][index]
        if state == BROKEN:
            ticks.append((values, "violated", False))
        else:
            finite = accepts(counted.template, counted.states[state])
            ticks.append((values, counted.verdicts[state], finite))
    for (values, verdict, finite), repeated in groupby(ticks):
        named = dict(zip(atoms, values, strict=True))
        yield RepeatedTick(len([*repeated]), named, verdict, finite)
