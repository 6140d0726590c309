"""Names, offers and types of DDS, and their counterparts in ROS 2.

Names are those of https://design.ros2.org/articles/topic_and_service_names.html. No type is ever
created from untrusted type information: Cyclone DDS's Python would execute the names in it as code.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

from fretc.logs.messages import definitions as ros
from fretish.classes.frozen import dataclass

_TYPE = re.compile(r"(\w+)::(\w+)::dds_::(\w+)_", re.ASCII)
_NAME = re.compile(r"[A-Za-z]\w{0,99}((::|/)[A-Za-z]\w{0,99}){0,9}", re.ASCII)
_HASH = re.compile(rb"(?:^|;)typehash=(RIHS01_[0-9a-f]{64});")


@dataclass(frozen=True, slots=True)
class Offer:
    """The properties of a publisher that it announces."""

    type: str
    """`sensor_msgs/msg/LaserScan`, or the unchanged name of a type that is not of ROS 2."""
    hash: str | None = None
    """The hash of the definition, `RIHS01_...`."""
    reliable: bool = False
    keeps: bool = False
    """Whether late readers get the last messages (`transient_local`)."""
    described: bool = False
    """Whether it has type information, which that of a reader must match."""


class UnreadableTypeError(Exception):
    """A type cannot be read or written; the text gives the reason."""


def dds_topic(name: str) -> str:
    """`/scan` → `rt/scan`; a name without a leading slash is that of a DDS topic."""
    return f"rt{name}" if name.startswith("/") else name


def ros_topic(name: str) -> str | None:
    """`rt/scan` → `/scan`; None: an internal topic of ROS 2, such as those of services."""
    if name.startswith("rt/"):
        return name[2:]
    return None if name.startswith("r") and name[2:3] == "/" else name


def ros_type(name: str) -> str:
    """`sensor_msgs::msg::dds_::LaserScan_` → `sensor_msgs/msg/LaserScan`."""
    match = _TYPE.fullmatch(name)
    return "/".join(match.groups()) if match else name


def is_type(name: str) -> bool:
    """Whether the name of a type is safe for Cyclone DDS to print."""
    return _NAME.fullmatch(name) is not None


def _dds_type(name: str) -> str:
    """The name of the type in Cyclone's Python, with `.`."""
    parts = name.split("/")
    if len(parts) not in (2, 3):
        return name.replace("::", ".")
    package, kind = parts[0], parts[1] if len(parts) == 3 else "msg"
    return f"{package}.{kind}.dds_.{parts[-1]}_"


def offered(endpoint: Any) -> Offer:
    """The offer of a publisher, from the data of Cyclone DDS."""
    from cyclonedds.qos import Policy

    qos = endpoint.qos
    said = qos[Policy.Userdata]
    digest = _HASH.search(said.data) if said is not None else None
    type_ = ros_type(endpoint.type_name)
    return Offer(
        type_,
        digest[1].decode() if digest else None,
        qos[Policy.Reliability] not in (None, Policy.Reliability.BestEffort),
        qos[Policy.Durability] not in (None, Policy.Durability.Volatile),
        is_type(type_) and endpoint.type_id not in (None, _nothing(type_)),
    )


def payloads_of(name: str, definition: str | None) -> Any:
    """A class of Cyclone DDS whose objects are payloads.

    Args:
        name: the name of the type.
        definition: None: the class has no type information, and matches publishers without it.

    Raises:
        UnreadableError: type information cannot express the definition.
    """
    fields: dict[str, Any] = {}
    if definition is not None:
        try:
            types = ros.types(name, definition, ros1=False)
            fields = _fields(ros.short(name), types, {})
        except ros.DefinitionError as error:
            raise UnreadableTypeError(str(error)) from None
    return _payloads(_struct(name, fields))


def _struct(name: str, fields: dict[str, Any]) -> Any:
    from cyclonedds.idl import make_idl_struct

    # as a dataclass, the names of its fields would be compiled
    return make_idl_struct("Message", _dds_type(name), fields, dataclassify=False)


def _fields(name: str, types: ros.Types, made: dict[str, Any]) -> dict[str, Any]:
    return {field.name: _field(field, types, made) for field in types[name]}


def _field(field: ros.MessageField, types: ros.Types, made: dict[str, Any]) -> Any:
    from cyclonedds.idl import types as idl

    if field.type in ros.NUMBERS:
        kind = bool if field.type == "bool" else getattr(idl, field.type)
    elif field.type in ros.TEXTS:
        kind = str
    else:
        if field.type not in made:
            made[field.type] = _struct(field.type, _fields(field.type, types, made))
        kind = made[field.type]
    if not field.many:
        return kind
    many: Any = idl  # its generic types exist only at run time
    return many.sequence[kind] if field.count is None else many.array[kind, field.count]


def _payloads(struct: Any) -> Any:
    """The class, whose objects are read and written as bytes."""

    def read(cls: Any, data: bytes, /, *_: object, **__: object) -> Any:
        sample = cls()
        sample.payload = data
        return sample

    def write(self: Any, *_: object, **__: object) -> bytes:
        payload: bytes = self.payload
        return payload

    struct.deserialize = classmethod(read)
    struct.deserialize_key = classmethod(lambda cls, *_, **__: cls())
    struct.serialize = write
    return struct


@lru_cache(100)
def _nothing(name: str) -> Any:
    """The type information of a type without fields."""
    return _struct(name, {}).__idl__.get_type_id()
