"""Runs that come back, for requirements without inputs: compared with what arithmetic says."""

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.analysis.arena.budget import Budget
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.games.lassos import lasso
from fretc.analysis.games.unrolled_runs import NoShortRun, SatisfyingRun
from fretish.bindings.declarations import Role
from tests.effort import FULL, examples
from tests.requirement_sets import ROLES, analyzed, drawn, requirements, roles, staged

NAMED = roles([], ["v", "x"])
SOON = 3 if FULL else 0
"""Ticks: how far runs are unrolled."""
HIGH, LOW = (3, 1) if FULL else (1, 0)
COUNTED = (
    "the sw shall always satisfy x <-> v = preReal(9.0, v) + 1",
    "whenever x the sw shall at the next timepoint satisfy x | v > 4",
)
RATE = "the sw shall always satisfy absReal(v - preReal({}, v)) <= {}"


def found(*sentences: str, as_fret: bool = False) -> SatisfyingRun | NoShortRun | None:
    return lasso(requirements(*sentences), NAMED, Budget(60), as_fret=as_fret)


def values(run: SatisfyingRun) -> list[Fraction]:
    return [Fraction(str(each["v"].as_fraction())) for each in run.numbers]


@pytest.mark.slow
@examples(6)
@given(st.integers(-3, 3), st.integers(1, 4), st.integers(0, 6), st.integers(-8, 12), st.booleans())
def test_a_goal_is_reached_just_where_the_rate_lets_it(
    first: int, rate: int, bound: int, goal: int, strict: bool
) -> None:
    """At tick n the number is at most `first + rate * (n + 1)`."""
    sign = ">" if strict else ">="
    sentences = (
        RATE.format(f"{first}.0" if first >= 0 else f"-{-first}.0", rate),
        f"the sw shall within {bound} ticks satisfy v {sign} {goal}",
    )
    highest = first + rate * (bound + 1)
    run = found(*sentences)
    if highest > goal or (highest == goal and not strict):
        assert isinstance(run, SatisfyingRun)
        known = values(run)
        assert run.loop is not None
        assert all(abs(b - a) <= rate for a, b in pairwise([Fraction(first), *known]))
        assert abs(known[run.loop] - known[-1]) <= rate
        assert max(known[: bound + 1]) >= goal
    else:
        assert isinstance(run, NoShortRun)
        assert run.ticks == bound + 1
        assert run.of <= {"R1", "R2"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentences", "verdict"),
    [
        (["the sw shall eventually satisfy v > 5"], RealizabilityVerdict.REALIZABLE),
        (
            [f"the sw shall within {SOON} ticks satisfy v > {SOON + 2}"],
            RealizabilityVerdict.UNREALIZABLE,
        ),
        (
            [
                f"whenever v > {HIGH} the sw shall eventually satisfy v < {LOW}",
                f"whenever v < {LOW} the sw shall eventually satisfy v > {HIGH}",
                *(COUNTED if FULL else ()),
            ],
            RealizabilityVerdict.REALIZABLE,
        ),
        (
            ["the sw shall always satisfy v >= preReal(0.0, v) + 0.5 & v < 9"],
            RealizabilityVerdict.UNREALIZABLE,
        ),
    ][: 4 if FULL else 3],  # the last one takes longest
)
def test_what_no_memory_of_comparisons_tells_is_unrolled(
    sentences: list[str], verdict: RealizabilityVerdict
) -> None:
    whole = analyzed(RATE.format("0.0", 1), *sentences, roles=NAMED)
    assert whole.verdict is verdict
    assert whole.consistent is (verdict is RealizabilityVerdict.REALIZABLE)


@pytest.mark.slow
def test_what_never_comes_back_is_not_known() -> None:
    """A run that grows for ever keeps it; there is no lasso, and no end."""
    assert found("the sw shall always satisfy v > preReal(0.0, v)") is None


def test_a_demand_that_stays_open_is_not_met_by_coming_back() -> None:
    rising = "the sw shall always satisfy v = preReal(0.0, v) + 1 | v = 0"
    run = found(rising, "whenever v < 9 the sw shall eventually satisfy v > 4")
    assert isinstance(run, SatisfyingRun)
    assert max(values(run)[run.loop :]) > 4


@pytest.mark.slow
def test_without_numbers_it_is_as_the_game_says() -> None:
    """Over all scopes, conditions and timings, where the system chooses everything."""
    own = dict.fromkeys(ROLES, Role.OUTPUT)
    seen = set()
    for seed in range(60) if FULL else range(25, 36):
        for as_fret in (False, True):
            sentences = drawn(("lassos", seed), most=5)
            game = staged(*sentences, roles=own, as_fret=as_fret)
            is_kept = game.game(game.arena.counters, Budget(60)).solution().is_realizable
            run = lasso(requirements(*sentences), own, Budget(60), as_fret=as_fret)
            assert isinstance(run, SatisfyingRun) is is_kept, sentences
            seen.add(is_kept)
    assert seen == {True, False}


def test_as_fret_nothing_is_pending_at_any_tick() -> None:
    sentences = (RATE.format("0.0", 1), "the sw shall eventually satisfy v > 5")
    assert isinstance(found(*sentences), SatisfyingRun)
    assert isinstance(found(*sentences, as_fret=True), NoShortRun)


@pytest.mark.slow
def test_a_number_before_is_not_known_where_there_are_inputs() -> None:
    """Then one run shows nothing of the others."""
    jump = "whenever x the sw shall immediately satisfy v >= 5"
    named = roles(["x"], ["v"])
    whole = analyzed(RATE.format("0.0", 1), jump, roles=named)
    assert whole.verdict is not RealizabilityVerdict.REALIZABLE
