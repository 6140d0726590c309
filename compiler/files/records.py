"""Types of JSON files: they define what a file may hold, and its JSON Schema.

The only module that imports msgspec.
"""

from __future__ import annotations

import json
from typing import Annotated, Any, TypeVar

import msgspec
import msgspec.inspect
from msgspec import UNSET as UNSET
from msgspec import Meta as Meta
from msgspec import Raw as Raw
from msgspec import UnsetType as UnsetType
from msgspec import field as field
from msgspec.structs import replace as replace

from compiler.files.checked_json import GREATEST, LARGEST_COUNT, LEAST, SchemaError, parsed
from compiler.files.text_files import read as read_text
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source

types = msgspec.inspect
"""msgspec's description of types."""
R = TypeVar("R")


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A JSON object; its fields are the keys, in the order in which they are written.

    A key whose value is `UNSET` is not written.
    """


Whole = Annotated[int, Meta(extra_json_schema={"minimum": LEAST, "maximum": GREATEST})]
"""An integer of 64 bits, signed or unsigned: nanoseconds of a clock. `checked_json` reads no larger
one."""
Duration = Annotated[int, Meta(ge=0, extra_json_schema={"maximum": GREATEST})]
"""Nanoseconds between two times."""
Count = Annotated[int, Meta(ge=0, le=LARGEST_COUNT)]
Ordinal = Annotated[int, Meta(ge=1, le=LARGEST_COUNT)]
Number = int | float
"""A finite number; `1` and `1.0` stay distinct, so that files compare exactly."""
Distance = Annotated[int, Meta(ge=0)] | Annotated[float, Meta(ge=0)]
Share = Annotated[int, Meta(ge=0, le=1)] | Annotated[float, Meta(ge=0, le=1)]
Seconds = Annotated[int, Meta(ge=0, le=10**10)] | Annotated[float, Meta(ge=0, le=10**10)]
"""Seconds from the start of a recorded run, up to some three hundred years."""
Name = Annotated[str, Meta(min_length=1)]
Sha256 = Annotated[str, Meta(pattern="^[0-9a-f]{64}$", max_length=64)]
"""A SHA-256 in hexadecimal. `max_length` is needed because `$` in Python matches before a final
line break."""


def about(description: str) -> Meta:
    """The description of a value in the schema."""
    return Meta(description=description)


def decoded(value: object, kind: type[R]) -> R:
    """A JSON value as a record.

    Raises:
        SchemaError: the value does not fit the record; the message names the path.
    """
    try:
        return msgspec.convert(value, kind, strict=True)
    except msgspec.ValidationError as error:
        raise SchemaError(_in_words(str(error))) from None
    except UnicodeEncodeError:
        raise SchemaError("a text has a lone surrogate, which is half of a character") from None


def decoded_json(data: bytes | Raw, kind: type[R]) -> R:
    """A JSON text as a record, of which keys that the record does not have may be skipped.

    The text is not checked as strictly as by `checked_json`: of a key that appears twice the last
    one counts, and an integer of a type without bounds may have any size.

    Raises:
        SchemaError: the text does not fit the record.
    """
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.MsgspecError, UnicodeError) as error:
        raise SchemaError(_in_words(str(error))) from None
    except RecursionError:
        raise SchemaError("it is nested too deeply") from None


def json_bytes(record: object) -> bytes:
    """The shortest JSON text of a record: equal values give equal bytes."""
    return msgspec.json.encode(record)


def read(path: str, kind: type[R], command: str, again: str) -> tuple[Source, R] | Diagnostic:
    """Read and check a file that fretc writes; F503.

    Args:
        path: the file.
        kind: the type of its content.
        command: the command that writes it: `fretc verify`.
        again: the help text, which says how to make the file again.

    Returns:
        The text of the file, and its content.
    """
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    try:
        return source, decoded(parsed(source.text).value, kind)
    except json.JSONDecodeError as error:
        what = f"is not JSON: {error.msg[:1].lower()}{error.msg[1:]}"
    except SchemaError as error:
        what = f"is not what `{command}` writes: {error}"
    except RecursionError:
        what = "is not JSON that fretc can read: it is nested too deeply"
    except ValueError as error:
        what = f"is not JSON that fretc can read: {error}"
    span = Source(source.name, "").span()
    return diagnostic("bad_result_file", span, path=source.name, what=what, help=again)


def plain(record: object) -> Any:
    """The record as plain values for JSON."""
    return msgspec.to_builtins(record)


def json_schema(kind: type[Record], id: str, title: str, description: str) -> dict[str, Any]:
    """The JSON Schema of the files that hold such a record."""
    schema = msgspec.json.schema(kind)
    whole = schema["$defs"].pop(kind.__name__)
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": id,
        "title": title,
        "description": description,
    }
    return {**head, **{k: v for k, v in whole.items() if k not in head}, "$defs": schema["$defs"]}


def _in_words(message: str) -> str:
    """Rewrite msgspec's message in the words of `checked_json`."""
    what, _, place = message.rpartition(" - at ")
    if not what:
        return f"{message[:1].lower()}{message[1:]}"
    return f"{place}: {what[:1].lower()}{what[1:]}"
