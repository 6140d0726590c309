import math
import operator
from collections.abc import Callable
from fractions import Fraction
from itertools import permutations
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.logs.signals.measures import NameValues, number
from fretc.logs.signals.propositions import TRUE, truth
from fretc.logs.signals.samples import EXACT
from fretish import expressions as e
from fretish.bindings import expressions as binding
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.units import NAMES, unit
from tests.effort import examples

FACTORS = {name: known for name in (*NAMES, "km/h", "mm/s", "m/s") if (known := unit(name))}
PAIRS = [
    (one, other)
    for one, other in permutations(FACTORS, 2)
    if FACTORS[one].dimension == FACTORS[other].dimension
]
OPERATORS: dict[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "=": operator.eq,
    "!=": operator.ne,
}
DOUBLE, SINGLE = np.dtype(np.float64), np.dtype(np.float32)
MOST_DIGITS = {DOUBLE: 15, SINGLE: 6}
"""So many digits of a decimal come back from the nearest float."""


def parsed(text: str) -> e.Expression:
    found = binding.parse(Source("b", text).span())
    assert not isinstance(found, Diagnostic)
    return found


def is_true(text: str, x: Any, kind: np.dtype[Any], name: str = "1") -> bool:
    scope = NameValues(1, {"x": np.array([x], kind)}, scales={"x": FACTORS[name].factor})
    return bool(truth(parsed(text), scope)[0] == TRUE)


def written(value: Fraction, name: str) -> str:
    """A rational number of field units in a unit, exactly."""
    exact = value / FACTORS[name].factor
    return f"{abs(exact.numerator)} {'' if name == '1' else name} / {exact.denominator}"


@st.composite
def decimals(draw: st.DrawFn, digits: int) -> Fraction:
    whole = draw(st.integers(0, 10**digits - 1))
    return Fraction(whole, 10 ** draw(st.integers(0, digits + 2)))


@pytest.mark.slow
@pytest.mark.parametrize("op", OPERATORS)
@examples(10)
@given(st.data(), st.sampled_from(PAIRS), st.sampled_from([DOUBLE, SINGLE]), st.integers(-2, 2))
def test_equal_constants_of_two_units_judge_each_sample_alike(
    op: str, data: st.DataObject, pair: tuple[str, str], kind: np.dtype[Any], apart: int
) -> None:
    field = data.draw(st.sampled_from([n for n in FACTORS if same(n, pair[0])]))
    constant = data.draw(decimals(18))
    near = kind.type(constant / FACTORS[field].factor * FACTORS[pair[0]].factor)
    x = data.draw(
        st.one_of(st.just(moved(near, apart)), st.floats(width=64 if kind == DOUBLE else 32))
    )
    one, other = (written(constant * FACTORS[pair[0]].factor, name) for name in (pair[0], pair[1]))
    assert is_true(f"x {op} {one}", x, kind, field) == is_true(f"x {op} {other}", x, kind, field)


def same(one: str, other: str) -> bool:
    return FACTORS[one].dimension == FACTORS[other].dimension


def moved(number: Any, steps: int) -> Any:
    """Some floats further."""
    with np.errstate(over="ignore"):
        for _ in range(abs(steps)):
            number = np.nextafter(number, type(number)(math.copysign(math.inf, steps)))
    return number


@pytest.mark.slow
@pytest.mark.parametrize("op", OPERATORS)
@examples(10)
@given(st.data(), st.sampled_from(PAIRS), st.sampled_from([DOUBLE, SINGLE]))
def test_a_sample_that_was_a_decimal_is_judged_as_that_decimal(
    op: str, data: st.DataObject, pair: tuple[str, str], kind: np.dtype[Any]
) -> None:
    """Both are written down in the unit of the field, one of them then in another unit."""
    sample = data.draw(decimals(MOST_DIGITS[kind]))
    bound = data.draw(st.one_of(st.just(sample), decimals(MOST_DIGITS[kind])))
    x = np.float32(str(float(sample))) if kind == SINGLE else float(sample)
    text = f"x {op} {written(bound * FACTORS[pair[0]].factor, pair[1])}"
    assert is_true(text, x, kind, pair[0]) == OPERATORS[op](sample, bound)


@pytest.mark.parametrize(
    ("x", "field", "text", "expected"),
    [
        (0.35, "m", "x < 35 cm", False),
        (0.35, "m", "x = 35 cm", True),
        (350, "mm", "x <= 0.35 m", True),
        (35, "cm", "x <= 0.35 m", True),
        (35.7, "cm", "x = 0.357 m", True),
        (35, "%", "x <= 0.35", True),
        (0.35, "1", "x >= 35 %", True),
        (36, "km/h", "x = 10 m/s", True),
        (180, "deg", f"x = {math.pi!r} rad", True),
        (0.3, "1", "x = 0.1 + 0.2", True),
        (1 / 3, "1", "x = 1 / 3", True),
        (35.7, "cm", "abs(-x) = 0.357 m and max(x, x) = 0.357 m and -x = -0.357 m", True),
        (35.7, "cm", "min(x, 0.357 m) = 0.357 m and x - 357 mm = 0", True),
    ],
)
def test_the_same_length_in_two_units_is_the_same(
    x: float, field: str, text: str, expected: bool
) -> None:
    assert is_true(text, x, DOUBLE, field) is expected


