"""Names with numbers in them are in the order of the numbers."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.natural_order import by_place, natural


def test_numbers_count_and_not_their_digits() -> None:
    ordered = ["", "1", "R1", "R02", "R2", "R2a", "R10", "R10.2", "R10.10", "S1", "r1", "ä1"]
    assert sorted(random.Random(1).sample(ordered, len(ordered)), key=natural) == ordered


def test_a_number_of_any_length_can_be_compared() -> None:
    assert natural("R" + "9" * 5000) < natural("R1" + "0" * 5000)


@given(st.lists(st.integers(0, 10**20)), st.text("abR.-", min_size=1))
def test_the_same_name_with_a_number_is_in_the_order_of_the_number(
    numbers: list[int], name: str
) -> None:
    found = sorted((f"{name}{number}x" for number in numbers), key=natural)
    assert found == [f"{name}{number}x" for number in sorted(numbers)]


@pytest.mark.slow
@given(st.lists(st.text("aR0129.²٣"), unique=True), st.randoms(use_true_random=False))
def test_the_order_is_one_and_the_same(names: list[str], chance: random.Random) -> None:
    shuffled = chance.sample(names, len(names))
    assert sorted(names, key=natural) == sorted(shuffled, key=natural)


@given(st.lists(st.tuples(st.sampled_from(["r2", "r10", "b"]), st.integers(0, 9))))
def test_diagnostics_are_ordered_by_file_and_place(places: list[tuple[str, int]]) -> None:
    nowhere = Diagnostic(Code.INTERNAL, "")
    some = [Diagnostic(Code.INTERNAL, "", Source(n, "x\n" * 9).span(at, at)) for n, at in places]
    found = by_place([*some, nowhere])
    assert found[0] is nowhere
    keys = [(d.span.source.name, d.span.start) for d in found[1:] if d.span is not None]
    assert keys == sorted(places, key=lambda p: (["b", "r2", "r10"].index(p[0]), p[1]))
