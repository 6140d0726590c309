"""Messages in JSON, and the fields in a JSON schema.

Each message is read on its own: nothing is checked against a schema. A field that a message leaves
out or states as `null` is unknown in that message: several writers write NaN and both infinities as
`null`, so `null` is never one of them.

Sources: RFC 8259; NaN and Infinity as Python and JavaScript's JSON5 write them, and as texts as
ProtoJSON writes them, https://protobuf.dev/programming-guides/json/.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from math import isfinite
from typing import Any

from fretc.logs.messages.leaves import FieldKind, Leaf
from fretc.logs.signals.signals import Sparse, UnstatedError

_WORDS = {"NaN": float("nan"), "Infinity": float("inf"), "-Infinity": float("-inf")}
"""Texts that stand for numbers."""
_LARGEST = int(1.7976931348623157e308)
_DEEPEST = 20
_MOST = 2000
"""The most fields of one topic that are listed."""
_MOST_STEPS = 20_000
"""The most parts of a schema that are visited: those that refer to each other have no end."""


class Object(Sparse):
    """A JSON object."""

    __slots__ = ("_values",)

    def __init__(self, values: Mapping[str, object]) -> None:
        self._values = values

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its fields."""
        return tuple(self._values)

    def field(self, name: str) -> object:
        """The value of a field; any field may be left out."""
        value = self._values.get(name)
        if value is None:
            raise UnstatedError
        if isinstance(value, str):
            return _WORDS.get(value, value)
        if isinstance(value, list):
            return [_WORDS.get(item, item) if isinstance(item, str) else item for item in value]
        return value


def decode(payload: bytes) -> Object:
    """A message.

    Raises:
        ValueError: the payload is not a JSON object, names a field twice, or holds a number beyond
            64-bit floats: 1e400 is neither a measurement nor infinity.
        RecursionError: it is nested too deep.
    """
    message = json.loads(
        payload.decode(), object_pairs_hook=_object, parse_float=_float, parse_int=_int
    )
    if not isinstance(message, Object):
        raise ValueError("a message is an object")
    return message


def _object(pairs: Sequence[tuple[str, object]]) -> Object:
    values = dict(pairs)
    if len(values) < len(pairs):
        raise ValueError("a field is named twice")
    return Object(values)


def _float(text: str) -> float:
    value = float(text)
    if not isfinite(value):
        raise ValueError(f"{text[:40]} is too large")
    return value


def _int(text: str) -> int:
    value = int(text)
    if abs(value) > _LARGEST:
        raise ValueError(f"{text[:40]} is too large")
    return value


# Fields


def schema_leaves(schema: bytes) -> dict[str, Leaf]:
    """The numbers, truth values and texts in a JSON schema.

    Raises:
        ValueError: the text is not JSON, or not a schema.
        RecursionError: it is nested too deep.
    """
    root = json.loads(schema.decode() or "{}")
    if not isinstance(root, dict | bool):
        raise ValueError("a schema is an object")
    return _some(_of_schema(root))


def message_leaves(payloads: Iterable[bytes]) -> dict[str, Leaf]:
    """The numbers, truth values and texts in some messages; invalid payloads are skipped."""
    leaves: dict[str, Leaf] = {}
    for payload in payloads:
        try:
            message = decode(payload)
        except (ValueError, RecursionError):
            continue
        for path, leaf in _some(_of_value(message, "", 0)).items():
            leaves.setdefault(path, leaf)
    return dict(islice(leaves.items(), _MOST))


def _some(leaves: Iterator[tuple[str, FieldKind]]) -> dict[str, Leaf]:
    first: dict[str, Leaf] = {}
    for path, kind in leaves:
        if len(first) == _MOST:
            break
        first.setdefault(path, Leaf(kind))
    return first


def _of_schema(
    root: Any,
) -> Iterator[tuple[str, FieldKind]]:  # a schema may be any JSON value
    """The fields in a schema, the nearest ones first."""
    queue: list[tuple[Any, str, tuple[int, ...]]] = [(root, "", ())]
    for schema, path, within in queue:
        schema = _resolved(root, schema)
        if not isinstance(schema, dict) or id(schema) in within or len(queue) > _MOST_STEPS:
            continue
        yield from _own(root, schema, path)
        within = (*within, id(schema))
        for several in ("allOf", "anyOf", "oneOf"):
            parts = schema.get(several)
            queue += [(part, path, within) for part in (parts if isinstance(parts, list) else ())]
        properties = schema.get("properties")
        for name, part in properties.items() if isinstance(properties, dict) else ():
            if _is_name(name):
                queue.append((part, f"{path}.{name}" if path else name, within))


_KINDS = {
    "number": FieldKind.NUMBER,
    "integer": FieldKind.NUMBER,
    "boolean": FieldKind.FLAG,
    "string": FieldKind.TEXT,
}


def _own(root: Any, schema: dict[Any, Any], path: str) -> Iterator[tuple[str, FieldKind]]:
    """The path, if it is itself a field that can be read."""
    kinds = schema.get("type")
    kinds = kinds if isinstance(kinds, list) else [kinds]
    own = [_KINDS[kind] for kind in kinds if isinstance(kind, str) and kind in _KINDS]
    if path and own:
        yield path, own[0]
    if path and "array" in kinds:
        element = _resolved(root, schema.get("items"))
        kind = element.get("type") if isinstance(element, dict) else None
        if isinstance(kind, str) and _KINDS.get(kind, FieldKind.TEXT) is not FieldKind.TEXT:
            yield f"{path}[:]", _KINDS[kind]


def _resolved(root: Any, schema: Any) -> Any:
    """The schema, or the one in the same text to which it refers."""
    for _ in range(_DEEPEST):
        reference = schema.get("$ref") if isinstance(schema, dict) else None
        if not isinstance(reference, str) or not reference.startswith("#"):
            return schema
        schema = root
        for part in reference[1:].split("/")[1:]:
            part = part.replace("~1", "/").replace("~0", "~")
            schema = schema.get(part) if isinstance(schema, dict) else None
    return None


def _of_value(value: object, path: str, depth: int) -> Iterator[tuple[str, FieldKind]]:
    if isinstance(value, Object) and depth < _DEEPEST:
        for name in filter(_is_name, value.names):
            try:
                inner = value.field(name)
            except UnstatedError:
                continue
            yield from _of_value(inner, f"{path}.{name}" if path else name, depth + 1)
    elif isinstance(value, int | float):
        yield path, FieldKind.FLAG if isinstance(value, bool) else FieldKind.NUMBER
    elif isinstance(value, str):
        yield path, FieldKind.TEXT
    elif (
        isinstance(value, list)
        and any(isinstance(item, int | float) for item in value)
        and all(item is None or isinstance(item, int | float) for item in value)
    ):
        yield f"{path}[:]", FieldKind.NUMBER


def _is_name(name: object) -> bool:
    """Whether a path can contain the name."""
    return isinstance(name, str) and name.isidentifier() and name.isascii()
