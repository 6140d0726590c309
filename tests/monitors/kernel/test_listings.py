"""A listing is a tuple in all that can be done with it, though no tuple is made for it."""

import copy
import pickle
from collections.abc import Callable, Sequence
from itertools import groupby
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from monitors.kernel.listings import Listing, run_list, tick_list

lengths = st.sampled_from([0, 1, 63, 64, 65]) | st.integers(0, 80)
columns = lengths.flatmap(lambda ticks: st.integers(0, (1 << ticks) - 1))
LONG = (1 << 9000) - (1 << 4095) | 5
"""Its ticks come in more than one piece."""


def ticks(column: int) -> tuple[int, ...]:
    return tuple(tick for tick in range(column.bit_length()) if column >> tick & 1)


def runs(column: int) -> tuple[tuple[int, int], ...]:
    """Ticks that follow each other have the same distance from their places."""
    groups = groupby(enumerate(ticks(column)), lambda pair: pair[1] - pair[0])
    stretches = [[tick for _, tick in group] for _, group in groups]
    return tuple((stretch[0], stretch[-1]) for stretch in stretches)


KINDS: dict[Callable[[int], Listing[Any]], Callable[[int], tuple[Any, ...]]] = {
    tick_list: ticks,
    run_list: runs,
}

OPERATIONS: dict[str, Callable[[Sequence[Any]], object]] = {
    "length": len,
    "truth": bool,
    "iteration": list,
    "backwards": lambda x: list(reversed(x)),
    "text": repr,
    "hash": hash,
    "as a key": lambda x: {x: 1},
    "ends": lambda x: (x[0], x[-1]) if x else None,
    "slices": lambda x: [x[1:], x[:-1], x[::-2], x[5:2], x[:]],
    "membership": lambda x: [place in x for place in (0, 7, (0, 0), None)],
    "places": lambda x: [(x.index(item), x.count(item)) for item in x[:5]],
    "sum": lambda x: [x + (1,), (1,) + x, x + x],  # type: ignore[operator]
    "product": lambda x: [x * 2, 2 * x],  # type: ignore[operator]
    "order": lambda x: [(x < y, x <= y, x > y, x >= y, y < x) for y in ((), x, x[1:])],  # type: ignore[operator]
    "equality": lambda x: [x == y for y in ((), x[:], x[1:], list(x), None)],
    "difference": lambda x: [x != y for y in ((), x[:], x[1:], list(x), None)],
    "greatest": lambda x: max(x, default=None),
    "copy": lambda x: (copy.copy(x), copy.deepcopy(x)),
    "pickle": lambda x: pickle.loads(pickle.dumps(x)),
    "unpacking": lambda x: [*x],
}


@pytest.mark.slow
@example(LONG)
@given(columns)
def test_each_operation_gives_what_it_gives_of_the_tuple(column: int) -> None:
    for listing, eager in KINDS.items():
        for name, operation in OPERATIONS.items():
            expected = operation(eager(column))
            assert operation(listing(column)) == expected, name
            used = listing(column)
            assert used[:] == eager(column)
            assert operation(used) == expected, f"{name}, after a slice"


@given(columns, columns)
def test_listings_compare_as_their_tuples_do(left: int, right: int) -> None:
    for listing, eager in KINDS.items():
        for one, other in ((left, right), (left, left)):
            lazy, tuples = (listing(one), listing(other)), (eager(one), eager(other))
            assert (lazy[0] == lazy[1]) is (tuples[0] == tuples[1])
            assert (lazy[0] < lazy[1]) is (tuples[0] < tuples[1])
            assert (tuples[0] < lazy[1]) is (lazy[0] < tuples[1]) is (tuples[0] < tuples[1])
            assert tuples[0] == lazy[0]


def test_a_listing_refuses_what_a_tuple_refuses() -> None:
    listing: Any = tick_list(0b101)
    with pytest.raises(IndexError):
        listing[2]
    with pytest.raises(TypeError):
        listing + [1]
    with pytest.raises(TypeError):
        listing < [1]  # noqa: B015


def test_a_copy_in_another_process_carries_no_columns() -> None:
    listing = tick_list(1 << 10**6)
    assert type(pickle.loads(pickle.dumps(listing))) is tuple
    assert len(pickle.dumps(listing)) < 100


def test_the_length_needs_no_items() -> None:
    def items() -> Any:
        raise AssertionError("they are asked for")

    assert len(Listing(lambda: 0b1011, items)) == 3
    assert not Listing(lambda: 0, items)
