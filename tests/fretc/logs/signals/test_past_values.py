"""The value of the tick before, against a walk from tick to tick."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.signals.samples import EXACT, Recording, Samples
from fretc.logs.signals.traces import trace
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from monitors.kernel.columns import truths
from tests.fretc.logs.logs import declare

Value = float | None
Truth = bool | None
Pairs = Sequence[tuple[int, float]]
NAN = float("nan")


def bindings(expression: str, tick: str = "10 ns", unit: str = "1", extra: str = "") -> str:
    return (
        f'[clock]\ntick = "{tick}"\n'
        f'[signal.x]\npath = "/x.data"\nunit = "{unit}"\n'
        f'[signal.y]\npath = "/y.data"\nmax_age = "17 ns"\n'
        f'[proposition.p]\nexpr = "{expression}"\n{extra}'
    )


def samples(pairs: Pairs, kind: Any = np.float64) -> Samples:
    ordered = sorted(pairs, key=lambda pair: pair[0])
    times = np.array([time for time, _ in ordered], np.int64)
    return Samples(times, np.array([value for _, value in ordered], kind))


def column(
    expression: str,
    x: Samples,
    y: Pairs = (),
    end: int = 50,
    ticks: Sequence[int] = (),
    **options: str,
) -> list[Truth]:
    """The truth at each whole tick, and at the one that the end cuts short."""
    both = {"x": x, "y": samples(y)}
    marks = np.array(ticks, np.int64)
    log = Recording("log", "", 0, 0, end, both, marks, (), {}, {}, (), True)
    tick = "/x" if ticks else "10 ns"
    found = trace(declare(bindings(expression, tick, **options)), log, ["p"])
    whole = truths(found.columns["p"], len(found.timeline.times))
    return [*whole, *(found.cut.values() if found.cut is not None else ())]


def test_it_is_what_was_in_force_at_the_tick_before_not_the_sample_before() -> None:
    x = samples([(0, 1.0), (11, 7.0), (12, 8.0), (25, 2.0)])
    # at the ticks 0, 10, 20, ...: 1, 1, 8, 2, 2, 2
    assert column("pre(5, x) = 8", x) == [False, False, False, True, False, False]
    assert column("x - pre(5, x) = 7", x) == [False, False, True, False, False, False]


def test_the_initial_value_counts_at_the_first_tick() -> None:
    x = samples([(0, 1.0)])
    assert column("pre(5, x) = 5", x, end=20) == [True, False, False]
    assert column("pre(5, pre(6, x)) = 5", x, end=20) == [True, False, False]
    assert column("pre(5, pre(6, x)) = 6", x, end=20) == [False, True, False]


def test_what_was_unknown_is_unknown_one_tick_later() -> None:
    x = samples([(0, 1.0), (10, NAN), (20, 1.0)])
    assert column("pre(1, x) = 1", x, end=30) == [True, True, None, True]
    assert column("pre(1, x) = 1", samples([(15, 1.0)]), end=30) == [True, None, None, True]
    extra = "on_unknown = true"
    assert column("pre(1, x) = 1", samples([(15, 2.0)]), end=30, extra=extra) == [
        True,
        True,
        True,
        False,
    ]


def test_the_cut_tick_looks_back_to_the_last_whole_one() -> None:
    assert column("pre(0, x) = 2", samples([(0, 1.0), (10, 2.0)]), end=13) == [False, False, True]


def test_ticks_at_one_time_follow_each_other() -> None:
    x = samples([(0, 1.0), (5, 2.0), (5, 3.0), (5, 4.0), (9, 5.0)])
    ticks = [0, 5, 5, 5, 9]
    assert column("x - pre(0, x) = 1", x, end=9, ticks=ticks) == [True] * 5


def test_units_are_those_of_the_expression() -> None:
    x = replace(samples([(0, 250.0), (10, 251.0)]), scale=Fraction(1, 100))
    expression = "x - pre(2.5 m, x) = 1 cm"
    assert column(expression, x, end=20, unit="cm") == [False, True, False]


def test_a_32_bit_float_stays_one() -> None:
    x = samples([(0, 0.9)], np.float32)
    assert column("pre(0, x) = 0.9", x, end=10) == [False, True]
    assert column("pre(0.9, x) = 0.9", x, end=10) == [True, True]
    assert column("pre(0.9, x) < 0.90000001", x, end=0) == [True]


def test_large_whole_numbers_stay_exact() -> None:
    x = samples([(0, 2**53 + 1), (10, 2**53 + 3)], EXACT)
    assert column(f"pre({2**53 + 1}, x) = {2**53 + 1}", x, end=20) == [True, True, False]


@pytest.mark.parametrize(
    ("fields", "code"),
    [
        ('expr = "pre(x) < 1"', Code.BAD_EXPRESSION),
        ('expr = "pre(0 m, x) < 1"', Code.UNIT_MISMATCH),
        ('expr = "pre(0, x < 1)"', Code.BAD_EXPRESSION),
        ('expr = "pre(0, x) < 1"\nagg = "any"', Code.BAD_BINDING_FIELD),
        ('expr = "pre(0, x) < 1 for 20 ns"', Code.BAD_EXPRESSION),
        (f'expr = "{"pre(0, " * 17}x{")" * 17} < 1"', Code.BAD_EXPRESSION),
    ],
)
def test_where_it_means_nothing_it_is_a_mistake(fields: str, code: Code) -> None:
    text = bindings("x < 1").replace('expr = "x < 1"', fields)
    _, said = read_bindings(Source("bindings.toml", text))
    assert [each.code for each in said if each.is_error] == [code]


# Against a walk


def walked(x: Value, y: Value, before: dict[str, Value], tick: int) -> dict[str, Value]:
    """What each `pre` keeps of a tick, for the next one."""
    inner = 1.0 if tick == 0 else before["y"]
    return {"x": x, "y": y, "sum": None if x is None or inner is None else x + inner}


EXPRESSIONS: dict[str, Callable[[Value, Value, dict[str, Value], int], Truth]] = {
    "x - pre(4, x) <= 0": lambda x, y, kept, tick: less(x, 4.0 if tick == 0 else kept["x"]),
    "x <= pre(y, y)": lambda x, y, kept, tick: less(x, y if tick == 0 else kept["y"]),
    "x <= pre(4, x + pre(1, y))": (
        lambda x, y, kept, tick: less(x, 4.0 if tick == 0 else kept["sum"])
    ),
}


def less(left: Value, right: Value) -> Truth:
    return None if left is None or right is None else left <= right


def in_force(pairs: Pairs, time: int, age: int | None = None) -> Value:
    past = [pair for pair in sorted(pairs, key=lambda pair: pair[0]) if pair[0] <= time]
    if not past or np.isnan(past[-1][1]) or (age is not None and time - past[-1][0] > age):
        return None
    return past[-1][1]


PAIRS = st.lists(st.tuples(st.integers(0, 60), st.sampled_from([1.0, 4.0, 9.0, NAN])), max_size=9)


@pytest.mark.slow
@given(PAIRS, PAIRS, st.sampled_from(list(EXPRESSIONS)), st.integers(0, 70))
def test_it_agrees_with_a_walk_from_tick_to_tick(
    x: Pairs, y: Pairs, expression: str, end: int
) -> None:
    kept: dict[str, Value] = {}
    expected = []
    for tick, time in enumerate(sorted({*range(0, end + 1, 10), end})):
        seen = in_force(x, time), in_force(y, time, 17)
        expected.append(EXPRESSIONS[expression](*seen, kept, tick))
        kept = walked(*seen, kept, tick)
    assert column(expression, samples(x), y, end) == expected
