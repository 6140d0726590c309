"""A new log changes one part, and no log is lost."""

from itertools import chain

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.store.parts import AVERAGE, MOST, parts

NAMES = [f"run{number:05}.mcap" for number in range(20 * AVERAGE)]


@given(st.lists(st.text(max_size=3), max_size=20))
def test_each_log_is_in_one_part_in_its_order(names: list[str]) -> None:
    assert [*chain.from_iterable(parts(names))] == [*range(len(names))]


def test_parts_are_neither_many_nor_large() -> None:
    sizes = [*map(len, parts(NAMES))]
    assert max(sizes) <= MOST
    assert AVERAGE / 2 < len(NAMES) / len(sizes) < MOST


@given(st.integers(0, len(NAMES)))
def test_a_new_log_changes_the_part_that_it_is_in_and_few_behind_it(at: int) -> None:
    names = [*NAMES[:at], "new.mcap", *NAMES[at:]]
    before = {tuple(NAMES[n] for n in part) for part in parts(NAMES)}
    after = {tuple(names[n] for n in part) for part in parts(names)}
    assert len(after - before) <= 6
