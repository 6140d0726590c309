"""Values at a violation, as the monitor saw them."""

from math import inf

import pytest

from compiler.files.records import replace
from fretc.audit.evidence.samples import RunPart, SignalSamples
from fretc.audit.evidence.schema import Violation
from fretc.report.model.pictures import SpanMark
from fretc.report.pictures.first_tick import reading
from fretc.report.pictures.signals import panels
from fretc.report.pictures.timeline import cause
from tests.fretc.audit.results import moment, violation
from tests.fretc.report.pictures.test_timeline import EMPTY

RESULT = replace(EMPTY, units={"x": "m"})


def broken(value: float | None, *times: float, values: tuple[float, ...] = ()) -> Violation:
    """Broken at 12.3 s, with samples of `x` at these times."""
    at = moment(123, 12.3)
    samples = SignalSamples(times, values or (value,) * len(times))
    return violation(at, at, None, None, "q", {"x": value}, RunPart(10.0, 13.3, {"x": samples}))


@pytest.mark.parametrize(
    ("last", "age", "words"),
    [
        (12.3, 0.3, "2 m"),
        (12.0, 0.3, "2 m"),  # as old as it may be
        (11.999999999, 0.3, "unknown: 2 m is 300.000001 ms old, and valid for 300 ms"),
        (11.8, 0.3, "unknown: 2 m is 500 ms old, and valid for 300 ms"),
        (-4.0, 0.3, "unknown: 2 m is 16.3 s old, and valid for 300 ms"),
        (-4.0, None, "2 m"),
    ],
)
def test_a_value_counts_up_to_its_age(last: float, age: float | None, words: str) -> None:
    ages = {} if age is None else {"x": age}
    assert reading("x", broken(2.0, last), RESULT, ages) == words


def test_the_last_sample_at_the_tick_is_the_one_that_counts() -> None:
    one = broken(2.0, 10.0, 12.2, 12.4)
    assert reading("x", one, RESULT, {"x": 0.3}) == "2 m"


def test_what_is_not_known_has_no_age() -> None:
    assert reading("x", broken(None, 10.0), RESULT, {"x": 0.3}) == "unknown"
    assert reading("x", broken(2.0), RESULT, {"x": 0.3}) == "2 m"
    assert reading("x", replace(broken(2.0), surroundings=None), RESULT, {"x": 0.3}) == "2 m"


def test_an_infinite_value_grows_too_old_as_well() -> None:
    one = replace(broken(None, 12.2, values=(inf,)))
    assert reading("x", one, RESULT, {"x": 0.3}) == "+inf"
    assert reading("x", one, RESULT, {"x": 0.05}) == (
        "unknown: +inf is 100 ms old, and valid for 50 ms"
    )


@pytest.mark.parametrize("count", [2, 50])
@pytest.mark.parametrize("age", [0.1, 0.2, 0.3, 0.5, 5.0])
def test_the_number_and_the_picture_say_the_same(age: float, count: int) -> None:
    """Also where samples were thinned: then the picture bridges what thinning took out."""
    times = tuple(9.0 + 3.0 * i / (count - 1) for i in range(count))
    violation, ages = broken(2.0, *times), {"x": age}
    (panel,) = panels(violation, RESULT, ages, 10.0, 13.3)
    hatched = any(mark.start < 12.3 < mark.end for mark in panel.unknown)
    assert reading("x", violation, RESULT, ages).startswith("unknown") is hatched is (age < 0.3)
    assert ("x was unknown" in cause(violation, RESULT, ages)) is hatched


def test_of_thinned_samples_only_the_one_at_the_tick_ends_at_its_age() -> None:
    times = tuple(10.0 + 0.04 * i for i in range(49)) + (12.5,)
    (panel,) = panels(broken(2.0, *times), RESULT, {"x": 0.03}, 10.0, 13.3)
    assert panel.unknown[0] == SpanMark(11.95, 12.5, 1)
