"""Numbers of logs are judged as the numbers that were recorded: whichever type, unit and way in."""

import math
import struct
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.signals.samples import EXACT, NumberList, Values, distinct, scaled, widest
from fretc.logs.signals.traces import trace
from tests.fretc.logs.logs import MS, S, Sent, declare, recorded, said, scan, write

FORMATS = {"Float32": "<f", "Float64": "<d", "Int64": "<q", "UInt64": "<Q", "Int32": "<i"}
MANY = 200
"""So many messages that they are read at once, by their places."""


def sent(kind: str, value: float, time: int) -> Sent:
    if kind == "JSON":
        return said("/x", time, data=value)
    data = b"\0\1\0\0" + struct.pack(FORMATS[kind], value)
    return Sent("/x", f"std_msgs/msg/{kind}", data, time)


def true_ticks(
    path: Path, messages: Sequence[Sent], unit: str, text: str, field: str = "/x.data"
) -> int:
    """At how many ticks it is true, with a message at each of them."""
    declarations = declare(
        f'[clock]\ntick = "100 ms"\n[signal.x]\npath = "{field}"\nunit = "{unit}"\n'
        f'[proposition.p]\nexpr = "{text}"\n'
    )
    recording = recorded(write(path / "l.mcap", messages), declarations)
    column = trace(declarations, recording, ["p"]).columns["p"]
    assert not column.unknown
    return column.true.bit_count()


@pytest.mark.slow
@pytest.mark.parametrize("count", [3, MANY])
@pytest.mark.parametrize(
    ("kind", "value", "unit", "text", "expected"),
    [
        ("JSON", 0.35, "m", "x < 35 cm", False),
        ("JSON", 350, "mm", "x <= 0.35 m", True),
        ("JSON", 35, "cm", "x <= 0.35 m", True),
        ("JSON", 35, "%", "x <= 0.35", True),
        ("JSON", 0.35, "1", "x >= 35 %", True),
        ("JSON", 2**53, "1", "x != 9007199254740993", True),
        ("JSON", 2**53 + 1, "1", "x = 9007199254740993", True),
        ("Float64", 0.35, "m", "x = 35 cm", True),
        ("Float64", 35.7, "cm", "x = 0.357 m", True),
        ("Float32", 0.35, "m", "x = 35 cm", True),
        ("Float32", 0.9, "1", "x < 90 %", False),
        ("Float32", 35.7, "cm", "abs(-x) >= 0.357 m and x <= 357 mm", True),
        ("Int64", 2**53 + 1, "1", "x > 9007199254740992", True),
        ("Int64", -(2**63), "1", "x < -9223372036854775807", True),
        ("Int64", 2**53 + 1, "mm", "x = 9007199254740.993 m", True),
        ("UInt64", 2**64 - 1, "1", "x = 18446744073709551615", True),
        ("UInt64", 2**64 - 1, "1", "x > 18446744073709551614", True),
        ("Int32", 350, "mm", "x = 35 cm", True),
    ],
)
def test_a_number_of_a_log_is_the_number_that_was_recorded(
    tmp_path: Path, count: int, kind: str, value: float, unit: str, text: str, expected: bool
) -> None:
    messages = [sent(kind, value, S + i * 100 * MS) for i in range(count)]
    assert true_ticks(tmp_path, messages, unit, text) == (count if expected else 0)


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@pytest.mark.parametrize("count", [3, MANY])
def test_an_element_of_a_scan_is_compared_with_32_bit_floats(
    tmp_path: Path, encoding: str, count: int
) -> None:
    messages = [scan([0.9, 2.3], S + i * 100 * MS, encoding=encoding) for i in range(count)]
    for text in ("x < 0.9 m", "x > 90 cm"):
        assert true_ticks(tmp_path, messages, "m", text, "/scan.ranges[0]") == 0
    assert true_ticks(tmp_path, messages, "m", "x = 230 cm", "/scan.ranges[1]") == count


@pytest.mark.parametrize("first", [1, MANY])
def test_whole_numbers_that_outgrow_floats_keep_those_before_them(
    tmp_path: Path, first: int
) -> None:
    numbers = [*range(first), 2**53 + 1, 2**53, 5]
    messages = [sent("Int64", value, S + i * 100 * MS) for i, value in enumerate(numbers)]
    assert true_ticks(tmp_path, messages, "1", "x < 9007199254740993") == first + 2


def test_the_kind_of_a_series_is_the_narrowest_that_holds_all() -> None:
    series = NumberList()
    parts: list[Values] = [np.array([0.1], np.float32), np.array([0.1]), widest(np.array([2**60]))]
    kinds = []
    for part in parts:
        series.add(part)
        kinds.append(series.values().dtype)
    assert kinds == [np.float32, np.float64, EXACT]
    assert series.values().tolist() == [np.float32(0.1), 0.1, 2**60]


@given(st.lists(st.integers(-(2**63), 2**63 - 1)))
def test_whole_numbers_of_64_bits_are_held_exactly(numbers: list[int]) -> None:
    assert [int(one) for one in widest(np.array(numbers, np.int64))] == numbers
    assert [int(one) for one in widest(np.array(numbers, np.int64).view(np.uint64))] == [
        number % 2**64 for number in numbers
    ]


@given(st.floats(1e-200, 1e200), st.sampled_from([1, 10, 100, 1000, 10**9]))
def test_a_power_of_ten_is_rounded_once(value: float, factor: int) -> None:
    assert scaled(value, Fraction(factor)) == float(Fraction(value) * factor)
    assert scaled(value, Fraction(1, factor)) == float(Fraction(value) / factor)


def test_what_a_scale_makes_too_large_is_infinite() -> None:
    huge = Fraction(10) ** 400
    assert scaled(2.0, huge) == math.inf
    assert scaled(-2.0, huge / 3) == -math.inf
    assert scaled(2.0, 1 / huge) == 0
    assert math.isnan(scaled(0.0, huge))


def test_a_product_of_many_units_is_no_fault(tmp_path: Path) -> None:
    path = write(tmp_path / "x.mcap", [sent("Float64", 2.0, S + k * 100 * MS) for k in range(3)])
    product = "*".join(["x"] * 120)
    declarations = declare(
        f'[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.data"\nunit = "km"\n'
        f'[proposition.p]\nexpr = "{product} + {product} > {product}"\n'
    )
    log = recorded(path, declarations)
    assert trace(declarations, log, ["p"]).columns["p"].true == 0b111


@given(st.lists(st.integers(-3, 3)))
def test_distinct_values_are_those_of_numpy(numbers: list[int]) -> None:
    values = np.array(numbers, np.int64)
    assert np.array_equal(distinct(values), np.unique(values))
