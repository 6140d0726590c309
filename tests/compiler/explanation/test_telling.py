"""What monitors tell of single demands is what the definition says of them."""

import random

import pytest

from tests.demands import demands_of
from tests.each import each
from tests.monitoring import monitor, over, steps
from tests.strategies import Template, few_templates

LENGTH, TRACES = 9, 15


@pytest.mark.slow
@each("template", few_templates())
def test_triggers_answers_violations_and_open_demands_are_those_of_the_definition(
    template: Template,
) -> None:
    machine, choose = monitor(template.sentence), random.Random(repr(template))
    for _ in range(TRACES):
        odds = {name: choose.choice((0.2, 0.5, 0.8)) for name in template.columns}
        columns = {name: [choose.random() < odds[name] for _ in range(LENGTH)] for name in odds}
        found, expected = over(machine, columns), demands_of(template, columns)
        assert found.triggers == expected.triggers, (template, columns)
        assert found.answers == expected.answers, (template, columns)
        assert found.violations == expected.violations, (template, columns)
        if expected.open is not None:
            assert found.open == expected.open, (template, columns)
            steps(machine, columns)
            obligation_pending = bool(expected.open) or LENGTH - 1 in expected.triggers
            assert machine.statuses()[0].obligation_pending is obligation_pending, (
                template,
                columns,
            )


def test_a_response_after_the_interval_is_no_answer() -> None:
    machine = monitor("in m mode whenever p the sw shall within 3 ticks satisfy q")
    columns = {"m": [True, True, False], "p": [True, False, False], "q": [False, False, True]}
    assert over(machine, columns).answers == ()
    columns["m"][2] = True
    assert over(machine, columns).answers == ((0, 2),)
