"""Strategies that are written: no run of them breaks a requirement, as Spot and monitors say."""

import random
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import pytest
import spot

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.logic.formula import atoms
from fretc.analysis.arena.budget import Budget
from fretc.analysis.controllers import moves
from fretc.analysis.controllers.circuit import circuit
from fretc.analysis.controllers.files import ControllerFormat, automata, controller
from fretc.analysis.controllers.machine import MealyMachine, NoMachineError, machine
from fretc.analysis.controllers.moves import mealy
from fretc.analysis.realizability_problem import RealizabilityProblem
from monitors.kernel.verdicts import VIOLATED
from tests.effort import FULL
from tests.fretc.analysis.games.strategies import first_breaches
from tests.monitoring import monitor
from tests.requirement_sets import assumed, drawn, requirement, staged

ENDLESS = Budget(float("inf"))
WAITS = (
    "whenever a the sw shall eventually satisfy x",
    "whenever b the sw shall eventually satisfy y",
    "the sw shall always satisfy !(x & y)",
)


def made(setting: RealizabilityProblem) -> MealyMachine | None:
    """The machine of a set that can be kept."""
    game = setting.game(setting.arena.counters, ENDLESS)
    solution = game.solution()
    return machine(game, solution, ENDLESS) if solution.is_realizable else None


def program(found: MealyMachine, setting: RealizabilityProblem) -> Any:
    """The class that is written."""
    ids = [requirement.id for requirement in setting.requirements]
    text = controller([circuit(found, ids, 1)], dict.fromkeys(ids, ""), {}).text
    space: dict[str, Any] = {"__name__": "controller"}
    exec(compile(text, "controller.py", "exec"), space)  # it is ours
    return space["Controller"]


def hoa(found: MealyMachine) -> str:
    return automata([mealy(found, ["R1"], ENDLESS)], ControllerFormat.HOA)[0].text


def runs_that(automaton: Any, formula: str) -> bool:
    """Whether some run of the automaton satisfies a formula."""
    return not spot.product(
        automaton, spot.translate(formula, dict=automaton.get_dict())
    ).is_empty()


def formula(requirements: Sequence[FormalizedRequirement]) -> str:
    return (
        " & ".join(f"({printing.future(requirement.ft_infinite)})" for requirement in requirements)
        or "1"
    )


def machines(
    count: int, *, given: bool
) -> Iterator[tuple[RealizabilityProblem, list[FormalizedRequirement], MealyMachine]]:
    for seed in range(count):
        promises = [assumed(("controller", seed, i)) for i in range(2)] if given else []
        setting = staged(*drawn(("controller", seed), most=4), assumed=promises)
        assumptions = [requirement(f"A{i}", sentence) for i, sentence in enumerate(promises, 1)]
        if given and not setting.runs((), ENDLESS).is_possible():
            continue
        found = made(setting)
        if found is not None:
            yield setting, assumptions, found


@pytest.mark.slow
@pytest.mark.parametrize("given", [False, True])
def test_no_run_of_an_automaton_breaks_a_requirement(given: bool) -> None:
    shown = 0
    count = 120 if FULL else 20
    for setting, assumptions, found in machines(count, given=given):
        automaton = spot.automaton(hoa(found))
        wrong = f"({formula(assumptions)}) & !({formula(setting.requirements)})"
        assert not runs_that(automaton, wrong), [
            each.entry.wording for each in setting.requirements
        ]
        assert runs_that(automaton, "1")
        shown += 1
    assert shown > count / 4


def test_the_program_does_as_the_automaton_and_breaks_nothing() -> None:
    for number, (setting, _, found) in enumerate(machines(60 if FULL else 12, given=False)):
        choose = random.Random(number)
        states, state = mealy(found, ["R1"], ENDLESS).states, 0
        step = program(found, setting)().step
        letters = []
        for _ in range(30):
            inputs = {name: choose.random() < 0.5 for name in found.inputs.values()}
            outputs = step(inputs)
            (move,) = [
                move
                for move in states[state]
                if any(term.items() <= inputs.items() for term in move.when)
            ]
            assert outputs == dict(sorted(move.outputs.items()))
            state = move.after
            letters.append({**inputs, **outputs})
        assert_kept(setting, letters)


def assert_kept(setting: RealizabilityProblem, letters: Sequence[dict[str, bool]]) -> None:
    names = {
        name
        for requirement in setting.requirements
        for s in requirement.watch.signals
        for name in atoms(s)
    }
    known = {
        name: sum(letter[name] << tick for tick, letter in enumerate(letters)) for name in names
    }
    breaches = first_breaches(setting.requirements, known, len(letters))
    assert not [id for id, tick in breaches.items() if tick is not None]


PATTERNS: Sequence[Callable[[int], bool]] = (
    lambda tick: True,
    lambda tick: tick % 2 == 0,
    lambda tick: tick % 7 < 3,
    lambda tick: tick == 11,
)
"""Of an input: what is likely to find a gap."""


@pytest.mark.slow
def test_generated_monitors_find_nothing_whatever_comes() -> None:
    for number, (setting, _, found) in enumerate(machines(25 if FULL else 12, given=False)):
        sentences = [requirement.entry.wording.text for requirement in setting.requirements]
        watching = monitor(*sentences)
        choose = random.Random(number)
        patterns = {name: choose.choice(PATTERNS) for name in found.inputs.values()}
        made = program(found, setting)()
        for tick in range(40):
            inputs = {name: pattern(tick) for name, pattern in patterns.items()}
            values = {**inputs, **made.step(inputs)}
            watching.advance([[values.get(name, False) for name in watching.PROPOSITIONS]])
        assert VIOLATED not in watching.verdicts(), sentences


def test_two_goals_take_turns() -> None:
    setting = staged(*WAITS)
    found = made(setting)
    assert found is not None
    automaton = spot.automaton(hoa(found))
    assert not runs_that(automaton, f"!({formula(setting.requirements)})")
    step = program(found, setting)().step
    outputs = [step({"a": True, "b": True}) for _ in range(6)]
    assert {"x": True, "y": False} in outputs
    assert {"x": False, "y": True} in outputs


@pytest.mark.slow
def test_long_bounds_need_no_states() -> None:
    bound = 100_000 if FULL else 20_000
    setting = staged(
        f"upon a the sw shall for {bound} ticks satisfy x",
        "whenever b the sw shall immediately satisfy y",
    )
    found = made(setting)
    assert found is not None
    step = program(found, setting)().step
    assert step({"a": True, "b": False}) == {"x": True, "y": False}
    for _ in range(bound):
        assert step({"a": False, "b": False})["x"]
    assert step({"a": False, "b": False}) == {"x": False, "y": False}
    with pytest.raises(NoMachineError, match=f"more than {moves.MOST_STATES} states"):
        mealy(found, ["R1"], ENDLESS)


def test_an_input_that_is_unknown_is_an_error() -> None:
    setting = staged(*WAITS)
    found = made(setting)
    assert found is not None
    with pytest.raises(ValueError, match="the input a is to be true or false at each tick"):
        program(found, setting)().step({"b": True})
