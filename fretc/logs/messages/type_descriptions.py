"""Type descriptions of ROS 2: their type hash, and the message definition that they stand for.

Source: REP 2016, ROS 2 Interface Type Descriptions (https://ros.org/reps/rep-2016.html), with the
numbers of `type_description_interfaces/msg/FieldType`. A description has no constants.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence

from fretc.logs.messages.definitions import DefinitionError
from fretish.classes.frozen import dataclass

_NESTED = 1
_NAMES: Mapping[int, str] = {
    2: "int8",
    3: "uint8",
    4: "int16",
    5: "uint16",
    6: "int32",
    7: "uint32",
    8: "int64",
    9: "uint64",
    10: "float32",
    11: "float64",
    15: "bool",
    16: "byte",
    17: "string",
    18: "wstring",
    21: "string",
    22: "wstring",
}
"""The name of each type of single values; bounded texts have the same name as unbounded ones."""
_BOUNDED_TEXTS = (21, 22)
_KINDS = 48
"""A number of a type plus 48 is an array of it, plus 96 a bounded sequence, plus 144 a sequence."""
_TYPE = re.compile(r"[A-Za-z]\w{0,99}/msg/[A-Za-z]\w{0,99}", re.ASCII)
_FIELD = re.compile(r"[A-Za-z]\w{0,99}", re.ASCII)


@dataclass(frozen=True, slots=True)
class DescribedField:
    """A field of a message, in the terms of `type_description_interfaces/msg/Field`."""

    name: str
    type_id: int
    capacity: int
    """The length of an array, or the most elements of a bounded sequence."""
    string_capacity: int
    """The most characters of a bounded text."""
    nested_type_name: str


@dataclass(frozen=True, slots=True)
class DescribedType:
    """A message, in the terms of `type_description_interfaces/msg/IndividualTypeDescription`."""

    name: str
    """`sensor_msgs/msg/LaserScan`."""
    fields: tuple[DescribedField, ...]


def type_hash(main: DescribedType, referenced: Sequence[DescribedType]) -> str:
    """The type hash, `RIHS01_...`.

    Args:
        main: the message.
        referenced: all messages within it, in the order of the description.
    """
    whole = {
        "type_description": _as_json(main),
        "referenced_type_descriptions": [_as_json(each) for each in referenced],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(whole).encode()).hexdigest()}"


def _as_json(described: DescribedType) -> Mapping[str, object]:
    fields = [
        {
            "name": field.name,
            "type": {
                "type_id": field.type_id,
                "capacity": field.capacity,
                "string_capacity": field.string_capacity,
                "nested_type_name": field.nested_type_name,
            },
        }
        for field in described.fields
    ]
    return {"type_name": described.name, "fields": fields}


def definition(main: DescribedType, referenced: Sequence[DescribedType]) -> str:
    """The text of the message definition, with those of all messages within it.

    Raises:
        DefinitionError: a name is no name of ROS 2, or a field has a type without a name there.
    """
    sections = [_section(main)]
    for each in referenced:
        sections.append(f"{'=' * 80}\nMSG: {_short(each.name)}\n{_section(each)}")
    return "\n".join(sections)


def _section(described: DescribedType) -> str:
    return "".join(f"{_line(field)}\n" for field in described.fields)


def _line(field: DescribedField) -> str:
    if _FIELD.fullmatch(field.name) is None:
        raise DefinitionError(f"a field has the name `{field.name[:100]}`")
    kind, base = divmod(field.type_id, _KINDS)
    name = _short(field.nested_type_name) if base == _NESTED else _NAMES.get(base)
    if name is None or kind > 3:
        raise DefinitionError(f"the field `{field.name}` has the type number {field.type_id}")
    if base in _BOUNDED_TEXTS:
        name = f"{name}<={field.string_capacity}"
    count = ("", f"[{field.capacity}]", f"[<={field.capacity}]", "[]")[kind]
    return f"{name}{count} {field.name}"


def _short(name: str) -> str:
    """`sensor_msgs/msg/LaserScan` → `sensor_msgs/LaserScan`, as definitions write it."""
    if _TYPE.fullmatch(name) is None:
        raise DefinitionError(f"a message has the name `{name[:200]}`")
    return name.replace("/msg/", "/")
