from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fretc.logs.signals.propositions import evaluate
from fretc.logs.signals.samples import Recording, Samples, Topic
from fretc.logs.signals.traces import Trace, timeline, trace
from monitors.kernel.columns import truths
from tests.fretc.logs.logs import MS, S, declare

Value = bool | None


def bindings(aggregate: str = "last", tick: str = "10 ns", extra: str = "") -> str:
    return (
        f'[clock]\ntick = "{tick}"\n[signal.x]\npath = "/x.data"\n'
        f'[proposition.p]\nexpr = "x < 5"\nagg = "{aggregate}"\n{extra}'
    )


def recording(
    pairs: Sequence[tuple[int, float]],
    start: int = 0,
    end: int = 50,
    ticks: Sequence[int] = (),
) -> Recording:
    times = np.array([time for time, _ in pairs], np.int64)
    values = np.array([value for _, value in pairs], np.float64)
    samples = {"x": Samples(times, values)}
    return Recording(
        "log", "", 0, start, end, samples, np.array(ticks, np.int64), (), {}, {}, (), True
    )


def values(found: Trace) -> list[Value]:
    """The column of p."""
    return truths(found.columns["p"], len(found.timeline.times))


def column(
    pairs: Sequence[tuple[int, float]], aggregate: str, end: int = 50, extra: str = ""
) -> list[Value]:
    declarations = declare(bindings(aggregate, extra=extra))
    return values(trace(declarations, recording(pairs, end=end), ["p"]))


LOW, HIGH, NAN = 1.0, 9.0, float("nan")


@pytest.mark.parametrize(
    ("end", "ticks"), [(7, [7]), (16, [7]), (26, [7, 17]), (27, [7, 17, 27]), (28, [7, 17, 27])]
)
def test_whole_ticks_come_each_period_up_to_the_last_message(end: int, ticks: list[int]) -> None:
    found = timeline(declare(bindings()), recording([], start=7, end=end))
    assert found.times.tolist() == ticks
    assert found.period == 10


def cut(pairs: list[tuple[int, float]], aggregate: str, end: int) -> Value:
    """What the tick sees that the end of the log cuts short."""
    found = trace(declare(bindings(aggregate)), recording(pairs, end=end), ["p"]).cut
    assert found is not None
    return found["p"]


@pytest.mark.parametrize(
    ("phase", "ticks"), [(0, [7, 17, 27]), (1, [8, 18]), (9, [16, 26]), (3, [10, 20])]
)
def test_a_phase_shifts_the_grid_and_the_first_tick_sees_all_since_the_log_began(
    phase: int, ticks: list[int]
) -> None:
    declarations = declare(bindings("any", extra="").replace("[sig", f'phase = "{phase} ns"\n[sig'))
    found = trace(declarations, recording([(7, LOW), (8, HIGH)], start=7, end=27), ["p"])
    assert found.timeline.times.tolist() == ticks
    assert values(found)[0] is True


def test_a_phase_behind_the_end_of_the_log_leaves_no_tick() -> None:
    declarations = declare(bindings().replace("[sig", 'phase = "5 ns"\n[sig'))
    found = trace(declarations, recording([(0, LOW)], end=4), ["p"])
    assert (values(found), found.cut) == ([], None)


def test_a_log_whose_end_is_on_the_grid_has_no_cut_tick() -> None:
    log = recording([(0, HIGH), (20, LOW)], end=20)
    assert trace(declare(bindings("last")), log, ["p"]).cut is None


def test_a_pulse_after_the_last_whole_tick_is_seen_by_the_cut_one() -> None:
    pulse, break_ = [(0, HIGH), (23, LOW), (24, HIGH)], [(0, LOW), (23, HIGH), (24, LOW)]
    assert column(pulse, "any", end=26) == [False, False, False]
    assert cut(pulse, "any", end=26) is True
    assert cut(pulse, "last", end=26) is False
    assert cut(break_, "all", end=26) is False


def test_a_sample_at_the_very_end_counts_for_the_cut_tick() -> None:
    assert column([(0, HIGH), (26, LOW)], "last", end=26) == [False, False, False]
    assert cut([(0, HIGH), (26, LOW)], "last", end=26) is True


@pytest.mark.parametrize(("max_age", "last"), [(5, None), (6, True), (7, True)])
def test_what_expires_after_the_end_changes_nothing_at_the_cut_tick(
    max_age: int, last: Value
) -> None:
    text = bindings("last").replace('"/x.data"', f'"/x.data"\nmax_age = "{max_age} ns"')
    log = recording([(0, HIGH), (20, LOW)], end=26)
    assert trace(declare(text), log, ["p"]).cut == {"p": last}


