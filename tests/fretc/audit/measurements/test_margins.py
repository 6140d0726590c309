"""How near a run came to a bound: written out, and against every nanosecond looked at alone."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import inf, isnan, nan

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.audit.measurements.margins import Margin, margins, worst
from fretc.logs.signals.samples import Gap, Recording, Samples
from fretc.logs.signals.traces import timeline
from fretish.bindings.declarations import Declarations
from tests.fretc.logs.logs import declare

BINDINGS = """
[clock]
tick = "10 ns"
[signal.x]
path = "/x.data"
unit = "cm"
max_age = "15 ns"
[signal.y]
path = "/y.data"
unit = "m/s"
[proposition.p]
expr = "{}"
"""


def declared(expr: str) -> Declarations:
    return declare(BINDINGS.format(expr))


def recorded(
    x: Sequence[tuple[int, float]], end: int, gaps: Sequence[Gap] = (), y: float | None = None
) -> Recording:
    """Samples of x in metres at nanoseconds from 0 to `end`; y all the time the same."""
    signals = {
        "x": Samples(np.array([t for t, _ in x], np.int64), np.array([v for _, v in x], float))
    }
    if y is not None:
        signals["y"] = Samples(np.array([0], np.int64), np.array([y]))
    none = np.array([], np.int64)
    return Recording("run", "", 1, 0, end, signals, none, tuple(gaps), {}, {}, (), not gaps)


def margins_of(expr: str, recording: Recording) -> tuple[Margin, ...]:
    declarations = declared(expr)
    ticks = timeline(declarations, recording).times
    return margins(declarations.propositions["p"], declarations, recording, ticks)


def test_a_bound_that_is_never_crossed_has_a_margin_and_the_time_it_came_that_near() -> None:
    log = recorded([(0, 1.0), (10, 0.3), (20, 0.3), (30, 2.0)], end=40)
    (margin,) = margins_of("x < 5 cm", log)
    assert (margin.threshold.text, margin.threshold.operator) == ("x", "<")
    assert (margin.threshold.bound, margin.threshold.unit) == (0.05, "m")
    assert (margin.least, margin.greatest, margin.comparison) == (0.3, 2.0, False)
    assert margin.distance == pytest.approx(0.25)
    assert margin.nearest_ns == 10


def test_one_that_is_crossed_has_none_and_the_time_of_the_first_change() -> None:
    (margin,) = margins_of("x < 5 cm", recorded([(0, 1.0), (10, 0.04), (20, 1.0)], end=30))
    assert (margin.comparison, margin.distance, margin.nearest_ns) == ("crossed", None, 10)
    assert (margin.least, margin.greatest) == (0.04, 1.0)


@pytest.mark.parametrize(
    ("operator", "truth_value"), [("<", False), ("<=", True), (">", False), (">=", True)]
)
def test_at_the_bound_itself_the_margin_is_zero(operator: str, truth_value: bool) -> None:
    (margin,) = margins_of(f"x {operator} 1 m", recorded([(0, 1.0)], end=10))
    assert (margin.comparison, margin.distance) == (truth_value, 0.0)


def test_a_margin_is_judged_as_the_proposition_is() -> None:
    """35.7 / 100 is not the float nearest to 0.357."""
    assert 35.7 / 100 != 0.357
    log = recorded([(0, 35.7)], end=10)
    x = Samples(log.samples["x"].times, log.samples["x"].values, Fraction(1, 100))
    (margin,) = margins_of("x < 0.357 m", replace(log, samples={"x": x}))
    assert (margin.comparison, margin.distance) == (False, 0.0)
    single = Samples(x.times, x.values.astype(np.float32), x.scale)
    (margin,) = margins_of("x >= 0.357 m", replace(log, samples={"x": single}))
    assert (margin.comparison, margin.distance, margin.threshold.bound) == (True, 0.0, 0.357)


def test_the_constant_may_stand_on_the_left_and_the_number_be_computed() -> None:
    log = recorded([(0, 1.0), (10, 3.0)], end=10, y=-0.5)
    first, second = margins_of("2 m > x or abs(y) >= 0.2 m/s", log)
    assert (first.threshold.text, first.threshold.operator) == ("x", "<")
    assert first.comparison == "crossed"
    assert (second.threshold.text, second.threshold.unit) == ("abs(y)", "m/s")
    assert second.comparison is True
    assert second.distance == pytest.approx(0.3)


@pytest.mark.parametrize("expr", ["x = 1 m", "x != 1 m", "x < x", "1 < 2", "x / 1 m < 1 / 0"])
def test_equalities_and_comparisons_without_a_constant_bound_are_no_thresholds(expr: str) -> None:
    assert margins_of(expr, recorded([(0, 1.0)], end=10)) == ()


def test_what_is_unknown_does_not_count() -> None:
    """NaN, what is too old, a gap and what follows it, and what comes after the last tick."""
    samples = [(0, 1.0), (10, nan), (35, 2.0), (50, -9.0), (60, 3.0), (78, -9.0)]
    (margin,) = margins_of("x < 5 cm", recorded(samples, end=79, gaps=[(45, 55)]))
    assert (margin.least, margin.greatest, margin.comparison) == (1.0, 3.0, False)


def test_nothing_known_is_no_margin() -> None:
    for log in (recorded([], end=50), recorded([(0, nan)], end=50)):
        (margin,) = margins_of("x < 5 cm", log)
        assert margin.comparison is margin.least is margin.greatest is margin.distance is None


def test_infinite_values_are_on_a_side_and_never_near() -> None:
    (far,) = margins_of("x < 5 cm", recorded([(0, inf), (10, 0.25), (20, inf)], end=20))
    assert (far.comparison, far.distance, far.nearest_ns) == (False, 0.2, 10)
    assert (far.least, far.greatest) == (0.25, inf)
    (near,) = margins_of("x < 5 cm", recorded([(0, 0.25), (10, -inf)], end=20))
    assert (near.comparison, near.distance) == ("crossed", None)
    (never,) = margins_of("x < 5 cm", recorded([(0, inf)], end=10))
    assert (never.comparison, never.distance, never.nearest_ns) == (False, None, None)


def test_the_worst_is_the_least_part_of_its_bound() -> None:
    log = recorded([(0, 1.0)], end=10, y=1.9)
    length, speed = margins_of("x < 5 m and y < 2 m/s", log)
    assert length.distance == 4.0
    assert speed.distance == pytest.approx(0.1)
    assert worst([length, speed]) is speed
    (small,) = margins_of("x < 100.5 cm", log)
    assert worst([length, speed, small]) is small
    (zero,) = margins_of("x > 0 m", log)
    assert (zero.share, worst([zero, speed])) == (1.0, speed)
    assert worst([]) is None


VALUES = st.sampled_from([0.0, 0.03, 0.05, 0.07, 1.0, nan, inf, -inf])
SAMPLES = st.lists(st.tuples(st.integers(0, 60), VALUES), max_size=8)
GAPS = st.lists(st.tuples(st.integers(0, 60), st.integers(0, 12)), max_size=2)


@given(SAMPLES, GAPS, st.integers(0, 60))
@example([(0, 0.07), (0, 0.03)], [], 10)
@example([(5, 0.07), (30, 0.03)], [(6, 3)], 40)
def test_it_agrees_with_a_look_at_every_nanosecond(
    samples: list[tuple[int, float]], gaps: list[tuple[int, int]], end: int
) -> None:
    samples = sorted(((t, v) for t, v in samples if t <= end), key=lambda sample: sample[0])
    holes = [(start, start + length) for start, length in gaps if start + length <= end]
    recording = recorded(samples, end, holes)
    (margin,) = margins_of("x < 5 cm", recording)
    readings = [(t, value) for t in range(end // 10 * 10 + 1) for value in _at(t, samples, holes)]
    values = [value for _, value in readings]
    below = {value < 0.05 for value in values}
    assert margin.least == min(values, default=None)
    assert margin.greatest == max(values, default=None)
    expected = None if not below else "crossed" if len(below) == 2 else below == {True}
    assert margin.comparison == expected
    distances = [(abs(value - 0.05), t) for t, value in readings if abs(value) != inf]
    if len(below) != 1 or not distances:
        assert margin.distance is None
    else:
        assert (margin.distance, margin.nearest_ns) == min(distances)


def _at(t: int, samples: Sequence[tuple[int, float]], gaps: Sequence[Gap]) -> list[float]:
    """Each known value that is in force at some point of that nanosecond."""
    if any(start <= t <= end for start, end in gaps):
        return []
    now = [value for time, value in samples if time == t]
    before = [sample for sample in samples if sample[0] < t][-1:]
    fresh = [
        value
        for time, value in before
        if t - time <= 15 and not any(time <= end <= t for _, end in gaps)
    ]
    return [value for value in (now or fresh) if not isnan(value)]
