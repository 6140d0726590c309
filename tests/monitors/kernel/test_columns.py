"""Columns of whole traces: each operator against its definition, tick by tick."""

import itertools
import tracemalloc
from collections.abc import Sequence
from itertools import pairwise, product
from typing import Any
from unittest import mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from monitors.kernel import columns as c
from monitors.kernel.verdicts import Truth

Bits = list[bool]
bits = st.lists(st.booleans(), max_size=70)
pairs = st.integers(0, 70).flatmap(
    lambda n: st.tuples(*(st.lists(st.booleans(), min_size=n, max_size=n),) * 2)
)
bounds = st.tuples(st.integers(0, 80), st.one_of(st.none(), st.integers(0, 80))).map(
    lambda pair: (pair[0], None if pair[1] is None else pair[0] + pair[1])
)


def number(values: Sequence[bool]) -> int:
    return sum(1 << i for i, value in enumerate(values) if value)


def since(left: Bits, right: Bits, lo: int, hi: int | None) -> Bits:
    """`left S[lo,hi] right`, from its definition."""

    def at(t: int) -> bool:
        first = 0 if hi is None else max(0, t - hi)
        return any(right[j] and all(left[j + 1 : t + 1]) for j in range(first, t - lo + 1))

    return [at(t) for t in range(len(left))]


def inverted(values: Bits) -> Bits:
    return [not value for value in values]


def every(values: Sequence[object]) -> int:
    return (1 << len(values)) - 1


@pytest.mark.slow
@given(pairs)
def test_since(both: tuple[Bits, Bits]) -> None:
    left, right = both
    assert c.since(number(left), number(right)) == number(since(left, right, 0, None))


@pytest.mark.slow
@given(pairs)
def test_released_is_the_dual_of_since(both: tuple[Bits, Bits]) -> None:
    left, right = both
    dual = inverted(since(inverted(left), inverted(right), 0, None))
    assert c.released(number(left), number(right)) == number(dual)


@pytest.mark.slow
@given(pairs, bounds)
def test_since_between(both: tuple[Bits, Bits], ago: tuple[int, int | None]) -> None:
    left, right = both
    found = c.since_between(number(left), number(right), *ago, every(left))
    assert found == number(since(left, right, *ago))


@given(pairs, bounds)
def test_released_between_is_its_dual(both: tuple[Bits, Bits], ago: tuple[int, int | None]) -> None:
    left, right = both
    dual = inverted(since(inverted(left), inverted(right), *ago))
    assert c.released_between(number(left), number(right), *ago, every(left)) == number(dual)


@pytest.mark.slow
@given(pairs, st.integers(0, 80))
def test_since_from(both: tuple[Bits, Bits], lo: int) -> None:
    """Also where each witness lies within the left side: then it is found in another way."""
    left, right = both
    within = [a and b for a, b in zip(left, right, strict=True)]
    for seen in (right, within):
        held = c.since(number(left), number(seen))
        found = c.since_from(held, number(left), number(seen), lo, every(left))
        assert found == number(since(left, seen, lo, None))


@given(bits, bounds)
def test_once_and_historically(values: Bits, ago: tuple[int, int | None]) -> None:
    always = [True] * len(values)
    once = since(always, values, *ago)
    assert c.once(number(values), *ago, every(values)) == number(once)
    never = inverted(since(always, inverted(values), *ago))
    assert c.historically(number(values), *ago, every(values)) == number(never)


@given(bits)
def test_previous(values: Bits) -> None:
    strong, weak = [False, *values][: len(values)], [True, *values][: len(values)]
    assert c.previous(number(values), every(values)) == number(strong)
    assert c.weak_previous(number(values), every(values)) == number(weak)


def test_operators_on_every_short_trace() -> None:
    for length in range(5):
        for left, right in product(map(list, product((False, True), repeat=length)), repeat=2):
            for lo, hi in [(0, None), (1, None), (2, None), (0, 1), (1, 1), (1, 3), (0, 9)]:
                found = c.since_between(number(left), number(right), lo, hi, every(left))
                assert found == number(since(left, right, lo, hi)), (left, right, lo, hi)


def test_a_bound_beyond_the_trace_costs_no_memory() -> None:
    """Shifting by it would take 10^15 bits."""
    far = 10**15
    assert c.once(5, far, None, 7) == c.since_between(7, 5, far, None, 7) == 0
    assert c.once(1, 0, far, 7) == c.historically(3, far, far, 7) == 7


