# ruff: noqa: E501
"""Faults in what a monitor's text compares: each is refuted by a tick, or refused."""

from functools import cache

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimOutcome, ClaimResult
from compiler.targets.python import monitor as target
from tests.each import each
from tests.effort import some
from tests.monitoring import requirement
from tests.proofs import verified

SENTENCE = "whenever battery < 20 & preReal(0, speed) < 2 the agv shall within 1 ticks satisfy docking | level = 3"
LESS = 'compared(battery, "<", exact("20"))'
KEPT = "self.kept = (speed,)"
EARLIER = '_earlier_1 = first(exact("0")) if kept is None else kept[0]'
NUMBER = 'battery = measurement(battery, "battery")'
WRONG, REFUSED, SAME = ClaimResult.COUNTEREXAMPLE, ClaimResult.NOT_CHECKED, ClaimResult.PROVED

FAULTS = (
    # Constants, operators, operands.
    (LESS, 'compared(battery, "<", exact("20.000000000000001"))', REFUSED),
    (LESS, 'compared(battery, "<", exact("20.1"))', WRONG),
    (LESS, 'compared(battery, "<", exact("21"))', WRONG),
    (LESS, 'compared(battery, "<", exact("-20"))', WRONG),
    (LESS, 'compared(battery, "<=", exact("20"))', WRONG),
    (LESS, 'compared(battery, ">", exact("20"))', WRONG),
    (LESS, 'compared(battery, "!=", exact("20"))', WRONG),
    (LESS, 'compared(exact("20"), "<", battery)', WRONG),
    (LESS, 'compared(speed, "<", exact("20"))', WRONG),
    (LESS, 'compared(plus(battery, exact("0.5")), "<", exact("20"))', WRONG),
    (LESS, 'compared(absolute(battery), "<", exact("20"))', WRONG),
    (LESS, 'compared(in_base(battery, exact("1/100")), "<", exact("20"))', WRONG),
    (LESS, 'compared(battery, "<", _earlier_1)', WRONG),
    (LESS, "True", WRONG),
    (LESS, "None", WRONG),
    (LESS, "docking", REFUSED),
    (LESS, 'not compared(battery, ">=", exact("20"))', REFUSED),
    (LESS, 'compared(battery, "<", 20)', REFUSED),
    (LESS, 'compared(battery, "<", exact(str(20)))', REFUSED),
    (LESS, 'compared(battery, "<", exact("20")) or False', REFUSED),
    (LESS, 'battery < 20', REFUSED),
    (LESS, 'compared(battery, "<", exact("40/2"))', SAME),
    (LESS, 'compared(battery, "<", lesser(exact("20"), exact("20")))', REFUSED),
    # What is given, and what of it is unknown.
    (f"        {NUMBER}\n", "", REFUSED),
    (NUMBER, "battery = battery or 0.0", REFUSED),
    (NUMBER, 'battery = measurement(speed, "battery")', REFUSED),
    (NUMBER, 'battery = measurement(battery, "speed")', REFUSED),
    ('docking = truth_value(docking, "docking")', "docking = bool(docking)", REFUSED),
    ("battery: Number, speed: Number, docking: Truth, level: Number) -> \"tuple", "battery: Number, speed: Number, docking: Truth, level: Number = 3) -> \"tuple", REFUSED),
    ("def truths(self, battery: Number, speed", "def truths(self, speed: Number, battery", REFUSED),
    ('"battery": Variable("battery", "number")', '"battery": Variable("battery", "truth")', REFUSED),
    ('"battery": Variable("battery", "number")', '"speed": Variable("battery", "number")', REFUSED),
    ('"battery": Variable("battery", "number")', '"battery": Variable("speed", "number")', REFUSED),
    ('        "battery": Variable("battery", "number"),\n', "", REFUSED),
    # What is kept.
    (EARLIER, EARLIER.replace('"0"', '"2"'), WRONG),
    (EARLIER, EARLIER.replace('"0"', '"1"'), REFUSED),
    (EARLIER, EARLIER.replace("[0]", "[1]"), REFUSED),
    (EARLIER, EARLIER.replace("is None", "is not None"), REFUSED),
    (KEPT, "self.kept = (battery,)", WRONG),
    (KEPT, 'self.kept = (exact("0"),)', WRONG),
    (KEPT, "self.kept = (_earlier_1,)", REFUSED),
    (KEPT, "self.kept = (first(speed),)", REFUSED),
    (KEPT, "self.kept = kept", REFUSED),
    (KEPT, "self.other = (speed,)", REFUSED),
    (f"        {KEPT}\n", "", REFUSED),
    # What comes of it.
    ("return (battery_lt_20, preReal", "return (level_eq_3, preReal", REFUSED),
    ("self.take(((battery, speed, docking, level),))", "self.take(((battery, battery, docking, level),))", REFUSED),
    ("        self.take(rows)\n", "        self.take(list(rows)[:5000])\n", REFUSED),
    ("(VariableMonitor):", "(Monitor):", REFUSED),
    ("sys.exit(main_by_variables(MONITOR))", "sys.exit(main(MONITOR))", REFUSED),
)  # fmt: skip


