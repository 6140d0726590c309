"""HOA files: Spot reads them back, and they have the language of the formula."""

import time
from typing import Any

import pytest
import spot

from compiler.logic import printing
from compiler.targets.comparison_names import comparison_names, with_renamed_atoms
from tests.each import each
from tests.emitting import LOOKING_BACK, MANY, PROBABLE, SHARING, emitted, refused, requirement
from tests.strategies import Template, few_templates


def text_of(sentence: str) -> str:
    return emitted("hoa", sentence)["r1.hoa"]


def read(text: str) -> Any:
    """As Spot reads it, which checks what is declared of determinism and completeness."""
    automaton = spot.automaton(text)
    assert spot.is_deterministic(automaton)
    assert spot.is_complete(automaton)
    assert automaton.prop_state_acc().is_true()
    if automaton.prop_weak().is_true():
        assert spot.is_weak_automaton(automaton)
    return automaton


def assert_has_the_language_of_the_formula(sentence: str) -> None:
    read_as = with_renamed_atoms(
        requirement(sentence).ft_infinite, comparison_names(requirement(sentence))
    )
    formula = printing.text(read_as, printing.SPOT)
    assert spot.are_equivalent(read(text_of(sentence)), spot.formula(formula)), sentence


@pytest.mark.slow
@each("template", few_templates((0, 1, 3)))
def test_every_template_has_the_language_of_its_formula(template: Template) -> None:
    assert_has_the_language_of_the_formula(template.sentence)


@each("sentence", SHARING)
def test_expressions_may_share_propositions(sentence: str) -> None:
    assert_has_the_language_of_the_formula(sentence.format(n=2))


def test_the_comparison_sees_a_difference_of_one_tick() -> None:
    text = text_of("whenever p the sw shall within 3 ticks satisfy q")
    assert spot.are_equivalent(read(text), "G(p -> F[0:3]q)")
    assert not spot.are_equivalent(read(text), "G(p -> F[0:4]q)")


def test_the_whole_text() -> None:
    assert text_of("whenever p the sw shall within 1 tick satisfy q & x > 3") == (
        "HOA: v1\n"
        'name: "R1"\n'
        'tool: "fretc" "0.1.0"\n'
        "/* whenever p the sw shall within 1 tick satisfy q & x > 3 */\n"
        '/* The infinite traces that satisfy it. State "violated": no continuation satisfies it;'
        ' "satisfied": every one does. */\n'
        "/* x_gt_3: x > 3 */\n"
        "States: 4\n"
        "Start: 0\n"
        'AP: 3 "p" "q" "x_gt_3"\n'
        "acc-name: Buchi\n"
        "Acceptance: 1 Inf(0)\n"
        "properties: trans-labels explicit-labels state-acc complete deterministic weak\n"
        "Alias: @condition 0\n"
        "Alias: @response 1 & 2\n"
        "--BODY--\n"
        'State: 0 "start" {0}\n'
        "[!@condition | @response] 1\n"
        "[@condition & !@response] 2\n"
        'State: 1 "waiting" {0}\n'
        "[!@condition | @response] 1\n"
        "[@condition & !@response] 2\n"
        'State: 2 "open for 1 tick" {0}\n'
        "[!@response] 3\n"
        "[@response] 1\n"
        'State: 3 "violated"\n'
        "[t] 3\n"
        "--END--\n"
    )


@pytest.mark.parametrize(
    ("sentence", "acceptance", "weak"),
    [
        ("whenever p the sw shall immediately satisfy q", "Inf(0)", True),
        ("whenever p the sw shall eventually satisfy q", "Inf(0)", False),
        ("before m mode whenever p the sw shall eventually satisfy q", "Inf(0)", False),
        ("whenever p the sw shall finally satisfy q", "t", True),
        ("the sw shall always satisfy false", "Inf(0)", True),
    ],
)
def test_acceptance_and_weakness(sentence: str, acceptance: str, weak: bool) -> None:
    automaton = read(text_of(sentence))
    assert str(automaton.get_acceptance()) == acceptance
    assert automaton.prop_weak().is_true() is weak


def test_a_sentence_that_nothing_satisfies_is_its_sink_alone() -> None:
    text = text_of("whenever p | !p the sw shall within 2 ticks satisfy p & !p")
    assert "States: 1\n" in text
    assert read(text).is_empty()


def test_a_sentence_that_nothing_violates_is_one_state() -> None:
    assert 'State: 0 "satisfied"\n[t] 0\n' in text_of("the sw shall finally satisfy p")


@pytest.mark.slow
def test_ten_thousand_ticks_take_seconds() -> None:
    start = time.process_time()
    text = text_of("whenever p the sw shall within 10000 ticks satisfy q")
    assert time.process_time() - start < 10
    assert "States: 10003\n" in text
    assert spot.automaton(text).num_states() == 10_003


def test_twenty_propositions_are_no_two_to_the_twentieth() -> None:
    text = text_of(f"whenever {MANY} the sw shall within 3 ticks satisfy p0 xor {MANY}")
    assert len(text) < 3000
    assert spot.automaton(text).num_states() == 6


def test_deep_equivalences_stay_as_long_as_they_are() -> None:
    chain = "p0"
    for i in range(1, 40):
        chain = f"(p{i} <-> {chain})"
    assert len(text_of(f"the sw shall always satisfy {chain}")) < 5000


def test_a_sentence_cannot_end_its_comment() -> None:
    text = text_of('the sw shall always satisfy f(x, 2*3/4) & "a*/b"')
    assert spot.automaton(text).num_states() == 3


# Refusals -------------------------------------------------------------------------------------


def test_a_probability_is_refused() -> None:
    assert refused("hoa", PROBABLE) == (
        "F601 HOA cannot express the probability of R1\n"
        "  --> r.fret:1:1\n"
        f"   | {PROBABLE}\n"
        f"   | {'^' * len(PROBABLE)}\n"
        "help: leave it out, or use `--emit prism`"
    )


def test_a_predicate_that_looks_elsewhere_is_refused() -> None:
    assert "F601 HOA cannot express the predicate `persisted` of R1" in refused("hoa", LOOKING_BACK)


def test_an_automaton_that_is_too_large_is_refused(most_states: int) -> None:
    sentence = "only in m mode whenever p the sw shall after 60 ticks satisfy q"
    assert refused("hoa", sentence) == (
        f"F670 the automaton of R1 has more than {most_states} states\n"
        "  --> r.fret:1:1\n"
        f"   | {sentence}\n"
        f"   | {'^' * len(sentence)}\n"
        "help: state a shorter duration, use a clock with longer ticks, or `--emit smv`"
    )
