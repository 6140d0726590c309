"""What no run can violate, compared with Spot and against every short run."""

from itertools import product

import pytest
import spot

from compiler.explanation.violability import is_violable, limit
from compiler.logic import printing
from compiler.logic.formula import Formula
from fretish.clock import Clock, End
from monitors.kernel import VIOLATED, evaluate
from monitors.kernel.columns import column
from tests.compiler.formalization.test_anticipation import WHEN, counted, sharing
from tests.effort import pairwise
from tests.meaning import SCOPES
from tests.monitoring import monitor, requirement
from tests.strategies import few_templates, some_templates


def is_live(formula: Formula) -> bool:
    """Spot: every finite word can go on to one of the language."""
    automaton = spot.translate(spot.formula(printing.future(formula)))
    return bool(spot.is_liveness_automaton(automaton))


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_of_each_template_spot_says_the_same(scope: str) -> None:
    for template in few_templates((0, 1, 3)):
        if template.scope == scope:
            made = requirement(template.sentence)
            assert is_violable(made) is not is_live(made.ft_infinite), template.sentence


@pytest.mark.slow
def test_of_parts_that_share_atoms_spot_says_the_same() -> None:
    for scope, condition, (timing, n) in pairwise(SCOPES, WHEN, [*counted()]):
        made = requirement(
            sharing(scope, condition, timing, n, f"{scope} {condition} {timing} {n}")
        )
        assert is_violable(made) is not is_live(made.ft_infinite), made.sentence


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_where_the_end_violates_some_short_run_does_exactly_if_it_is_violable(scope: str) -> None:
    clock = Clock(10**8, end=End.VIOLATED)
    for template in some_templates((1,)):
        if template.scope != scope:
            continue
        made, machine = requirement(template.sentence, clock=clock), monitor(template.sentence)
        found = any(
            evaluate(machine, dict(zip(template.columns, told, strict=True)), 3, VIOLATED)[
                0
            ].verdict
            == VIOLATED
            for told in product(
                [column(bytes(bits)) for bits in product((0, 1), repeat=3)],
                repeat=len(template.columns),
            )
        )
        assert is_violable(made) is found, template.sentence


def test_what_whatever_happens_keeps_is_not_violated_by_the_end_either() -> None:
    clock = Clock(10**8, end=End.VIOLATED)
    assert not is_violable(requirement("the sw shall always satisfy q | !q", clock=clock))
    assert is_violable(requirement("the sw shall eventually satisfy q", clock=clock))


@pytest.mark.parametrize(
    ("sentence", "words"),
    [
        ("the sw shall within 3 ticks satisfy q", ""),
        ("the sw shall always satisfy q | !q", "No run can violate R1: every run satisfies it."),
        (
            "whenever p the sw shall eventually satisfy q",
            "No run can violate R1: it sets no bound, so an answer that has not come may always "
            "come later.",
        ),
    ],
)
def test_the_reason_is_one_sentence(sentence: str, words: str) -> None:
    assert limit(requirement(sentence)) == words
