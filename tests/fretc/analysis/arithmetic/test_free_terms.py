"""Terms that are not linear, and functions without a definition, against z3's arithmetic."""

import random
from collections.abc import Sequence
from itertools import product
from typing import Any

import pytest
import z3

from fretc.analysis.findings import RealizabilityVerdict
from tests.effort import FULL
from tests.requirement_sets import analyzed, roles

NAMED = roles(["i", "j"], ["v", "b"])
FIRST, SECOND, T = z3.Reals("i j t")
TERMS = {"i * j": T, "i * j + 1": T + 1, "i": FIRST, "j - 2": SECOND - 2, "2": z3.RealVal(2)}
RELATIONS = ("<", "<=", ">", ">=", "=")
Demand = tuple[str, str]
GIVEN = {"": z3.BoolVal(True), "i > 1": FIRST > 1, "i * j < 3": T < 3}


def between(lower: tuple[bool, Any], upper: tuple[bool, Any]) -> Any:
    """Whether a number lies between two bounds; each is strict or not."""
    return lower[1] < upper[1] if lower[0] or upper[0] else lower[1] <= upper[1]


def is_kept_for_all_inputs(demands: Sequence[tuple[str, str, str]], meaning: Any) -> bool:
    """Whether there is a `v` for each input, by the bounds that the triggered demands leave.

    Args:
        demands: relation of `v`, term, and condition of each demand.
        meaning: what `t` is; true: it may be anything.
    """
    for chosen in product((False, True), repeat=len(demands)):
        active = [each for each, is_so in zip(demands, chosen, strict=True) if is_so]
        lower = [(r == ">", TERMS[t]) for r, t, _ in active if r in (">", ">=", "=")]
        upper = [(r == "<", TERMS[t]) for r, t, _ in active if r in ("<", "<=", "=")]
        fits = z3.And([between(low, high) for low in lower for high in upper])
        solver = z3.Solver()
        solver.add(meaning, z3.Not(fits))
        solver.add([GIVEN[c] == is_so for (*_, c), is_so in zip(demands, chosen, strict=True)])
        answer = solver.check()
        assert answer != z3.unknown
        if answer == z3.sat:
            return False
    return True


@pytest.mark.slow
def test_an_answer_holds_for_the_product_and_for_every_other_function() -> None:
    choose = random.Random(4)
    counts = dict.fromkeys(RealizabilityVerdict, 0)
    for _ in range(1_000 if FULL else 10):
        demands = [
            (choose.choice(RELATIONS), choose.choice([*TERMS]), choose.choice([*GIVEN]))
            for _ in range(choose.randint(1, 3))
        ]
        sentences = [
            f"{f'whenever {c} ' if c else ''}the sw shall "
            f"{'immediately' if c else 'always'} satisfy v {r} {t}"
            for r, t, c in demands
        ]
        found = analyzed(*sentences, roles=NAMED)
        counts[found.verdict] += 1
        of_product = is_kept_for_all_inputs(demands, T == FIRST * SECOND)
        of_zero = is_kept_for_all_inputs(demands, T == 0)
        of_any = is_kept_for_all_inputs(demands, z3.BoolVal(True))
        match found.verdict:
            case RealizabilityVerdict.REALIZABLE:
                assert of_any, demands
            case RealizabilityVerdict.UNREALIZABLE:
                assert not of_product, demands
                assert not of_zero, demands
            case RealizabilityVerdict.NOT_CHECKED:
                assert not of_any, demands
        for conflict in found.conflicts:
            own = [demands[int(id[1:]) - 1] for id in conflict.requirements]
            assert not is_kept_for_all_inputs(own, T == FIRST * SECOND), (demands, conflict)
    assert all(counts.values()), counts


@pytest.mark.parametrize(
    ("sentences", "verdict", "why"),
    [
        (["the sw shall always satisfy v = mag(i) + 1"], "realizable", ""),
        (["the sw shall always satisfy b <=> mag(i) > mag(j)"], "realizable", ""),
        (
            ["the sw shall always satisfy v >= mag(i)", "the sw shall always satisfy v < mag(i)"],
            "unrealizable",
            "",
        ),
        (
            ["the sw shall always satisfy v = mag(i)", "the sw shall always satisfy v >= 0"],
            "not checked",
            "`mag(i)` is not computed, and may have any value",
        ),
        (
            # The system chooses what the function is of: its value is not known before.
            ["the sw shall always satisfy (mag(v) > 0) <=> (v > 0)"],
            "not checked",
            "it calls `mag`",
        ),
    ],
)
def test_a_function_without_a_definition_may_be_any(
    sentences: Sequence[str], verdict: str, why: str
) -> None:
    found = analyzed(*sentences, roles=NAMED)
    assert found.verdict == verdict
    assert why in found.why
    for conflict in found.conflicts:
        assert conflict.play == (), "its numbers would not be those of the function"
        assert conflict.because.endswith("whatever the unknown values are")


def test_a_product_of_earlier_numbers_is_not_taken_for_a_free_value() -> None:
    """Without inputs one run would be enough, but its product would not be computed."""
    product_ = "preReal(1.0, v) * preReal(1.0, v)"
    found = analyzed(
        f"the sw shall always satisfy {product_} < 0.0",
        "the sw shall always satisfy v > 0",
        "the other shall always satisfy b <=> i > 0",
        roles=NAMED,
    )
    about_v = next(each for each in found.components if "v" in each.outputs)
    assert about_v.verdict is RealizabilityVerdict.NOT_CHECKED
