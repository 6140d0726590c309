"""The messages between a Foxglove WebSocket server and its client.

An untrusted server is read strictly: a violation of the protocol is an error, and unknown newer
messages are ignored.

Source: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md
"""

from __future__ import annotations

import binascii
import json
import struct
from base64 import b64decode
from collections.abc import Collection, Mapping
from urllib.parse import SplitResult, urlsplit

from compiler.files.checked_json import JsonValue, SchemaError
from compiler.files.checked_json import plain as json_value
from fretc.watch.sources.source import Channel
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
"""The names of the protocol: of the SDK, and of older servers."""
LARGEST_SCHEMA = 2**20
"""The most characters of a type definition."""
_DATA_HEAD = struct.Struct("<xIQ")
_SCHEMA_ENCODINGS: Mapping[str, str] = {
    "cdr": "ros2msg",
    "ros1": "ros1msg",
    "json": "jsonschema",
    "protobuf": "protobuf",
    "flatbuffer": "flatbuffer",
}
"""For each encoding of messages, the encoding of its schema, unless the server states one."""
_BINARY = ("protobuf", "flatbuffer")
"""Encodings of schemas that are bytes, which a server sends as base64."""


@dataclass(frozen=True, slots=True)
class Greeting:
    """The first message of a server."""


@dataclass(frozen=True, slots=True)
class Advertised:
    """A channel that the server offers."""

    id: int
    topic: str
    channel: Channel | str
    """The channel, or the reason why it cannot be read."""


@dataclass(frozen=True, slots=True)
class Advertisement:
    """Channels of the wanted topics."""

    channels: tuple[Advertised, ...]


@dataclass(frozen=True, slots=True)
class ChannelWithdrawal:
    """Channels that the server no longer offers."""

    ids: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Status:
    """A status message of the server, for people."""

    is_grave: bool
    text: str


@dataclass(frozen=True, slots=True)
class Data:
    """A message of a channel."""

    subscription: int
    time: int
    """The receive time at the server, in nanoseconds of its clock."""
    payload: bytes


@dataclass(frozen=True, slots=True)
class ServerTime:
    """The time of the server, which sets the clock."""


Message = Greeting | Advertisement | ChannelWithdrawal | Status | Data | ServerTime


def read(message: str | bytes, topics: Collection[str]) -> Message | None:
    """One message of a server; None: it does not concern these topics.

    Raises:
        SchemaError: the message violates the protocol.
    """
    return _text(message, topics) if isinstance(message, str) else _binary(message)


def _binary(message: bytes) -> Message | None:
    match message[:1]:
        case b"":
            raise SchemaError("a binary message is empty")
        case b"\x01":
            if len(message) < _DATA_HEAD.size:
                raise SchemaError("a message of a channel is truncated")
            subscription, time = _DATA_HEAD.unpack_from(message)
            return Data(subscription, time, message[_DATA_HEAD.size :])
        case b"\x02":
            return ServerTime()
        case _:
            return None


def _text(message: str, topics: Collection[str]) -> Message | None:
    shape = JsonValue(json_value(message))
    match shape.field("op").text():
        case "serverInfo":
            return Greeting()
        case "advertise":
            items = shape.field("channels").items()
            return Advertisement(tuple(_advertised(item) for item in items if _is_in(item, topics)))
        case "unadvertise":
            return ChannelWithdrawal(
                tuple(item.count() for item in shape.field("channelIds").items())
            )
        case "status":
            return Status(shape.field("level").count() > 0, shape.field("message").text())
        case _:
            return None


def _is_in(channel: JsonValue, topics: Collection[str]) -> bool:
    return channel.field("topic").text() in topics


def _advertised(shape: JsonValue) -> Advertised:
    encoding, schema = shape.field("encoding").text(), shape.field("schema").text()
    of_schema = _SCHEMA_ENCODINGS.get(encoding, "")
    if shape.has("schemaEncoding") and shape.field("schemaEncoding").value is not None:
        of_schema = shape.field("schemaEncoding").text()
    id, topic = shape.field("id").count(), shape.field("topic").text()
    name = shape.field("schemaName").text()
    size = sum(map(len, (encoding, name, of_schema, schema)))
    if size > LARGEST_SCHEMA:
        return Advertised(id, topic, "the definition of its type is larger than any type needs")
    try:
        data = b64decode(schema, validate=True) if of_schema in _BINARY else schema.encode()
        for text in (encoding, name, of_schema):
            text.encode()
    except binascii.Error:
        return Advertised(id, topic, "the definition of its type is not base64")
    except UnicodeEncodeError:
        return Advertised(id, topic, "the definition of its type is not Unicode")
    return Advertised(id, topic, Channel(topic, encoding, name, of_schema, data))


def subscribe(subscription: int, channel: int) -> str:
    """The message that subscribes to a channel by a number of the client's."""
    wanted = [{"id": subscription, "channelId": channel}]
    return json.dumps({"op": "subscribe", "subscriptions": wanted})


def unsubscribe(subscription: int) -> str:
    """The message that ends a subscription."""
    return json.dumps({"op": "unsubscribe", "subscriptionIds": [subscription]})


def address(url: str) -> SplitResult | Diagnostic:
    """The parts of the URL of a server, or a diagnostic about it."""
    try:
        parts = urlsplit(url)
        is_named = parts.scheme in ("ws", "wss") and parts.hostname and parts.port != 0
    except ValueError:
        return _no_url(url)
    is_plain = url.isascii() and url.isprintable() and " " not in url and not parts.fragment
    return parts if is_named and is_plain else _no_url(url)


def _no_url(text: str) -> Diagnostic:
    if not text:
        return diagnostic("no_foxglove_server_named")
    return diagnostic("bad_foxglove_url", text=text)
