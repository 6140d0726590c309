"""DataFlash, the log of ArduPilot: records that describe themselves.

A topic is `/ATT`; of messages with an instance, such as `/BAT`, each further one is a topic of its
own, `/BAT/instance_1`. Texts are left out. DataFlash has no check sums: a record counts only if
another one, or the end of the file, follows it. What cannot be read, and what the autopilot says it
has dropped, is a gap. Times are nanoseconds since the start of the autopilot.

Source: https://ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html, and the formats
of `LogStructure.h` of ArduPilot.
"""

from __future__ import annotations

import re
import struct
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field

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
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

_SYNC = b"\xa3\x95"
_FMT = 128
MAGIC = _SYNC + bytes([_FMT])
"""The first bytes of the file."""
_FORMAT = struct.Struct("<BB4s16s64s")
_HEAD = 3
"""Bytes before the fields of a record."""
_TYPES: Mapping[str, tuple[str, str, int]] = {
    "b": ("i1", "int8", 1), "B": ("u1", "uint8", 1), "M": ("u1", "uint8", 1),
    "h": ("<i2", "int16", 1), "H": ("<u2", "uint16", 1), "i": ("<i4", "int32", 1),
    "I": ("<u4", "uint32", 1), "q": ("<i8", "int64", 1), "Q": ("<u8", "uint64", 1),
    "g": ("<f2", "float32", 1), "f": ("<f4", "float32", 1), "d": ("<f8", "float64", 1),
    "c": ("<i2", "float64", 100), "C": ("<u2", "float64", 100), "e": ("<i4", "float64", 100),
    "E": ("<u4", "float64", 100), "L": ("<i4", "float64", 10**7), "a": ("(32,)<i2", "int16[32]", 1),
    "n": ("S4", "", 1), "N": ("S16", "", 1), "Z": ("S64", "", 1),
}  # fmt: skip
"""The types of fields, each with NumPy's and ROS's name and the divisor; a text has none of ROS."""
_WHOLE = frozenset("bBhHiI")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_CLOCKS = {"TimeUS": 1000, "TimeMS": 10**6}
"""The columns with the time of a record, each with the nanoseconds of its unit."""
_UNITS, _INSTANCE = "FMTU", "#"
"""The records with units, and the unit that marks the column with the instance."""
_MOST_INSTANCES = 256
_STATISTICS, _DROPPED = "DSF", "Dp"
"""The records of the logger about itself, and their column with the blocks it dropped so far."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """The form of the records of one type."""

    name: str
    size: int
    """Bytes, with the head."""
    columns: tuple[str, ...]
    formats: str

    @property
    def row(self) -> np.dtype[np.void]:
        """The type of a record, without its head."""
        names = zip(self.columns, self.formats, strict=True)
        return np.dtype([(name, _TYPES[letter][0]) for name, letter in names])


def _is_whole_number(kind: _Kind, column: str) -> bool:
    """Whether the records have a column of that name with whole numbers."""
    letter = kind.formats[kind.columns.index(column)] if column in kind.columns else ""
    return letter in _WHOLE


@dataclass(slots=True)
class _Records:
    """Where the records of a file are."""

    kinds: dict[int, _Kind] = field(default_factory=dict)
    places: dict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    """For each type the positions of its records."""
    breaks: list[tuple[int, str]] = field(default_factory=list)
    """Positions at which something cannot be read, and what."""
    is_cut: bool = False
    """Whether the file ends within a record."""


def read(log: OpenLog, sink: Sink, span: Span) -> FileContents | Diagnostic:
    """Pass all messages of a DataFlash log to a sink, one topic after the other.

    Args:
        log: the file.
        sink: receives the messages.
        span: the file, as named on the command line.

    Returns:
        Its contents; or why it cannot be read.
    """
    log.stream.seek(0)
    content = log.stream.read()
    records = _records(content)
    instances = _instances(records, content)
    topics: list[PackedTopic] = []
    positions: list[NDArray[np.int64]] = []
    drops = np.zeros(0, np.int64), np.zeros(0, np.int64)
    for type_, places in records.places.items():
        kind = records.kinds[type_]
        clock = next((name for name in _CLOCKS if name in kind.columns), None)
        if clock is None:
            continue
        rows = _rows(content, kind, places)
        times = np.minimum(rows[clock].astype(np.uint64), LATEST // _CLOCKS[clock] + 1)
        at = times.astype(np.int64) * _CLOCKS[clock]
        positions.append(np.stack([np.array(places, np.int64), at]))
        topics += _topics(len(topics), kind, rows, at, instances.get(type_))
        if kind.name == _STATISTICS and _is_whole_number(kind, _DROPPED):
            drops = rows[_DROPPED].astype(np.int64), at
    if not positions:
        return diagnostic("empty_log", span)
    placed = np.concatenate(positions, axis=1)
    start, end = int(placed[1].min()), int(placed[1].max())
    if end >= LATEST:
        return diagnostic("bad_dataflash", span, why="a message has an impossible time")
    for topic in topics:
        topic.pass_to(sink)
    damages = (*_drops(*drops, start), *_damages(records, placed[:, placed[0].argsort()]))
    note = diagnostic("limits_of_dataflash", span)
    return FileContents(log.sha256(), log.size, (start, end), damages, (note,))


# Records


def _records(content: bytes) -> _Records:
    """The records of a file; each is followed by another one, or by the end of the file."""
    records = _Records()
    sizes = [0] * 256
    sizes[_FMT] = _HEAD + _FORMAT.size
    at, end = 0, len(content)
    is_broken = False
    while at < end:
        size = sizes[content[at + 2]] if content[at : at + 2] == _SYNC and at + 2 < end else 0
        after = at + size
        if size and (after == end or content[after : after + 2] == _SYNC):
            type_ = content[at + 2]
            if type_ == _FMT:
                _learn(records, sizes, content, at)
            records.places[type_].append(at)
            at, is_broken = after, False
            continue
        if size and after > end:
            records.is_cut = True
        if not is_broken:
            what = "its last record is not whole" if records.is_cut else "a record cannot be read"
            records.breaks.append((at, what))
        is_broken = True
        at = content.find(_SYNC, at + 1)
        at = end if at < 0 else at
    for type_ in [each for each in records.places if each not in records.kinds]:
        del records.places[type_]
    return records


def _learn(records: _Records, sizes: list[int], content: bytes, at: int) -> None:
    """Read the form of a type; one that contradicts an earlier form, or itself, is a break."""
    type_, size, name, formats, columns = _FORMAT.unpack_from(content, at + _HEAD)
    texts = [each.rstrip(b"\0").decode("latin-1") for each in (name, formats, columns)]
    kind = _Kind(texts[0], size, tuple(filter(None, texts[2].split(","))), texts[1])
    known = records.kinds.get(type_)
    if type_ == _FMT:
        return
    is_whole = (
        len(kind.columns) == len(kind.formats) == len({*kind.columns})
        and {*kind.formats} <= _TYPES.keys()
        and all(map(_NAME.fullmatch, (kind.name, *kind.columns)))
        and kind.row.itemsize + _HEAD == size
    )
    if not is_whole or known not in (None, kind):
        records.breaks.append((at, f"the format of the type {type_} cannot be read"))
        return
    records.kinds[type_], sizes[type_] = kind, size


def _rows(content: bytes, kind: _Kind, places: Sequence[int]) -> NDArray[np.void]:
    """The records of one type, shape (n,)."""
    size = kind.size - _HEAD
    starts = np.array(places, np.int64)[:, None] + _HEAD + np.arange(size)
    data = np.frombuffer(content, np.uint8)[starts]
    return np.ascontiguousarray(data).view(kind.row)[:, 0]


def _instances(records: _Records, content: bytes) -> dict[int, str]:
    """For each type with instances, the column that tells them apart."""
    columns: dict[int, str] = {}
    for type_, kind in records.kinds.items():
        if kind.name != _UNITS or not {"FmtType", "UnitIds"} <= {*kind.columns}:
            continue
        for row in _rows(content, kind, records.places[type_]) if type_ in records.places else []:
            of, units = int(row["FmtType"]), bytes(row["UnitIds"]).decode("latin-1")
            place = units.find(_INSTANCE)
            named = records.kinds[of].columns[place : place + 1] if of in records.kinds else ()
            if place >= 0 and named and _is_whole_number(records.kinds[of], named[0]):
                columns[of] = named[0]
    return columns


def _topics(
    count: int, kind: _Kind, rows: NDArray[np.void], times: NDArray[np.int64], instance: str | None
) -> Iterator[PackedTopic]:
    """The topics of one type, of which `count` come before them."""
    own = None if instance is None else rows[instance]
    numbers = [0] if own is None else np.unique(own)[:_MOST_INSTANCES].tolist()
    for number in numbers:
        chosen = slice(None) if own is None else own == number
        topic = f"/{kind.name}" if number == 0 else f"/{kind.name}/instance_{number}"
        count += 1
        fields = list(_fields(kind, rows[chosen]))
        yield packed_topic(count, topic, f"dataflash/{kind.name}", fields, times[chosen])


def _fields(kind: _Kind, rows: NDArray[np.void]) -> Iterator[PackedField]:
    for name, letter in zip(kind.columns, kind.formats, strict=True):
        _, ros, divisor = _TYPES[letter]
        column = rows[name]
        if not ros:
            continue
        if column.ndim > 1:
            yield PackedField(name, ros, [*column.T])
        elif divisor > 1:
            yield PackedField(name, ros, [column / divisor])
        else:
            yield PackedField(name, ros, [column.astype("<f4") if letter == "g" else column])


# Damage


def _damages(records: _Records, placed: NDArray[np.int64]) -> Iterator[tuple[Damage, Gap]]:
    """What cannot be read: from the message before it to the one after it.

    Args:
        records: the records of the file.
        placed: shape (2, n): positions and times of the messages, in order of positions.
    """
    for at, what in records.breaks:
        i = int(np.searchsorted(placed[0], at))
        before = int(placed[1][:i].max()) if i else int(placed[1].min())
        after = int(placed[1][i:].min()) if i < placed.shape[1] else before
        is_last = records.is_cut and (at, what) == records.breaks[-1]
        code = Code.TRUNCATED_LOG if is_last else Code.DAMAGED_CHUNK
        yield Damage(NOWHERE, what, code=code), (min(before, after), max(before, after))


def _drops(
    counts: NDArray[np.int64], times: NDArray[np.int64], start: int
) -> Iterator[tuple[Damage, Gap]]:
    """The losses that the autopilot states, each between two of its statements.

    Args:
        counts: shape (n,): the blocks that it had dropped since the log began.
        times: shape (n,): nanoseconds.
        start: the first message.
    """
    before, since = 0, start
    for count, time in zip(counts.tolist(), times.tolist(), strict=True):
        if count != before:
            what = f"the autopilot states that it has dropped {count} blocks in all"
            yield Damage(NOWHERE, what), (min(since, time), time)
        before, since = count, time
