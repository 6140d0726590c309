"""Messages that are read alone have the values that the official decoder gives."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import isnan
from unittest.mock import patch

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.logs import extraction
from fretc.watch.decoding import Decoder
from fretc.watch.single_messages import SingleMessages
from fretc.watch.sources.source import Arrival, Channel
from fretish.bindings.declarations import Declarations
from tests.effort import examples
from tests.fretc.logs.logs import S, declare, definition, scan

NAN, INF = float("nan"), float("inf")
FOOTPRINT = "[[0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3], [0.3, -0.3]]"
VALID = 'valid = "range_min <= x and x <= range_max"'
INVALID = (
    'invalid = {{ nan = "{}", "+inf" = "{}", "-inf" = "{}", other = "{}", empty = "unknown" }}'
)
SCAN = """
[clock]
tick = "100 ms"
time = "header.stamp"
lateness = "50 ms"
[signal.gap]
path = "/x.ranges[:]"
unit = "{unit}"
reduce = "outline"
footprint = {footprint}
sensor = [0.1, 0.0, 0.2]
{policy}
[signal.least]
path = "/x.ranges[:]"
reduce = "min"
{policy}
[signal.most]
path = "/x.ranges[:]"
reduce = "max"
[signal.third]
path = "/x.ranges[2]"
[signal.reach]
path = "/x.range_max"
valid = "x > 3"
[signal.turn]
path = "/x.angle_increment"
"""
MEANINGS = st.sampled_from(["drop", "far", "near", "unknown"])
CUSTOM = b"string s\nfloat32 f\nint64 i\nuint8 mode\nbool b\nfloat64[3] a\n"
NUMBERS = """
[clock]
tick = "100 ms"
[signal.f]
path = "/x.f"
values = { idle = 0, docking = 1 }
[signal.f2]
path = "/x.f"
[signal.i]
path = "/x.i"
[signal.mode]
path = "/x.mode"
values = { idle = 0, docking = 1, lost = 3 }
[signal.b]
path = "/x.b"
[signal.a]
path = "/x.a[1]"
[signal.none]
path = "/x.a[4]"
"""
FLOATS = [0.0, -0.0, 1.0, 0.9, 7.25, 1e30, NAN, INF, -INF]


def channel(type_: str, schema: bytes = b"") -> Channel:
    return Channel("/x", "cdr", type_, "ros2msg", schema or definition(type_, "cdr"))


def custom(s: bytes, f: float, i: int, mode: int, b: int, a: Sequence[float]) -> bytes:
    data = struct.pack("<I", len(s) + 1) + s + b"\0"
    data += bytes(-len(data) % 4) + struct.pack("<f", f)
    data += bytes(-len(data) % 8) + struct.pack("<qBB", i, mode, b)
    return b"\0\1\0\0" + data + bytes(-len(data) % 8) + struct.pack("<3d", *a)


@contextmanager
def by_the_official_decoder() -> Iterator[None]:
    with patch.object(extraction, "shape", lambda stream: None):
        yield


def read(of: Declarations, sent: Sequence[tuple[Channel, bytes]]) -> list[object]:
    """All that a decoder gives for messages, and the number of those that it could not decode."""
    decoder = Decoder(of)
    found: list[object] = []
    for i, (source, content) in enumerate(sent, 1):
        messages, problems = decoder.read(Arrival(source, content, i * S, i * S))
        found.append([each.code for each in problems])
        for message in messages:
            found.append((message.time, message.arrival))
            for name, (value, kind, text) in sorted(message.values.items()):
                number = "unknown" if isnan(value) else float(value)
                found.append((name, number, str(number), kind, text))
    return [*found, decoder.undecoded]


def same(of: Declarations, sent: Sequence[tuple[Channel, bytes]]) -> int:
    """Compare both ways; the number of messages that were read alone."""
    count = 0
    alone = SingleMessages.read

    def counted(self: SingleMessages, content: bytes) -> object:
        nonlocal count
        found = alone(self, content)
        count += found is not None
        return found

    with patch.object(SingleMessages, "read", counted):
        fast = read(of, sent)
    with by_the_official_decoder():
        assert fast == read(of, sent)
    return count


mutations = st.one_of(
    st.none(),
    st.tuples(st.just("flip"), st.integers(0, 400), st.integers(1, 255)),
    st.tuples(st.just("cut"), st.integers(0, 400), st.just(0)),
    st.tuples(st.just("longer"), st.integers(1, 9), st.just(0)),
)


def mutated(content: bytes, mutation: tuple[str, int, int] | None) -> bytes:
    match mutation:
        case "flip", at, bits:
            at %= len(content)
            return content[:at] + bytes([content[at] ^ bits]) + content[at + 1 :]
        case "cut", at, _:
            return content[: at % len(content)]
        case "longer", count, _:
            return content + bytes(count)
        case _:
            return content


ranges = st.lists(
    st.sampled_from([0.05, 0.5, 0.51, 1.0, 3.0, 9.5, 40.0, NAN, INF, -INF, -1.0])
    | st.floats(0.25, 12.0, width=32),
    min_size=6,
    max_size=6,
)


@pytest.mark.slow
@given(
    st.lists(st.tuples(ranges, st.sampled_from([0.1, 0.3]), mutations), min_size=2, max_size=8),
    st.tuples(*[MEANINGS] * 4),
    st.sampled_from([VALID, VALID, 'valid = "x > 0.5 m"', ""]),
    st.sampled_from(["m", "m", "cm"]),
)
@examples(25)
def test_scans_have_the_values_of_the_official_decoder(
    some: list[tuple[list[float], float, tuple[str, int, int] | None]],
    meanings: tuple[str, str, str, str],
    valid: str,
    unit: str,
) -> None:
    policy = f"{valid}\n{INVALID.format(*meanings)}"
    of = declare(SCAN.format(footprint=FOOTPRINT, policy=policy, unit=unit))
    source = channel("sensor_msgs/msg/LaserScan")
    plain = scan([1.0] * 6, S).payload
    sent = [(source, plain)]
    for i, (numbers, increment, mutation) in enumerate(some, 1):
        whole = scan(numbers, i * S, increment=increment).payload
        sent.append((source, mutated(whole, mutation)))
    same(of, [*sent, (source, plain)])


@pytest.mark.slow
@given(
    st.lists(
        st.tuples(
            st.sampled_from([*[b"abc"] * 5, b"", b"\xc3\xa9a", b"\xff\xfe\xfd"]),
            st.sampled_from([*[1.0, 0.0] * 9, *FLOATS]),
            st.sampled_from([0, -5, 2**53 - 1, 2**53, -(2**53), 2**62 + 1]),
            st.sampled_from([0, 1, 3, 3, 2]),
            st.integers(0, 2),
            st.tuples(*[st.sampled_from([*[7.25] * 9, *FLOATS])] * 3),
            mutations,
        ),
        min_size=2,
        max_size=10,
    )
)
@example(
    [
        (b"abc", 1.0, 0, 0, 0, (7.25, 7.25, 7.25), None),
        (b"abc", math.inf, 0, 0, 0, (7.25, 7.25, 7.25), ("flip", 192, 1)),  # a NaN that signals
    ]
)
@examples(40)
def test_numbers_have_the_values_of_the_official_decoder(
    some: list[tuple[bytes, float, int, int, int, tuple[float, ...], tuple[str, int, int] | None]],
) -> None:
    source = channel("one/msg/T", CUSTOM)
    usual = custom(b"abc", 1.0, 5, 1, 1, (1.0, 2.0, 3.0))
    others = [mutated(custom(s, f, i, mode, b, a), how) for s, f, i, mode, b, a, how in some]
    sent = [usual, *others, usual]
    same(declare(NUMBERS), [(source, each) for each in sent])


def test_usual_messages_are_read_alone_from_the_second_on() -> None:
    policy = f"{VALID}\n{INVALID.format('drop', 'far', 'near', 'drop')}"
    of = declare(SCAN.format(footprint=FOOTPRINT, policy=policy, unit="m"))
    source = channel("sensor_msgs/msg/LaserScan")
    some = [scan([1.0, 2.0, 0.5 + i, INF, 3.0, NAN], i * S).payload for i in range(1, 9)]
    assert same(of, [(source, each) for each in some]) == 7
    sent = [
        (channel("one/msg/T", CUSTOM), custom(b"a", 1.0, i, 1, 1, (1.0, 2.0, 3.0)))
        for i in range(8)
    ]
    assert same(declare(NUMBERS), sent) == 7


def test_big_endian_messages_are_left_to_the_decoder() -> None:
    of = declare('[clock]\ntick = "1 s"\n[signal.x]\npath = "/x.data"\n')
    source = channel("std_msgs/msg/Float64")
    sent = [b"\0\1\0\0" + struct.pack("<d", 2.5), b"\0\0\0\0" + struct.pack(">d", 2.5)] * 3
    assert same(of, [(source, each) for each in sent]) == 2


def test_a_stamp_that_was_never_set_makes_a_message_unknown() -> None:
    of = declare(SCAN.format(footprint=FOOTPRINT, policy="", unit="m"))
    source = channel("sensor_msgs/msg/LaserScan")
    some = [scan([1.0] * 6, S, stamp=stamp).payload for stamp in (S, S, 0, 3 * S)]
    assert same(of, [(source, each) for each in some]) == 3
