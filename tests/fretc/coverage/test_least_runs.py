"""The fewest runs that show all, against trying every choice of runs."""

import random
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.coverage import least_runs as least
from fretc.coverage.least_runs import least_runs
from tests.programs import needs_package

AIMS = st.lists(st.frozensets(st.integers(0, 6), min_size=1), max_size=10)


def fewest(aims: list[frozenset[int]]) -> int:
    """By trying all choices, the small ones first."""
    return next(
        size
        for size in range(8)
        for chosen in combinations(range(7), size)
        if all(aim & {*chosen} for aim in aims)
    )


@given(AIMS)
def test_so_many_runs_are_needed(aims: list[frozenset[int]]) -> None:
    found = least_runs(aims)
    assert found.is_exact
    assert all(aim & {*found.runs} for aim in aims)
    assert len(found.runs) == fewest(aims)


@given(AIMS, st.sampled_from(["_CELLS", "_NODES"]), st.integers(-1, 4))
def test_without_an_end_of_the_search_the_answer_shows_all_and_says_so(
    aims: list[frozenset[int]], name: str, limit: int
) -> None:
    exact = least_runs(aims)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(least, name, limit)
        found = least_runs(aims)
    assert all(aim & {*found.runs} for aim in aims)
    assert len(found.runs) >= len(exact.runs)
    assert not found.is_exact or len(found.runs) == len(exact.runs)


@needs_package("scipy")
@pytest.mark.slow
def test_of_many_runs_no_fewer_do_by_an_integer_program() -> None:
    from scipy.optimize import Bounds, LinearConstraint, milp

    choose = random.Random(7)
    for count, size, chance in ((20, 60, 0.2), (40, 150, 0.1), (60, 200, 0.05)):
        table = [[choose.random() < chance for _ in range(count)] for _ in range(size)]
        aims = [frozenset(np.flatnonzero(row).tolist()) for row in table if any(row)]
        rows = np.array([row for row in table if any(row)], np.float64)
        ones = np.ones(count)
        best = milp(ones, integrality=ones, bounds=Bounds(0, 1),
                    constraints=LinearConstraint(rows, lb=1))  # fmt: skip
        found = least_runs(aims)
        assert found.is_exact
        assert all(aim & {*found.runs} for aim in aims)
        assert len(found.runs) == round(best.fun)


def test_the_same_runs_give_the_same_answer_in_any_order() -> None:
    aims = [frozenset(each) for each in ([0, 1], [1, 2], [2, 3], [3, 0], [4])]
    assert least_runs(aims) == least_runs(aims[::-1])
