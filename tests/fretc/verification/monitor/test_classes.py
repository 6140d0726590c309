"""Lock step by classes of states finds each difference that lock step by pairs finds."""

from hypothesis import given
from hypothesis import strategies as st

from fretc.verification.monitor import approximations

LETTERS = ((False,), (True,))


class Table:
    """A machine given by its table: what it gives, and its next state."""

    def __init__(self, rows: list[list[tuple[int, int]]]) -> None:
        self.rows, self.state = rows, 0

    def save(self) -> int:
        return self.state

    def step(self, state: int, letter: tuple[bool]) -> tuple[object, ...]:
        given, after = self.rows[state][letter[0]]
        self.state = after % len(self.rows)
        return (given,)


cells = st.tuples(st.integers(0, 1), st.integers(0, 4))
tables = st.lists(st.lists(cells, min_size=2, max_size=2), min_size=1, max_size=5).map(Table)


def first_difference(left: Table, right: Table) -> int | None:
    """The length of a shortest word that shows one, by all pairs of states."""
    level, seen, length = {(0, 0)}, {(0, 0)}, 0
    while level:
        length, after = length + 1, set()
        for first, second in level:
            for letter in LETTERS:
                if left.step(first, letter) != right.step(second, letter):
                    return length
                after.add((left.state, right.state))
        level = after - seen
        seen |= after
    return None


@given(tables, tables)
def test_classes_and_pairs_agree(left: Table, right: Table) -> None:
    expected = first_difference(left, right)
    left.state = right.state = 0
    result = approximations.in_lock_step(left, right, LETTERS, 10**6, ("given",))
    if expected is None:
        assert isinstance(result, approximations.Equivalent)
        assert result.states <= len(left.rows) + len(right.rows)
    else:
        assert isinstance(result, approximations.Distinguished)
        assert len(result.word) == expected
