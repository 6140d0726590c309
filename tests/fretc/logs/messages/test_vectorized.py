import math
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fretc.logs.messages.vectorized import nearest, samples, siblings
from fretc.logs.signals.samples import widest
from fretc.logs.signals.signals import nearest as nearest_of_one
from fretc.logs.signals.signals import sample
from fretish.bindings.declarations import Signal
from tests.effort import FULL, some
from tests.fretc.logs.logs import declare

NAN, INF = float("nan"), float("inf")
SIGNALLING = struct.unpack("<d", b"\1\0\0\0\0\0\xf0\x7f")[0]


def signal(fields: str, path: str = "/t.a[:]") -> Signal:
    text = f'[clock]\ntick = "100 ms"\n[signal.s]\npath = "{path}"\n{fields}'
    return declare(text).signals["s"]


def bits(value: float) -> bytes:
    return struct.pack("<d", value)


def both(signal: Signal, rows: list[list[float]], beside: list[dict[str, float]]) -> None:
    """The signal of many messages at once is that of each of them, bit by bit."""
    array = signal.path.each or signal.path.index is not None
    columns = {name: np.array([names[name] for names in beside]) for name in siblings(signal)}
    matrix = np.array(rows, np.float64).reshape(len(rows), -1)
    with np.errstate(all="ignore"):
        narrow = matrix.astype(np.float32)
    same = np.array_equal(narrow, matrix, equal_nan=True)
    for numbers in (matrix, narrow) if same else (matrix,):
        one_by_one = [
            sample(
                signal,
                SimpleNamespace(a=row if array else row[0], **names),
                single=numbers is narrow,
            )
            for row, names in zip(rows, beside, strict=True)
        ]
        at_once = samples(signal, numbers, columns)
        assert [bits(value) for value in at_once] == [bits(value) for value in one_by_one]


# Signals of all kinds

INVALID = st.fixed_dictionaries(
    {
        kind: st.sampled_from(["drop", "far", "near", "unknown"])
        for kind in ("nan", '"+inf"', '"-inf"', "other")
    }
).map(lambda kinds: ", ".join(f'{kind} = "{reading}"' for kind, reading in kinds.items()))
VALIDS = st.sampled_from(
    [
        "",
        'valid = "range_min <= x and x <= range_max"\n',
        'valid = "x < 0.3"\n',
        'valid = "abs(x) <= range_max or x = 0.7"\n',
        'valid = "1 / x > range_min"\n',
        'valid = "x < 30 cm"\n',
        'valid = "range_max > x and (x > -3 and 0.7 >= x)"\n',
    ]
)
SQUARE = "footprint = [[1, 1], [-1, 1], [-1, -1], [1, -1]]\n"


@st.composite
def signals(draw: st.DrawFn) -> Signal:
    kind = draw(st.sampled_from(["", "index", "min", "max", "mean", "outline"]))
    valid = draw(VALIDS)
    fields = f"invalid = {{ {draw(INVALID)} }}\n{valid}"
    unit = "m" if kind == "outline" else draw(st.sampled_from(["m", "cm", "mm", "km"]))
    fields += f'unit = "{unit}"\n'
    if kind == "outline":
        fields += 'type = "sensor_msgs/LaserScan"\n' + SQUARE
        fields += "sensor = [0.3, -0.1, 0.7]\n"
    if kind in ("min", "max", "mean", "outline"):
        return signal(f'reduce = "{kind}"\n{fields}')
    return signal(fields, "/t.a[1]" if kind == "index" else "/t.a")


ODD = st.sampled_from([NAN, -NAN, INF, -INF, 0.0, -0.0, 0.3, 0.7])
DOUBLES = st.one_of(
    ODD, st.floats(-20, 20), st.floats(), st.sampled_from([1e300, -1e300, 1e308, 5e-324])
)
SINGLES = st.one_of(
    ODD.map(lambda x: float(np.float32(x))), st.floats(-20, 20, width=32), st.floats(width=32)
)


