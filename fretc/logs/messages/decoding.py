"""Decoders of payloads: ROS 2 (cdr with ros2msg or ros2idl), ROS 1, JSON and Protobuf.

A message definition may be any text, and a payload any bytes.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import lru_cache
from io import StringIO

from mcap.records import Schema

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages import idl, protobuf
from fretc.logs.messages import json_messages as jsontext
from fretc.logs.messages.definitions import TypesTooLargeError, types
from fretc.logs.messages.definitions import constants as constants_of_ros
from fretc.logs.messages.layouts import TopicType, Where
from fretc.logs.messages.leaves import FieldKind, Leaf, Leaves
from fretc.logs.signals.signals import Sparse, fields, optional_field
from fretish.bindings.declarations import short_type
from fretish.classes.frozen import dataclass

Decode = Callable[[bytes], object]
"""A payload → an object with the message's fields; it may raise any exception."""

_STAMPS = (("sec", "nanosec"), ("secs", "nsecs"))
"""Names of the fields of a stamp in ROS 2 and in ROS 1."""
_SPARSE_STAMPS = (("seconds", "nanos"), ("sec", "nsec"))
"""Names of the fields in google.protobuf.Timestamp, and in Foxglove's JSON and Gazebo's
messages."""
_LAID_OUT = ("ros1msg", "ros2msg", "ros2idl")
_EXTRAS = {"protobuf": ("mcap-protobuf-support", "protobuf"), "cdr": ("rosbags", "bags")}
"""The package that decodes an encoding, and the extra that installs it."""

_NAME = r"[A-Za-z][A-Za-z0-9_]*"
_ROS1_TYPE = re.compile(rf"{_NAME}/{_NAME}")
_FIELD = re.compile(rf"{_NAME}(/{_NAME})?(\[[0-9]*\])? {_NAME}")
_CONSTANT = re.compile(rf"{_NAME} [^=]*=")
_NEXT_TYPE = re.compile(rf"MSG: {_NAME}/{_NAME}")
_SERVICE_EVENT = re.compile(rf"{_NAME}/srv/{_NAME}_Event")
_SEPARATOR = re.compile(r"={3,}")


class MissingExtra(str):
    """The reason why the messages of a stream cannot be decoded: an extra is not installed."""

    __slots__ = ("extra",)

    def __new__(cls, package: str, extra: str) -> MissingExtra:
        """The reason for a missing `package`."""
        text = super().__new__(cls, f"that needs `{package}`")
        text.extra = extra
        return text

    extra: str
    """The name of the extra for pip."""


@dataclass(frozen=True, slots=True)
class ServiceEventInfo:
    """service_msgs/ServiceEventInfo, as far as signals read it."""

    event_type: int


@dataclass(frozen=True, slots=True)
class ServiceEvent:
    """The first field of a message on `_service_event`; the others differ by service."""

    info: ServiceEventInfo


def _service_event(payload: bytes) -> ServiceEvent:
    """The event of a service, whose type is the first byte of its message.

    rosidl begins each event with it. The definition is not needed: rosbag2 records that of the
    service in a form of its own, or none.
    """
    return ServiceEvent(ServiceEventInfo(_plain(payload)[4]))


def decoder(stream: ChannelDefinition) -> Decode | str:
    """The decoder of the messages of a stream, or the reason why there is none."""
    encoding, schema = stream.channel.message_encoding, stream.schema
    if schema is not None and encoding == "cdr" and _SERVICE_EVENT.fullmatch(schema.name):
        return _service_event
    if schema is None and encoding != "json":
        return "its messages have no definition"
    try:
        match encoding, schema.encoding if schema is not None else "":
            case "json", "jsonschema" | "":
                jsontext.schema_leaves(schema.data if schema is not None else b"")
                return jsontext.decode
            case "protobuf", "protobuf":
                return protobuf.decoder(stream)
            case "cdr", "ros2idl":
                decode = idl.decoder(stream)
                return lambda payload: decode(_plain(payload))
            case "cdr", "ros2msg":
                assert schema is not None
                return _ros2(schema.name, schema.data)
            case "ros1", "ros1msg":
                assert schema is not None
                return _ros1(schema.name, schema.data)
            case _, defined:
                return f"its messages are encoded as `{encoding}`, defined in `{defined}`"
    except ModuleNotFoundError:
        package, extra = _EXTRAS[encoding]
        return MissingExtra(package, extra)
    except Exception:  # the parsers trust the definition
        return "the definition of its messages cannot be read"