def test_a_sample_at_the_time_of_a_tick_counts_for_that_tick() -> None:
    pairs = [(0, HIGH), (10, LOW), (11, HIGH)]
    assert column(pairs, "last", end=20) == [False, True, False]
    assert column([(10, LOW)], "last", end=20) == [None, True, True]


def test_a_pulse_shorter_than_a_tick_is_seen_by_any_and_not_by_last() -> None:
    pairs = [(0, HIGH), (13, LOW), (14, HIGH)]
    assert column(pairs, "any", end=30) == [False, False, True, False]
    assert column(pairs, "last", end=30) == [False, False, False, False]


def test_all_sees_the_shortest_break() -> None:
    pairs = [(0, LOW), (13, HIGH), (14, LOW)]
    assert column(pairs, "all", end=30) == [True, True, False, True]


def test_unknown_yields_to_what_decides() -> None:
    assert column([(1, NAN), (2, LOW)], "any", end=10) == [None, True]
    assert column([(1, NAN), (2, HIGH)], "any", end=10) == [None, None]
    assert column([(1, NAN), (2, LOW)], "all", end=10) == [None, None]
    assert column([(1, NAN), (2, HIGH)], "all", end=10) == [None, False]
    assert column([(1, NAN), (2, HIGH)], "last", end=10) == [None, False]


def test_what_was_in_force_before_does_not_count_where_there_are_steps() -> None:
    assert column([(0, LOW), (13, HIGH)], "any", end=20) == [True, True, False]
    assert column([(0, HIGH), (13, LOW)], "all", end=20) == [False, False, True]


def test_on_unknown_replaces_what_is_unknown_at_the_end() -> None:
    pairs = [(1, NAN), (2, HIGH), (11, LOW), (21, NAN)]
    assert column(pairs, "any", end=30) == [None, None, True, None]
    assert column(pairs, "any", end=30, extra="on_unknown = true") == [True, True, True, True]
    assert column(pairs, "any", end=30, extra="on_unknown = false") == [False, False, True, False]


def test_a_clock_by_message_ticks_with_each_of_them() -> None:
    declarations = declare(bindings("any", tick="/scan"))
    log = recording([(0, HIGH), (12, LOW), (13, HIGH)], ticks=[5, 20, 21])
    found = trace(declarations, log, ["p"])
    assert found.timeline.period is None
    assert found.timeline.times.tolist() == [5, 20, 21]
    assert values(found) == [False, True, False]


def test_messages_with_equal_times_are_a_tick_each_with_its_own_sample() -> None:
    declarations = declare(bindings("any", tick="/x"))
    log = recording([(5, HIGH), (9, LOW), (9, HIGH), (9, HIGH)], ticks=[5, 9, 9, 9])
    assert values(trace(declarations, log, ["p"])) == [False, True, False, False]


def test_the_last_of_equal_ticks_sees_all_that_is_left() -> None:
    declarations = declare(bindings("any", tick="/y"))
    log = recording([(9, HIGH), (9, HIGH), (9, LOW), (11, HIGH)], ticks=[9, 9, 12])
    assert values(trace(declarations, log, ["p"])) == [False, True, False]


def test_a_clock_without_messages_has_no_ticks() -> None:
    declarations = declare(bindings("any", tick="/y"))
    assert values(trace(declarations, recording([(9, HIGH)]), ["p"])) == []


def slow_tick(times: list[int], values: list[Value], low: int, high: int, how: str) -> Value:
    """`(low, high]`, by the definition."""
    inside = [value for time, value in zip(times, values, strict=True) if low < time <= high]
    before = [value for time, value in zip(times, values, strict=True) if time <= low]
    if not inside:
        return before[-1] if before else None
    if how == "last":
        return inside[-1]
    decisive = how == "any"
    return decisive if decisive in inside else None if None in inside else not decisive


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 60), st.sampled_from([LOW, HIGH, NAN])), max_size=12),
    st.sampled_from(["any", "all", "last"]),
    st.integers(1, 25),
    st.integers(0, 20),
    st.integers(0, 24),
)
@example([(0, LOW), (0, HIGH)], "any", 10, 0, 0)
@example([(0, NAN), (0, LOW)], "all", 1, 0, 0)
@example([(0, NAN), (0, HIGH)], "any", 1, 0, 0)
def test_aggregation_agrees_with_the_definition(
    pairs: list[tuple[int, float]], aggregate: str, period: int, start: int, phase: int
) -> None:
    phase %= period
    pairs = sorted(pairs, key=lambda pair: pair[0])
    tick = f'{period} ns"\nphase = "{phase} ns'
    declarations = declare(bindings(aggregate, tick=tick))
    log = replace(recording(pairs, end=61), start_ns=min(start, pairs[0][0] if pairs else 0))
    steps = evaluate(declarations.propositions["p"], declarations, log)
    ticks = sorted({*range(log.start_ns + phase, 62, period), 61})
    begun = pairs[0][0] if pairs else 61
    yet = sum(time < begun and time <= ticks[0] for time in steps.times.tolist())
    unheard = min(yet, sum(time <= ticks[0] for time in steps.times.tolist()) - 1)
    expected = [  # of the first tick, what is unknown because no sample has come yet is left out
        slow_tick(steps.times.tolist()[unheard:], steps.values[unheard:], low, high, aggregate)
        for low, high in zip([log.start_ns - 1, *ticks], ticks, strict=False)
    ]
    found = trace(declarations, log, ["p"])
    whole = found.timeline.times.tolist()
    seen = [*values(found), *(found.cut.values() if found.cut is not None else ())]
    assert whole == list(range(log.start_ns + phase, 62, period))
    assert seen == expected


