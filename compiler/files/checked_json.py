"""Checked access to values of a JSON file: errors name the path of the value.

An invalid value raises `SchemaError` with the path. Files whose types are known are read by
`compiler/files/records.py`.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from math import isfinite
from typing import NoReturn

from fretish.classes.frozen import dataclass

LEAST, GREATEST = -(2**63), 2**64 - 1
"""Range of integers: 64 bits, signed or unsigned, as times in logs are."""
LARGEST_COUNT = 2**63 - 1
"""Largest count: 64 bits with a sign, as in columns of tables."""
_DIGITS = 21
_EXCERPT = 40


class SchemaError(ValueError):
    """A value is missing or of the wrong kind; the message says which and where."""


def parsed(text: str) -> JsonValue:
    """The value of a strict JSON text: each key appears once, and numbers are finite.

    Raises:
        json.JSONDecodeError: the text is not JSON.
        ValueError: the text is ambiguous JSON, or Python cannot read it.
        RecursionError: the text is nested too deeply.
    """
    value = json.loads(
        text,
        object_pairs_hook=_distinct,
        parse_int=_whole,
        parse_float=_finite,
        parse_constant=_no_number,
    )
    return JsonValue(value)


def plain(text: str) -> object:
    """The value of a JSON text.

    Raises:
        SchemaError: the text is not strict JSON.
    """
    try:
        return parsed(text).value
    except RecursionError:
        raise SchemaError("it is nested too deeply") from None
    except ValueError as error:
        raise SchemaError(f"the text is not JSON that fretc can read: {error}") from None


def _distinct(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    fields: dict[str, object] = {}
    for key, value in pairs:
        if key in fields:
            raise ValueError(f"`{key[:_EXCERPT]}` appears twice in one object")
        fields[key] = value
    return fields


def _whole(word: str) -> float:
    """An integer of at most 64 bits, or a float such as `1e30` for a larger one."""
    if len(word) > _DIGITS or not LEAST <= int(word) <= GREATEST:
        return _finite(word)
    return int(word)


def _finite(word: str) -> float:
    if not isfinite(float(word)):
        raise ValueError(f"`{word[:_EXCERPT]}` is too large for a number")
    return float(word)


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"`{word}` is not a JSON number")


@dataclass(frozen=True, slots=True)
class JsonValue:
    """A JSON value with its path, such as `results[3].verdict`."""

    value: object
    path: str = ""

    @property
    def name(self) -> str:
        """The path, for messages."""
        return f"`{self.path}`" if self.path else "the whole file"

    def field(self, key: str) -> JsonValue:
        """The value of a key of an object."""
        fields = self._object()
        if key not in fields:
            raise SchemaError(f"{self.name} has no `{key}`")
        return JsonValue(fields[key], f"{self.path}.{key}".removeprefix("."))

    def has(self, key: str) -> bool:
        """Whether an object has a key."""
        return key in self._object()

    def fields(self) -> dict[str, JsonValue]:
        """All values of an object, in the order of their keys."""
        fields = self._object()
        return {key: JsonValue(fields[key], f'{self.path}["{key}"]') for key in sorted(fields)}

    def items(self) -> tuple[JsonValue, ...]:
        """The values of an array."""
        if not isinstance(self.value, list):
            raise self.wrong("an array")
        return tuple(JsonValue(value, f"{self.path}[{i}]") for i, value in enumerate(self.value))

    def text(self) -> str:
        """The value as a text."""
        if not isinstance(self.value, str):
            raise self.wrong("a text")
        return self.value

    def one_of(self, words: Collection[str]) -> str:
        """The value as one of `words`."""
        if self.value not in words or not isinstance(self.value, str):
            raise self.wrong(f"one of {', '.join(words)}")
        return self.value

    def flag(self) -> bool:
        """The value as a truth value."""
        if not isinstance(self.value, bool):
            raise self.wrong("true or false")
        return self.value

    def whole(self) -> int:
        """The value as an integer of at most 64 bits."""
        if not isinstance(self.value, int) or isinstance(self.value, bool):
            raise self.wrong("a whole number")
        if abs(self.value) > LARGEST_COUNT:
            raise self.wrong("a whole number of at most 64 bits")
        return self.value

    def count(self) -> int:
        """The value as a non-negative integer."""
        if self.whole() < 0:
            raise self.wrong("a whole number from 0 on")
        return self.whole()

    def number(self) -> float:
        """The value as a finite number."""
        if not isinstance(self.value, int | float) or isinstance(self.value, bool):
            raise self.wrong("a number")
        if isinstance(self.value, int):
            return float(self.whole())
        if not isfinite(self.value):
            raise self.wrong("a finite number")
        return self.value

    def only(self, *keys: str) -> None:
        """Check that an object has no keys but these."""
        for key in self._object():
            if key not in keys:
                raise SchemaError(f"{self.name} may not have `{key[:_EXCERPT]}`")

    def wrong(self, wanted: str) -> SchemaError:
        """The error of a value that is not `wanted`."""
        return SchemaError(f"{self.name} must be {wanted}, and is {self._excerpt()}")

    def _object(self) -> dict[str, object]:
        if not isinstance(self.value, dict):
            raise self.wrong("an object")
        return self.value

    def _excerpt(self) -> str:
        match self.value:
            case None:
                return "null"
            case bool():
                return str(self.value).lower()
            case dict():
                return "an object"
            case list():
                return "an array"
            case int() if abs(self.value) > LARGEST_COUNT:
                return "far too large"
            case _:
                text = str(self.value)
                return f"`{text[:_EXCERPT]}{'…' if len(text) > _EXCERPT else ''}`"
