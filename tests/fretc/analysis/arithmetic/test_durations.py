"""Propositions that last for ticks in plays that leap over ticks."""

import random
from itertools import chain

import pytest

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.arena.budget import ENDLESS
from fretc.analysis.findings import Analysis
from fretc.analysis.games import game_traces, squaring
from fretc.analysis.games.replay import remembering
from fretc.analysis.realizability_problem import stage
from fretish.bindings.declarations import Role
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from tests.fretc.analysis.arithmetic.test_steps import TICK, declared

ROLES = {"p0": Role.INPUT, "p1": Role.INPUT, "p2": Role.OUTPUT}


def made(ticks: int, within: int) -> list[FormalizedRequirement]:
    """`p0` lasts so many ticks, and fights with a deadline."""
    declarations = declared(
        [f'expr = "x > 3 for {ticks * TICK} ns"', 'expr = "x > 5"', 'expr = "y > 1"']
    )
    sentences = (
        f"whenever p1 the sw shall within {within} ticks satisfy p2",
        "whenever p0 the sw shall always satisfy !p2",
        f"whenever p1 the sw shall for {within // 2} ticks satisfy !p2",
    )
    requirements = []
    for number, sentence in enumerate(sentences, 1):
        entry = RequirementEntry(f"R{number}", Source("r.fret", sentence).span())
        requirement, remarks = formalize(entry, declarations)
        assert requirement is not None, remarks
        requirements.append(requirement)
    return requirements


def found(requirements: list[FormalizedRequirement]) -> Analysis:
    return analyze(requirements, ROLES, (), AnalysisOptions(repairs=False))


@pytest.mark.slow
@pytest.mark.parametrize(("ticks", "within"), [(3, 6), (6, 3)])
def test_leaps_leave_what_lasts_as_it_is(
    ticks: int, within: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`p0` is certain when it has lasted since the first tick; a deadline from there is lost."""
    requirements = made(ticks, within)
    slow = found(requirements)
    monkeypatch.setattr(squaring.IterativeSquaring, "is_due", lambda self: True)
    monkeypatch.setattr(game_traces, "_LONG", 0)
    fast = found(requirements)
    for answer in (slow, fast):
        assert [each.requirements for each in answer.conflicts] == [("R1", "R2"), ("R1", "R3")]
        lengths = [len(each.play) for each in answer.conflicts]
        assert lengths == [ticks + within + 1, within + 1]
    assert slow.verdict is fast.verdict


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_what_is_remembered_of_a_letter_that_stays_is_that_of_each_tick(seed: int) -> None:
    choose = random.Random(seed)
    alphabet = stage(made(choose.randint(1, 5), 4), (), ROLES, budget=ENDLESS).arena.alphabet
    assert alphabet.memory() is not None
    bits = [*alphabet.inputs, *alphabet.outputs]
    runs = [({bit: choose.random() < 0.7 for bit in bits}, choose.randint(1, 9)) for _ in range(5)]
    single = [(letter, 1) for letter, count in runs for _ in range(count)]
    known = chain.from_iterable([letter] * count for letter, count in remembering(alphabet, runs))
    assert [*known] == [letter for letter, _ in remembering(alphabet, single)]
