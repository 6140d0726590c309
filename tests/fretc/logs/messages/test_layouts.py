import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.records import Channel, Schema

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.payloads import Payloads
from fretc.logs.messages.decoding import decoder, shape
from fretc.logs.messages.layouts import LayoutError, Layouts, TopicType
from tests.effort import FULL
from tests.fretc.logs.kinds import Encoder, Kind, Part, kinds, message, official

BOTH = pytest.mark.parametrize("ros1", [False, True])


def read(encoder: Encoder, payloads: list[bytes]) -> int:
    """Hold all that the layouts find against the decoder; gives how many rows they read."""
    decode, known = decoder(encoder.stream), shape(encoder.stream)
    assert callable(decode)
    assert known is not None
    batch, wanted, seen, rows = Payloads.of(payloads), known.numbers(), [], 0
    for group in Layouts(known, wanted).groups(batch):
        seen += group.rows.tolist()
        if group.layout is None:
            continue
        rows += len(group.rows)
        messages = [decode(payloads[row]) for row in group.rows]  # never one that is refused
        for where in wanted:
            field = group.layout.locations[where]
            found = batch.gathered(group.rows, field.at, field.dtype, field.count)
            assert len(found) == len(messages)
            with np.errstate(invalid="ignore"):  # of a NaN that signals
                numbers = found.astype(float)
            for one, other in zip(numbers, messages, strict=True):
                assert np.array_equal(one, official(other, where), equal_nan=True)
    assert sorted(seen) == list(range(len(payloads)))
    return rows


@pytest.mark.slow
@BOTH
@given(data=st.data(), seed=st.integers(0, 2**32))
@settings(max_examples=2000 if FULL else 6)
def test_every_number_is_what_the_official_decoder_reads(
    data: st.DataObject, seed: int, *, ros1: bool
) -> None:
    kind = data.draw(kinds(ros1=ros1))
    encoder, some = Encoder(kind, ros1=ros1), random.Random(seed)
    payloads = [encoder(message(kind, some, ros1=ros1)) for _ in range(8)]
    texts = [payload for payload in payloads if ros1 or b"\xc3" not in payload]
    assert read(encoder, payloads) >= len([p for p in texts if p.isascii()])


@pytest.mark.slow
@BOTH
@given(data=st.data(), seed=st.integers(0, 2**32))
@settings(max_examples=2000 if FULL else 5)
def test_a_damaged_payload_is_read_as_the_official_decoder_does_or_left_to_it(
    data: st.DataObject, seed: int, *, ros1: bool
) -> None:
    kind = data.draw(kinds(ros1=ros1))
    encoder, some = Encoder(kind, ros1=ros1), random.Random(seed)
    whole = [encoder(message(kind, some, ros1=ros1)) for _ in range(3)]
    read(encoder, [damaged(some.choice(whole), some) for _ in range(24)] + whole)


def damaged(payload: bytes, some: random.Random) -> bytes:
    """Cut, lengthened, declared big-endian, or with some bits turned over."""
    match some.randrange(5):
        case 0:
            return payload[: some.randrange(len(payload) + 1)]
        case 1:
            return payload + some.randbytes(some.randrange(1, 12))
        case 2:
            return b"\0\0" + payload[2:]
        case _:
            data = bytearray(payload)
            for _ in range(some.randrange(1, 3)):
                if data:
                    data[some.randrange(min(len(data), 60))] ^= 1 << some.randrange(8)
            return bytes(data)


# Single layouts


def known(text: str, *, ros1: bool = False, name: str = "one/T") -> TopicType:
    found = shape(stream(text, ros1=ros1, name=name))
    assert found is not None
    return found


def stream(text: str, *, ros1: bool = False, name: str = "one/T") -> ChannelDefinition:
    schema = Schema(1, text.encode(), "ros1msg" if ros1 else "ros2msg", name)
    return ChannelDefinition(Channel(1, "/x", "ros1" if ros1 else "cdr", {}, 1), schema)


def at(shape: TopicType, payload: bytes, *where: str) -> tuple[int, int | None]:
    found = shape.layout(memoryview(payload), [where]).locations[where]
    return found.at, found.count


PLAIN = b"\0\1\0\0"


def test_an_8_byte_number_after_an_odd_text_begins_at_the_next_multiple_of_8() -> None:
    payload = PLAIN + b"\4\0\0\0abc\0" + b"d" * 8
    assert at(known("string a\nfloat64 b"), payload, "b") == (12, None)
    payload = PLAIN + b"\5\0\0\0abcd\0" + bytes(7) + b"d" * 8
    assert at(known("string a\nfloat64 b"), payload, "b") == (20, None)


def test_an_empty_array_of_8_byte_numbers_takes_no_room_to_align() -> None:
    payload = PLAIN + b"\0\0\0\0" + b"\7\0\0\0"
    assert at(known("float64[] a\nint32 b"), payload, "b") == (8, None)
    assert at(known("float64[] a\nint32 b"), payload, "a") == (8, 0)


def test_ros_2_writes_a_byte_for_an_empty_type_and_ros_1_nothing() -> None:
    text = "one/E a\nuint8 b\n===\nMSG: one/E\n"
    assert at(known(text), PLAIN + b"\0\7", "b") == (5, None)
    assert at(known(text, ros1=True), b"\7", "b") == (0, None)


