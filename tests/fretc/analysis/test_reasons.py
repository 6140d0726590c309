"""The sentence that says why requirements fight."""

import re

import pytest

from tests.requirement_sets import analyzed, terse


@pytest.mark.parametrize(
    ("sentences", "because"),
    [
        (
            (
                "whenever a the sw shall within 2 ticks satisfy x",
                "upon b the sw shall for 3 ticks satisfy !x",
            ),
            "at tick 2 R1 demands `x` (since tick 0, by tick 2), and R2 forbids it (since tick 0, "
            "up to tick 3)",
        ),
        (
            (
                "whenever a the sw shall within 3 ticks satisfy x",
                "upon b the sw shall until !a satisfy !x",
            ),
            "at tick 3 R1 demands `x` (since tick 0, by tick 3), and R2 forbids it (since tick 0, "
            "until `!a`, which the environment withholds)",
        ),
        (
            (
                "the sw shall before preBool(false, b) satisfy x",
                "the sw shall immediately satisfy !x",
            ),
            "at tick 1 R1 cannot be satisfied by any output (before `preBool(false, b)`); R2 "
            "forbids `x` at "
            "tick 0",
        ),
        (
            ("whenever a the sw shall eventually satisfy x", "the sw shall never satisfy x"),
            "R1 (since tick 0) is never met, because R2 forbids `x`: the environment repeats "
            "tick 1 for ever",
        ),
    ],
)
def test_what_is_open_since_when_and_until_when(sentences: tuple[str, ...], because: str) -> None:
    (conflict,) = analyzed(*sentences).conflicts
    assert conflict.because == because


@pytest.mark.slow
def test_each_requirement_of_a_conflict_has_its_part() -> None:
    fought = 0
    for seed in range(40):
        for conflict in analyzed(*terse(("because", seed), most=4)).conflicts:
            assert all(re.search(rf"\b{id}\b", conflict.because) for id in conflict.requirements), (
                conflict
            )
            fought += len(conflict.requirements) > 1
    assert fought > 4
