"""Payloads decoded: ROS 2 messages (cdr with ros2msg) and ROS 1 messages (ros1 with ros1msg).

A message definition may be any text, and a payload any bytes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from io import StringIO

from monitors.container import Stream
from monitors.definitions import types
from monitors.layouts import Shape
from monitors.signals import fields

Decode = Callable[[bytes], object]
"""From a payload to an object with the message's fields; it raises whatever it likes."""

_NAME = r"[A-Za-z][A-Za-z0-9_]*"
_ROS1_TYPE = re.compile(rf"{_NAME}/{_NAME}")
_FIELD = re.compile(rf"{_NAME}(/{_NAME})?(\[[0-9]*\])? {_NAME}")
_CONSTANT = re.compile(rf"{_NAME} [^=]*=")
_NEXT_TYPE = re.compile(rf"MSG: {_NAME}/{_NAME}")
_SEPARATOR = re.compile(r"={3,}")


def decoder(stream: Stream) -> Decode | str:
    """What decodes the messages of a stream, or why nothing does."""
    encoding, schema = stream.channel.message_encoding, stream.schema
    if schema is None:
        return "its messages have no definition"
    try:
        match encoding, schema.encoding:
            case "cdr", "ros2msg":
                return _ros2(stream)
            case "ros1", "ros1msg":
                return _ros1(stream)
            case _:
                return f"its messages are encoded as `{encoding}`, defined in `{schema.encoding}`"
    except Exception:  # the parsers trust the definition
        return "the definition of its messages cannot be read"


def shape(stream: Stream) -> Shape | None:
    """How the messages of a stream are laid out; None where only its decoder knows."""
    schema = stream.schema
    if schema is None:
        return None
    ros1 = schema.encoding == "ros1msg"
    try:
        known = types(schema.name, schema.data.decode(), ros1=ros1)
    except ValueError:  # no UTF-8, or nothing that is laid out
        return None
    return Shape(short_type(schema.name), known, cdr=not ros1)


def _ros2(stream: Stream) -> Decode:
    from mcap_ros2.decoder import DecoderFactory

    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):  # its parser prints
        decode = DecoderFactory().decoder_for("cdr", stream.schema)
    assert decode is not None
    return lambda payload: decode(_plain(payload))


def _plain(payload: bytes) -> bytes:
    """The payload, if it is plain CDR: its first two bytes tell the representation."""
    if payload[:2] not in (b"\0\0", b"\0\1"):
        raise ValueError("not plain CDR")
    return payload


def _ros1(stream: Stream) -> Decode:
    """With the decoder that is made of the fields alone.

    It makes Python code of the definition and runs it: constants, comments and names of any
    other kind would run too.

    Raises:
        ValueError: something else is in the definition.
    """
    from mcap_ros1.decoder import DecoderFactory

    schema = stream.schema
    assert schema is not None
    if not _ROS1_TYPE.fullmatch(schema.name):
        raise ValueError(f"`{schema.name}` is no type")
    bare = replace(schema, data=_fields_only(schema.data.decode()).encode())
    decode = DecoderFactory().decoder_for("ros1", bare)
    assert decode is not None
    return decode


def _fields_only(definition: str) -> str:
    """The definition of a ROS 1 message with nothing in it but types and names of fields.

    Raises:
        ValueError: something else is in it than those, constants and comments.
    """
    lines = []
    for line in definition.splitlines():
        bare = " ".join(line.split("#")[0].split())
        if _SEPARATOR.fullmatch(bare):
            lines.append("=" * 80)
        elif _FIELD.fullmatch(bare):
            lines.append(bare)
        elif _NEXT_TYPE.fullmatch(bare):
            lines += [bare, ""]  # without a line after it, the name of an empty type is cut off
        elif bare and not _CONSTANT.match(bare):
            raise ValueError(f"`{bare}` is no field")
    return "\n".join(lines)


def stamp(message: object | None) -> int | None:
    """`header.stamp` in nanoseconds; None for a message without one."""
    time = getattr(getattr(message, "header", None), "stamp", None)
    names = fields(time)
    for parts in (("sec", "nanosec"), ("secs", "nsecs")):
        if all(part in names for part in parts):
            seconds, nanoseconds = (getattr(time, part) for part in parts)
            if isinstance(seconds, int) and isinstance(nanoseconds, int):
                return seconds * 10**9 + nanoseconds
    return None


def short_type(name: str) -> str:
    """`sensor_msgs/LaserScan` for ROS 2's `sensor_msgs/msg/LaserScan`."""
    return name.replace("/msg/", "/")