@given(pairs, st.integers(0, 80) | st.just(10**15))
def test_until(both: tuple[Bits, Bits], most: int) -> None:
    left, right = both

    def at(t: int) -> bool:
        later = range(t, min(t + most + 1, len(left)))
        return any(right[j] and all(left[t:j]) for j in later)

    expected = [at(t) for t in range(len(left))]
    assert c.until(number(left), number(right), most) == number(expected)


# Ticks and runs -------------------------------------------------------------------------------


@given(bits)
def test_the_ticks_of_a_column_are_those_of_its_bits(values: Bits) -> None:
    assert list(c.ticks_of(number(values))) == [i for i, value in enumerate(values) if value]


@given(bits)
def test_the_first_tick_of_a_column_is_that_of_its_lowest_bit(values: Bits) -> None:
    assert c.first_of(number(values)) == (values.index(True) if True in values else None)


@given(bits)
def test_runs_are_maximal_and_cover_every_tick(values: Bits) -> None:
    runs = list(c.runs_of(number(values)))
    covered = [tick for first, last in runs for tick in range(first, last + 1)]
    assert covered == [i for i, value in enumerate(values) if value]
    assert all(first > last + 1 for (_, last), (first, _) in pairwise(runs))
    assert c.starts_of(number(values)) == sum(1 << first for first, _ in runs)


@given(st.lists(st.tuples(*(st.sampled_from([True, False, None]),) * 2), max_size=40))
def test_rows_become_columns_and_truth_values_again(rows: list[tuple[Truth, Truth]]) -> None:
    ticks, made = c.columns_of(c.pieces_of(rows), 2)
    assert ticks == len(rows)
    for place, column in enumerate(made):
        assert c.truths(column, ticks) == [row[place] for row in rows]
        assert [column.at(tick) for tick in range(ticks)] == [row[place] for row in rows]
        assert not column.true & column.unknown


@given(st.lists(st.lists(st.sampled_from([0, 1, 2]), max_size=20), max_size=8))
def test_a_tape_is_the_column_of_all_its_parts(parts: list[list[int]]) -> None:
    tape = c.Tape()
    for part in parts:
        tape.append(bytes(part))
    assert tape.column() == c.column(bytes(itertools.chain.from_iterable(parts)))


@given(st.lists(st.tuples(*(st.sampled_from([True, False, None]),) * 2), max_size=40))
def test_rows_come_out_of_columns_in_stretches(rows: list[tuple[Truth, Truth]]) -> None:
    ticks, made = c.columns_of(c.pieces_of(rows), 2)
    for stretch in (1, 2, 64):
        with mock.patch.object(c, "_STRETCH", stretch):
            assert list(c.rows_of(made, ticks)) == rows


def test_a_trace_without_propositions_has_ticks_too() -> None:
    assert c.columns_of(c.pieces_of([()] * 5000), 0) == (5000, ())
    assert list(c.rows_of((), 3)) == [(), (), ()]


def test_a_trace_is_held_in_two_bits_a_value() -> None:
    pieces = itertools.repeat(c.Piece(4000, [b"\0\1\2\1" * 1000]), 200)
    tracemalloc.start()
    ticks, _ = c.columns_of(pieces, 1)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 3 * 2 * ticks / 8  # both as bytes, and as numbers beside them


@pytest.mark.parametrize("value", [True, False, None])
def test_a_column_can_be_followed_by_one_more_value(value: Truth) -> None:
    _, (column,) = c.columns_of(c.pieces_of([(True,), (None,), (False,)]), 1)
    assert c.truths(column.followed(value, 3), 4) == [True, None, False, value]


def test_booleans_of_numpy_are_truth_values() -> None:
    rows: Any = [(np.True_,), (np.False_,), (None,), (np.array([3]) > 2)]
    ticks, (column,) = c.columns_of(c.pieces_of(rows), 1)
    assert c.truths(column, ticks) == [True, False, None, True]


@pytest.mark.parametrize(
    "value",
    [np.int64(1), np.float64(1), np.array([True]), 0, 1, 2, "1", "", float("nan"), 1.0, "true"],
)
def test_nothing_else_is_a_truth_value(value: object) -> None:
    with pytest.raises(TypeError, match="a truth value is True, False or None"):
        list(c.pieces_of([(value,)]))  # type: ignore[list-item]


@pytest.mark.parametrize("row", [(), (True, True, True)])
def test_a_row_has_one_value_for_each_column(row: tuple[bool, ...]) -> None:
    with pytest.raises(ValueError, match="there are more or fewer values than expected"):
        c.columns_of(c.pieces_of([row]), 2)
