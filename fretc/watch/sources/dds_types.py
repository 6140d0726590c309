"""Names, offers and types of DDS, and what they are in ROS 2.

Names are those of https://design.ros2.org/articles/topic_and_service_names.html. No type is ever
made of untrusted type information: Cyclone DDS's Python would run the names in it as code.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from fretc.logs.messages import definitions as ros

_TYPE = re.compile(r"(\w+)::(\w+)::dds_::(\w+)_", re.ASCII)
_NAME = re.compile(r"[A-Za-z]\w{0,99}((::|/)[A-Za-z]\w{0,99}){0,9}", re.ASCII)
_HASH = re.compile(rb"(?:^|;)typehash=(RIHS01_[0-9a-f]{64});")


@dataclass(frozen=True, slots=True)
class Offer:
    """What a publisher says of what it sends."""

    type: str
    """`sensor_msgs/msg/LaserScan`, or the name as it is where it is none of ROS 2's."""
    hash: str | None = None
    """`RIHS01_...`, of the definition."""
    reliable: bool = False
    keeps: bool = False
    """Whether who comes later gets the last messages (`transient_local`)."""
    described: bool = False
    """Whether it comes with type information, which a reader's has to agree with."""


class UnreadableError(Exception):
    """A type cannot be read or written; the text says why."""


def dds_topic(name: str) -> str:
    """`/scan` → `rt/scan`; what has no slash before it is the name of a topic of DDS."""
    return f"rt{name}" if name.startswith("/") else name


def ros_topic(name: str) -> str | None:
    """`rt/scan` → `/scan`; None: it is a topic within ROS 2, as services have them."""
    if name.startswith("rt/"):
        return name[2:]
    return None if name.startswith("r") and name[2:3] == "/" else name


def ros_type(name: str) -> str:
    """`sensor_msgs::msg::dds_::LaserScan_` → `sensor_msgs/msg/LaserScan`."""
    match = _TYPE.fullmatch(name)
    return "/".join(match.groups()) if match else name


def is_type(name: str) -> bool:
    """Whether a type of others has such a name that Cyclone DDS may print it."""
    return _NAME.fullmatch(name) is not None


def _dds_type(name: str) -> str:
    """As Cyclone's Python writes it, with `.`."""
    parts = name.split("/")
    if len(parts) not in (2, 3):
        return name.replace("::", ".")
    package, kind = parts[0], parts[1] if len(parts) == 3 else "msg"
    return f"{package}.{kind}.dds_.{parts[-1]}_"


def offered(endpoint: Any) -> Offer:
    """What a publisher says, as Cyclone DDS hands it on."""
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
        name: of the type.
        definition: None: it says nothing of its fields, and matches who says nothing either.

    Raises:
        UnreadableError: nobody can say such a definition.
    """
    fields: dict[str, Any] = {}
    if definition is not None:
        try:
            types = ros.types(name, definition, ros1=False)
            fields = _fields(ros.short(name), types, {})
        except ros.DefinitionError as error:
            raise UnreadableError(str(error)) from None
    return _payloads(_struct(name, fields))


def _struct(name: str, fields: dict[str, Any]) -> Any:
    from cyclonedds.idl import make_idl_struct

    # as a dataclass, the names of its fields would be compiled
    return make_idl_struct("Message", _dds_type(name), fields, dataclassify=False)


def _fields(name: str, types: ros.Types, made: dict[str, Any]) -> dict[str, Any]:
    return {field.name: _field(field, types, made) for field in types[name]}


def _field(field: ros.Field, types: ros.Types, made: dict[str, Any]) -> Any:
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
    many: Any = idl  # its generics are made at run time
    return many.sequence[kind] if field.count is None else many.array[kind, field.count]


def _payloads(struct: Any) -> Any:
    """The class, whose objects come and go as bytes."""

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
