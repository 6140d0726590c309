"""Messages in Protobuf, by the definition in the log: a FileDescriptorSet.

A field whose presence is known (a submessage, a member of a `oneof`, an `optional`, every single
field of proto2) is unknown if it is left out, and never its default. The presence of a plain field
of proto3 is not known: 0 and "left out" are the same bytes, and both are 0.

Source: https://protobuf.dev/programming-guides/field_presence/.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.leaves import FieldKind, Leaf
from fretc.logs.signals.signals import Sparse, UnstatedError

_MOST = 2000
"""The most fields of one topic that are listed."""
_MOST_STEPS = 20_000
"""The most nested messages to visit."""


class Message(Sparse):
    """A decoded message."""

    __slots__ = ("_message",)

    def __init__(self, message: Any) -> None:
        self._message = message

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the fields of its type."""
        return tuple(field.name for field in self._message.DESCRIPTOR.fields)

    def field(self, name: str) -> object:
        """The value of a field; numbers of an enum, bytes, texts and messages are unchanged."""
        descriptor = self._message.DESCRIPTOR.fields_by_name[name]
        if descriptor.has_presence and not self._message.HasField(name):
            raise UnstatedError
        value = getattr(self._message, name)
        if _is_repeated(descriptor):
            return dict(value) if _is_map(descriptor) else list(value)
        return Message(value) if descriptor.message_type is not None else value


def decoder(stream: ChannelDefinition) -> Callable[[bytes], Message]:
    """The decoder of the messages of a stream.

    Raises:
        ModuleNotFoundError: the extra `protobuf` is not installed.
        Exception: of many kinds; the definition cannot be read.
    """
    official = _official(stream)
    return lambda payload: Message(official(payload))


def leaves(stream: ChannelDefinition) -> dict[str, Leaf]:
    """The numbers, truth values and texts in its messages; `a.c[:]` for a repeated number."""
    descriptor = _official(stream)(b"").DESCRIPTOR
    return dict(islice(_leaves(descriptor), _MOST))


def is_single(stream: ChannelDefinition, where: Sequence[str]) -> bool:
    """Whether the numbers of a field are 32-bit floats."""
    descriptor, field = _official(stream)(b"").DESCRIPTOR, None
    for name in where:
        field = descriptor.fields_by_name.get(name) if descriptor is not None else None
        descriptor = field.message_type if field is not None else None
    return field is not None and bool(field.type == field.TYPE_FLOAT)


def constants(stream: ChannelDefinition, where: Sequence[str]) -> Mapping[str, int] | None:
    """The names of the numbers of a field; None: it has no numbers."""
    descriptor, field = _official(stream)(b"").DESCRIPTOR, None
    for name in where:
        field = descriptor.fields_by_name.get(name) if descriptor is not None else None
        descriptor = field.message_type if field is not None else None
    if field is None or field.message_type is not None or field.cpp_type == field.CPPTYPE_STRING:
        return None
    return _names(field)


def _official(stream: ChannelDefinition) -> Callable[[bytes], Any]:
    from mcap_protobuf.decoder import DecoderFactory

    decode = DecoderFactory().decoder_for("protobuf", stream.schema)
    assert decode is not None
    return decode


def _leaves(descriptor: Any) -> Iterator[tuple[str, Leaf]]:
    """The fields, the nearest ones first."""
    queue: list[tuple[Any, str, tuple[str, ...]]] = [(descriptor, "", ())]
    for message, path, within in queue:
        if message.full_name in within or len(queue) > _MOST_STEPS:
            continue
        for field in message.fields:
            where = f"{path}.{field.name}" if path else field.name
            many = _is_repeated(field)
            if field.message_type is not None:
                if not many:
                    queue.append((field.message_type, where, (*within, message.full_name)))
            elif field.cpp_type != field.CPPTYPE_STRING:
                yield f"{where}[:]" if many else where, _number(field)
            elif field.type == field.TYPE_BYTES and not many:
                yield f"{where}[:]", Leaf(FieldKind.NUMBER)
            elif field.type == field.TYPE_STRING and not many:
                yield where, Leaf(FieldKind.TEXT)


def _number(field: Any) -> Leaf:
    flag = field.cpp_type == field.CPPTYPE_BOOL
    return Leaf(FieldKind.FLAG if flag else FieldKind.NUMBER, _names(field))


def _names(field: Any) -> Mapping[str, int]:
    """The names of an enum."""
    kind = field.enum_type
    return {} if kind is None else {name: each.number for name, each in kind.values_by_name.items()}


def _is_repeated(field: Any) -> bool:
    """Whether a field is repeated; older releases of the library have only the label."""
    many = getattr(field, "is_repeated", None)
    return bool(field.label == field.LABEL_REPEATED if many is None else many)


def _is_map(descriptor: Any) -> bool:
    inner = descriptor.message_type
    return inner is not None and bool(inner.GetOptions().map_entry)
