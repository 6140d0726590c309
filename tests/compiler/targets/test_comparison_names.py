"""A comparison is one name in every language, with its definition, and with what contradicts it."""

import re
from itertools import product

import pytest

from compiler.emit import TARGETS
from compiler.explanation.constant_parts import constant_parts
from compiler.explanation.examples import examples
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import impossible_combinations
from compiler.targets.comparison_names import comparison_names, definitions
from compiler.targets.ltl import text
from compiler.targets.target import TargetOptions
from fretish.printer import expression
from tests.bound_requirements import bound_requirement

BINDINGS = """\
[clock]
tick = "100 ms"
[signal.battery]
path = "/battery.percentage"
unit = "%"
[signal.speed]
path = "/odom.twist.twist.linear.x"
unit = "m/s"
[signal.mode]
path = "/mode.data"
values = ["drive", "docking"]
[proposition.speed_gt_2]
expr = "speed > 1 m/s"
"""
SENTENCE = (
    "whenever battery < 20 & speed_gt_2 the agv shall eventually satisfy "
    "battery > 30 | speed > 7.2 km/h | mode = docking"
)
NAMES = {
    "battery_lt_20": "battery < 20 %",
    "battery_gt_30": "battery > 30 %",
    "speed_gt_2_2": "speed > 2 m/s",
    "mode_eq_docking": '"mode" = docking',
}


def requirement(sentence: str = SENTENCE, bindings: str = BINDINGS) -> FormalizedRequirement:
    return bound_requirement(sentence, bindings, "A1")


def emitted(target: str, sentence: str = SENTENCE) -> str:
    return "\n".join(file.text for file in TARGETS[target].emit([requirement(sentence)]))


def test_names_are_readable_and_no_other_s() -> None:
    assert definitions(requirement(), comparison_names(requirement())) == NAMES


@pytest.mark.parametrize("target", ["hoa", "dot", "smv", "prism", "dafny", "ajpf"])
def test_each_language_has_the_same_names_with_their_definitions(target: str) -> None:
    sentence = SENTENCE.replace("eventually", "with probability >= 0.9 eventually")
    told = re.sub(r"\\n", " ", emitted(target, sentence if target == "prism" else SENTENCE))
    for name, meaning in NAMES.items():
        assert name in told
        assert meaning in told.replace('\\"', '"')
    assert "(battery < 20)" not in told


@pytest.mark.parametrize("notation", ["spot", "nusmv"])
def test_formulas_for_tools_have_them_too(notation: str) -> None:
    told = text(requirement(), TargetOptions(notation=notation))
    assert re.search(r"G ?\(+battery_lt_20 & speed_gt_2\)? -> F", told)
    assert re.search(r"^  speed_gt_2_2 +speed > 2 m/s$", told, re.M)
    assert "(battery < 20)" in text(requirement())


def test_an_agent_believes_a_comparison_that_an_adapter_derives() -> None:
    told = emitted("ajpf")
    assert "(B(agv,battery_lt_20)) & (B(agv,speed_gt_2))" in told
    assert "# battery_lt_20: battery < 20 %; an adapter has to derive it for the agent\n" in told


def test_what_no_numbers_make_stands_in_the_file() -> None:
    assert "  INVAR !(battery_lt_20 & battery_gt_30);\n" in emitted("smv")
    assert "/* never at one tick: battery_lt_20 true, battery_gt_30 true */\n" in emitted("hoa")


def test_a_name_does_not_depend_on_the_target_nor_on_where_it_stands() -> None:
    turned = requirement(
        "whenever speed > 2 the agv shall immediately satisfy battery < 20 | speed_gt_2"
    )
    names = comparison_names(turned)
    assert {*names.values()} == {"speed_gt_2_2", "battery_lt_20"}


# Valuations -----------------------------------------------------------------------------------


def exclusions(sentence: str, bindings: str = BINDINGS) -> set[frozenset[tuple[str, bool]]]:
    return {frozenset(each) for each in impossible_combinations(requirement(sentence, bindings))}


BOTH = "the agv shall always satisfy battery < 20 | battery > 30"
EXCLUDED = {frozenset({("(battery < 20)", True), ("(battery > 30)", True)})}
DECLARED = '[proposition."(battery < 20)"]\nexpr = "battery < 20 %"\n'


@pytest.mark.parametrize(
    ("declared", "found"),
    [
        ("", EXCLUDED),
        (DECLARED, EXCLUDED),
        (f'{DECLARED}agg = "any"\n', set()),
        (f"{DECLARED}on_unknown = true\n", set()),
    ],
)
def test_a_proposition_that_is_more_than_its_comparison_is_free(
    declared: str, found: set[frozenset[tuple[str, bool]]]
) -> None:
    """With `any`, one sample of a tick may be below 20 % and another one above 30 %."""
    assert exclusions(BOTH, BINDINGS + declared) == found


def test_no_trace_of_an_explanation_is_impossible() -> None:
    for word, timing in product(("whenever", "upon"), ("immediately", "within 2 ticks", "always")):
        sentence = (
            f"{word} battery < 20 the agv shall {timing} satisfy battery > 30 & mode = drive"
            " | mode = docking"
        )
        asked = requirement(sentence)
        found, never = examples(asked), impossible_combinations(asked)
        assert never
        assert found.violated
        for each in (*found.satisfied, *found.violated):
            for row in (*each.prefix, *each.loop):
                values = dict(zip(found.atoms, row, strict=True))
                assert not any(all(values[n] is v for n, v in one) for one in never), values


@pytest.mark.parametrize(
    ("sentence", "parts"),
    [
        ("whenever battery < 20 & battery > 30 the agv shall always satisfy speed > 1", {False}),
        ("the agv shall always satisfy battery < 30 | battery > 20", {True}),
        ("the agv shall always satisfy mode = drive | mode = docking", {True}),
        ("while mode = drive when mode = docking the agv shall always satisfy speed > 1", {False}),
        ("the agv shall always satisfy speed > 1 | (battery < 2 & battery > 3)", {False}),
        ("the agv shall always satisfy battery < 20 | battery > 30", set()),
        ("whenever mode = drive the agv shall always satisfy mode = docking", set()),
        ("the agv shall always satisfy p | !p", set()),
    ],
)
def test_what_comparisons_make_constant_is_found(sentence: str, parts: set[bool]) -> None:
    assert {value for _, value in constant_parts(requirement(sentence))} == parts


def test_the_greatest_constant_part_is_named() -> None:
    told = "the agv shall always satisfy speed > 1 & battery < 2 & (battery > 3 | battery > 4)"
    ((part, value),) = constant_parts(requirement(told))
    assert not value
    assert expression(part) == "speed > 1 & battery < 2 & (battery > 3 | battery > 4)"
