from itertools import pairwise
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.measurements.states import IDLE, OPEN, UNKNOWN, VIOLATED, states
from monitors.kernel import Outcome


def outcome(ticks: int = 20, **changes: Any) -> Outcome:
    nothing: dict[str, Any] = {"violations": (), "unknown": (), "triggers": (), "answers": ()}
    nothing |= {"open": (), "verdict": "satisfied", "finite": True, "first_violation": None}
    return Outcome("R1", ticks, **(nothing | changes))


def test_without_triggers_the_state_is_idle_all_the_time() -> None:
    assert states(outcome()) == ((0, IDLE),)
    assert states(outcome(ticks=0)) == ()


def test_a_demand_is_open_from_its_trigger_up_to_its_answer() -> None:
    changes = outcome(triggers=(3, 9), answers=((3, 5), (9, 9)))
    assert states(changes) == ((0, IDLE), (3, OPEN), (5, IDLE))


def test_a_demand_that_waits_at_the_end_is_open_up_to_the_end() -> None:
    assert states(outcome(triggers=(3,), open=((3, None),))) == ((0, IDLE), (3, OPEN))


def test_a_demand_that_is_broken_is_open_before() -> None:
    changes = outcome(triggers=(3, 6, 12), violations=((6, 8),), answers=((12, 14),))
    assert states(changes) == (
        (0, IDLE),
        (3, OPEN),
        (6, VIOLATED),
        (9, IDLE),
        (12, OPEN),
        (14, IDLE),
    )


def test_what_is_violated_counts_before_what_is_unknown_and_that_before_what_is_open() -> None:
    changes = outcome(triggers=(0,), answers=((0, 9),), unknown=((2, 6),), violations=((4, 5),))
    assert states(changes) == (
        (0, OPEN),
        (2, UNKNOWN),
        (4, VIOLATED),
        (6, UNKNOWN),
        (7, OPEN),
        (9, IDLE),
    )


RUNS = st.lists(st.tuples(st.integers(0, 19), st.integers(0, 19)).map(sorted), max_size=4)


@given(RUNS, RUNS, RUNS)
def test_each_tick_has_the_state_that_its_stretches_say(
    violations: list[list[int]], unknown: list[list[int]], answers: list[list[int]]
) -> None:
    answers = list({t: [t, k] for t, k in answers}.values())
    changes = states(
        outcome(
            violations=tuple(map(tuple, sorted(violations))),
            unknown=tuple(map(tuple, sorted(unknown))),
            triggers=tuple(sorted(t for t, _ in answers)),
            answers=tuple(map(tuple, answers)),
        )
    )
    assert all(one[1] != other[1] for one, other in pairwise(changes))
    for tick in range(20):
        (*_, (_, state)) = (change for change in changes if change[0] <= tick)
        if any(a <= tick <= b for a, b in violations):
            assert state == VIOLATED
        elif any(a <= tick <= b for a, b in unknown):
            assert state == UNKNOWN
        else:
            assert state == (OPEN if any(t <= tick < k for t, k in answers) else IDLE)