def shape(stream: ChannelDefinition) -> TopicType | None:
    """The shape of the messages of a stream; None: only its decoder can read them."""
    schema = stream.schema
    if schema is None or schema.encoding not in _LAID_OUT:
        return None
    return _shape(schema.encoding, schema.name, schema.data)


def is_single(stream: ChannelDefinition, where: Sequence[str]) -> bool:
    """Whether the numbers of a field are 32-bit floats.

    Args:
        stream: a stream whose messages can be decoded.
        where: the names of fields from the message down.
    """
    if stream.channel.message_encoding == "protobuf":
        return protobuf.is_single(stream, where)
    layout = shape(stream)
    field = layout.number(tuple(where)) if layout is not None else None
    return field is not None and field.type == "float32"


def constants(stream: ChannelDefinition, where: Sequence[str]) -> Mapping[str, int] | None:
    """The names that the definition of messages has for the numbers of a field.

    In ROS they are the constants of the type that has the field, in Protobuf those of its enum.

    Args:
        stream: a stream whose messages can be decoded.
        where: the names of fields from the message down.

    Returns:
        None where the field holds no numbers, or only each message tells.
    """
    if stream.channel.message_encoding == "protobuf":
        return protobuf.constants(stream, where)
    layout, schema = shape(stream), stream.schema
    holder = layout.holder(tuple(where)) if layout is not None else None
    if schema is None or holder is None:
        return None
    return _constants(schema.encoding, schema.name, schema.data).get(holder, {})


_MOST = 256
"""The number of cached definitions: all logs of a robot have the same ones."""


@lru_cache(_MOST)
def _constants(encoding: str, name: str, data: bytes) -> Mapping[str, Mapping[str, int]]:
    """The constants of each type in a message, whose definition has a shape."""
    if encoding == "ros2idl":
        return idl.constants(data.decode())
    return constants_of_ros(name, data.decode())


@lru_cache(_MOST)
def _shape(encoding: str, name: str, data: bytes) -> TopicType | None:
    ros1 = encoding == "ros1msg"
    try:
        definition = data.decode()
        if encoding == "ros2idl":
            definitions = idl.types(name, definition)
        else:
            definitions = types(name, definition, ros1=ros1)
    except Exception:  # not UTF-8, unsupported, or an error of the parser
        return None
    return TopicType(short_type(name), definitions, cdr=not ros1)


def leaves(stream: ChannelDefinition, payloads: Sequence[bytes] = ()) -> Leaves | None:
    """The numbers, truth values and texts in the messages of a stream.

    Args:
        stream: the stream of the messages.
        payloads: some of the messages; those in JSON show fields that their schema leaves open.

    Returns:
        None where its messages cannot be read.
    """
    if isinstance(decoder(stream), str):
        return None
    match stream.channel.message_encoding:
        case "json":
            named = jsontext.schema_leaves(stream.schema.data if stream.schema is not None else b"")
            seen = jsontext.message_leaves(payloads)
            return named | {path: seen[path] for path in seen if path not in named}
        case "protobuf":
            return protobuf.leaves(stream)
    layout = shape(stream)
    if layout is None:
        return {}
    numbers = dict(_number(stream, layout, where) for where in layout.numbers())
    return numbers | {".".join(where): Leaf(FieldKind.TEXT) for where in layout.texts()}


def _number(stream: ChannelDefinition, layout: TopicType, where: Where) -> tuple[str, Leaf]:
    """The path of a number, or of an array of numbers, and its kind."""
    field = layout.number(where)
    assert field is not None
    kind = FieldKind.FLAG if field.type == "bool" else FieldKind.NUMBER
    path = f"{'.'.join(where)}{'[:]' if field.many else ''}"
    return path, Leaf(kind, _named(stream, layout, where) if "int" in field.type else {})


