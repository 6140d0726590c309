"""Values that are kept as JSON: their types say what a file may hold, and give its JSON Schema.

The only module that imports msgspec.
"""

from __future__ import annotations

from typing import Annotated, Any, TypeVar

import msgspec
import msgspec.inspect
from msgspec import UNSET as UNSET
from msgspec import Meta as Meta
from msgspec import UnsetType as UnsetType
from msgspec import field as field
from msgspec.structs import replace as replace

from compiler.files.checked_json import GREATEST, LARGEST_COUNT, LEAST, SchemaError

types = msgspec.inspect
"""Types of records as values."""
R = TypeVar("R")


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An object of JSON: each of its keys, in the order in which they are written.

    A key whose value is `UNSET` is not written.
    """


Whole = Annotated[int, Meta(extra_json_schema={"minimum": LEAST, "maximum": GREATEST})]
"""Of 64 bits, with or without a sign: nanoseconds by a clock. `checked_json` reads no more."""
Duration = Annotated[int, Meta(ge=0, extra_json_schema={"maximum": GREATEST})]
"""Nanoseconds between two such times."""
Count = Annotated[int, Meta(ge=0, le=LARGEST_COUNT)]
Ordinal = Annotated[int, Meta(ge=1, le=LARGEST_COUNT)]
Number = int | float
"""Finite; `1` stays another number than `1.0`, so that files compare exactly."""
Distance = Annotated[int, Meta(ge=0)] | Annotated[float, Meta(ge=0)]
Share = Annotated[int, Meta(ge=0, le=1)] | Annotated[float, Meta(ge=0, le=1)]
Seconds = Annotated[int, Meta(ge=0, le=10**10)] | Annotated[float, Meta(ge=0, le=10**10)]
"""From the start of a recorded run: up to some three hundred years."""
Name = Annotated[str, Meta(min_length=1)]
Sha256 = Annotated[str, Meta(pattern="^[0-9a-f]{64}$", max_length=64)]
"""The length, since `$` of Python allows for a line break at the end."""


def about(description: str) -> Meta:
    """What a value is, for its schema."""
    return Meta(description=description)


def decoded(value: object, kind: type[R]) -> R:
    """A value of JSON as a record.

    Raises:
        SchemaError: it is none; the message names the place.
    """
    try:
        return msgspec.convert(value, kind, strict=True)
    except msgspec.ValidationError as error:
        raise SchemaError(_in_words(str(error))) from None
    except UnicodeEncodeError:
        raise SchemaError("a text has a lone surrogate, which is half of a character") from None


def plain(record: object) -> Any:
    """What is written of a record: plain values."""
    return msgspec.to_builtins(record)


def json_schema(kind: type[Record], id: str, title: str, description: str) -> dict[str, Any]:
    """The JSON Schema of the files that hold such a record."""
    found = msgspec.json.schema(kind)
    whole = found["$defs"].pop(kind.__name__)
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": id,
        "title": title,
        "description": description,
    }
    return {**head, **{k: v for k, v in whole.items() if k not in head}, "$defs": found["$defs"]}


def _in_words(message: str) -> str:
    """`$.results[0]`: expected `array`, got `object`."""
    what, _, place = message.rpartition(" - at ")
    if not what:
        return f"{message[:1].lower()}{message[1:]}"
    return f"{place}: {what[:1].lower()}{what[1:]}"
