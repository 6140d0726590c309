"""The fewest runs that show all, against trying every choice of runs."""

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from fretc.coverage import least_runs as least
from fretc.coverage.least_runs import least_runs

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


@given(AIMS)
def test_without_an_end_of_the_search_the_answer_shows_all_and_says_so(
    aims: list[frozenset[int]],
) -> None:
    exact = least_runs(aims)
    limit, least._CELLS = least._CELLS, -1
    try:
        found = least_runs(aims)
    finally:
        least._CELLS = limit
    assert all(aim & {*found.runs} for aim in aims)
    assert len(found.runs) >= len(exact.runs)
    assert not found.is_exact or len(found.runs) == len(exact.runs)


def test_the_same_runs_give_the_same_answer_in_any_order() -> None:
    aims = [frozenset(each) for each in ([0, 1], [1, 2], [2, 3], [3, 0], [4])]
    assert least_runs(aims) == least_runs(aims[::-1])
