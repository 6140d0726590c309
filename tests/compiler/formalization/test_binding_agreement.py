"""A comparison of a sentence is bound to itself, or not at all."""

import operator
from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.binding_agreement import unbound_propositions
from compiler.formalization.formalize import formalize
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import requirements

HEAD = """\
[clock]
tick = "100 ms"
[signal.vx]
path = "/odom.vx"
unit = "m/s"
[signal.vy]
path = "/odom.vy"
unit = "m/s"
[signal.soc]
path = "/battery.soc"
unit = "%"
[signal.state]
path = "/state.data"
values = ["drive", "docking"]
"""


def said(sentence: str, proposition: str, expr: str) -> tuple[Diagnostic, ...]:
    """What there is to say of the sentence, where one proposition is bound."""
    bindings = f"{HEAD}[proposition.'{proposition}']\nexpr = \"{expr}\"\n"
    declared, wrong = read_bindings(Source("bindings.toml", bindings))
    assert wrong == ()
    text = f"the robot shall always satisfy {sentence}"
    ((entry,), _) = requirements(Source("r1.fret", text))
    requirement, remarks = formalize(entry, declared)
    assert (requirement is None) == any(remark.is_error for remark in remarks)
    return remarks


AGREE = [
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "1.5 m/s >= vx"),
    ("1.5 >= speed", "(1.5 >= speed)", "vx <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 1.50 m/s"),
    ("speed <= 150", "(speed <= 150)", "vx <= 150 cm/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "abs(vx) <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "max(vx, -vy) <= 1.5 m/s"),
    ("speed > -1.5", "(speed > (- 1.5))", "vx > -1.5 m/s"),
    ("charge >= 20", "(charge >= 20)", "soc >= 20 %"),
    ("speed = 0", "(speed = 0)", "0 m/s = vx"),
    ("absReal(speed) < 2", "(absReal(speed) < 2)", "abs(vx) < 2 m/s"),
    ("a < b", "(a < b)", "vx < vy"),
    ("a = b", "(a = b)", "vy = vx"),
    ("vx < vy", "(vx < vy)", "vx < vy"),
    ("a < a", "(a < a)", "vx < vx"),
    ("speed + 1 < 3", "((speed + 1) < 3)", "vx + 1 m/s < 3 m/s"),
    ('"speed <= 1.5"', "speed <= 1.5", "vx <= 1.5 m/s"),
    ("speed <= 1.5 m/s", "(speed <= 1.5 m/s)", "vx <= 150 cm/s"),
    ("charge >= 20 %", "(charge >= 20 %)", "soc >= 0.2"),
    ("near(drum)", "near(drum)", "vx <= 1.5 m/s"),
    ("slow", "slow", "vx <= 1.5 m/s"),
    ("state = docking", "(state = docking)", "state = 'docking'"),
    ("phase = docking", "(phase = docking)", "docking = state"),
]
DIFFER = [
    ("state = docking", "(state = docking)", "state = 'drive'"),
    ("state = docking", "(state = docking)", "state != 'docking'"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 15 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx < 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx >= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "1.5 m/s <= vx"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= -1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 150 cm/s"),  # it is another number
    ("speed <= 1.5", "(speed <= 1.5)", "not vx > 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 1.5 m/s for 200 ms"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 1.5 m/s and vy <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx <= 1.5 m/s or true"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx / 10 <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "vx - 1 m/s <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "min(vx, 1 m/s) <= 1.5 m/s"),
    ("speed <= 1.5", "(speed <= 1.5)", "true"),
    ("a < b", "(a < b)", "vy > vx"),  # nothing says which is a
    ("a < b", "(a < b)", "vx < 3 m/s"),
    ("vx < vy", "(vx < vy)", "vy < vx"),
    ("a < a", "(a < a)", "vx < vy"),
    ("speed + 1 < 3", "((speed + 1) < 3)", "vx - 1 m/s < 3 m/s"),
    ("speed + 1 < 3", "((speed + 1) < 3)", "vx + 2 m/s < 3 m/s"),
    ("absReal(speed) < 2", "(absReal(speed) < 2)", "vx < 2 m/s"),
    ("preReal(0, speed) < 2", "(preReal(0,speed) < 2)", "vx < 2 m/s"),
    ('"speed <= 1.5"', "speed <= 1.5", "vx <= 15 m/s"),
    ("near(5)", "near(5)", "vx <= 1.5 m/s"),
    ("charge >= 0.5 %", "(charge >= 0.5 %)", "soc >= 0.5"),
    ("speed <= 1.5 m/s", "(speed <= 1.5 m/s)", "vx <= 1.5 cm/s"),
    ("speed > -1.5 m/s", "(speed > (- 1.5 m/s))", "vx > -1.5 cm/s"),
    ("p | persisted(3, speed <= 1.5)", "(speed <= 1.5)", "vx <= 15 m/s"),
]


@pytest.mark.parametrize(("sentence", "proposition", "expr"), AGREE)
def test_the_same_comparison_is_taken(sentence: str, proposition: str, expr: str) -> None:
    assert Code.NUMBER_DRIFT not in [remark.code for remark in said(sentence, proposition, expr)]


@pytest.mark.parametrize(("sentence", "proposition", "expr"), DIFFER)
def test_another_comparison_is_refused(sentence: str, proposition: str, expr: str) -> None:
    remarks = said(sentence, proposition, expr)
    assert [remark.code for remark in remarks if remark.is_error] == [Code.NUMBER_DRIFT]


@pytest.mark.parametrize(
    ("least", "codes"),
    [
        ("vx >= 0.5 m/s", []),
        ("vy >= 0.5 m/s", [Code.NUMBER_DRIFT]),
        ("vx >= 0.5 cm/s", [Code.NUMBER_DRIFT]),
    ],
)
def test_a_name_is_one_term_in_one_unit_throughout_a_sentence(
    least: str, codes: list[Code]
) -> None:
    other = f"(speed >= 0.5)']\nexpr = \"{least}\"\n[proposition.'(speed <= 1.5)"
    remarks = said("speed <= 1.5 & speed >= 0.5", other, "vx <= 1.5 m/s")
    assert [remark.code for remark in remarks] == codes


def test_both_places_are_told_and_no_number_is_proposed() -> None:
    (wrong,) = said("p & speed <= 1.5", "(speed <= 1.5)", "vx <= 15 m/s")
    assert wrong.message == (
        '`(speed <= 1.5)` of r1 is bound to another comparison: "vx <= 15 m/s" (bindings.toml:16:8)'
    )
    assert wrong.span is not None
    assert (wrong.span.source.name, wrong.span.text) == ("r1.fret", "speed <= 1.5")
    assert wrong.help is not None
    assert not any(character.isdigit() for character in wrong.help)


# The law ---------------------------------------------------------------------------------------

OPERATORS: dict[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
numbers = st.sampled_from(["0", "1", "1.5", "1.50", "15", "0.15", "2"])
signed = st.builds(lambda sign, digits: f"{sign}{digits}", st.sampled_from(["", "-"]), numbers)
sides = st.tuples(st.sampled_from(sorted(OPERATORS)), signed, st.booleans())


def holds(side: tuple[str, str, bool], value: Fraction) -> bool:
    """Whether the comparison is true of a value, by the definition."""
    op, number, number_first = side
    bound = Fraction(number)
    return OPERATORS[op](bound, value) if number_first else OPERATORS[op](value, bound)


def text(side: tuple[str, str, bool], name: str, unit: str = "") -> str:
    op, number, number_first = side
    return f"{number}{unit} {op} {name}" if number_first else f"{name} {op} {number}{unit}"


@given(stated=sides, bound=sides, unit=st.sampled_from([" m/s", " cm/s", " km/h"]))
def test_what_is_taken_is_true_of_the_same_numbers(
    stated: tuple[str, str, bool], bound: tuple[str, str, bool], unit: str
) -> None:
    """And what is true of the same numbers, but for two ways to write one, is taken."""
    op, number, number_first = stated
    inside = f"(- {number[1:]})" if number.startswith("-") else number
    proposition = f"({inside} {op} speed)" if number_first else f"(speed {op} {inside})"
    remarks = said(text(stated, "speed"), proposition, text(bound, "vx", unit))
    taken = Code.NUMBER_DRIFT not in [remark.code for remark in remarks]
    near = {Fraction(side[1]) for side in (stated, bound)}
    values = {n + step for n in near for step in (Fraction(-1, 9), Fraction(0), Fraction(1, 9))}
    same = all(holds(stated, value) == holds(bound, value) for value in values)
    assert taken == same


def test_a_word_is_never_compared_with_a_number() -> None:
    remarks = said("state = vx", "(state = vx)", "state = 'drive'")
    assert [remark.code for remark in remarks] == [Code.BAD_EXPRESSION]


def test_a_word_in_the_place_of_a_mode_is_told_where_it_belongs() -> None:
    declared, _ = read_bindings(Source("bindings.toml", HEAD))
    assert declared is not None
    sentence = Source("r.fret", "in docking mode the robot shall always satisfy vx < 1")
    ((entry,), _) = requirements(sentence)
    requirement, _ = formalize(entry, declared)
    assert requirement is not None
    assert requirement.declarations is not None
    (missing,) = unbound_propositions(requirement, requirement.declarations)
    assert missing.message == "`docking` of r has no binding in bindings.toml"
    assert missing.help == (
        "`docking` is a word of `state`: write `state = docking` (as a scope `while state = "
        "docking`), or add `[proposition.docking]` with its `expr` to bindings.toml"
    )


def test_a_comparison_of_a_signal_with_a_mistake_has_that_mistake_alone() -> None:
    text = HEAD.replace('path = "/state.data"', 'path = "TODO"')
    declared, wrong = read_bindings(Source("bindings.toml", text))
    assert declared is not None
    ((entry,), _) = requirements(Source("r.fret", "the robot shall satisfy state = docking"))
    requirement, _ = formalize(entry, declared)
    assert requirement is not None
    assert requirement.declarations is not None
    assert tuple(unbound_propositions(requirement, requirement.declarations)) == wrong
