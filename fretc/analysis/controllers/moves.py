"""A machine state by state, with its moves, as in an automaton."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget
from fretc.analysis.controllers.machine import MealyMachine, NoMachineError
from fretish.classes.frozen import dataclass

MOST_STATES, MOST_MOVES = 1_000, 10_000
"""Maximum size of an automaton that is written."""
Term = Mapping[str, bool]
"""Truth values of some propositions."""


@dataclass(frozen=True, slots=True)
class MachineMove:
    """Next state and outputs of a machine for some inputs."""

    when: tuple[Term, ...]
    """Inputs: one of these terms holds."""
    outputs: Term
    """Values of all outputs."""
    after: int


@dataclass(frozen=True, slots=True)
class Mealy:
    """The machine of some requirements, state by state; the first state is initial."""

    requirements: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: tuple[tuple[MachineMove, ...], ...]


def mealy(machine: MealyMachine, requirements: Sequence[str], budget: Budget) -> Mealy:
    """Reachable states of a machine, with its moves.

    Args:
        machine: a machine of any size.
        requirements: ids of its requirements.
        budget: time limit.

    Raises:
        NoMachineError: it has too many states or moves.
        OutOfTimeError: it takes too long.
    """
    numbers: dict[tuple[bool, ...], int] = {tuple(False for _ in machine.steps): 0}
    states: list[tuple[MachineMove, ...]] = []
    size = 0
    while len(states) < len(numbers):
        budget.check()
        state = next(each for each, number in numbers.items() if number == len(states))
        moves = []
        for inputs, outputs, after in _moves(machine, state):
            number = numbers.setdefault(after, len(numbers))
            when = tuple(_terms(inputs, machine.inputs))
            moves.append(
                MachineMove(when, {machine.outputs[o]: v for o, v in outputs.items()}, number)
            )
            size += len(when)
        states.append(tuple(moves))
        if len(numbers) > MOST_STATES or size > MOST_MOVES:
            raise NoMachineError(
                f"its automaton has more than {MOST_STATES} states or {MOST_MOVES} moves"
            )
    return Mealy(
        tuple(requirements),
        tuple(machine.inputs.values()),
        tuple(machine.outputs.values()),
        tuple(states),
    )


def _moves(
    machine: MealyMachine, state: tuple[bool, ...]
) -> Iterator[tuple[Function, Mapping[int, bool], tuple[bool, ...]]]:
    """Sets of inputs with the same outputs and the same next state."""
    known = bdd.point(dict(zip(machine.steps, state, strict=True)))
    replies = {output: bdd.at(reply, known) for output, reply in machine.replies.items()}
    for inputs, outputs in _split(bdd.at(machine.legal, known), replies):
        there = known & bdd.point(outputs)
        steps = {bit: bdd.at(step, there) for bit, step in machine.steps.items()}
        for some, after in _split(inputs, steps):
            yield some, outputs, tuple(after.values())


def _split(
    inputs: Function, functions: Mapping[int, Function]
) -> list[tuple[Function, dict[int, bool]]]:
    """Inputs split by the values of functions."""
    pieces: list[tuple[Function, dict[int, bool]]] = [(inputs, {})]
    for number, function in functions.items():
        pieces = [
            (part, {**values, number: value})
            for some, values in pieces
            for value, part in ((False, some - function), (True, some & function))
            if part != bdd.false()
        ]
    return pieces


def _terms(inputs: Function, names: Mapping[int, str]) -> Iterator[Term]:
    """Terms whose disjunction is the set of inputs."""
    while inputs != bdd.false():
        term = bdd.witness(inputs)
        inputs = inputs - bdd.point(term)
        yield {names[number]: value for number, value in term.items()}
