"""Message classes as ROS 2 generates them for Python, of the definitions that rosbags has.

What generated code promises (rosidl_generator_py, `_msg.py.em`) and is kept here: a message is made
without arguments and its fields are then zero, empty or false; a field takes a value of its own
type only, and `assert`s that (an int is no float64, a str is no byte); arrays of numbers are
`array.array` where they have no fixed length; a `byte` is a `bytes` of length one; a constant is an
attribute of the class. Arguments by keyword set fields.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from functools import cache
from types import ModuleType
from typing import Any

from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
_CODES = {
    "float32": "f",
    "float64": "d",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
}
_IDL = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet"}
_BASE, _NAME, _ARRAY = 1, 2, 3


class Message:
    """What all message classes have in common."""

    NAME = ""
    KINDS: Mapping[str, Any] = {}

    def __init__(self, **values: Any) -> None:
        for field, kind in self.KINDS.items():
            setattr(self, field, values.pop(field) if field in values else _zero(kind))
        assert not values, f"{self.NAME} has no field {sorted(values)[0]}"

    def __setattr__(self, field: str, value: Any) -> None:
        assert field in self.KINDS, f"{self.NAME} has no field {field}"
        name = f"{self.NAME}.{field}"
        object.__setattr__(self, field, _checked(name, self.KINDS[field], value))

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"{self.NAME}({', '.join(f'{k}={v!r}' for k, v in vars(self).items())})"

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Of each field the type, in the words of IDL."""
        return {field: _idl(kind) for field, kind in cls.KINDS.items()}


@cache
def message_class(name: str) -> type[Any]:
    """The class of `std_msgs/Bool`.

    Raises:
        KeyError: no such type is known.
    """
    package, _, short = name.partition("/")
    constants, fields = STORE.fielddefs[f"{package}/msg/{short}"]
    values = {
        constant: bytes([int(value)]) if kind == "byte" else value
        for constant, kind, value in constants
    }
    return type(short, (Message,), {"NAME": name, "KINDS": dict(fields), **values})


def _idl(described: Any) -> str:
    kind, inner = int(described[0]), described[1]
    if kind == _NAME:
        return str(inner.replace("/msg/", "/"))
    if kind == _BASE:
        return _IDL.get(inner[0], str(inner[0]))
    return f"{_idl(inner[0])}[{inner[1]}]" if kind == _ARRAY else f"sequence<{_idl(inner[0])}>"


def _zero(described: Any) -> Any:
    kind, inner = int(described[0]), described[1]
    if kind == _NAME:
        return message_class(inner.replace("/msg/", "/"))()
    if kind == _BASE:
        base = inner[0]
        if base in ("float32", "float64"):
            return 0.0
        return {"bool": False, "string": "", "byte": b"\x00"}.get(base, 0)
    (element_kind, element), length = (int(inner[0][0]), inner[0][1]), inner[1]
    if element_kind == _BASE and element[0] in _CODES:
        return array(_CODES[element[0]], [0] * (length if kind == _ARRAY else 0))
    return [_zero(inner[0]) for _ in range(length if kind == _ARRAY else 0)]


def _checked(name: str, described: Any, value: Any) -> Any:
    kind, inner = int(described[0]), described[1]
    if kind == _NAME:
        wanted = message_class(inner.replace("/msg/", "/"))
        assert isinstance(value, wanted), f"{name} is no {inner}: {value!r}"
        return value
    if kind == _BASE:
        return _checked_base(name, inner[0], value)
    element_kind, element = int(inner[0][0]), inner[0][1]
    if element_kind == _BASE and element[0] in _CODES:
        if isinstance(value, array):
            assert value.typecode == _CODES[element[0]], f"{name} has other numbers"
            return value
        return array(_CODES[element[0]], value)
    assert isinstance(value, (list, tuple)), f"{name} is no sequence: {value!r}"
    return [_checked(name, inner[0], each) for each in value]


def _checked_base(name: str, base: str, value: Any) -> Any:
    wanted: dict[str, type] = {"bool": bool, "string": str, "byte": bytes}
    if base in ("float32", "float64"):
        assert isinstance(value, float), f"{name} is no float: {value!r}"
        return array("f", [value])[0] if base == "float32" else value
    assert isinstance(value, wanted.get(base, int)), f"{name} is no {base}: {value!r}"
    assert not isinstance(value, bytes) or len(value) == 1, f"{name} is no byte: {value!r}"
    return value


class Messages(ModuleType):
    """`sensor_msgs.msg`: its classes are made as they are asked for."""

    def __getattr__(self, name: str) -> type[Any]:
        if name.startswith("__"):
            raise AttributeError(name)
        package = self.__name__.removesuffix(".msg")
        return message_class(f"{package}/{name}")
