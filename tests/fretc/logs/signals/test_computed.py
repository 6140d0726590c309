"""Computed signals over a recording, held to the sentence of docs/bindings.md.

"Its value at an instant is that of the expression over the values of its signals at the same
instant." The naive evaluator below takes each instant by itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.signals.computed import computed_samples
from fretc.logs.signals.samples import Recording, Samples
from fretc.logs.signals.traces import trace
from fretish.units import unit
from monitors.kernel.columns import truths
from tests.effort import examples
from tests.fretc.logs.logs import declare

END, MAX_AGE = 60, 7
Row = Sequence[tuple[int, float]]
Function = Callable[[float, float, float], float]

VALUES: Sequence[tuple[str, str, Function]] = (
    ("x + 2 * y", "m", lambda x, y, n: x + 2 * y),
    ("x / n", "m", lambda x, y, n: math.nan if n == 0 else x / n),
    ("hypot(x, y)", "m", lambda x, y, n: math.sqrt(x * x + y * y)),
    ("sqrt(x * y)", "m", lambda x, y, n: math.sqrt(x * y) if x * y >= 0 else math.nan),
    ("clamp(n, 0, 2)", "", lambda x, y, n: min(max(n, 0.0), 2.0)),
    ("atan2(y, x) * n", "rad", lambda x, y, n: math.atan2(y, x) * n),
    ("log(n) + sign(x - y)", "", lambda x, y, n: _log(n) + (x > y) - (x < y)),
    ("floor(n) * x", "m", lambda x, y, n: math.floor(n) * x),
    ("x mod y", "m", lambda x, y, n: math.nan if y == 0 else x % y),
)


def _log(n: float) -> float:
    return math.log(n) if n > 0 else math.nan


def bindings(value: str, bound: str) -> str:
    return f"""
[clock]
tick = "10 ns"
[signal.x]
path = "/x.data"
unit = "m"
max_age = "{MAX_AGE} ns"
[signal.y]
path = "/y.data"
unit = "cm"
[signal.n]
path = "/n.data"
[signal.v]
value = "{value}"
[proposition.p]
expr = "v < {bound}"
"""


def recording(x: Row, y: Row, n: Row, gaps: Sequence[tuple[int, int]] = ()) -> Recording:
    metre, centimetre = unit("m"), unit("cm")
    assert metre is not None
    assert centimetre is not None
    samples = {
        name: Samples(
            np.array([time for time, _ in row], np.int64),
            np.array([value for _, value in row], np.float64),
            scale,
        )
        for name, row, scale in (
            ("x", x, metre.factor),
            ("y", y, centimetre.factor),
            ("n", n, metre.factor),
        )
    }
    return Recording(
        "log", "", 0, 0, END, samples, np.zeros(0, np.int64), tuple(gaps), {}, {}, (), True
    )


def held(row: Row, time: int, max_age: int | None, gaps: Sequence[tuple[int, int]]) -> float:
    """The value of a signal at an instant; NaN: unknown."""
    past = [(at, value) for at, value in row if at <= time]
    if not past:
        return math.nan
    at, value = past[-1]
    if max_age is not None and time - at > max_age:
        return math.nan
    if any(at <= end and start <= time for start, end in gaps):
        return math.nan
    return value


times = st.lists(st.integers(0, END), unique=True, max_size=8).map(sorted)
numbers = st.sampled_from([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, -1.0, -2.5, 100.0, math.nan])


@st.composite
def rows(draw: st.DrawFn) -> Row:
    return [(time, draw(numbers)) for time in draw(times)]


@pytest.mark.slow
@examples(60)
@given(
    st.sampled_from(VALUES),
    st.sampled_from([0.0, 1.0, 1.5, 2.0, 5.0]),
    rows(),
    rows(),
    rows(),
    st.lists(st.tuples(st.integers(0, 50), st.integers(0, 9)), max_size=1),
)
def test_the_value_is_that_of_the_expression_at_the_same_instant(
    one: tuple[str, str, Function],
    bound: float,
    x: Row,
    y: Row,
    n: Row,
    lost: list[tuple[int, int]],
) -> None:
    value, base, function = one
    gaps = [(start, start + length) for start, length in lost]
    declarations = declare(bindings(value, f"{bound} {base}"))
    log = recording(x, y, n, gaps)
    found = trace(declarations, log, ["p"])

    def naive(time: int) -> float:
        ages = zip((x, y, n), (MAX_AGE, None, None), strict=True)
        a, b, c = (held(row, time, age, gaps) for row, age in ages)
        used = [number for name, number in zip("xyn", (a, b, c), strict=True) if name in value]
        return math.nan if any(map(math.isnan, used)) else function(a, b / 100, c)

    ticks = found.timeline.times.tolist()
    expected = [None if math.isnan(naive(tick)) else naive(tick) < bound for tick in ticks]
    assert truths(found.columns["p"], len(ticks)) == expected

    series = computed_samples(["v"], declarations, log)["v"]
    for time in range(END + 1):
        place = int(np.searchsorted(series.times, time, "right")) - 1
        assert float(series.values[place]) == pytest.approx(naive(time), rel=1e-15, nan_ok=True)


def test_a_value_changes_with_each_of_its_signals() -> None:
    declarations = declare(bindings("x + y", "3 m"))
    log = recording([(0, 1.0), (5, 2.0)], [(2, 100.0), (30, 300.0)], [])
    series = computed_samples(["v"], declarations, log)["v"]
    told = dict(zip(series.times.tolist(), series.values.tolist(), strict=True))
    unknown = {0, 13}  # before the first y, and after the last x became too old
    assert {time for time, value in told.items() if math.isnan(value)} == {*unknown, 30}
    assert (told[2], told[5]) == (2.0, 3.0)
    assert all(type(value) is float for value in told.values())


def test_a_proposition_that_holds_for_a_time_reads_a_computed_signal() -> None:
    text = bindings("x + y", "3 m").replace("v < 3 m", "v < 3 m for 15 ns").replace("7 ns", "1 s")
    log = recording([(0, 1.0), (21, 9.0)], [(0, 0.0), (40, 0.0)], [])
    found = trace(declare(text), log, ["p"])
    assert found.timeline.times.tolist() == [0, 10, 20, 30, 40, 50, 60]
    assert truths(found.columns["p"], 7) == [None, None, True, False, False, False, False]


def test_any_sees_a_pulse_of_a_computed_signal_between_two_ticks() -> None:
    text = bindings("2 * x", "3 m").replace("7 ns", "1 s") + 'agg = "any"\n'
    log = recording([(0, 9.0), (13, 1.0), (14, 9.0)], [], [])
    found = trace(declare(text), log, ["p"])
    assert truths(found.columns["p"], 7) == [False, False, True, False, False, False, False]