@pytest.mark.parametrize("payload", [b"", b"\0", b"\0\1", b"\0\0\0\0\7\7", b"\0\7\0\0\7\7",
                                     b"\1\1\0\0\7\7", PLAIN, PLAIN + b"\7",
                                     PLAIN + b"\7\7" + bytes(8)])  # fmt: skip
def test_what_is_not_plain_or_has_another_length_is_left_to_the_decoder(payload: bytes) -> None:
    with pytest.raises(LayoutError):
        known("uint8 a\nuint8 b").layout(memoryview(payload), [("a",)])


@pytest.mark.parametrize(
    "where", [("b",), ("s",), ("m",), ("m", "y"), ("many", "x"), ("a", "x"), ()]
)
def test_what_is_no_number_of_each_message_has_no_place(where: tuple[str, ...]) -> None:
    found = known("uint8 a\nstring s\none/M m\none/M[1] many\n===\nMSG: one/M\nuint8 x")
    assert found.numbers() == (("a",), ("m", "x"))
    assert found.number(where) is None
    assert not found.has(where)
    payload = PLAIN + b"\7\0\0\0" + b"\1\0\0\0\0" + b"\1\1"
    with pytest.raises(LayoutError):
        found.layout(memoryview(payload), [where])


def test_an_array_is_a_number_of_each_message_and_not_a_number_alone() -> None:
    found = known("uint8[] a\nuint8 b")
    assert (found.has(("a",)), found.has(("b",))) == (False, True)
    field = found.number(("a",))
    assert field is not None
    assert field.many


def test_a_time_of_ros_1_is_carried_over_only_in_the_message_itself() -> None:
    found = known("time t\nHeader h\n===\nMSG: std_msgs/Header\ntime stamp", ros1=True)
    assert found.numbers() == (("h", "stamp", "secs"), ("h", "stamp", "nsecs"))


def test_a_text_that_is_no_utf_8_is_left_to_the_decoder() -> None:
    kind = Kind("one/T", (Part("s", "string"), Part("x", "float64")))
    encoder = Encoder(kind, ros1=False)
    whole = encoder({"s": "abc", "x": 1.5})
    odd = whole.replace(b"abc", b"a\xffc")
    found = known(kind.lines())
    split = [(g.rows.tolist(), g.layout is None) for g in
             Layouts(found, found.numbers()).groups(Payloads.of([odd, whole, odd]))]  # fmt: skip
    assert split == [([1], False), ([0, 2], True)]
    assert read(encoder, [odd.replace(b"\xff", b"c"), whole]) == 2


def test_messages_of_several_lengths_are_grouped_by_their_layout() -> None:
    kind = Kind("one/T", (Part("s", "string"), Part("a", "int32", ""), Part("x", "float64")))
    encoder = Encoder(kind, ros1=False)
    # Those of "ab" and "abc" have one size, and other lengths in them.
    texts = ["ab", "abc", "ab", "", "abc", "ab"]
    sent = [encoder({"s": s, "a": [1, 2], "x": float(i)}) for i, s in enumerate(texts)]
    assert len({len(payload) for payload in (sent[0], sent[1])}) == 1
    found = known(kind.lines())
    rows = [g.rows.tolist() for g in Layouts(found, found.numbers()).groups(Payloads.of(sent))]
    assert rows == [[0, 2, 5], [1, 4], [3]]
    assert read(encoder, sent) == 6


def test_a_message_with_very_many_lengths_shares_its_layout_with_none() -> None:
    kind = Kind("one/T", (Part("s", "string", ""), Part("x", "float64")))
    encoder = Encoder(kind, ros1=False)
    sent = [encoder({"s": ["abc"] * 100, "x": float(i)}) for i in range(4)]
    found = known(kind.lines())
    assert [len(g.rows) for g in Layouts(found, found.numbers()).groups(Payloads.of(sent))] == [
        1
    ] * 4
    assert read(encoder, sent) == 4


def test_a_truth_value_of_any_byte_is_one() -> None:
    found = known("bool a\nbool[2] b")
    batch = Payloads.of([PLAIN + b"\2\0\xff"])
    (group,) = Layouts(found, [("a",), ("b",)]).groups(batch)
    assert group.layout is not None
    fields = [group.layout.locations[where,] for where in "ab"]
    numbers: list[Any] = [
        batch.gathered(group.rows, f.at, f.dtype, f.count).tolist() for f in fields
    ]
    assert numbers == [[True], [[False, True]]]


@pytest.mark.parametrize("ros1", [False, True])
def test_a_length_beyond_all_measure_is_refused_at_once(*, ros1: bool) -> None:
    head = b"" if ros1 else PLAIN
    nested = "one/A[] a\n===\nMSG: one/A\none/B[255] b\n===\nMSG: one/B\nuint8[255] c"
    for text in ("float64[] a", "string[] a", "string a", nested):
        for length in (b"\xff" * 4, b"\0\1\0\0"):
            with pytest.raises(LayoutError):
                known(text, ros1=ros1).layout(memoryview(head + length + bytes(300)), [])
