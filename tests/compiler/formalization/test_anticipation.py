"""Verdicts come as early as they can: at the tick at which Spot's three-valued monitor tells."""

import random
from collections.abc import Iterator

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimResult
from tests.each import each
from tests.effort import FULL, pairwise, some
from tests.meaning import SCOPES
from tests.monitoring import emitted, monitor, requirement, steps
from tests.proofs import verified
from tests.spot_monitors import Ltl3
from tests.strategies import Template, few_templates

LENGTH = 12


def words(names: tuple[str, ...], count: int, seed: str) -> list[dict[str, list[bool]]]:
    """Random columns, each with odds of its own: rare and frequent events both matter."""
    choose = random.Random(seed)
    found = []
    for _ in range(count):
        odds = {name: choose.choice((0.1, 0.3, 0.5, 0.9)) for name in names}
        found.append(
            {name: [choose.random() < odds[name] for _ in range(LENGTH)] for name in names}
        )
    return found


def check(sentence: str, made: FormalizedRequirement, names: tuple[str, ...], count: int) -> None:
    machine, oracle = monitor(sentence), Ltl3(made.ft_infinite)
    for columns in words(names, count, sentence):
        letters = [
            dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)
        ]
        told = [step.decided for step in steps(machine, columns)]
        assert told == oracle.verdicts(letters), (sentence, columns)


@pytest.mark.slow
@each("template", few_templates())
def test_each_template_is_decided_at_the_earliest_tick(template: Template) -> None:
    check(template.sentence, requirement(template.sentence), template.columns, 12)


# Parts that share atoms -------------------------------------------------------------------------

SHARED = ("a", "b", "!a", "!b", "a & b", "a | b", "a & !b", "a xor b", "true", "false", "a & !a")
WHERE = {
    "null": "",
    "in": "while {},",
    "notin": "except while {},",
    "before": "before {},",
    "after": "after {},",
    "onlyIn": "only while {},",
    "onlyBefore": "only before {},",
    "onlyAfter": "only after {},",
}
WHEN = ("", "upon {},", "whenever {},")
UNCOUNTED = (
    "immediately",
    "at the next timepoint",
    "finally",
    "eventually",
    "always",
    "never",
    "until {}",
    "before {}",
)
COUNTED = ("within {n} ticks", "for {n} ticks", "after {n} ticks")


def sharing(scope: str, condition: str, timing: str, n: int, seed: str) -> str:
    """A sentence of that form about a and b: its expressions are drawn."""
    choose = random.Random(seed)

    def filled(text: str) -> str:
        return text.format(choose.choice(SHARED), n=n)

    parts = (WHERE[scope], condition, "the sw shall", timing, "satisfy {}")
    return " ".join(filled(part) for part in parts)


def counted() -> Iterator[tuple[str, int]]:
    yield from ((timing, 0) for timing in UNCOUNTED)
    yield from ((timing, n) for timing in COUNTED for n in (0, 1, 2))


@pytest.mark.slow
def test_parts_that_share_atoms_are_decided_at_the_earliest_tick() -> None:
    draws = range(2 if FULL else 1)
    cases = pairwise(SCOPES, WHEN, [*counted()], draws)
    for scope, condition, (timing, n), draw in some(cases, 3):
        sentence = sharing(scope, condition, timing, n, f"{scope} {condition} {timing} {n} {draw}")
        check(sentence, requirement(sentence), ("a", "b"), 6)


@pytest.mark.slow
def test_long_durations_over_shared_atoms_are_decided_at_the_earliest_tick() -> None:
    """Above the length to which durations are shortened, at their own length."""
    for scope, condition, timing, n in some(pairwise(SCOPES, WHEN, COUNTED, (7, 9, 25)), 2):
        if n == 25 and scope.startswith("only") and timing.startswith("after"):
            continue  # what it demands of each trigger is another: 2^25 states
        sentence = sharing(scope, condition, timing, n, f"{scope} {condition} {timing}")
        found = verified(requirement(sentence), emitted(sentence))
        assert found.result is ClaimResult.PROVED, (sentence, found)


@pytest.mark.parametrize(
    ("sentence", "column", "decided"),
    [
        ("whenever !p the sw shall after 9 ticks satisfy p", [True, False], "violated"),
        ("whenever p the sw shall after 9 ticks satisfy p", [False, True], "violated"),
        ("upon p the sw shall within 9 ticks satisfy p", [False], "satisfied"),
        ("the sw shall for 9 ticks satisfy p | !p", [True], "satisfied"),
        ("whenever p the sw shall always satisfy p", [False, True, True], "pending"),
        ("the sw shall until p satisfy !p", [False], "satisfied"),
        ("the sw shall until p satisfy p", [False], "violated"),
        ("the sw shall before p satisfy p", [False, True], "violated"),
    ],
)
def test_a_sentence_is_decided_at_that_tick_and_not_before(
    sentence: str, column: list[bool], decided: str
) -> None:

    *before, last = [step.decided for step in steps(monitor(sentence), {"p": column})]
    assert (before, last) == (["pending"] * (len(column) - 1), decided)