@st.composite
def messages(draw: st.DrawFn) -> tuple[list[list[float]], list[dict[str, float]]]:
    length, count = draw(st.integers(0, 17)), draw(st.integers(1, 6))
    numbers = draw(st.sampled_from([SINGLES, DOUBLES]))
    rows = draw(st.lists(st.lists(numbers, min_size=length, max_size=length), min_size=count,
                         max_size=count))  # fmt: skip
    limits = st.one_of(st.floats(-1, 10, width=32), numbers)
    names = st.fixed_dictionaries(
        dict.fromkeys(("range_min", "range_max", "angle_min", "angle_increment"), limits)
    )
    return rows, draw(st.lists(names, min_size=count, max_size=count))


NAMES = {"range_min": 0.1, "range_max": 9.0, "angle_min": 0.0, "angle_increment": 0.1}


@pytest.mark.slow
@given(signals(), messages())
@example(signal('reduce = "min"\n'), ([[0.0, -0.0], [-0.0, 0.0]], [NAMES, NAMES]))
@example(signal('reduce = "max"\n'), ([[0.0, -0.0] * 9, [-0.0, 0.0] * 9], [NAMES, NAMES]))
@example(signal('reduce = "mean"\n'), ([[1e308] * 4, [-0.0] * 4], [NAMES, NAMES]))
@example(
    signal('reduce = "mean"\ninvalid = { "+inf" = "far", "-inf" = "near" }\n'),
    ([[INF, -INF], [INF, 1.0]], [NAMES, NAMES]),
)
@example(signal('reduce = "min"\nvalid = "x < 1"\n'), ([[SIGNALLING, 0.5]], [NAMES]))
def test_signals_of_many_messages_are_those_of_each_of_them(
    signal: Signal, sent: tuple[list[list[float]], list[dict[str, float]]]
) -> None:
    rows, beside = sent
    if not signal.path.each and signal.path.index is None:
        rows = [row or [NAN] for row in rows]
        rows = [row[:1] for row in rows]
    both(signal, rows, beside)


DROPS = 'nan = "drop", "+inf" = "drop", "-inf" = "drop", other = "drop"'


@pytest.mark.slow
@pytest.mark.parametrize("reduce", ["min", "max"])
@pytest.mark.parametrize("op", ["<", "<="])
def test_the_ends_of_a_band_are_told_from_the_floats_around_them(reduce: str, op: str) -> None:
    """The least and the greatest are found by bit patterns, which are not those of all floats."""
    ends = np.array([1e-45, 0.12, 12.0, 1e38], np.float32)
    floats = [float(np.nextafter(end, np.float32(to))) for end in ends for to in (-INF, INF, end)]
    odd = [0.0, -0.0, -float(ends[0]), -float(ends[1]), -12.0, NAN, -NAN, INF, -INF]
    rows = [[one, other] for one in (*floats, *odd) for other in (0.5, NAN, -1.0)]
    bands = ((0.12, 12), (1e-45, 12), (0, 12), (12, 0.12), (0.12, INF), (NAN, 1))
    for low, high in some(bands, 2, op == "<"):
        limits = {"range_min": float(np.float32(low)), "range_max": float(np.float32(high))}
        valid = f"range_min {op} x and x {op} range_max"
        own = signal(f'reduce = "{reduce}"\nvalid = "{valid}"\ninvalid = {{ {DROPS} }}\n')
        both(own, rows, [limits] * len(rows))
        by_turns = [limits, {"range_min": 0.5, "range_max": 1.0}] * len(rows)
        both(own, rows, by_turns[: len(rows)])


def test_a_number_that_its_unit_makes_infinite_is_infinite_without_a_warning() -> None:
    both(signal('unit = "km"\n', "/t.a"), [[1e307], [1.0]], [{}, {}])


@pytest.mark.parametrize("reduce", ["min", "max", "mean", "outline"])
def test_bits_that_are_no_number_give_no_warning(reduce: str) -> None:
    kind = SQUARE + 'type = "sensor_msgs/LaserScan"\n' if reduce == "outline" else ""
    declared = signal(f'reduce = "{reduce}"\nunit = "m"\nvalid = "x < 5"\n{kind}')
    both(declared, [[SIGNALLING, 2.0], [3.0, 4.0], [INF, -INF]], [NAMES] * 3)


