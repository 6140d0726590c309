"""Message definitions in OMG IDL, as ROS 2 records them (`ros2idl`), and their decoder.

The decoder is that of rosbags. It makes Python code of a definition and runs it, so only types
and names of fields reach it: constants, comments and annotations do not.

Source: MCAP registry, `ros2idl`, https://mcap.dev/spec/registry#ros2idl.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.definitions import (
    NUMBERS,
    TEXTS,
    DefinitionError,
    MessageField,
    Types,
    measured,
    short,
)

_SEPARATOR = re.compile(r"^={3,}[ \t]*\r?\n(?:IDL:[^\n]*\n)?", re.MULTILINE)
_INCLUDE = re.compile(r"^[ \t]*#.*$", re.MULTILINE)
"""A line for a preprocessor; the file that it includes is part of the same text."""
_NAME = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)
_TEXT = r'"(?:\\.|[^"\\])*"'
_UNUSED = re.compile(
    rf"(?P<text>{_TEXT}|'(?:\\.|[^'\\])')|/\*.*?\*/|//[^\n]*"
    rf"|@\s*[\w:]+(?:\s*\((?:{_TEXT}|[^()\"])*\))?|(?P<open>(?:\"|/\*).*)",
    re.DOTALL,
)
"""Comments and annotations. Texts are matched too, because they may contain what looks like one; so
are unclosed ones, which would otherwise be searched from each quote again."""
_COMPUTED = re.compile(r"[(+*/%&|^~]|<<|-\s*-")
"""The operators of computed bounds; no message of ROS has any."""
_NESTED = re.compile(r"\bsequence\s*<(\s*sequence\b|[^;]*\[)")
"""Arrays of arrays, which the parser reads as single arrays."""
_LONGEST = 2**20
"""The most characters of a definition."""

_MOST = 4096
"""The most elements of an array of fixed length that are not numbers: the decoder expands each."""
_KINDS = {"byte": "uint8", "char": "uint8"}
"""The kind of these types; the decoder treats an octet as a signed number."""


def decoder(stream: ChannelDefinition) -> Callable[[bytes], object]:
    """The decoder of the messages of a stream.

    Raises:
        ModuleNotFoundError: the extra `bags` is not installed.
        Exception: of many kinds; the definition cannot be read.
    """
    from rosbags.typesys import Stores, get_typestore

    schema = stream.schema
    assert schema is not None
    parsed = _parsed(schema.data.decode())
    store = get_typestore(Stores.EMPTY)
    store.register({name: ([], fields) for name, fields in parsed.items()})
    name = _full(schema.name)
    store.get_msgdef(name)
    return lambda payload: store.deserialize_cdr(payload, name)


def types(name: str, definition: str) -> Types:
    """All types in a message, by their short names.

    Raises:
        DefinitionError: a type is of an unsupported kind.
        Exception: of many kinds; the definition cannot be read.
    """
    all_types = {
        short(full): tuple(_field(part, kind) for part, kind in fields)
        for full, fields in _parsed(definition).items()
    }
    if short(name) not in all_types:
        raise DefinitionError(f"the type `{name}` is not defined")
    return measured(all_types)


def constants(definition: str) -> Mapping[str, Mapping[str, int]]:
    """The constants of each type that are whole numbers, by the type's short name.

    Raises:
        Exception: of many kinds; the definition cannot be read.
    """
    return {
        short(name): {part: int(value) for part, _, value in values if isinstance(value, int)}
        for name, values, _ in _sections(definition)
    }


def _parsed(definition: str) -> Mapping[str, Any]:
    """The fields of each type, in the form of rosbags.

    Raises:
        DefinitionError: a name is invalid, a type is defined in two ways, or the definition could
            cost too much.
        could
            cost more than it is worth.
    """
    all_types: dict[str, Any] = {}
    for name, _, fields in _sections(definition):
        names = [name, *(field for field, _ in fields)]
        if not all(_NAME.fullmatch(each) for each in names):
            raise DefinitionError(f"`{name}` is no type")
        fields = [(part, _decoder_kind(kind)) for part, kind in fields]
        if all_types.setdefault(name, fields) != fields:
            raise DefinitionError(f"the type `{name}` is defined twice")
    return all_types


def _sections(definition: str) -> Iterator[tuple[str, Any, Any]]:
    """Each type with its constants and its fields, in the form of rosbags."""
    from rosbags.typesys import get_types_from_idl

    if len(definition) > _LONGEST:
        raise DefinitionError("the definition is too long")
    for section in _SEPARATOR.split(_INCLUDE.sub("", definition)):
        bare = _bare(section)
        for name, (values, fields) in get_types_from_idl(bare).items() if bare else ():
            yield name, values, fields


def _bare(section: str) -> str:
    """The definition without comments and annotations.

    Raises:
        DefinitionError: the parser would take very long, or misread the definition.
    """
    bare = _UNUSED.sub(_kept, section).strip()
    outside = re.sub(_TEXT, "", bare)
    if _COMPUTED.search(outside):
        raise DefinitionError("the definition computes its bounds")
    if _NESTED.search(outside):
        raise DefinitionError("the definition holds arrays of arrays")
    return bare


def _kept(match: re.Match[str]) -> str:
    if match["open"]:
        raise DefinitionError("a text or a comment is not closed")
    return match["text"] or " "


def _decoder_kind(kind: Any) -> Any:
    """The kind of a field for the decoder."""
    from rosbags.interfaces import Nodetype

    node, detail = kind
    if node == Nodetype.BASE:
        return node, (_KINDS.get(detail[0], detail[0]), detail[1])
    if node == Nodetype.NAME:
        return kind
    inner, count = detail
    numbers = inner[0] == Nodetype.BASE and inner[1][0] not in TEXTS
    if node == Nodetype.ARRAY and not numbers and count > _MOST:
        raise DefinitionError(f"an array of {count} elements is too long")
    return node, (_decoder_kind(inner), count)


def _full(name: str) -> str:
    """`sensor_msgs/msg/LaserScan` for `sensor_msgs/LaserScan`."""
    return name if name.count("/") != 1 else name.replace("/", "/msg/")


def _field(name: str, kind: Any) -> MessageField:
    from rosbags.interfaces import Nodetype

    node, detail = kind
    if node in (Nodetype.BASE, Nodetype.NAME):
        return MessageField(name, _type(kind), many=False, count=None)
    inner, count = detail
    return MessageField(
        name, _type(inner), many=True, count=count if node == Nodetype.ARRAY else None
    )


def _type(kind: Any) -> str:
    from rosbags.interfaces import Nodetype

    node, detail = kind
    if node == Nodetype.NAME:
        return short(detail)
    base = str(detail[0])
    if base not in NUMBERS and base not in TEXTS:
        raise DefinitionError(f"`{base}` is not laid out here")
    return base
