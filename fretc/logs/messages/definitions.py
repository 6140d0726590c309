"""Message definitions of ROS 1 and ROS 2: from the text to the fields of a payload, in their order.

Sources: ROS 2 interface definitions, https://docs.ros.org/en/humble/Concepts/Basic/About-Interfaces.html;
ROS 1 messages, https://wiki.ros.org/msg.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from fretish.classes.frozen import dataclass

NUMBERS: Mapping[str, str] = {
    "bool": "?",
    "int8": "i1",
    "uint8": "u1",
    "int16": "<i2",
    "uint16": "<u2",
    "int32": "<i4",
    "uint32": "<u4",
    "int64": "<i8",
    "uint64": "<u8",
    "float32": "<f4",
    "float64": "<f8",
}
"""The NumPy name of each primitive type."""

_ALIASES = {True: {"byte": "int8", "char": "uint8"}, False: {"byte": "uint8", "char": "int8"}}
"""The meaning of these types in ROS 1 (True) and in the decoder of ROS 2."""

TEXTS = frozenset({"string"})
_TIMES = {
    "time": (("secs", "uint32"), ("nsecs", "uint32")),
    "duration": (("secs", "int32"), ("nsecs", "int32")),
}
CARRIED = frozenset(_TIMES)
"""Types whose nanoseconds the decoder of ROS 1 may carry over into seconds."""
_ROS2_TIMES = {
    "builtin_interfaces/Time": (("sec", "uint32"), ("nanosec", "uint32")),
    "builtin_interfaces/Duration": (("sec", "uint32"), ("nanosec", "uint32")),
}
"""The fields of time types in the decoder of ROS 2, if the definition leaves them out."""

_DEEPEST = 50
"""The most levels of nested messages; deeper types may contain themselves."""
_MOST_FIELDS = 10_000
"""The most fields of a message, with those of nested messages."""

_NAME = re.compile(r"\w+/(?:msg/)?\w+")
_SEPARATOR = re.compile(r"={3,}\s*")
_NEXT = re.compile(r"MSG:\s*(\S+)\s*")
_FIELD = re.compile(
    r"(?P<type>[A-Za-z][\w/]*)(?P<most><=\d+)?"
    r"(?P<array>\[(?:<=)?(?P<count>\d*)\])?\s+(?P<name>[A-Za-z]\w*)(?P<rest>[\s=].*)?"
)

_CONSTANT = re.compile(
    r"(?:bool|byte|char|u?int(?:8|16|32|64))\s+(?P<name>[A-Za-z]\w*)\s*=\s*"
    r"(?P<value>[+-]?(?:0[xX][0-9A-Fa-f]{1,16}|\d{1,20})|[Tt]rue|[Ff]alse)\s*(?:#.*)?"
)
"""A constant that is a whole number."""

_MOST_ELEMENTS = 2**20
"""The most elements of a message, in all of its arrays of fixed length, nested ones too."""


class DefinitionError(ValueError):
    """The definition contains something that this module does not support."""


class TypesTooLargeError(DefinitionError):
    """The types contain themselves, or are too large."""


@dataclass(frozen=True, slots=True)
class MessageField:
    """One field of a message."""

    name: str
    type: str
    """A key of `NUMBERS`, `string`, or the full name of a type."""
    many: bool
    count: int | None
    """The length of an array of fixed length; None: the length precedes its elements."""


Types = Mapping[str, tuple[MessageField, ...]]
"""The fields of each type, by its full name: `sensor_msgs/LaserScan`."""


def types(name: str, definition: str, *, ros1: bool) -> Types:
    """All types that a message is made of.

    Args:
        name: the name of the message, with or without `msg/`.
        definition: the text, with the definitions of the types that it uses after lines of `=`.
        ros1: whether the definition is of ROS 1.

    Raises:
        DefinitionError: a line or a type is unknown, a type is defined twice, or types contain
            themselves.
    """
    all_types: dict[str, tuple[MessageField, ...]] = {}
    for full, lines in _sections(short(name), definition):
        package = full.partition("/")[0]
        read = (_field(line, package, ros1=ros1) for line in lines)
        fields = tuple(field for field in read if field is not None)
        if all_types.setdefault(full, fields) != fields:
            raise DefinitionError(f"the type `{full}` is defined twice")
    return measured(_builtin(ros1=ros1) | all_types)


def constants(name: str, definition: str) -> Mapping[str, Mapping[str, int]]:
    """The constants of each type that are whole numbers, by the type's full name.

    Args:
        name: the name of the message, with or without `msg/`.
        definition: the text, as for `types`.

    Raises:
        DefinitionError: the definition cannot be read.
    """
    constants_of_types: dict[str, dict[str, int]] = {}
    for full, lines in _sections(short(name), definition):
        matches = filter(None, map(_CONSTANT.fullmatch, lines))
        constants_of_types[full] = {match["name"]: _whole(match["value"]) for match in matches}
    return constants_of_types


def _whole(text: str) -> int:
    if text.lower() in ("true", "false"):
        return int(text.lower() == "true")
    sign, digits = (-1 if text[0] == "-" else 1), text.lstrip("+-")
    return sign * int(digits, 16 if digits[:2].lower() == "0x" else 10)


def measured(all_types: Types) -> Types:
    """The types, after a check of their size.

    Raises:
        DefinitionError: a type is not defined, contains itself, or is too large.
    """
    for fields in all_types.values():
        for field in fields:
            if (
                field.type not in NUMBERS
                and field.type not in TEXTS
                and field.type not in all_types
            ):
                raise DefinitionError(f"the type `{field.type}` is not defined")
    if _largest(all_types, elements=False) > _MOST_FIELDS:
        raise TypesTooLargeError("the types are nested too deeply")
    if _largest(all_types, elements=True) > _MOST_ELEMENTS:
        raise TypesTooLargeError("the arrays of fixed length are too long")
    return all_types


def _largest(all_types: Types, *, elements: bool) -> int:
    """The number of fields of the largest type, or of its elements, with nested ones.

    Raises:
        TooLargeError: the types contain themselves.
    """
    sizes: dict[str, int] = {}
    rest = dict(all_types)
    for _ in range(_DEEPEST):
        ready = {
            name: sum(
                (1 + sizes.get(field.type, 0)) * ((field.count or 1) if elements else 1)
                for field in fields
            )
            for name, fields in rest.items()
            if all(field.type in sizes or field.type not in all_types for field in fields)
        }
        sizes |= ready
        rest = {name: fields for name, fields in rest.items() if name not in ready}
        if not rest:
            return max(sizes.values())
    raise TypesTooLargeError("the types are nested too deeply")


def _builtin(*, ros1: bool) -> dict[str, tuple[MessageField, ...]]:
    times = _TIMES if ros1 else _ROS2_TIMES
    return {
        name: tuple(MessageField(part, type_, many=False, count=None) for part, type_ in parts)
        for name, parts in times.items()
    }


def short(name: str) -> str:
    """`sensor_msgs/LaserScan`, with or without `msg/` in it.

    Raises:
        DefinitionError: the text is not the name of a type.
    """
    if not _NAME.fullmatch(name):
        raise DefinitionError(f"`{name}` is no type")
    return name.replace("/msg/", "/")


def _sections(name: str, definition: str) -> list[tuple[str, list[str]]]:
    """Each type with its lines; empty lines are left out."""
    sections: list[tuple[str, list[str]]] = [(name, [])]
    has_name = True
    for line in definition.splitlines():
        bare = line.strip()
        if not bare or bare.startswith("#"):
            continue
        following = _NEXT.fullmatch(bare)
        if not has_name and following:
            sections.append((short(following[1]), []))
            has_name = True
        elif has_name and _SEPARATOR.fullmatch(bare):
            has_name = False
        elif has_name:
            sections[-1][1].append(bare)
        else:
            break
    if not has_name:
        raise DefinitionError("a type has no name")
    return sections


def _field(line: str, package: str, *, ros1: bool) -> MessageField | None:
    """The field of a line; None for a constant."""
    match = _FIELD.fullmatch(line.split("#")[0].strip() if "=" not in line else line.strip())
    if match is None:
        raise DefinitionError(f"`{line}` is no field")
    rest = (match["rest"] or "").strip()
    if rest.startswith("="):
        return None
    if ros1 and rest and not rest.startswith("#"):
        raise DefinitionError(f"`{line}` is no field")
    many = match["array"] is not None
    type_ = _resolved(match["type"], package, many=many, ros1=ros1)
    bounded = many and "<=" in match["array"]
    count = int(match["count"]) if many and match["count"] and not bounded else None
    return MessageField(match["name"], type_, many, count)


def _resolved(name: str, package: str, *, many: bool, ros1: bool) -> str:
    name = _ALIASES[ros1].get(name, name)
    if name in NUMBERS or name in TEXTS or "/" in name:
        return name
    if ros1 and name in _TIMES:
        return name
    if ros1 and name == "Header" and not many:  # an array has the type of the package
        return "std_msgs/Header"
    return f"{package}/{name}"
