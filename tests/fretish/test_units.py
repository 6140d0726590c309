"""Units are exact, and two dimensions never meet."""

import math
from fractions import Fraction

import pytest

from fretish import units
from fretish.units import DIMENSIONLESS, NAMES, base_name, nanoseconds, unit


@pytest.mark.parametrize(
    ("text", "factor", "base"),
    [
        ("m", Fraction(1), "m"),
        ("cm", Fraction(1, 100), "m"),
        ("mm", Fraction(1, 1000), "m"),
        ("km", Fraction(1000), "m"),
        ("ms", Fraction(1, 1000), "s"),
        ("min", Fraction(60), "s"),
        ("h", Fraction(3600), "s"),
        ("m/s", Fraction(1), "m/s"),
        ("km/h", Fraction(5, 18), "m/s"),
        ("kn", Fraction(463, 900), "m/s"),
        ("ft", Fraction(381, 1250), "m"),
        ("m/s^2", Fraction(1), "m/s^2"),
        ("m/s2", Fraction(1), "m/s^2"),
        ("kg*m/s^2", Fraction(1), "m*kg/s^2"),
        ("N", Fraction(1), "m*kg/s^2"),
        ("g", Fraction(1, 1000), "kg"),
        ("rad/s", Fraction(1), "rad/s"),
        ("Hz", Fraction(1), "1/s"),
        ("%", Fraction(1, 100), ""),
        ("1", Fraction(1), ""),
    ],
)
def test_a_unit_is_a_factor_of_its_base(text: str, factor: Fraction, base: str) -> None:
    found = unit(text)
    assert found is not None
    assert (found.factor, base_name(found.dimension)) == (factor, base)


def test_a_degree_is_a_part_of_a_turn() -> None:
    degree = unit("deg")
    assert degree is not None
    assert math.isclose(degree.factor, 2 * math.pi / 360, rel_tol=1e-15)


def test_an_angle_is_no_plain_number() -> None:
    radian, plain = unit("rad"), unit("1")
    assert radian is not None
    assert plain is not None
    assert radian.dimension != plain.dimension == DIMENSIONLESS


@pytest.mark.parametrize("text", [
     "", "metre", "m/", "/s", "m//s", "m^", "m**2", "5 m", "M", "m s",
     "km^200", "m^-200", "km^99999999"])  # fmt: skip
def test_what_is_no_unit_is_not_read(text: str) -> None:
    assert unit(text) is None


def test_a_watt_is_a_newton_metre_a_second() -> None:
    assert unit("W") == unit("N*m/s") == unit("V*A")


def test_every_name_is_a_unit() -> None:
    assert [name for name in NAMES if unit(name) is None] == []


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("100 ms", 100_000_000),
        ("100ms", 100_000_000),
        (" 2 s ", 2_000_000_000),
        ("0.5 us", 500),
        ("0.1 ms", 100_000),
        ("1 min", 60_000_000_000),
        ("1 h", 3_600_000_000_000),
        ("1 ns", 1),
        ("0 s", 0),
    ],
)
def test_a_period_is_a_whole_number_of_nanoseconds(text: str, count: int) -> None:
    assert nanoseconds(text) == count


@pytest.mark.parametrize("text", ["", "100", "ms", "0.5 ns", "-1 s", "1 day", "1 s 5 ms", "1e3 s"])
def test_what_is_no_period_is_not_read(text: str) -> None:
    assert nanoseconds(text) is None


def test_a_number_is_exact_and_of_no_more_digits_than_anybody_means() -> None:
    assert units.number("-2.5e-3") == Fraction(-1, 400)
    for text in ("1e999999999", "9" * 61, "0." + "9" * 61, "1/3", "nan", "1_0", ""):
        with pytest.raises(ValueError, match="is not a number"):
            units.number(text)


def test_a_unit_of_absurd_powers_or_many_factors_is_none() -> None:
    assert units.unit("km^999999999") is None
    assert units.unit("*".join(["km"] * 17)) is None
    assert units.unit(" m / s ^2") is None
    assert units.unit("kg * m / s^2") == units.unit("N")
