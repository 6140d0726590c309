"""The wanted values of the metadata records of a log: `build.version` → values."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from mcap.records import Metadata

from fretc.logs.mcap.container import BrokenError, parse

LARGEST = 2**20
"""Bytes; a larger record is skipped."""
_MOST = 4
"""The most different values of one key that are kept."""

Described = Mapping[str, tuple[str, ...]]
"""Record and key, joined by a dot → its values in the order of the log, each once."""


def described(content: bytes, wanted: Collection[str]) -> Described:
    """The wanted values of one record; empty if the record cannot be read."""
    if not wanted or len(content) > LARGEST:
        return {}
    try:
        record = parse(Metadata.read, content)
    except BrokenError:
        return {}
    return of_record(record.name, record.metadata, wanted)


def of_record(name: str, values: Mapping[str, str], wanted: Collection[str]) -> Described:
    """The wanted values of a parsed record."""
    wanted_values = {
        text: values[key]
        for text in wanted
        if text.startswith(f"{name}.") and (key := text[len(name) + 1 :]) in values
    }
    return {text: (value,) for text, value in wanted_values.items()}


def together(parts: Sequence[Described]) -> Described:
    """The values of several logs or files together."""
    if not any(parts):
        return {}
    keys = dict.fromkeys(key for part in parts for key in part)
    values = {key: [value for part in parts for value in part.get(key, ())] for key in keys}
    return {key: tuple(dict.fromkeys(some))[:_MOST] for key, some in values.items()}
