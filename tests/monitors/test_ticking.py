"""Ticks, late messages, and what is judged again: each against its definition."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

import fretc
from monitors.kernel import Monitor
from monitors.loading import load
from monitors.ticking import JUMP, Ledger, Ticking, is_jump, late

PERIOD = 10
TOPICS = ("/a", "/b", "/c")
Messages = list[tuple[str, int]]


def naive_origin(messages: Messages) -> int:
    """As the documentation says it."""
    firsts = {topic: min(t for each, t in messages if each == topic) for topic, _ in messages}
    start, last = min(firsts.values()), max(firsts.values())
    return last if last - start < PERIOD else start


messages = st.lists(st.tuples(st.sampled_from(TOPICS), st.integers(1, 60)), min_size=1, max_size=12)


@given(messages, st.integers(0, 9), st.integers(1, 80))
def test_ticks_are_those_of_the_whole_log_however_time_passes(
    found: Messages, phase: int, pace: int
) -> None:
    end = max(time for _, time in found)
    ticking, passed = Ticking(TOPICS, PERIOD, phase), 0
    ticks: list[int] = []
    for topic, time in sorted(found, key=lambda each: each[1]):
        while passed + pace <= time:
            passed += pace
            ticks += ticking.until(passed)
        ticking.arrive(topic, time)
    ticks += ticking.end(end)
    assert ticks == list(range(naive_origin(found) + phase, end + 1, PERIOD))
    assert ticking.origin == (naive_origin(found) if ticks else None)


def test_no_tick_is_placed_while_a_topic_may_move_the_grid() -> None:
    ticking = Ticking(("/a", "/b"), PERIOD)
    ticking.arrive("/a", 5)
    assert list(ticking.until(14)) == []
    assert list(ticking.waiting) == ["/b"]
    ticking.arrive("/b", 14)
    assert list(ticking.until(15)) == [14]
    assert not ticking.waiting


def test_a_clock_of_messages_ticks_with_each_of_them() -> None:
    ticking = Ticking(("/a", "/c"), None, clock="/c")
    for topic, time in (("/c", 7), ("/a", 3), ("/c", 7), ("/c", 9)):
        ticking.arrive(topic, time)
    assert list(ticking.until(9)) == [7, 7]
    assert list(ticking.end(9)) == [9]


@given(st.integers(0, 50), st.integers(0, 50), st.integers(0, 20), st.integers(0, 60))
def test_late_are_ticks_that_were_judged_before_the_arrival(
    time: int, arrival: int, lateness: int, tick: int
) -> None:
    span = late(time, arrival, lateness)
    is_late = span is not None and span[0] <= tick <= span[1]
    assert is_late == (time <= tick and tick + lateness < arrival)


def test_a_clock_that_was_set_back_is_no_late_message() -> None:
    assert not is_jump(None, 5)
    assert not is_jump(2 * JUMP, JUMP)
    assert is_jump(2 * JUMP, JUMP - 1)


SENTENCES = (
    "whenever p the robot shall within 2 ticks satisfy q",
    "the robot shall always satisfy p",
    "the robot shall before q satisfy p",
    "upon p the robot shall for 3 ticks satisfy q",
)
truth = st.sampled_from([True, False, None])
rows = st.lists(st.fixed_dictionaries({"p": truth, "q": truth}), max_size=200)
names = st.lists(st.sampled_from("pq"), min_size=1, unique=True)


def monitors() -> list[Monitor]:
    return [load("m", fretc.monitor_text(fretc.formalize(each))) for each in SENTENCES]


def states(some: Sequence[Monitor]) -> list[object]:
    return [(each.tick, each.statuses()) for each in some]


@pytest.fixture(scope="module")
def pairs() -> tuple[list[Monitor], list[Monitor]]:
    return monitors(), monitors()


@pytest.mark.slow
@given(
    rows=rows,
    changes=st.lists(
        st.tuples(st.integers(0, 200), st.integers(0, 30), st.integers(0, 90), names), max_size=4
    ),
)
def test_a_tick_that_becomes_unknown_is_as_if_it_always_had_been(
    pairs: tuple[list[Monitor], list[Monitor]],
    rows: list[dict[str, bool | None]],
    changes: list[tuple[int, int, int, list[str]]],
) -> None:
    """Each change comes after so many rows, and reaches so many ticks back."""
    for each in (*pairs[0], *pairs[1]):
        each.reset()
    ledger, final, known = Ledger(pairs[0]), [dict(row) for row in rows], set[int]()
    for i, row in enumerate(rows):
        ledger.advance(i * PERIOD, row)
        for after, length, back, changed in changes:
            if after == i:
                first = max(0, i - back)
                last = min(i, first + length)
                for k in range(first, last + 1):
                    if any(final[k][name] is not None for name in changed):
                        known.add(k)
                    final[k].update(dict.fromkeys(changed))
                ledger.withdraw(first * PERIOD, last * PERIOD, changed)
    for each in pairs[1]:
        each.advance(final)
    assert states(pairs[0]) == states(pairs[1])
    assert (ledger.late, ledger.beyond) == (len(known), 0)


@given(rows=rows.filter(bool), place=st.integers(0, 200))
def test_a_late_tick_stands_where_its_time_is(
    pairs: tuple[list[Monitor], list[Monitor]], rows: list[dict[str, bool | None]], place: int
) -> None:
    place = min(place, len(rows))
    for each in (*pairs[0], *pairs[1]):
        each.reset()
    ledger = Ledger(pairs[0])
    for i, row in enumerate(rows):
        ledger.advance(i * PERIOD, row)
    ledger.insert(place * PERIOD - 1, ("p", "q"))
    for each in pairs[1]:
        each.advance([*rows[:place], {"p": None, "q": None}, *rows[place:]])
    assert states(pairs[0]) == states(pairs[1])


def test_what_is_not_kept_any_more_is_counted() -> None:
    ledger = Ledger(monitors(), kept=100)
    for i in range(1000):
        ledger.advance(i, {"p": True, "q": True})
    assert ledger.withdraw(899, 899, ("p",)) == 1
    assert (ledger.late, ledger.beyond) == (1, 0)
    assert ledger.withdraw(899, 899, ("p", "q")) == 1
    assert ledger.withdraw(3, 3, ("p",)) == 0
    for i in range(1000, 2000):
        ledger.advance(i, {"p": True, "q": True})
    assert (ledger.late, ledger.beyond) == (1, 1)