def test_a_zero_is_the_same_zero_whichever_comes_first() -> None:
    for reduce in ("min", "max"):
        for row in ([0.0, -0.0], [-0.0, 0.0], [-0.0] * 40, [0.0] * 40 + [-0.0]):
            found = samples(signal(f'reduce = "{reduce}"\n'), np.array([row]), {})
            assert math.copysign(1.0, found[0]) == 1.0


def test_a_limit_of_one_message_is_not_that_of_another() -> None:
    declared = signal('reduce = "min"\nvalid = "x < range_max"\ninvalid = { other = "drop" }\n')
    found = samples(declared, np.array([[1.0, 5.0]] * 2), {"range_max": np.array([0.5, 9.0])})
    assert np.isnan(found[0])
    assert found[1] == 1.0


def test_messages_of_32_and_of_64_bits_are_each_compared_as_what_they_are() -> None:
    rounded = float(np.float32(0.3))
    assert rounded > 0.3
    declared = signal('valid = "x <= 0.3"\n', "/t.a")
    both(declared, [[rounded], [math.nextafter(rounded, 1)], [0.3]], [{}] * 3)
    found = samples(declared, np.array([[rounded], [math.nextafter(0.3, 1)], [0.3]]), {})
    assert np.isnan(found).tolist() == [True, True, False]
    after = np.nextafter(np.float32(0.3), np.float32(1))
    found = samples(declared, np.array([[rounded], [after]], np.float32), {})
    assert np.isnan(found).tolist() == [False, True]


WHOLE = st.one_of(
    st.integers(-(2**63), 2**63 - 1), st.integers(2**53 - 2, 2**53 + 5), st.integers(-9, 9)
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "fields", ["", 'reduce = "min"\n', 'reduce = "max"\n', 'reduce = "mean"\n']
)
@pytest.mark.parametrize(
    "valid", ["", "x > 9007199254740993", "x != 9007199254740993", "abs(x) < 9"]
)
@given(st.lists(st.lists(WHOLE, min_size=3, max_size=3), min_size=1, max_size=4))
@settings(max_examples=2000 if FULL else 5)
def test_whole_numbers_of_64_bits_are_read_alike_at_once_and_one_by_one(
    fields: str, valid: str, rows: list[list[int]]
) -> None:
    declared = signal(
        fields + (f'valid = "{valid}"\ninvalid = {{ other = "drop" }}\n' if valid else ""),
        "/t.a[:]" if fields else "/t.a[1]",
    )
    at_once = samples(declared, widest(np.array(rows, np.int64)), {})
    each = [sample(declared, SimpleNamespace(a=row)) for row in rows]
    for one, other in zip(at_once, each, strict=True):
        assert one == other or (np.isnan(one) and math.isnan(other))


def test_an_empty_array_and_an_index_past_the_end_are_unknown() -> None:
    assert np.isnan(samples(signal('reduce = "min"\n'), np.zeros((2, 0)), {})).all()
    assert np.isnan(samples(signal("", "/t.a[2]"), np.zeros((2, 2)), {})).all()


def test_what_is_read_beside_the_field_is_what_valid_and_the_outline_name() -> None:
    declared = signal(
        'reduce = "outline"\nunit = "m"\ntype = "sensor_msgs/LaserScan"\n'
        f'valid = "x < range_max"\n{SQUARE}'
    )
    assert siblings(declared) == ("angle_increment", "angle_min", "range_max")
    assert siblings(signal("", "/t.a")) == ()


@given(st.lists(st.floats(width=32), max_size=6), st.sampled_from(["m", "cm", "mm"]))
def test_the_least_range_is_the_least_of_those_that_each_message_states(
    stated: list[float], unit: str
) -> None:
    declared = signal(f'reduce = "min"\nunit = "{unit}"\n')
    each: list[Any] = [nearest_of_one(declared, SimpleNamespace(range_min=x)) for x in stated]
    least = min((x for x in each if x is not None), default=None)
    assert nearest(declared, np.array(stated)) == least
