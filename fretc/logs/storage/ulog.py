"""ULog, the log of PX4, read with pyulog; its messages go to a sink.

A topic is `/vehicle_status`, and its further instances are `/vehicle_status/instance_1` and so
on. Messages are passed on as ROS 1 lays fields out, which ULog does alike: packed, little-endian.
Texts and padding are left out. ULog has no check sums; it states dropouts, and those are gaps.
Times are nanoseconds since the start of the autopilot.

Source: https://docs.px4.io/main/en/dev_log/ulog_file_format.html.
"""

from __future__ import annotations

import contextlib
import io
import struct
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fretc.logs.mcap.damage import LATEST, Damage
from fretc.logs.mcap.messages import Sink
from fretc.logs.signals.samples import Gap
from fretc.logs.storage.bags import NOWHERE
from fretc.logs.storage.inputs import OpenLog
from fretc.logs.storage.packed_topics import PackedField, PackedTopic, packed_topic
from fretc.logs.storage.parts import FileContents
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

MAGIC = b"ULog\x01\x12\x35"
"""The first bytes of the file."""
_TYPES = {
    "int8_t": ("int8", "i1"), "uint8_t": ("uint8", "u1"), "int16_t": ("int16", "<i2"),
    "uint16_t": ("uint16", "<u2"), "int32_t": ("int32", "<i4"), "uint32_t": ("uint32", "<u4"),
    "int64_t": ("int64", "<i8"), "uint64_t": ("uint64", "<u8"), "float": ("float32", "<f4"),
    "double": ("float64", "<f8"), "bool": ("bool", "u1"),
}  # fmt: skip
"""The types of fields, each with ROS's and NumPy's name of it."""
_RECORD = struct.Struct("<HB")
_FIRST_RECORD = 16
"""Bytes of the file's head."""
_MILLISECOND, _MICROSECOND = 10**6, 10**3


def read(log: OpenLog, sink: Sink, span: Span) -> FileContents | Diagnostic:
    """Pass all messages of a ULog to a sink, one topic after the other.

    Args:
        log: the file.
        sink: receives the messages.
        span: the file, as named on the command line.

    Returns:
        Its contents; or why it cannot be read.
    """
    try:
        from pyulog import ULog
    except ModuleNotFoundError:
        return missing_extra("a ULog cannot be read: that needs", ["pyulog"], "ulog", span)
    log.stream.seek(0)
    content = log.stream.read()
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # pyulog prints warnings
            parsed = ULog(io.BytesIO(content), None, disable_str_exceptions=True)
        topics = [_topic(i, each, parsed) for i, each in enumerate(parsed.data_list, 1)]
    except Exception as error:  # the reader trusts each byte, and each may be wrong
        reason = str(error).partition("\n")[0][:200] or type(error).__name__
        return diagnostic("bad_ulog", span, why=reason)
    times = np.sort(np.concatenate([each.times for each in topics] or [np.zeros(0, np.int64)]))
    if not times.size:
        return diagnostic("empty_log", span)
    if int(times[-1]) >= LATEST:
        return diagnostic("bad_ulog", span, why="a message has an impossible time")
    for topic in topics:
        topic.pass_to(sink)
    whole = int(times[0]), int(times[-1])
    damages = (*_dropouts(parsed, times), *_damages(parsed, content, whole))
    note = diagnostic("limits_of_ulog", span)
    return FileContents(log.sha256(), log.size, whole, damages, (note,))


def _topic(number: int, data: Any, parsed: Any) -> PackedTopic:
    """The messages of a topic.

    Raises:
        KeyError: a field has no values.
    """
    fields = [
        PackedField(
            field.name, field.type, [data.data[name].view(field.kind) for name in field.values]
        )
        for field in _fields(data.name, "", "", parsed.message_formats)
    ]
    stamps = data.data["timestamp"]
    times = np.minimum(stamps, np.uint64(LATEST // _MICROSECOND + 1)).astype(np.int64)
    times *= _MICROSECOND
    topic = f"/{data.name}" if data.multi_id == 0 else f"/{data.name}/instance_{data.multi_id}"
    return packed_topic(number, topic, f"ulog/{data.name}", fields, times)


@dataclass(frozen=True, slots=True)
class _Field:
    """A field of a message."""

    name: str
    type: str
    """In ROS's words."""
    kind: str
    """NumPy's type of its numbers."""
    values: tuple[str, ...]
    """pyulog's name of each of its numbers."""


def _fields(name: str, ours: str, theirs: str, formats: Mapping[str, Any]) -> Iterator[_Field]:
    """The fields of a message; `esc[1].rpm`, in a message within it, is `esc_1_rpm`.

    Args:
        name: a format.
        ours: what stands before the names of its fields here.
        theirs: what stands before them in pyulog.
        formats: all formats of the file.
    """
    for kind, count, field in formats[name].fields:
        if field.startswith("_padding") or kind == "char":
            continue
        indices = [f"[{i}]" for i in range(count)] or [""]
        if kind in _TYPES:
            ros, own = _TYPES[kind]
            values = tuple(f"{theirs}{field}{index}" for index in indices)
            yield _Field(f"{ours}{field}", f"{ros}[{count}]" if count else ros, own, values)
            continue
        for index in indices:
            inside = f"{ours}{field}_{index[1:-1]}_" if index else f"{ours}{field}_"
            yield from _fields(kind, inside, f"{theirs}{field}{index}.", formats)


# Damage


def _dropouts(parsed: Any, times: NDArray[np.int64]) -> Iterator[tuple[Damage, Gap]]:
    """The losses that the autopilot states: each from the message before it to the one after it."""
    for each in parsed.dropouts:
        start = min(each.timestamp * _MICROSECOND, int(times[-1]))
        least = start + each.duration * _MILLISECOND
        i = int(np.searchsorted(times, max(least, start + 1)))
        end = int(times[i]) if i < times.size else int(times[-1])
        what = f"the autopilot states a dropout of {each.duration} ms"
        yield Damage(NOWHERE, what), (start, max(start, end))


def _damages(parsed: Any, content: bytes, whole: Gap) -> Iterator[tuple[Damage, Gap]]:
    """What the file itself has lost."""
    if parsed.file_corruption:
        yield Damage(NOWHERE, "records of the file are damaged"), whole
    elif parsed.has_data_appended:
        what = "data was appended to it after a crash"
        yield Damage(NOWHERE, what, code=Code.TRUNCATED_LOG), (whole[1], whole[1])
    elif _is_cut(content):
        what = "its last record is not whole"
        yield Damage(NOWHERE, what, code=Code.TRUNCATED_LOG), (whole[1], whole[1])


def _is_cut(content: bytes) -> bool:
    """Whether the last record ends behind the file."""
    at = _FIRST_RECORD
    while at + _RECORD.size <= len(content):
        size, _ = _RECORD.unpack_from(content, at)
        at += _RECORD.size + size
    return at != len(content)
