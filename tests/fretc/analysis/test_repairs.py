"""What is suggested to settle conflicts: Spot proves it, and no smaller change would do."""

from collections.abc import Sequence

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.analysis import analyze
from fretc.analysis.findings import Analysis, RealizabilityVerdict, Repair
from fretish.bindings.declarations import Role
from fretish.clock import Clock
from tests.effort import FULL
from tests.monitoring import requirement as timed
from tests.requirement_sets import ROLES, analyzed, requirement, requirements, synthesized, terse

ONE_AT_A_TIME = (
    "upon a the sw shall immediately satisfy x",
    "upon b the sw shall for 3 ticks satisfy !x",
)


def suggested(*sentences: str) -> list[tuple[str | None, tuple[str, ...]]]:
    return [(each.requirement, each.sentences) for each in fixed(*sentences).repairs]


def fixed(*sentences: str, assumed: Sequence[str] = ()) -> Analysis:
    return analyzed(*sentences, assumed=assumed, repairs=True)


def test_the_weakest_assumption_of_each_family_is_suggested() -> None:
    at_once = "whenever {} the sw shall immediately satisfy {}"
    assert suggested(at_once.format("a", "x"), at_once.format("b", "!x")) == [
        (None, ("the environment shall never satisfy a & b",))
    ]
    assert suggested("the sw shall immediately satisfy x", at_once.format("a", "!x")) == [
        (None, ("the environment shall immediately satisfy !a",))
    ]
    assert suggested(*ONE_AT_A_TIME) == [
        (None, ("whenever b the environment shall for 3 ticks satisfy !a",))
    ]
    assert suggested("upon a the sw shall after 2 ticks satisfy x") == [
        (None, ("whenever !a & preBool(false, a) the environment shall for 2 ticks satisfy !a",))
    ]


@pytest.mark.slow
@pytest.mark.parametrize(("within", "hold"), [(0, 0), (0, 3), (1, 1), (2, 9), (5, 6)])
def test_the_least_change_of_each_bound_is_suggested(within: int, hold: int) -> None:
    soon = "upon a the sw shall within {} satisfy x".format
    off = "the sw shall for {} satisfy !x".format
    sentences = (soon(ticks(within)), off(ticks(hold)))
    found = {id: text for id, text in suggested(*sentences) if id is not None}
    longer = {"R1": (soon(ticks(hold + 1)),)}
    shorter = {"R2": (off(ticks(within - 1)),)} if within else {}
    assert found == longer | shorter
    for repair in fixed(*sentences).repairs:
        assert synthesized(*changed(sentences, repair)), repair


@pytest.mark.slow
def test_long_bounds_are_repaired_as_short_ones_are() -> None:
    bound = 4000 if FULL else 100
    assert suggested(
        f"upon a the sw shall within {bound} ticks satisfy x",
        f"the sw shall for {bound} ticks satisfy !x",
    )[:2] == [
        ("R1", (f"upon a the sw shall within {bound + 1} ticks satisfy x",)),
        ("R2", (f"the sw shall for {bound - 1} ticks satisfy !x",)),
    ]


def ticks(number: int) -> str:
    return f"{number} tick" if number == 1 else f"{number} ticks"


@pytest.mark.parametrize(
    ("unit", "milliseconds", "fixing"),
    [
        ("100 milliseconds", 50, "150 milliseconds"),
        ("1 second", 500, "1500 milliseconds"),
        ("1 second", 1000, "2 seconds"),
        ("1 minute", 60_000, "2 minutes"),
    ],
)
def test_a_bound_stays_in_its_unit_or_in_one_that_is_exact(
    unit: str, milliseconds: int, fixing: str
) -> None:
    clock = Clock(milliseconds * 10**6)
    given = [
        timed(f"upon a the sw shall within {unit} satisfy x", "R1", clock),
        timed(f"the sw shall for {unit} satisfy !x", "R2", clock),
    ]
    repairs = {each.requirement: each.sentences for each in analyze(given, ROLES).repairs}
    assert repairs["R1"] == (f"upon a the sw shall within {fixing} satisfy x",)


def test_no_assumption_takes_a_trigger_away() -> None:
    both = "whenever a & b the sw shall immediately satisfy {}"
    assert suggested(both.format("x"), both.format("!x")) == []


def test_what_settles_one_conflict_of_several_says_so() -> None:
    found = fixed(*ONE_AT_A_TIME, "the sw shall never satisfy x")
    assert found.verdict is RealizabilityVerdict.UNREALIZABLE
    assert all(not each.settles for each in found.repairs)
    assert found.repairs


def test_assumptions_that_are_there_stay() -> None:
    found = fixed(
        *ONE_AT_A_TIME, assumed=["whenever b the operator shall for 2 ticks satisfy !a"]
    ).repairs
    assert [(each.requirement, each.sentences) for each in found] == [
        ("R2", ("upon b the sw shall for 2 ticks satisfy !x",)),
        (None, ("whenever b the environment shall for 3 ticks satisfy !a",)),
    ]


def changed(
    sentences: Sequence[str], repair: Repair
) -> tuple[list[FormalizedRequirement], list[FormalizedRequirement]]:
    """The requirements of its conflict and the assumptions, as the repair has them."""
    mine = [each for each in requirements(*sentences) if each.id in repair.conflict]
    if repair.requirement is None:
        return mine, [requirement(f"A{i}", each) for i, each in enumerate(repair.sentences)]
    (sentence,) = repair.sentences
    return [
        requirement(each.id, sentence) if each.id == repair.requirement else each for each in mine
    ], []


@pytest.mark.slow
def test_spot_proves_each_suggestion() -> None:
    shown = 0
    for seed in range(150 if FULL else 60):
        sentences = terse(("repair", seed))
        for repair in fixed(*sentences).repairs:
            if any("preBool" in each for each in repair.sentences):
                continue
            assert synthesized(*changed(sentences, repair)), (sentences, repair)
            shown += 1
    assert shown > (5 if FULL else 2)


def test_comparisons_of_the_environment_can_be_assumed_apart() -> None:
    given = [
        requirement("R1", "whenever t > 30 the sw shall immediately satisfy x"),
        requirement("R2", "whenever p < 2 the sw shall immediately satisfy !x"),
    ]
    roles = {"t": Role.INPUT, "p": Role.INPUT, "x": Role.OUTPUT}
    (found,) = analyze(given, roles).repairs
    assert found.sentences == ("the environment shall never satisfy t > 30 & p < 2",)