def _named(stream: ChannelDefinition, layout: TopicType, where: Where) -> Mapping[str, int]:
    """The constants that are most likely meant for a field, which ROS does not define.

    Their names begin with the name of the field; or the field is the only whole number of its type.
    """
    named_constants = constants(stream, where) or {}
    begins = f"{where[-1].upper()}_"
    own = {name: number for name, number in named_constants.items() if name.startswith(begins)}
    holder = layout.holder(where)
    whole = [field for field in layout.types[holder] if "int" in field.type] if holder else []
    return own or (named_constants if len(whole) == 1 else {})


@lru_cache(_MOST)
def _ros2(name: str, data: bytes) -> Decode:
    from mcap_ros2.decoder import DecoderFactory

    _measured(name, data.decode(), ros1=False)
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):  # its parser prints
        decode = DecoderFactory().decoder_for("cdr", Schema(1, data, "ros2msg", name))
    assert decode is not None
    return lambda payload: decode(_plain(payload))


def _plain(payload: bytes) -> bytes:
    """The payload, if it is plain CDR, which its first two bytes state."""
    if payload[:2] not in (b"\0\0", b"\0\1"):
        raise ValueError("not plain CDR")
    return payload


@lru_cache(_MOST)
def _ros1(name: str, data: bytes) -> Decode:
    """A decoder from the fields alone.

    The library turns the definition into Python code and executes it: constants, comments and names
    of any other kind would be executed too.

    Raises:
        ValueError: the definition contains something else, or it is too large.
    """
    from mcap_ros1.decoder import DecoderFactory

    if not _ROS1_TYPE.fullmatch(name):
        raise ValueError(f"`{name}` is no type")
    text = _fields_only(data.decode())
    _measured(name, text, ros1=True)
    bare = Schema(1, text.encode(), "ros1msg", name)
    decode = DecoderFactory().decoder_for("ros1", bare)
    assert decode is not None
    return decode


def _measured(name: str, definition: str, *, ros1: bool) -> None:
    """Check the size of the types, because official decoders expand nested types and arrays.

    Raises:
        TooLargeError: the expansion would not end, or be too large.
    """
    try:
        types(name, definition, ros1=ros1)
    except TypesTooLargeError:
        raise
    except ValueError:  # the official parser knows more
        return


def _fields_only(definition: str) -> str:
    """The definition of a ROS 1 message with only types and names of fields.

    Raises:
        ValueError: the definition contains something other than fields, constants and comments.
    """
    lines = []
    for line in definition.splitlines():
        bare = " ".join(line.split("#")[0].split())
        if _SEPARATOR.fullmatch(bare):
            lines.append("=" * 80)
        elif _FIELD.fullmatch(bare):
            lines.append(bare)
        elif _NEXT_TYPE.fullmatch(bare):
            lines += [
                bare,
                "",
            ]  # the parser cuts off the name of an empty type without a line after it
        elif bare and not _CONSTANT.match(bare):
            raise ValueError(f"`{bare}` is no field")
    return "\n".join(lines)


def stamp(message: object | None) -> int | None:
    """`header.stamp` in nanoseconds; None for a message without one.

    Of JSON and Protobuf the field `timestamp` too, which Foxglove's messages have instead.
    """
    time = optional_field(optional_field(message, "header"), "stamp")
    if not isinstance(message, Sparse):
        return _nanoseconds(time, _STAMPS)
    if time is None:
        time = optional_field(message, "timestamp")
    return _nanoseconds(time, (*_STAMPS, *_SPARSE_STAMPS))


def _nanoseconds(time: object | None, kinds: Sequence[tuple[str, str]]) -> int | None:
    names = fields(time)
    for parts in kinds:
        if all(part in names for part in parts):
            seconds, nanoseconds = (optional_field(time, part) for part in parts)
            if isinstance(seconds, int) and isinstance(nanoseconds, int):
                return seconds * 10**9 + nanoseconds
    return None