@pytest.mark.parametrize("expression", ["x < 5", "x < 5 for 200 ms"])
def test_ten_minutes_are_a_column_of_6001_ticks(expression: str) -> None:
    text = bindings("any", tick="100 ms").replace("x < 5", expression)
    times = np.arange(30_000, dtype=np.int64) * (20 * MS)
    samples = {"x": Samples(times, np.sin(times / S) * 10)}
    log = replace(recording([], end=600 * S), samples=samples)
    declarations = declare(text)
    assert len(values(trace(declarations, log, ["p"]))) == 6001


@pytest.mark.parametrize("hold", ["", " for 10 ns", " for 15 ns", " for 3 ns"])
@pytest.mark.parametrize(("aggregate", "seen"), [("any", True), ("last", False)])
def test_a_pulse_of_no_length_is_seen_by_any_whatever_stands_beside_it(
    hold: str, aggregate: str, seen: bool
) -> None:
    """x is low only for an instant, at 50 ns; y, which is high then, is low up to 30 ns."""
    log = recording([(0, HIGH), (50, LOW), (50, HIGH), (90, HIGH)], end=90)
    y = np.arange(0, 91, 10, dtype=np.int64)
    log = replace(log, samples={**log.samples, "y": Samples(y, np.where(y < 30, LOW, HIGH))})
    text = with_y(bindings(aggregate)).replace("x < 5", f"x < 5 and not (y < 5{hold})")
    found = values(trace(declare(text), log, ["p"]))
    assert found == [False] * 5 + [seen] + [False] * 4


def two_topics(second_begins: int) -> Recording:
    """/x from 0 on, /y from later on; both have a sample every 10 ns."""
    log = recording([(t, LOW) for t in range(0, 60, 10)], end=55)
    y = np.arange(second_begins, 56, 10, dtype=np.int64)
    topics = {
        name: Topic(name, "", "cdr", 1, first, 55, 10, 0, 0)
        for name, first in (("/x", 0), ("/y", second_begins))
    }
    samples = {**log.samples, "y": Samples(y, np.full(len(y), LOW))}
    return replace(log, samples=samples, topics=topics)


def with_y(text: str) -> str:
    return text.replace("[proposition.p]", '[signal.y]\npath = "/y.data"\n[proposition.p]')


BOTH = with_y(bindings("any")).replace("x < 5", "x < 5 and y < 5")


def test_the_first_tick_waits_for_a_topic_that_begins_less_than_a_tick_later() -> None:
    found = trace(declare(BOTH), two_topics(3), ["p"])
    assert found.timeline.times.tolist() == [3, 13, 23, 33, 43, 53]
    assert values(found) == [True] * 6


def test_a_topic_that_begins_later_than_that_leaves_the_ticks_before_it_unknown() -> None:
    found = trace(declare(BOTH), two_topics(15), ["p"])
    assert found.timeline.times.tolist() == [0, 10, 20, 30, 40, 50]
    assert values(found) == [None, None, True, True, True, True]


@pytest.mark.parametrize(("aggregate", "then"), [("any", HIGH), ("all", LOW)])
def test_the_first_tick_is_unknown_where_a_sample_within_it_is(aggregate: str, then: float) -> None:
    log = replace(two_topics(4), samples={"x": Samples(np.array([0, 3]), np.array([NAN, then]))})
    declarations = declare(with_y(bindings(aggregate)))
    assert values(trace(declarations, log, ["p"]))[0] is None


@pytest.mark.parametrize(("aggregate", "then"), [("any", HIGH), ("all", LOW)])
def test_the_first_tick_is_unknown_where_part_of_it_is_lost(aggregate: str, then: float) -> None:
    declarations = declare(with_y(bindings(aggregate)))
    late = Samples(np.array([3]), np.array([then]))
    log = replace(two_topics(4), samples={"x": late})
    assert values(trace(declarations, log, ["p"]))[0] is (aggregate == "all")
    lost = replace(log, gaps=((1, 2),))
    assert values(trace(declarations, lost, ["p"]))[0] is None
