"""What the metadata records of a log say, as far as it is asked for: `build.version` → values."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from mcap.records import Metadata

from fretc.logs.mcap.container import BrokenError, parse

LARGEST = 2**20
"""Bytes; a larger record is passed by."""
_MOST = 4
"""Different values of one key that are kept."""

Described = Mapping[str, tuple[str, ...]]
"""Record and key, with a dot between them → its values in the order of the log, each once."""


def described(content: bytes, wanted: Collection[str]) -> Described:
    """What is wanted of one record; nothing of a record that cannot be read."""
    if not wanted or len(content) > LARGEST:
        return {}
    try:
        record = parse(Metadata.read, content)
    except BrokenError:
        return {}
    return of_record(record.name, record.metadata, wanted)


def of_record(name: str, values: Mapping[str, str], wanted: Collection[str]) -> Described:
    """What is wanted of a record."""
    found = {
        text: values[key]
        for text in wanted
        if text.startswith(f"{name}.") and (key := text[len(name) + 1 :]) in values
    }
    return {text: (value,) for text, value in found.items()}


def together(parts: Sequence[Described]) -> Described:
    """Several of them as one."""
    if not any(parts):
        return {}
    keys = dict.fromkeys(key for part in parts for key in part)
    values = {key: [value for part in parts for value in part.get(key, ())] for key in keys}
    return {key: tuple(dict.fromkeys(some))[:_MOST] for key, some in values.items()}