def test_a_32_bit_float_is_compared_with_the_nearest_32_bit_float() -> None:
    assert float(np.float32(0.9)) < 0.9
    assert is_true("x = 0.9 and not x < 90 %", np.float32(0.9), SINGLE)
    assert is_true("x < 0.9", moved(np.float32(0.9), -1), SINGLE)
    assert is_true("x < 0.9", float(np.float32(0.9)), DOUBLE)


def test_the_nearest_32_bit_float_is_not_that_of_the_nearest_64_bit_float() -> None:
    above = "1.00000005960464477540"  # just above the middle between 1 and the float after it
    assert np.float32(float(above)) == 1
    assert is_true(f"x = {above}", moved(np.float32(1), 1), SINGLE)


INTEGERS = st.one_of(
    st.integers(-(2**63), 2**64 - 1),
    st.integers(-3, 3).map(lambda i: 2**53 + i),
    st.integers(-3, 3).map(lambda i: -(2**53) + i),
    st.integers(-9, 0).map(lambda i: 2**64 - 1 + i),
)


@pytest.mark.slow
@pytest.mark.parametrize("op", OPERATORS)
@examples(10)
@given(INTEGERS, st.data(), st.sampled_from(["m", "mm", "km"]), st.sampled_from(["m", "mm"]))
@example(2**53, None, "m", "m")
def test_whole_numbers_of_64_bits_are_compared_as_whole_numbers(
    op: str, x: int, data: st.DataObject | None, field: str, name: str
) -> None:
    close = st.integers(-9, 9).map(lambda n: x + Fraction(n, 4))
    bound = data.draw(st.one_of(close, INTEGERS.map(Fraction))) if data else Fraction(x + 1)
    if abs(bound) < 2**52:
        bound = Fraction(int(bound))
    sign = "-" if bound < 0 else ""
    text = f"{sign}({written(bound * FACTORS[field].factor, name)})"
    expected = OPERATORS[op](Fraction(x), bound)
    mirrored = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}.get(op, op)
    kinds: tuple[np.dtype[Any], ...] = (
        (EXACT, DOUBLE) if abs(x) <= 2**53 and abs(bound) < 2**53 else (EXACT,)
    )
    for kind in kinds:
        for term in ("x", "min(x, x)", "max(x, x)"):
            assert is_true(f"{term} {op} {text}", x, kind, field) == expected
            assert is_true(f"{text} {mirrored} {term}", x, kind, field) == expected


def test_a_fraction_among_whole_numbers_stays_a_fraction() -> None:
    scope = NameValues(3, {"x": np.array([0.5, 2**53 + 1, np.nan], EXACT)})
    assert truth(parsed("x < 0.7"), scope).tolist() == [2, 0, 1]
    assert truth(parsed("min(x, 9007199254740993.5) < 0.7"), scope).tolist() == [2, 0, 1]


@pytest.mark.parametrize("text", ["1e300", "-1e300", "18446744073709551616", "123456789e12"])
def test_a_float_beyond_whole_numbers_is_its_decimal_beside_whole_numbers_too(text: str) -> None:
    scope = NameValues(2, {"x": np.array([float(text), 2**53 + 1], EXACT)})
    assert truth(parsed(f"x = {text}"), scope).tolist() == [2, 0]


def test_the_lesser_of_two_whole_numbers_is_a_whole_number() -> None:
    numbers = {"x": np.array([2**53 + 1], EXACT), "y": np.array([2**53 + 3], EXACT)}
    scope = NameValues(1, numbers, scales=dict.fromkeys("xy", Fraction(1, 100)))
    assert truth(parsed("min(x, y) = 9007199254740993 cm"), scope).tolist() == [2]
    assert truth(parsed("max(x, y) = 9007199254740995 cm"), scope).tolist() == [2]
    assert truth(parsed("min(x, y) = 9007199254740992 cm"), scope).tolist() == [0]


def test_two_signals_of_one_unit_are_compared_as_they_were_recorded() -> None:
    scale = {"x": Fraction(1, 1000), "y": Fraction(1, 1000)}
    numbers = {"x": np.array([2**53 + 1], EXACT), "y": np.array([2.0**53])}
    assert truth(parsed("x > y and not x = y"), NameValues(1, numbers, scales=scale)).tolist() == [
        2
    ]


def test_arithmetic_is_of_64_bit_floats_in_base_units() -> None:
    scales = {"x": Fraction(1, 100), "y": Fraction(1)}
    numbers = {"x": np.array([50.0]), "y": np.array([0.25], np.float32)}
    scope = NameValues(1, numbers, scales=scales)
    assert number(parsed("x + y"), scope).tolist() == [0.75]
    assert number(parsed("x * y"), scope).tolist() == [0.125]
    assert number(parsed("x / y"), scope).tolist() == [2.0]
    assert number(parsed("x - 25 cm"), scope).tolist() == [0.25]
    assert number(parsed("max(x, y)"), scope).tolist() == [0.5]


def test_constants_beyond_all_floats_are_infinite() -> None:
    scope = NameValues(2, {"x": np.array([1e308, math.inf])})
    assert truth(parsed("x < 1e999"), scope).tolist() == [2, 0]
    assert truth(parsed("x > -1e999"), scope).tolist() == [2, 2]
    assert is_true("x < 1e999 and x > -1e999", 2**64 - 1, EXACT)
    assert truth(parsed("1 / 0 < 1 or 1e400 < 1e401"), scope).tolist() == [2, 2]
    assert truth(parsed("1 / 0 < 1"), scope).tolist() == [1, 1]
