"""Values with memory equal those of a naive evaluator, written from their definition."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.logs.signals.memory import with_memory
from fretc.logs.signals.samples import Samples, Values
from fretish.bindings import declarations as d
from fretish.units import ONE
from monitors.kernel.readings import Reading
from monitors.memory import Memory, MemorySeries

END = 60
NAN, INF = math.nan, math.inf


@dataclass(frozen=True)
class Case:
    """Samples in order of arrival, the function, and the gaps of the recording."""

    samples: tuple[tuple[int, float], ...]
    memory: Memory
    gaps: tuple[tuple[int, int], ...] = ()

    @property
    def ordered(self) -> list[tuple[int, float]]:
        """By time; those of equal times in order of arrival."""
        return sorted(self.samples, key=lambda sample: sample[0])


NUMBERS = (0.0, 1.0, 1.0, 2.5, -4.0, 0.1, 1e308, NAN, INF, -INF)
MEMORIES = st.builds(
    Memory,
    st.sampled_from(["mean", "max", "min", "count", "rate"]),
    st.sampled_from([1, 3, 10]),
    st.sampled_from([None, 0, 4, 9]),
) | st.builds(Memory, st.just("rate"), st.none(), st.sampled_from([None, 0, 4, 9]))
GAPS = st.lists(st.tuples(st.integers(0, 50), st.integers(0, 9)), max_size=2).map(
    lambda spans: tuple((first, first + length) for first, length in spans)
)
CASES = st.builds(
    Case,
    st.lists(
        st.tuples(st.integers(0, 40), st.sampled_from(NUMBERS[:2] * 3 + NUMBERS)), max_size=14
    ).map(tuple),
    MEMORIES,
    st.just(()) | GAPS,
)


def is_known_at(case: Case, time: int) -> bool:
    """Whether the recorded signal is known after all samples of a time."""
    before = [sample for sample in case.ordered if sample[0] <= time]
    if not before or math.isnan(before[-1][1]):
        return False
    last, max_age = before[-1][0], case.memory.max_age
    if max_age is not None and time - last > max_age:
        return False
    return not any(first <= time and last <= stop for first, stop in case.gaps)


def naive(case: Case, time: int) -> float | None:
    """The value after all samples of a time; None: unknown."""
    past = [sample for sample in case.ordered if sample[0] <= time]
    if not past or not is_known_at(case, time):
        return None
    memory = case.memory
    if memory.function == "rate":
        now = past[-1][0]
        latest = now - 1 if memory.over is None else now - memory.over
        earlier = [sample for sample in past if sample[0] <= latest]
        if not earlier:
            return None
        begin = earlier[-1][0]
    else:
        assert memory.over is not None
        begin = now = time - memory.over
    instants = range(begin, time + 1)  # just after `begin` it is as known as at it
    if not all(is_known_at(case, each) for each in instants):
        return None
    within = [value for at, value in past if at > begin]
    if any(math.isnan(value) for value in within):
        return None
    if memory.function == "rate":
        rate = (past[-1][1] - earlier[-1][1]) / ((now - begin) / 1e9)
        return None if math.isnan(rate) else rate
    if memory.function == "count":
        are_truths = all(value in (0, 1) for value in within)
        return float(within.count(1)) if are_truths else None
    if not within:
        return None
    if memory.function == "mean":
        if any(math.isinf(value) for value in within):
            infinite = sum(value for value in within if math.isinf(value))
            return None if math.isnan(infinite) else infinite
        total = sum(map(Fraction, within))
        try:
            return float(total) / len(within)
        except OverflowError:
            return float(total / len(within))
    return max(within) if memory.function == "max" else min(within)


def close(one: Reading, other: float | None) -> bool:
    """Whether values are equal; a mean of huge numbers may differ in the last digit."""
    if one is None or other is None:
        return one is other
    return one == other or (abs(other) > 1e300 and math.isclose(one, other, rel_tol=1e-15))


def signal(memory: Memory) -> d.Signal:
    path = d.path("/x.data")
    assert path is not None
    made = d.Memory(memory.function, "x", memory.over, memory.max_age, ONE)
    return d.Signal("y", path, ONE, "", memory=made)


def audited(case: Case, kind: type = np.float64) -> Samples:
    times = np.array([time for time, _ in case.ordered], np.int64)
    values: Values = np.array([value for _, value in case.ordered], kind)
    return with_memory(signal(case.memory), Samples(times, values), case.gaps, END)


def in_force(samples: Samples, gaps: Sequence[tuple[int, int]], time: int) -> float | None:
    """The value that an audit sees at a time: its own rule about gaps included."""
    index = int(samples.times.searchsorted(time, "right")) - 1
    if index < 0 or math.isnan(samples.values[index]):
        return None
    if any(first <= time and samples.times[index] <= stop for first, stop in gaps):
        return None
    return float(samples.values[index])


@given(CASES)
@example(Case(((0, 1.0), (5, 1.0), (5, 0.0), (9, 1.0)), Memory("count", 5)))
@example(Case(((0, 1.0), (5, 2.5), (5, 0.0)), Memory("rate", None)))
@example(Case(((0, 1.0), (2, 0.0), (20, 1.0)), Memory("count", 3)))
@example(Case(((0, 0.0), (1, 1.0), (1, 1.0), (1, 0.1)), Memory("mean", 1)))
@example(Case(((0, 1.0), (4, 0.0), (9, 1.0)), Memory("max", 3, 4)))
@example(Case(((0, 1.0), (4, 0.0), (9, 1.0)), Memory("count", 3), ((1, 2),)))
def test_an_audit_has_the_values_of_the_definition_at_every_instant(case: Case) -> None:
    samples = audited(case)
    assert (np.diff(samples.times) >= 0).all()
    for time in range(END):
        value = in_force(samples, case.gaps, time)
        assert close(value, naive(case, time)), (time, value)


@given(CASES, st.lists(st.integers(0, END), max_size=3), st.randoms(use_true_random=False))
@example(Case(((0, 1.0), (6, 1.0), (6, 1.0)), Memory("count", 5)), [10], random.Random(0))
@example(Case(((14, 0.0), (24, 0.0), (26, 0.0)), Memory("rate", 3, 9)), [35], random.Random(0))
def test_a_series_has_them_in_any_order_of_arrival(
    case: Case, cuts: list[int], chance: random.Random
) -> None:
    case = replace(case, gaps=())
    series, left = MemorySeries(case.memory), list(case.samples)
    chance.shuffle(left)
    arrived: list[tuple[int, float]] = []
    start = 0
    for cut in [*sorted(cuts), END]:
        late = [sample for sample in left if sample[0] < cut]
        for sample in late:  # all that lies before a cut comes before time has passed it
            series.put(sample[0], None if math.isnan(sample[1]) else sample[1])
            arrived.append(sample)
            left.remove(sample)
        now = replace(case, samples=tuple(arrived))
        for time in range(start, END):
            _, end = series.span(time)
            assert close(series.at(end - 1, time), naive(now, time)), time
        series.forget(cut)
        start = cut


@given(CASES)
def test_equal_times_are_seen_one_after_the_other(case: Case) -> None:
    samples = audited(replace(case, gaps=()))
    series = MemorySeries(case.memory)
    for time, value in case.samples:
        series.put(time, None if math.isnan(value) else value)
    kept = [time for time in series.times if time <= END]
    assert kept == samples.times.tolist()
    for index, (time, value) in enumerate(zip(kept, samples.values.tolist(), strict=True)):
        assert series.at(index, time) == (None if math.isnan(value) else value)


def test_the_extremes_keep_the_type_of_their_samples() -> None:
    case = Case(((0, 0.9), (5, 0.9), (9, 0.1)), Memory("max", 5))
    assert audited(case, np.float32).values.dtype == np.float32
    assert audited(replace(case, memory=Memory("mean", 5)), np.float32).values.dtype == np.float64


def test_a_window_begins_after_the_sample_that_is_as_old_as_it_is_long() -> None:
    case = Case(((10, 1.0), (15, 0.0), (20, 0.0)), Memory("count", 10))
    samples = audited(case)
    at = dict(zip(samples.times.tolist(), samples.values.tolist(), strict=True))
    assert at[20] == 0.0  # the sample at 10 has left the window
    assert math.isnan(at[15])  # nothing is known before 10