@cache
def made() -> tuple[FormalizedRequirement, str]:
    right = requirement(SENTENCE)
    return right, target.text(right)


def with_fault(old: str, new: str) -> ClaimOutcome:
    right, text = made()
    place = text.index("# The requirements ---")
    assert text[place:].count(old) == 1, text[place:].count(old)
    return verified(right, text[:place] + text[place:].replace(old, new))


def test_what_fretc_writes_is_proved() -> None:
    right, text = made()
    assert verified(right, text).result is SAME


@pytest.mark.slow
@each("fault", some(FAULTS, 5, 4))
def test_a_fault_comes_to_what_is_written_beside_it(fault: tuple[str, str, ClaimResult]) -> None:
    old, new, expected = fault
    outcome = with_fault(old, new)
    assert outcome.result is expected, outcome


def test_a_wrong_threshold_is_shown_by_numbers() -> None:
    outcome = with_fault(LESS, LESS.replace("<", "<="))
    assert outcome.result is WRONG
    assert "`(battery < 20)` is true in it, and should be false" in outcome.detail
    assert "battery = 20" in outcome.detail


def test_another_name_for_what_is_kept_changes_nothing() -> None:
    right, text = made()
    assert verified(right, text.replace("_earlier_1", "before")).result is SAME


def test_a_monitor_that_is_given_the_truth_of_a_comparison_is_refused() -> None:
    """So were monitors until numbers could be given: where is it compared?"""
    right = requirement("the agv shall always satisfy x < 2")
    opaque = target.text(requirement("the agv shall always satisfy p"))
    place = opaque.index("# The requirements ---")
    own = opaque[place:].replace('"p": "p"', '"(x < 2)": "x_lt_2"').replace(right.id, "R1")
    for old, new in (('"p"', '"(x < 2)"'), ("not_p", "not_x_lt_2"), ("(p,)", "(x_lt_2,)")):
        own = own.replace(old, new)
    assert verified(right, opaque[:place] + own).result is REFUSED


@pytest.mark.slow
def test_each_requirement_of_a_file_is_compared_for_itself() -> None:
    requirements = [
        requirement(f"the agv shall always satisfy x < {n} & p", f"R{n}") for n in (2, 3)
    ]
    text = target.text(*requirements)
    wrong = text.replace('exact("3")', 'exact("4")')
    for one, expected in zip(requirements, (SAME, WRONG), strict=True):
        others = [other for other in requirements if other is not one]
        assert verified(one, text, others=others).result is SAME
        assert verified(one, wrong, others=others).result is expected


@pytest.mark.slow
def test_a_file_may_read_as_a_truth_value_what_one_requirement_takes_for_a_number() -> None:
    requirements = [
        requirement("the agv shall always satisfy x < 2", "R1"),
        requirement("the agv shall satisfy x", "R2"),
    ]
    text = target.text(*requirements)
    assert verified(requirements[0], text, others=requirements[1:]).result is SAME
    assert verified(requirements[0], text).result is REFUSED
