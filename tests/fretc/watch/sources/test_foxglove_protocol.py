"""What a server of somebody else says is a message, nothing of interest, or not of the protocol."""

import json
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.files.checked_json import SchemaError
from fretc.watch.sources.foxglove_protocol import (
    LARGEST_SCHEMA,
    Advertisement,
    ChannelWithdrawal,
    Data,
    Status,
    read,
)
from fretc.watch.sources.source import Channel
from tests.each import each
from tests.effort import examples
from tests.foxglove import advertisement, channel

values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=6,
)
KEYS = ("op", "channels", "channelIds", "level", "message")
OPS = ("serverInfo", "advertise", "unadvertise", "status")
OF_CHANNEL = ("id", "topic", "encoding", "schemaName", "schema", "schemaEncoding")
channels = st.fixed_dictionaries(
    {}, optional={key: values | st.sampled_from(["/x", "protobuf"]) for key in OF_CHANNEL}
)
texts = st.text() | st.fixed_dictionaries(
    {"op": st.sampled_from(OPS) | values},
    optional={key: values | st.lists(channels | st.integers(), max_size=3) for key in KEYS[1:]},
).map(json.dumps)


@examples(10)
@given(texts | st.binary() | st.binary().map(lambda data: b"\x01" + data))
def test_nothing_that_a_stranger_says_is_more_than_an_error(message: str | bytes) -> None:
    with suppress(SchemaError):
        read(message, {"/x"})


def test_a_message_that_is_nested_without_end_is_an_error() -> None:
    with pytest.raises(SchemaError, match="nested"):
        read('{"op":' + "[" * 100_000, {"/x"})


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**64 - 1), st.binary())
def test_data_is_read_as_the_specification_lays_it_out(
    subscription: int, time: int, payload: bytes
) -> None:
    head = b"\x01" + subscription.to_bytes(4, "little") + time.to_bytes(8, "little")
    assert read(head + payload, ()) == Data(subscription, time, payload)
    with pytest.raises(SchemaError):
        read(head[:-1], ())


def test_only_channels_of_the_topics_are_looked_at() -> None:
    other = {"topic": "/other"}
    found = read(advertisement(other, channel(3), other), {"/x"})  # type: ignore[arg-type]
    assert isinstance(found, Advertisement)
    assert [each.id for each in found.channels] == [3]


GUESSES = {"cdr": "ros2msg", "ros1": "ros1msg", "json": "jsonschema", "protobuf": "protobuf"}


@each("encoding", [*GUESSES, "own"])
def test_the_encoding_of_a_schema_follows_from_that_of_the_messages(encoding: str) -> None:
    for absent in ({"schemaEncoding": None}, {}):
        about = channel(1, encoding=encoding, schema="AAA=", schemaName="T")
        del about["schemaEncoding"]
        found = read(advertisement({**about, **absent}), {"/x"})
        assert isinstance(found, Advertisement)
        data = b"\0\0" if encoding == "protobuf" else b"AAA="
        expected = Channel("/x", encoding, "T", GUESSES.get(encoding, ""), data)
        assert found.channels[0].channel == expected


@each(
    "about",
    [
        {"schemaEncoding": "protobuf", "schema": "no base64"},
        {"schema": "x" * (LARGEST_SCHEMA + 1)},
        {"schemaName": "\udc80"},
    ],
)
def test_a_definition_that_cannot_be_one_is_refused(about: dict[str, object]) -> None:
    found = read(advertisement({**channel(1), **about}), {"/x"})
    assert isinstance(found, Advertisement)
    assert isinstance(found.channels[0].channel, str)


def test_the_other_messages() -> None:
    assert read('{"op": "unadvertise", "channelIds": [1, 2]}', ()) == ChannelWithdrawal((1, 2))
    assert read('{"op": "status", "level": 1, "message": "m"}', ()) == Status(True, "m")
    assert read('{"op": "status", "level": 0, "message": "m"}', ()) == Status(False, "m")
    assert read('{"op": "of a later version"}', ()) is None
    assert read(b"\x77", ()) is None
