"""Windows: the bounded since of a step, from its definition."""

from collections.abc import Callable
from itertools import product

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from monitors.kernel.stepping import Window


def since(left: list[bool], right: list[bool], lo: int, hi: int, at: int) -> bool:
    """`left S[lo,hi] right`, from its definition."""
    return any(right[j] and all(left[j + 1 : at + 1]) for j in range(at + 1) if lo <= at - j <= hi)


@given(st.integers(0, 4), st.integers(0, 4), st.lists(st.tuples(st.booleans(), st.booleans())))
@example(0, 2, [(True, True), (True, False), (True, False), (True, False)])
@example(2, 1, [(True, True), (False, False), (True, False), (True, False)])
@example(1, 0, [(False, True), (False, True), (True, False)])
def test_a_window_is_the_bounded_since_of_its_definition(
    lo: int, more: int, rows: list[tuple[bool, bool]]
) -> None:
    left, right = [row[0] for row in rows], [row[1] for row in rows]
    window = Window(lo, lo + more)
    stepped = [window.step(*row) for row in rows]
    assert stepped == [since(left, right, lo, lo + more, at) for at in range(len(rows))]


@pytest.mark.parametrize("lo", range(4))
@pytest.mark.parametrize("more", range(3))
def test_a_window_is_its_definition_on_every_short_trace(lo: int, more: int) -> None:
    for rows in product(product((False, True), repeat=2), repeat=5):
        left, right = [row[0] for row in rows], [row[1] for row in rows]
        window = Window(lo, lo + more)
        stepped = [window.step(*row) for row in rows]
        assert stepped == [since(left, right, lo, lo + more, at) for at in range(5)], rows


@pytest.mark.parametrize("hi", [3, 10**6])
def test_a_window_remembers_runs_and_not_ticks(hi: int) -> None:
    window = Window(hi, hi)
    for _ in range(10_000):
        window.step(left=True, right=True)
    assert len(window.state()) == 1


@given(st.integers(0, 4), st.integers(0, 4), st.lists(st.tuples(st.booleans(), st.booleans())))
def test_a_window_goes_on_from_its_state(lo: int, more: int, rows: list[tuple[bool, bool]]) -> None:
    window, other = Window(lo, lo + more), Window(lo, lo + more)
    for row in rows:
        other.restore(window.state())
        assert other.step(*row) == window.step(*row)
        assert other.state() == window.state()


def test_the_state_of_a_window_does_not_tell_when_it_is() -> None:
    window = Window(2, 3)
    states = [(window.step(left=True, right=True), window.state())[1] for _ in range(10)]
    assert len(set(states)) == 4


# Copies ---------------------------------------------------------------------------------------


def assert_alike_by_state(window: Window, fork: Window) -> None:
    """Windows whose clocks agree: both go on with right false up to the same tick."""
    one, other = window.copy(), fork.copy()
    while one.now != other.now:
        min(one, other, key=lambda each: each.now).step(left=True, right=False)
    assert one.is_like(other) == (one.state() == other.state())


ON, OFF = (True, True), (True, False)
Pairs = st.lists(st.tuples(st.booleans(), st.booleans()), max_size=8)


def stepped(lo: int, hi: int, rows: list[tuple[bool, bool]]) -> Window:
    window = Window(lo, hi)
    for row in rows:
        window.step(*row)
    return window


@given(
    st.integers(0, 3),
    st.integers(0, 6),
    Pairs,
    st.lists(st.tuples(Pairs, Pairs, st.booleans()), max_size=5),
)
@example(1, 6, [ON, OFF] * 3, [([ON] * 2, [OFF], True)] * 2)
@example(0, 6, [ON, OFF] * 2, [([ON, OFF] * 2, [], True)])
@example(0, 9, [ON, OFF, ON, OFF], [([ON, OFF, ON], [OFF, OFF, ON], False)])
def test_a_fork_and_its_window_go_their_own_ways_however_often_both_go_back(
    lo: int,
    more: int,
    before: list[tuple[bool, bool]],
    pieces: list[tuple[list[tuple[bool, bool]], list[tuple[bool, bool]], bool]],
) -> None:
    window = stepped(lo, lo + more, before)
    other = window.fork()
    sides = [(window, [*before]), (other, [*before])]
    for *both, fails in pieces:
        for place, rows in enumerate(both):
            one, history = sides[place]
            copy = one.copy()
            for row in rows:
                one.step(*row)
            sides[place] = (copy, history) if fails else (one, history + rows)
        for one, history in sides:
            assert one.state() == stepped(lo, lo + more, history).state()
        assert_alike_by_state(window=sides[0][0], fork=sides[1][0])


def test_a_fork_that_has_left_the_runs_of_its_window_behind_keeps_none_of_them() -> None:
    """The last one that both have leads to all that its window adds, for ever."""
    other = stepped(1, 5, [ON, OFF] * 3).fork()
    assert other.turn is not None
    for _ in range(6):
        other.step(left=True, right=False)
    assert {other.first, other.last, other.turn, other.branch} == {None}


@pytest.mark.parametrize("copied", [Window.copy, Window.fork])
def test_a_copy_shares_the_runs_that_have_ended(copied: Callable[[Window], Window]) -> None:
    window = stepped(9, 9, [ON, OFF] * 9)
    copy = copied(window)
    assert (copy.first, copy.last, copy.state()) == (window.first, window.last, window.state())


@pytest.mark.slow
def test_any_number_of_runs_can_be_forgotten_at_once() -> None:
    window = stepped(1, 10**6, [ON, OFF] * 200_000)
    window.step(left=False, right=False)
    assert window.state() == ()


@given(st.integers(0, 3), st.integers(0, 9), Pairs, Pairs, Pairs)
@example(0, 2, [], [ON] * 4 + [OFF], [OFF, *[ON] * 3])
@example(0, 9, [ON, ON], [OFF, ON], [])
@example(0, 9, [ON, ON, OFF, ON], [OFF, ON, OFF, ON], [])
def test_windows_of_one_state_are_alike(
    lo: int,
    more: int,
    first: list[tuple[bool, bool]],
    second: list[tuple[bool, bool]],
    after: list[tuple[bool, bool]],
) -> None:
    for rows in (first, second):
        window = stepped(lo, lo + more, rows)
        fork = window.fork()
        for one, history in ((window, second), (fork, first)):
            for row in (*history, *after):
                one.step(*row)
        assert_alike_by_state(window, fork)
    assert_alike_by_state(stepped(lo, lo + more, first), stepped(lo, lo + more, second))
