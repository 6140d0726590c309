"""Checkpoints: never later than what was true, and close to it."""

from hypothesis import given
from hypothesis import strategies as st

from fretc.watch.checkpoints import Checkpoints

MS = 10**6


@given(st.lists(st.tuples(st.integers(1, 300), st.integers(1, 100)), min_size=1), st.integers(0))
def test_a_checkpoint_is_at_most_a_tenth_of_a_second_of_arrivals_behind(
    steps: list[tuple[int, int]], asked: int
) -> None:
    found, arrival, time = Checkpoints(), 0, 0
    true: list[tuple[int, int]] = []
    for after, more in steps:
        arrival, time = arrival + after * MS, time + more
        found.add(arrival, time)
        true.append((arrival, time))
    at = asked % (arrival + MS)
    until = [pair for pair in true if pair[0] <= at]
    latest = [time for _, time in until]
    behind = [time for arrival, time in until if arrival <= until[-1][0] - 100 * MS]
    answer = found.latest(at)
    assert (answer is None) == (not latest)
    if answer is not None:
        assert answer <= latest[-1]
        assert answer >= (behind[-1] if behind else true[0][1])


def test_memory_is_limited_and_the_answers_stay_true() -> None:
    found = Checkpoints()
    for i in range(1, 10_001):
        found.add(i * 200 * MS, i)
    assert len(found._arrivals) <= 2001
    for i in (1, 2, 5000, 9999, 10_000):
        answer = found.latest(i * 200 * MS)
        assert answer is not None
        assert answer <= i
    assert found.latest(10_000 * 200 * MS) == 10_000
    assert found.latest(0) is None
    assert found.first == 1
