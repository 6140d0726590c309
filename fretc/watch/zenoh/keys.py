"""Keys, liveliness tokens and attachments of rmw_zenoh, and what they say in ROS 2.

A message has the key `<domain>/<topic>/<type>/<hash>`; a publisher has a token in `@ros2_lv`, with
`%` for each `/` within a part. Everything is from the network: what has another form is no key, no
token, no attachment.

Source: https://github.com/ros2/rmw_zenoh/blob/rolling/docs/design.md
"""

from __future__ import annotations

import re
from struct import Struct

from fretc.watch.sources.dds_types import ros_type
from fretish.classes.frozen import dataclass

LONGEST_ATTACHMENT = 77
"""Bytes of the longest known attachment."""
_LOCATOR = re.compile(r"(tcp|tls|udp|quic|ws)/(\[[0-9A-Fa-f:.%]+\]|[\w.-]+):[0-9]{1,5}", re.ASCII)
_NO_HASH = "TypeHashNotSupported"
"""In place of the type hash, by Humble and by publishers that do not know it."""
_TOPIC = re.compile(r"/?\w+(/\w+)*", re.ASCII)
_PART = re.compile(r"[^/*$?#]{1,255}")
_TOKEN_PARTS = 13
_DOMAIN, _PUBLISHER, _NAMESPACE, _NODE, _NAME, _TYPE, _HASH = 1, 5, 7, 8, 9, 10, 11
"""Places of the parts of a token."""
_NUMBERS = Struct("<qq")
_GID = 16
"""Bytes of the identifier of a publisher."""


@dataclass(frozen=True, slots=True)
class Kind:
    """The type of the messages of a publisher."""

    type: str
    """`sensor_msgs/msg/LaserScan`, or the unchanged name of a type that is not of ROS 2."""
    hash: str | None
    """The hash of the definition, `RIHS01_...`; None: the publisher does not state it."""


@dataclass(frozen=True, slots=True)
class Token:
    """What the token of a publisher says."""

    node: str
    """`/talker`."""
    key: str
    """The key of its messages."""


@dataclass(frozen=True, slots=True)
class Attachment:
    """What a publisher attaches to a message."""

    number: int
    """The number of the message, one more than the one before it."""
    sent: int | None
    """The send time in nanoseconds, on the clock of the publisher; None: not stated."""
    gid: bytes
    """The identifier of the publisher."""


def is_locator(text: str) -> bool:
    """Whether it has the form of a locator of Zenoh: `tcp/localhost:7447`."""
    return _LOCATOR.fullmatch(text) is not None


def has_key(topic: str) -> bool:
    """Whether the topic is a name of ROS 2, which is safe in a key."""
    return _TOPIC.fullmatch(topic) is not None


def keys_of_messages(domain: int, topic: str) -> str:
    """The key expression of the messages of a topic: `0/scan/*/*`."""
    return f"{domain}/{topic.removeprefix('/')}/*/*"


def keys_of_tokens(domain: int, topic: str) -> str:
    """The key expression of the tokens of the publishers of a topic."""
    name = topic if topic.startswith("/") else f"/{topic}"
    return f"@ros2_lv/{domain}/*/*/*/MP/*/*/*/{name.replace('/', '%')}/*/*/*"


def kind_of_message(key: str) -> Kind | None:
    """The type of a message that has this key."""
    parts = key.split("/")
    if len(parts) < 4 or not all(map(_PART.fullmatch, parts)):
        return None
    name, digest = parts[-2:]
    return Kind(ros_type(name), None if digest == _NO_HASH else digest)


def token(key: str) -> Token | None:
    """What a token says; None: it is none of a publisher."""
    parts = key.split("/")
    if len(parts) != _TOKEN_PARTS or not all(map(_PART.fullmatch, parts)):
        return None
    if parts[_PUBLISHER] != "MP":
        return None
    namespace, topic = (parts[place].replace("%", "/").rstrip("/") for place in (_NAMESPACE, _NAME))
    key = "/".join([parts[_DOMAIN], topic.removeprefix("/"), parts[_TYPE], parts[_HASH]])
    return Token(f"{namespace}/{parts[_NODE]}", key)


def attached(of: Attachment) -> bytes:
    """The bytes of an attachment, as `attachment` reads them."""
    return _NUMBERS.pack(of.number, of.sent or 0) + bytes([len(of.gid)]) + of.gid


def attachment(data: bytes) -> Attachment | None:
    """What is attached to a message; None: nothing that is known.

    The fields are the number, the send time and the identifier, which has its length before it.
    Jazzy's first releases wrote the name of each field before it.
    """
    names = (b"\x0fsequence_number", b"\x10source_timestamp", b"\x0asource_gid")
    if all(name in data for name in names):
        first, second, third = names
        pattern = first + b"(.{8})" + second + b"(.{8})" + third + b"(.*)"
        match = re.fullmatch(pattern, data, re.DOTALL)
        data = b"".join(match.groups()) if match else b""
    if len(data) != _NUMBERS.size + 1 + _GID or data[_NUMBERS.size] != _GID:
        return None
    number, sent = _NUMBERS.unpack_from(data)
    if number < 0:
        return None
    return Attachment(number, sent if sent > 0 else None, data[-_GID:])
