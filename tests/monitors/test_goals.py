"""The status of goals, against the definition: sentences about lists of goals."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from monitors.goals import STATUSES, goal_status
from tests.effort import examples

Goal = tuple[int, int]
"""The nanosecond in which it was accepted, and its status."""
NONE, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = range(7)


def message(*goals: Goal) -> Any:
    statuses = []
    for stamp, status in goals:
        sec, nanosec = divmod(stamp, 10**9)
        info = SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec))
        statuses.append(SimpleNamespace(goal_info=info, status=status))
    return SimpleNamespace(status_list=statuses)


@pytest.mark.parametrize(
    ("goals", "status"),
    [
        ((), "none"),
        (((5, ACCEPTED),), "accepted"),
        (((10**9, EXECUTING), (2, SUCCEEDED)), "executing"),
        (((2, SUCCEEDED), (10**9, ABORTED)), "aborted"),
        (((7, CANCELED), (7, CANCELED)), "canceled"),
    ],
)
def test_the_status_is_that_of_the_goal_that_was_accepted_last(
    goals: tuple[Goal, ...], status: str
) -> None:
    assert goal_status(message(*goals), "latest") == STATUSES.index(status)


def test_what_is_not_certain_is_unknown() -> None:
    assert goal_status(message((7, CANCELED), (7, ABORTED)), "latest") is None
    assert goal_status(message((7, 0)), "latest") is None
    assert goal_status(message((7, 9)), "latest") is None
    assert goal_status(message((7, 9)), "any", ["aborted"]) is None


@examples(100)
@given(
    st.lists(st.tuples(st.integers(0, 3 * 10**9), st.integers(1, 6)), max_size=4),
    st.sets(st.sampled_from(STATUSES[1:]), min_size=1),
)
def test_any_and_all_are_what_they_say(goals: list[Goal], wanted: set[str]) -> None:
    words = {STATUSES[status] for _, status in goals}
    assert goal_status(message(*goals), "any", [*wanted]) == bool(words & wanted)
    assert goal_status(message(*goals), "all", [*wanted]) == bool(words and words <= wanted)


def test_a_message_of_another_type_has_no_statuses() -> None:
    with pytest.raises(AttributeError):
        goal_status(SimpleNamespace(data=3), "latest")
