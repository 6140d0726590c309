"""Few conjunctions that hold where they should, and nowhere else."""

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from compiler.logic.implicants import cover, matches

VECTORS = list(product((False, True), repeat=4))


@given(st.lists(st.sampled_from(["on", "off", "either"]), min_size=16, max_size=16))
def test_the_terms_hold_at_the_first_and_at_none_of_the_others(kinds: list[str]) -> None:
    on = [v for v, kind in zip(VECTORS, kinds, strict=True) if kind == "on"]
    off = [v for v, kind in zip(VECTORS, kinds, strict=True) if kind == "off"]
    terms = cover(on, off)
    assert all(any(matches(term, v) for term in terms) for v in on)
    assert not any(matches(term, v) for term in terms for v in off)


def test_everything_is_one_empty_conjunction() -> None:
    assert cover(VECTORS, []) == [{}]


def test_a_disjunction_has_two_terms() -> None:
    p_or_not_q = [(False, False), (True, False), (True, True)]
    assert cover(p_or_not_q, [(False, True)]) == [{1: False}, {0: True}]
