"""What is tried where not everything is: no kind of case is left out."""

from itertools import combinations, product

from hypothesis import given
from hypothesis import strategies as st

from tests.effort import FULL, pairwise
from tests.strategies import some_templates, templates


@given(st.lists(st.integers(1, 6), min_size=1, max_size=4))
def test_any_two_values_meet_in_some_combination_and_none_comes_twice(lengths: list[int]) -> None:
    found = pairwise(*map(range, lengths))
    assert {*found} <= {*product(*map(range, lengths))}
    assert len({*found}) == len(found)
    for one, other in combinations(range(len(lengths)), 2):
        met = {(case[one], case[other]) for case in found}
        assert len(met) == lengths[one] * lengths[other]


def test_some_templates_are_a_third_and_all_with_the_full_profile() -> None:
    some, every = some_templates(), [*templates()]
    assert {*some} <= {*every}
    assert len(some) == (len(every) if FULL else len(every) // 3)
