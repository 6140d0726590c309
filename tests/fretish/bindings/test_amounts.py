from fractions import Fraction
from math import inf, isclose, nan

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretish.bindings.amounts import (
    declared_unit,
    duration,
    exact,
    exact_duration,
    instant,
    margin,
    scaled,
    seconds,
    shared_unit,
    value,
)
from tests.fretc.logs.logs import declare

SIGNALS = declare("""\
[clock]
tick = "100 ms"
[signal.v]
path = "/a.v"
unit = "km/h"
[signal.w]
path = "/a.w"
unit = "m/s"
[signal.charge]
path = "/a.c"
unit = "%"
[signal.plain]
path = "/a.p"
""").signals
finite = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("number", "unit", "beside", "text"),
    [
        (0.0318, "m", [], "0.0318 m"),
        (1.3888888888888888, "m/s", [], "1.39 m/s"),
        (5.0, "km/h", [], "5 km/h"),
        (0.0499999, "m", [0.05], "0.0499999 m"),
        (0.050000000000000003, "m", [0.05], "0.05 m"),
        (-0.1500001, "m/s", [0.15, -0.15], "-0.1500001 m/s"),
        (123456.7, "", [], "123457"),
        (1234567890.0, "Pa", [], "1230000000 Pa"),
        (1e20, "m", [], "1e+20 m"),
        (1e-9, "m", [0.0], "1e-09 m"),
        (0.0, "", [], "0"),
        (None, "m", [], "unknown"),
        ("+inf", "m", [], "+inf"),
        (-inf, "m", [], "-inf"),
        (nan, "m", [], "unknown"),
    ],
)
def test_a_number_has_the_digits_that_say_something(
    number: float | str | None, unit: str, beside: list[float], text: str
) -> None:
    assert value(number, unit, beside) == text


@given(finite, st.lists(finite, max_size=3))
def test_a_shown_number_lies_on_the_side_of_each_bound_on_which_it_is(
    number: float, bounds: list[float]
) -> None:
    shown = float(value(number, "", bounds))
    for bound in bounds:
        assert (shown < bound, shown > bound) == (number < bound, number > bound)
    assert isclose(shown, number, rel_tol=5.1e-3)


@pytest.mark.parametrize(
    ("number", "text"),
    [(0.05, "0.05"), (1.23456789, "1.23456789"), (100.0, "100"), (4.999999999999999, "5")],
)
def test_a_bound_has_all_its_digits_and_none_that_comes_of_converting_it(
    number: float, text: str
) -> None:
    assert exact(number, "m") == f"{text} m"


@given(finite)
def test_a_bound_is_read_back_as_it_was(number: float) -> None:
    assert isclose(float(exact(number, "")), number, rel_tol=1e-15)


@given(st.decimals(-1000, 1000, places=3), st.sampled_from(sorted(SIGNALS)))
def test_what_is_written_in_the_declared_unit_is_shown_as_it_was_written(
    written: float, name: str
) -> None:
    signal = SIGNALS[name]
    base = float(Fraction(written) * signal.unit.factor)
    unit, factor = declared_unit(name, str(signal.unit), SIGNALS)
    shown = exact(scaled(base, factor), unit)
    assert Fraction(shown.removesuffix(unit).strip()) == Fraction(written)
    assert unit == {"v": "km/h", "w": "m/s", "charge": "%", "plain": ""}[name]


def test_a_signal_that_is_not_declared_or_has_another_dimension_keeps_its_base_unit() -> None:
    assert declared_unit("gone", "m", SIGNALS) == ("m", Fraction(1))
    assert declared_unit("v", "rad", SIGNALS) == ("rad", Fraction(1))


@pytest.mark.parametrize(
    ("term", "base", "unit"),
    [
        ("v", "m/s", "km/h"),
        ("abs(v)", "m/s", "km/h"),
        ("v + w", "m/s", "m/s"),
        ("v * charge", "m/s", "km/h"),
        ("v / w", "", ""),
        ("charge", "", "%"),
    ],
)
def test_a_term_is_shown_in_the_unit_that_its_signals_share(
    term: str, base: str, unit: str
) -> None:
    assert shared_unit(term, base, SIGNALS)[0] == unit


@pytest.mark.parametrize(
    ("distance", "bound", "text"),
    [
        (13.2, 15.0, "13.2 m"),
        (0.00288001, 0.15, "0.003 m"),
        (1.1920929e-7, 1.5, "1e-07 m"),
        (0.31234, 0.0, "0.312 m"),
        (0.0, 1.0, "0 m"),
    ],
)
def test_a_margin_has_no_more_decimals_than_the_numbers_that_it_lies_between(
    distance: float, bound: float, text: str
) -> None:
    assert margin(distance, "m", bound) == text


@given(st.floats(0, allow_infinity=False, exclude_min=True), finite)
def test_a_margin_never_looks_like_none(distance: float, bound: float) -> None:
    shown = float(margin(distance, "", bound))
    assert shown > 0
    assert distance / 2 <= shown <= distance * 2


def test_a_time_ends_at_the_millisecond() -> None:
    assert [seconds(number) for number in (25.0, 0.9, 39.8004, 1852.25, -0.0001)] == [
        "25 s",
        "0.9 s",
        "39.8 s",
        "1852.25 s",
        "0 s",
    ]


@pytest.mark.parametrize(
    ("number", "bounds", "text"),
    [
        (0.304, [], "304 ms"),
        (0.0, [], "0 s"),
        (0.9996, [], "1 s"),
        (0.9994, [], "999 ms"),
        (0.00125, [], "1.25 ms"),
        (1.2e-5, [], "12 us"),
        (1e-9, [], "1 ns"),
        (0.0009997, [], "1 ms"),
        (39.8004, [], "39.8 s"),
        (1234.56, [], "1235 s"),
        (0.30004, [0.3], "300.04 ms"),
        (2.9996, [3.0], "2.9996 s"),
        (0.3, [0.3], "300 ms"),
        (-0.5, [], "-500 ms"),
    ],
)
def test_a_duration_is_in_the_unit_that_a_person_says(
    number: float, bounds: list[float], text: str
) -> None:
    assert duration(number, bounds) == text


def _in_seconds(text: str) -> float:
    number, unit = text.split()
    return float(number) * {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit]


@given(st.integers(0, 10**13), st.integers(0, 10**13))
@example(300_000_001, 300_000_000)
def test_a_duration_beyond_its_limit_never_looks_like_it(late_ns: int, limit_ns: int) -> None:
    late, limit = late_ns / 1e9, limit_ns / 1e9
    shown, bound = duration(late, [limit]), exact_duration(limit)
    assert (shown == bound) == (late == limit)
    assert isclose(_in_seconds(shown), late, rel_tol=5.1e-3)
    assert isclose(_in_seconds(bound), limit, rel_tol=1e-14)


def test_an_instant_is_a_date_where_there_is_one() -> None:
    assert instant(1_700_000_000_041_000_000) == "2023-11-14 22:13:20.041 UTC"
    assert instant(10**30) == f"{10**30} ns"
    assert instant(None) == "not known"
