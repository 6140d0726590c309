"""Verdicts come as early as they can: at the tick at which Spot's three-valued monitor tells."""

import random

import pytest

from compiler.rule import Rule
from tests.meaning import SCOPES
from tests.monitoring import monitor, rule, steps
from tests.spot_monitors import Ltl3
from tests.strategies import templates

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


def check(sentence: str, made: Rule, names: tuple[str, ...], count: int) -> None:
    machine, oracle = monitor(sentence), Ltl3(made.ft_infinite)
    for columns in words(names, count, sentence):
        letters = [
            dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)
        ]
        told = [step.decided for step in steps(machine, columns)]
        assert told == oracle.verdicts(letters), (sentence, columns)


@pytest.mark.parametrize("scope", SCOPES)
def test_each_template_is_decided_at_the_earliest_tick(scope: str) -> None:
    for template in templates():
        if template.scope == scope:
            sentence = template.sentence
            check(sentence, rule(sentence), template.columns, 12)
