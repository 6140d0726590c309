"""The model of agents against MCAPL's reasoning cycle written down a second time.

Each agent of a family is asked in both ways of perceiving, with every order of percepts. What the
model calls kept is kept in each of them; what it refutes is broken in one of them.
"""

from collections.abc import Callable

import pytest

from compiler.agents import gwendolen
from compiler.agents.gwendolen import Agent
from compiler.agents.model import Model
from compiler.agents.psl import read
from compiler.logic.kripke import check, explore
from compiler.targets.ajpf import bundle
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from tests.compiler.targets.ajpf.test_bundle import requirement
from tests.effort import some
from tests.reasoning import Machine, answers

TRIGGERS: dict[str, Callable[[frozenset[str]], bool]] = {
    "a": lambda b: "a" in b,
    "a & b": lambda b: {"a", "b"} <= b,
    "a & !b": lambda b: "a" in b and "b" not in b,
    "b & !a": lambda b: "b" in b and "a" not in b,
    "a | b": lambda b: bool({"a", "b"} & b),
    "a & b & c": lambda b: {"a", "b", "c"} <= b,
    "a & b & !c": lambda b: {"a", "b"} <= b and "c" not in b,
    "a & !b & !c": lambda b: "a" in b and not {"b", "c"} & b,
    "(a & !b) | c": lambda b: "c" in b or ("a" in b and "b" not in b),
}
KEPT = {
    # The real AJPF says so of the first five, and of the third without percept guards.
    ("a", True): True,
    ("a & b", True): True,
    ("a & !b", True): False,
    ("b & !a", True): False,
    ("a | b", True): True,
    ("a & !b", False): True,
    ("b & !a", False): True,
    ("a & b", False): True,
    ("a & b & c", True): True,
    ("a & b & !c", True): False,
    ("a & !b & !c", True): False,
    ("(a & !b) | c", True): False,
}


def parts(
    condition: str, word: str, guarded: bool, mutant: bool
) -> tuple[tuple[str, ...], Agent, str]:
    made = requirement(f"{word} {condition} the ag shall eventually satisfy r")
    known = bundle.forms(made)
    assert not isinstance(known, Diagnostic)
    found = known[0 if guarded else -1]
    files = bundle.texts(made, found)
    text = files["SIF_mutant.gwen" if mutant else "SIF.gwen"]
    agent = gwendolen.read(Source("SIF.gwen", text))
    assert not isinstance(agent, Diagnostic)
    return found.percepts, agent, files["SIF.psl"]


def modelled(percepts: tuple[str, ...], agent: Agent, properties: str, in_turn: bool) -> bool:
    """What the model says of the runs in which the agent perceives in one of the two ways."""
    diagnostic = read(Source("SIF.psl", properties))
    assert not isinstance(diagnostic, Diagnostic)
    model = Model(agent, percepts)
    explored = explore(
        model.initial,
        lambda state: (after for _, after in model.steps(state) if after.in_turn is in_turn),
        model.label,
        200_000,
    )
    return check(explored.kripke, diagnostic[0].formula) is None


CASES = [
    (condition, guarded, word)
    for condition, guarded in KEPT
    for word in ("whenever", "upon", "when")
    # `when` is `upon` under another name: with three percepts, one of them is enough.
    if word != "when" or "c" not in condition
]
TWO = [case for case in CASES if "c" not in case[0]]
THREE = [case for case in CASES if "c" in case[0]]


@pytest.mark.slow
@pytest.mark.parametrize(("condition", "guarded", "word"), [*TWO, *some(THREE, 8, 2)])
def test_the_model_and_the_cycle_written_twice_agree(
    condition: str, guarded: bool, word: str
) -> None:
    percepts, agent, properties = parts(condition, word, guarded, False)
    kept = [
        answers(
            Machine(agent, percepts, in_turn), TRIGGERS[condition], "r", word != "whenever",
            400_000,
        )
        for in_turn in (False, True)
    ]  # fmt: skip
    assert [modelled(percepts, agent, properties, way) for way in (False, True)] == kept
    assert all(kept) is KEPT[condition, guarded]


@pytest.mark.parametrize("condition", ["a", "a & b", "a & !b", "a | b"])
@pytest.mark.parametrize("guarded", [True, False])
def test_the_mutant_is_refuted_in_both(condition: str, guarded: bool) -> None:
    percepts, agent, properties = parts(condition, "whenever", guarded, True)
    for in_turn in (False, True):
        assert not modelled(percepts, agent, properties, in_turn)
        machine = Machine(agent, percepts, in_turn)
        assert not answers(machine, TRIGGERS[condition], "r", False, 100_000)


def test_one_order_of_percepts_is_enough_to_break_a_guard() -> None:
    """Names in alphabetical order, as in MCAPL; the real AJPF gives these three verdicts."""
    for condition, kept in (("a & !b", False), ("b & !a", False), ("a & b", True)):
        percepts, agent, _ = parts(condition, "whenever", True, False)
        machine = Machine(agent, percepts, False, lambda names: [tuple(names)])
        assert answers(machine, TRIGGERS[condition], "r", False, 100_000) is kept
