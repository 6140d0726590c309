"""Recorded logs: an MCAP file → samples of signals, and how healthy the file is.

A log is read from its first record to its last. What its summary states (where the chunks are,
how many messages there are) is held against what was found, so that a damaged place is a named
gap and never a silent loss. Times are nanoseconds.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import struct
import zlib
from array import array
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from io import BufferedReader, BytesIO, StringIO
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Header,
    Metadata,
    Schema,
    Statistics,
)

from fretish.clock import TimeSource
from fretish.declarations import Declarations, Signal
from fretish.diagnostic import Code, Diagnostic, Severity, suggestion
from fretish.source import Source, Span
from monitors.propositions import Numbers, Times
from monitors.signals import FieldError, fields, nearest, sample

_MAGIC = b"\x89MCAP0\r\n"
_HEAD = struct.Struct("<BQ")
"""What each record begins with: opcode and length."""
_MESSAGE = struct.Struct("<HIQQ")
"""What each message begins with: channel, sequence, log time, publish time."""
_INDEX, _ENTRY = struct.Struct("<HI"), struct.Struct("<QQ")
"""What the index of a chunk begins with (channel, length), and its entries: time, place."""
_PADDING = 256
"""Bytes; a record may be so much longer than what is in it."""
_FOOTER = struct.Struct("<QQI")
"""Start of the summary, start of its offsets, CRC."""
_LARGEST = 2**30
"""Bytes; a larger message or chunk is not read."""
_RATIO = 50_000
"""No compression packs more than so many bytes into one."""
_BLOCK = 2**20
_LATEST = 2**62
"""Nanoseconds, the year 2116; a later time is damage."""
_MOST_TICKS = 20_000_000
_MOST_TOLD = 20
_SECOND = 10**9
_HOUR = 3600 * _SECOND

Gap = tuple[int, int]
"""First and last nanosecond of a time whose messages are lost."""


@dataclass(frozen=True, slots=True)
class Samples:
    """One signal.

    `times` has shape (n,), nanoseconds that do not decrease; equal times stand in the order of
    the file. `values` has shape (n,), in the signal's base unit; NaN is unknown.
    """

    times: Times
    values: Numbers


@dataclass(frozen=True, slots=True)
class Topic:
    """How one topic of a log is, by the declared time (`log_time` where no signal reads it).

    `first_ns` and `last_ns` are None for a topic without messages. `out_of_order` counts the
    messages that are earlier than one before them, `equal_stamps` those with the time of another.
    """

    name: str
    type: str
    encoding: str
    count: int
    first_ns: int | None
    last_ns: int | None
    longest_gap_ns: int
    out_of_order: int
    equal_stamps: int


@dataclass(frozen=True, slots=True)
class Recording:
    """What one log holds of the declared signals.

    `start_ns` and `end_ns` are the times of the first and the last message of the topics that the
    bindings read, whichever signals were asked for, widened to the `gaps`. `ticks` are the times
    of the clock's topic, where the clock ticks by message. Each gap includes both its ends.
    `nearest` is, for signals that are the nearest of many readings, the least distance in metres
    that the sensor says it can report. `intact` is False when anything was found that could have
    lost messages.
    """

    name: str
    sha256: str
    size: int
    start_ns: int
    end_ns: int
    samples: Mapping[str, Samples]
    ticks: Times
    gaps: tuple[Gap, ...]
    topics: Mapping[str, Topic]
    nearest: Mapping[str, float]
    findings: tuple[Diagnostic, ...]
    intact: bool


def read(path: str, declarations: Declarations, wanted: Collection[str]) -> Recording | Diagnostic:
    """Read a log.

    Every byte is looked at once; only the messages of the topics in question are decoded.

    Args:
        path: the file, as the user names it.
        declarations: clock and signals.
        wanted: names of declared signals.

    Returns:
        The recording, with findings about single topics and damaged places; or what keeps the
        whole file from being read. Of a signal with an error among the findings there are no
        samples.

    Raises:
        KeyError: a wanted signal is not declared.
    """
    place = Source(path, "").span()
    signals = [declarations.signals[name] for name in dict.fromkeys(wanted)]
    try:
        status = os.stat(path)
        if stat.S_ISDIR(status.st_mode):
            return _is_a_directory(place)
        if not stat.S_ISREG(status.st_mode):
            return Diagnostic(Code.UNREADABLE, "it is not a regular file", place, "name a file")
        with Path(path).open("rb") as stream:
            return _read(stream, place, declarations, signals)
    except FileNotFoundError:
        return Diagnostic(Code.NO_SUCH_FILE, "there is no such file", place, "check the path")
    except OSError as error:
        reason = error.strerror or str(error)
        return Diagnostic(
            Code.UNREADABLE, f"it cannot be read: {reason}", place, "check its permissions"
        )


def _read(
    stream: BufferedReader, place: Span, declarations: Declarations, wanted: list[Signal]
) -> Recording | Diagnostic:
    digest = hashlib.file_digest(stream, "sha256").hexdigest()
    size = stream.tell()
    stream.seek(0)
    start = stream.read(max(len(_MAGIC), 16))
    if not start:
        return _empty(place)
    if start[: len(_MAGIC)] != _MAGIC:
        return _not_a_log(start, place)
    columns = _Columns(declarations, wanted)
    walk = _Walk(stream, size, columns)
    walk.run()
    if walk.cut is not None:
        return _truncated(walk, place)
    if not columns.count:
        return _nothing_whole(walk, place) if walk.damages else _empty(place)
    recording = _recording(place, digest, size, columns, walk.settled())
    return _too_long(recording, declarations, place) or recording


# The file


@dataclass(slots=True)
class _Damage:
    """A place of the file whose messages are lost, or may be.

    `stated` are the times that the file itself gives for it. `before` and `after` are the times
    of the messages around it. `lossless` says that no message can be missing.
    """

    at: int
    what: str
    stated: list[Gap] = field(default_factory=list)
    before: int | None = None
    after: int | None = None
    also: list[int] = field(default_factory=list)
    """Further bytes, where no whole message lies between."""
    lossless: bool = False
    anywhere: bool = False
    """Whether it may have cost messages of any time."""
    code: Code = Code.DAMAGED_CHUNK
    kept: bool = False


class _BrokenError(Exception):
    """A record is not what it should be; the text says in which way."""


class _Exact(ReadDataStream):
    """Bytes that cannot be read past their end."""

    def read(self, length: int) -> bytes:
        data = super().read(length)
        if len(data) != length:
            raise _BrokenError("a record is shorter than it states")
        return data


R = TypeVar("R")


def _parse(kind: Callable[[ReadDataStream], R], content: bytes) -> R:
    """One record, from its own bytes and no others.

    Raises:
        _BrokenError: they do not fit together.
    """
    try:
        return kind(_Exact(BytesIO(content)))
    except Exception as error:  # the parser trusts each byte, and each may be wrong
        raise _BrokenError("a record cannot be read") from error


def _unpacked(chunk: Chunk) -> bytes:
    """What is in a chunk: as long as it states, and with the CRC that it states.

    Never more memory than stated, and no more than `_LARGEST`, whatever the bytes ask for.

    Raises:
        _BrokenError: it is not so.
    """
    size = chunk.uncompressed_size
    if size > min(_LARGEST, _RATIO * (len(chunk.data) + 1)):
        raise _BrokenError(f"a chunk states the absurd size of {size} bytes")
    try:
        data = _decompress(chunk.compression, chunk.data, size + 1)
    except _BrokenError:
        raise
    except Exception as error:  # each codec has its own
        raise _BrokenError("a chunk does not decompress") from error
    if len(data) != size:
        raise _BrokenError("a chunk has another size than it states")
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise _BrokenError("a chunk has another CRC than it states")
    return data


def _decompress(compression: str, data: bytes, most: int) -> bytes:
    """Not more than `most` bytes of it."""
    match compression:
        case "":
            return data
        case "zstd":
            import zstandard

            with zstandard.ZstdDecompressor().stream_reader(data) as stream:
                return stream.read(most)
        case "lz4":
            import lz4.frame  # type: ignore[import-untyped]

            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=most))
        case _:
            raise _BrokenError(f"a chunk is compressed with the unknown `{compression}`")


@dataclass(slots=True)
class _Summary:
    """What the end of a file states about the rest; empty where it is damaged."""

    end: int
    """Where the data section ends, if `sound`; it ends earlier if not."""
    sound: bool
    statistics: Statistics | None = None
    chunks: dict[int, ChunkIndex] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)


def _footer(tail: bytes) -> tuple[int, bytes] | None:
    """Where the last record before the closing magic begins, in `tail`, and its content."""
    end = tail.rfind(_MAGIC)
    for length in range(_FOOTER.size, _FOOTER.size + _PADDING):
        at = end - _HEAD.size - length
        if at >= 0 and _HEAD.unpack_from(tail, at) == (Opcode.FOOTER, length):
            return at, tail[at + _HEAD.size : end]
    return None


def _summary(stream: BufferedReader, at: int, content: bytes) -> _Summary:
    """The summary of a file whose footer begins at byte `at`."""
    start, _, crc = _FOOTER.unpack_from(content)
    damaged = _Summary(at, sound=False)
    if start == 0:
        return _Summary(at, sound=True)
    if not len(_MAGIC) <= start <= at:
        return damaged
    stream.seek(start)
    data = stream.read(at - start)
    covered = zlib.crc32(_HEAD.pack(Opcode.FOOTER, len(content)), zlib.crc32(data))
    if crc and crc != zlib.crc32(content[: _FOOTER.size - 4], covered):
        return damaged
    summary = _Summary(start, sound=True)
    try:
        for opcode, begin, end in _frames(data):
            _note(summary, opcode, data[begin:end])
    except _BrokenError:
        return damaged
    return summary


def _note(summary: _Summary, opcode: int, content: bytes) -> None:
    match opcode:
        case Opcode.STATISTICS:
            summary.statistics = _parse(Statistics.read, content)
        case Opcode.CHUNK_INDEX:
            chunk = _parse(ChunkIndex.read, content)
            summary.chunks[chunk.chunk_start_offset] = chunk
        case Opcode.SCHEMA:
            schema = _parse(Schema.read, content)
            summary.schemas[schema.id] = schema
        case Opcode.CHANNEL:
            channel = _parse(Channel.read, content)
            summary.channels[channel.id] = channel


def _frames(data: bytes) -> Iterator[tuple[int, int, int]]:
    """`(opcode, start, end)` of the content of each record.

    Raises:
        _BrokenError: the last one is longer than the data.
    """
    at, size = 0, len(data)
    while at < size:
        if at + _HEAD.size > size:
            raise _BrokenError("a record is cut off")
        opcode, length = _HEAD.unpack_from(data, at)
        start = at + _HEAD.size
        at = start + length
        if at > size:
            raise _BrokenError("a record is cut off")
        yield opcode, start, at


class _Sink(Protocol):
    """Takes the messages in the order of the file; `data[start:end]` is the payload."""

    def add(
        self, channel: Channel, log_time: int, publish_time: int, data: bytes, start: int, end: int
    ) -> None: ...

    def declare(self, channel: Channel, schema: Schema | None) -> None: ...


_KNOWN = frozenset(Opcode)
_IN_DATA: dict[int, Callable[[ReadDataStream], object]] = {
    Opcode.HEADER: Header.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.METADATA: Metadata.read,
}


class _Walk:
    """One way through the data section; messages go to the sink, damages stay here."""

    def __init__(self, stream: BufferedReader, size: int, sink: _Sink) -> None:
        self._stream, self._size, self._sink = stream, size, sink
        self._summary = _Summary(size, sound=False)
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._counts: Counter[int] = Counter()
        self._whole: set[int] = set()
        self._unchecked: tuple[int, Chunk, dict[int, list[Gap]]] | None = None
        self._unprotected = False
        self._unknown: list[_Damage] = []
        self._waiting: list[_Damage] = []
        """Damages after which no message has come yet."""
        self._open: _Damage | None = None
        """The one of them that takes in what is found damaged next."""
        self._crc: int | None = 0
        self.damages: list[_Damage] = []
        self.first: int | None = None
        self.latest: int | None = None
        self.last: int | None = None
        self.cut: int | None = None
        """Up to which byte there are whole records, in a file without an end."""

    def run(self) -> None:
        """Read everything."""
        begin = max(0, self._size - _BLOCK)
        self._stream.seek(begin)
        tail = self._stream.read()
        found = _footer(tail)
        if found is None:
            self.cut = self._data(truncated=True)
            return
        at, content = found
        self._summary = _summary(self._stream, begin + at, content)
        self._schemas.update(self._summary.schemas)
        for channel in self._summary.channels.values():
            self._declare(channel, self._size)
        self._data(truncated=False)
        if not self._summary.sound:
            self._damage(begin + at, "its summary is damaged", lossless=True)
        after = begin + at + _HEAD.size + len(content) + len(_MAGIC)
        if after != self._size:
            self._damage(after, "it goes on after its end", lossless=True)

    # Records

    def _data(self, truncated: bool) -> int:
        """Walk through the data section; where it ended."""
        at = len(_MAGIC)
        walls = sorted({*self._summary.chunks, self._summary.end})
        walls = walls[: walls.index(self._summary.end) + 1]
        self._stream.seek(0)
        self._take(at)
        while at < self._summary.end:
            wall = walls[bisect_right(walls, at)]
            crc, head = self._crc, self._take(_HEAD.size)
            opcode, length = _HEAD.unpack(head) if len(head) == _HEAD.size else (0, self._size)
            stop: int = at + _HEAD.size + length
            if stop > wall:
                if truncated:
                    return at
                self._damage(at, "the length of a record is damaged")
                at = self._jump(wall)
                continue
            try:
                if opcode == Opcode.DATA_END:
                    self._data_end(length, stop, crc)
                    return stop
                self._record(opcode, at, length)
                at = stop
            except _BrokenError as error:
                self._damage(at, str(error))
                at = self._jump(stop if self._fits(stop, wall) else wall)
        if not truncated and self._crc is not None:
            self._damage(at, "the end of its data is damaged", lossless=not self._unprotected)
        return at

    def _take(self, length: int) -> bytes:
        data = self._stream.read(length)
        if self._crc is not None:
            self._crc = zlib.crc32(data, self._crc)
        return data

    def _jump(self, to: int) -> int:
        self._stream.seek(to)
        self._crc = None
        return to

    def _fits(self, at: int, wall: int) -> bool:
        """Whether there seems to be a record at that byte."""
        if at == wall:
            return True
        self._stream.seek(at)
        head = self._stream.read(_HEAD.size)
        if len(head) < _HEAD.size:
            return False
        opcode, length = _HEAD.unpack(head)
        return opcode in _KNOWN and at + _HEAD.size + length <= wall

    def _record(self, opcode: int, at: int, length: int) -> None:
        if opcode not in _KNOWN:
            if opcode == 0:
                raise _BrokenError("a record has no kind")
            self._skip(length)
            self._unknown.append(self._new(at, f"a record is of the unknown kind {opcode}"))
            return
        if length > _LARGEST:
            self._skip(length)
            raise _BrokenError(f"a record of {length} bytes is too large to be read")
        content = self._take(length)
        match opcode:
            case Opcode.MESSAGE:
                self._unprotected = True
                self._message(at, content, 0, length)
            case Opcode.CHUNK:
                self._chunk(at, _parse(Chunk.read, content))
            case Opcode.MESSAGE_INDEX:
                self._index(content)
            case Opcode.SCHEMA:
                self._define(_parse(Schema.read, content), at)
            case Opcode.CHANNEL:
                self._declare(_parse(Channel.read, content), at)
            case Opcode.HEADER | Opcode.METADATA | Opcode.ATTACHMENT:
                _parse(_IN_DATA[opcode], content)
            case _:
                raise _BrokenError("a record of the summary stands among the data")

    def _skip(self, length: int) -> None:
        while length > 0:
            taken = len(self._take(min(length, _BLOCK)))
            length -= taken or length

    def _data_end(self, length: int, stop: int, crc: int | None) -> None:
        if self._summary.sound and stop != self._summary.end:
            raise _BrokenError("the end of the data stands among the data")
        stated = _parse(DataEnd.read, self._take(length)).data_section_crc
        if stated and crc is not None and crc != stated and not self.damages:
            what = "its data has another CRC than it states"
            self._damage(stop, what, lossless=not self._unprotected, anywhere=True)

    def _define(self, schema: Schema, at: int) -> None:
        known = self._schemas.setdefault(schema.id, schema)
        if known != schema:
            self._damage(at, f"it defines `{schema.name}` in two ways", anywhere=True)

    def _declare(self, channel: Channel, at: int) -> None:
        known = self._channels.setdefault(channel.id, channel)
        if known != channel:
            self._damage(at, f"it declares the topic `{channel.topic}` in two ways", anywhere=True)
        self._sink.declare(known, self._schemas.get(known.schema_id))

    # Messages

    def _chunk(self, at: int, chunk: Chunk) -> None:
        self._unchecked = None
        try:
            data = _unpacked(chunk)
            messages = self._inside(at, chunk, data)
        except _BrokenError as error:
            self._damage(at, str(error), [(chunk.message_start_time, chunk.message_end_time)])
            return
        self._whole.add(at)
        for start, end in messages:
            self._message(at, data, start, end)
        if not chunk.uncompressed_crc:
            self._unprotected = True
            entries: dict[int, list[Gap]] = {}
            for start, _ in messages:
                channel, _, time, _ = _MESSAGE.unpack_from(data, start)
                entries.setdefault(channel, []).append((time, start - _HEAD.size))
            self._unchecked = at, chunk, entries

    def _inside(self, at: int, chunk: Chunk, data: bytes) -> list[tuple[int, int]]:
        """Where the messages of a chunk are, `data[start:end]` each.

        What a CRC does not protect is held against the chunk's own times.
        """
        trusted = bool(chunk.uncompressed_crc)
        messages = []
        for opcode, start, end in _frames(data):
            if opcode == Opcode.MESSAGE:
                if end - start < _MESSAGE.size:
                    raise _BrokenError("a message is cut off")
                messages.append((start, end))
                if not trusted:
                    self._check(chunk, *_MESSAGE.unpack_from(data, start))
            elif opcode == Opcode.SCHEMA:
                self._define(_parse(Schema.read, data[start:end]), at)
            elif opcode == Opcode.CHANNEL:
                self._declare(_parse(Channel.read, data[start:end]), at)
            elif not trusted:
                raise _BrokenError("a chunk holds a record that does not belong there")
        return messages

    def _check(self, chunk: Chunk, channel: int, _: int, log_time: int, __: int) -> None:
        if not chunk.message_start_time <= log_time <= chunk.message_end_time:
            raise _BrokenError("a message is of another time than its chunk states")
        if channel not in self._channels:
            raise _BrokenError("a message is of a topic that is not declared")

    def _index(self, content: bytes) -> None:
        """Hold the index of a chunk without CRC against the messages in it."""
        if len(content) < _INDEX.size:
            raise _BrokenError("a record cannot be read")
        channel, length = _INDEX.unpack_from(content)
        padding = len(content) - _INDEX.size - length
        if length % _ENTRY.size or not 0 <= padding < _PADDING:
            raise _BrokenError("a record cannot be read")
        if self._unchecked is None:
            return
        at, chunk, entries = self._unchecked
        listed = list(_ENTRY.iter_unpack(content[_INDEX.size : _INDEX.size + length]))
        if listed and sorted(listed) != sorted(entries.get(channel, [])):
            what = "the index of a chunk names other messages than are in it"
            self._damage(at, what, [(chunk.message_start_time, chunk.message_end_time)])

    def _message(self, at: int, data: bytes, start: int, end: int) -> None:
        if end - start < _MESSAGE.size:
            raise _BrokenError("a message is cut off")
        channel_id, _, log_time, publish_time = _MESSAGE.unpack_from(data, start)
        self._counts[channel_id] += 1
        channel = self._channels.get(channel_id)
        if channel is None or log_time >= _LATEST:
            what = (
                "a message is of a topic that is not declared"
                if channel is None
                else ("a message is of an absurd time")
            )
            self._damage(at, what)
            return
        for damage in self._waiting:
            damage.after = log_time
        self._waiting.clear()
        self._open = None
        self.last = log_time
        self.first = log_time if self.first is None else min(self.first, log_time)
        self.latest = log_time if self.latest is None else max(self.latest, log_time)
        self._sink.add(channel, log_time, publish_time, data, start + _MESSAGE.size, end)

    # Damages

    def _new(self, at: int, what: str, stated: list[Gap] | None = None) -> _Damage:
        damage = _Damage(at, what, stated or [], self.last)
        self._waiting.append(damage)
        return damage

    def _damage(
        self,
        at: int,
        what: str,
        stated: list[Gap] | None = None,
        *,
        lossless: bool = False,
        anywhere: bool = False,
    ) -> None:
        """Keep one; of several without a message between them the first one tells."""
        located = not lossless and not anywhere
        if located and self._open is not None:
            self._open.stated += stated or []
            self._open.also.append(at)
            return
        damage = self._new(at, what, stated)
        damage.lossless, damage.anywhere = lossless, anywhere
        if located:
            self._open = damage
        self._keep(damage)

    def _keep(self, *damages: _Damage) -> None:
        for damage in damages:
            if not damage.kept:
                damage.kept = True
                self.damages.append(damage)

    def settled(self) -> list[tuple[_Damage, Gap | None]]:
        """All damages, with the time that each has cost; None where it cost nothing."""
        self._compare_chunks()
        self._compare_counts()
        return [(damage, self._gap(damage)) for damage in self.damages]

    def _compare_chunks(self) -> None:
        """Each chunk that the index names was read whole."""
        places = {damage.at: damage for damage in self._unknown}
        places |= {at: damage for damage in self.damages for at in (damage.at, *damage.also)}
        for at, index in self._summary.chunks.items():
            if at in self._whole:
                continue
            stated = (index.message_start_time, index.message_end_time)
            if at in places:
                places[at].stated.append(stated)
                self._keep(places[at])
            else:
                self._damage(at, "a chunk that its index names is not there", [stated])

    def _compare_counts(self) -> None:
        """As many messages were read as the statistics state."""
        statistics = self._summary.statistics
        if statistics is None:
            self._keep(*self._unknown)
            return
        stated = {id: n for id, n in statistics.channel_message_counts.items() if n}
        right = statistics.message_count == self._counts.total()
        if right and (not stated or stated == dict(self._counts)):
            return
        self._keep(*self._unknown)
        if not any(not damage.lossless for damage in self.damages):
            what = f"it states {statistics.message_count} messages and holds {self._counts.total()}"
            if right:
                what = "its topics hold other numbers of messages than it states"
            self._damage(self._size, what, anywhere=True)
            self.damages[-1].code = Code.COUNT_MISMATCH

    def _span(self) -> Gap:
        """The time of the whole log, as far as it is known."""
        assert self.first is not None
        assert self.latest is not None
        spans = [(self.first, self.latest)]
        statistics = self._summary.statistics
        if statistics is not None and statistics.message_count:
            spans.append((statistics.message_start_time, statistics.message_end_time))
        chunks = self._summary.chunks.values()
        spans += [(chunk.message_start_time, chunk.message_end_time) for chunk in chunks]
        if len(spans) == 1:  # only the damaged places themselves can tell
            near = (self.first - _HOUR, self.latest + _HOUR)
            stated = [gap for damage in self.damages for gap in damage.stated]
            spans += [gap for gap in stated if near[0] <= gap[0] <= gap[1] <= near[1]]
        return min(a for a, _ in spans), min(_LATEST, max(b for _, b in spans))

    def _gap(self, damage: _Damage) -> Gap | None:
        if damage.lossless:
            return None
        start, end = self._span()
        if damage.anywhere:
            return start, end
        stated = [(a, b) for a, b in damage.stated if start <= a <= b <= end]
        if stated:
            return min(a for a, _ in stated), max(b for _, b in stated)
        before = start if damage.before is None else damage.before
        after = end if damage.after is None else damage.after
        return min(before, after), max(before, after)


# The messages

_NAME = r"[A-Za-z][A-Za-z0-9_]*"
_ROS1_TYPE = re.compile(rf"{_NAME}/{_NAME}")
_FIELD = re.compile(rf"{_NAME}(/{_NAME})?(\[[0-9]*\])? {_NAME}")
_CONSTANT = re.compile(rf"{_NAME} [^=]*=")
_NEXT_TYPE = re.compile(rf"MSG: {_NAME}/{_NAME}")
_SEPARATOR = re.compile(r"={3,}")

Decode = Callable[[bytes], object]


@dataclass(slots=True)
class _Column:
    """What is read of one topic; `logs` are the log times, `times` those of the declared clock."""

    name: str
    type: str
    encoding: str
    bound: bool
    signals: list[Signal]
    logs: array[int] = field(default_factory=lambda: array("q"))
    times: array[int] = field(default_factory=lambda: array("q"))
    values: dict[str, array[float]] = field(default_factory=dict)
    wrong: dict[str, Diagnostic] = field(default_factory=dict)
    undecoded: int = 0
    unstamped: int = 0


class _Columns:
    """Takes messages and keeps the numbers that the signals ask for."""

    def __init__(self, declarations: Declarations, wanted: list[Signal]) -> None:
        self.clock = declarations.clock
        self.wanted = wanted
        self.topics: dict[str, _Column] = {}
        self.nearest: dict[str, float] = {}
        self.count = 0
        self.first = _LATEST
        self._source = declarations.source
        self._bound = {signal.path.topic for signal in declarations.signals.values()}
        self._bound |= {self.clock.topic} if self.clock.topic else set()
        self._schemas: dict[int, Schema | None] = {}
        self._decoders: dict[int, Decode | None] = {}

    def declare(self, channel: Channel, schema: Schema | None) -> None:
        """A topic of the log, with or without messages."""
        self._schemas[channel.id] = schema
        column = self.topics.get(channel.topic)
        if column is None:
            column = self.topics[channel.topic] = _Column(
                channel.topic,
                schema.name if schema else "",
                channel.message_encoding,
                channel.topic in self._bound,
                [signal for signal in self.wanted if signal.path.topic == channel.topic],
            )
        for signal in list(column.signals):
            if schema and signal.type and _short(schema.name) != _short(signal.type):
                self._refuse(column, signal, _wrong_type(signal, schema.name))

    def add(
        self, channel: Channel, log_time: int, publish_time: int, data: bytes, start: int, end: int
    ) -> None:
        """One message; only those of bound topics are decoded."""
        self.count += 1
        self.first = min(self.first, log_time)
        column = self.topics[channel.topic]
        if not column.bound:
            column.logs.append(log_time)
            return
        message = None
        if column.signals or self.clock.time is TimeSource.HEADER_STAMP:
            message = self._decoded(column, channel, data, start, end)
        time = self._time(column, log_time, publish_time, message)
        if time >= _LATEST:
            column.undecoded += 1
            return
        column.logs.append(log_time)
        column.times.append(time)
        for signal in list(column.signals):
            self._sample(column, signal, message)

    def _decoded(
        self, column: _Column, channel: Channel, data: bytes, start: int, end: int
    ) -> object | None:
        if channel.id not in self._decoders:
            self._decoders[channel.id] = self._decoder(column, channel)
        decode = self._decoders[channel.id]
        if decode is None:
            return None
        try:
            return decode(data[start:end])
        except Exception:  # the decoder trusts each byte, and each may be wrong
            column.undecoded += 1
            return None

    def _decoder(self, column: _Column, channel: Channel) -> Decode | None:
        try:
            found = _decoder(channel, self._schemas.get(channel.id))
        except Exception:  # a message definition may be any text
            found = "the definition of its messages cannot be read"
        if not isinstance(found, str):
            return found
        for signal in list(column.signals):
            self._refuse(column, signal, _unknown_encoding(signal, found))
        return None

    def _refuse(self, column: _Column, signal: Signal, diagnostic: Diagnostic) -> None:
        """No samples of this signal."""
        column.signals.remove(signal)
        column.wrong[signal.name] = diagnostic
        column.values.pop(signal.name, None)

    def _time(
        self, column: _Column, log_time: int, publish_time: int, message: object | None
    ) -> int:
        """When the message was, on the declared clock."""
        match self.clock.time:
            case TimeSource.LOG_TIME:
                return log_time
            case TimeSource.PUBLISH_TIME:
                return publish_time
            case TimeSource.HEADER_STAMP:
                stamp = _stamp(message)
                if stamp is not None:
                    return stamp
                if message is None and column.times:
                    return column.times[-1]
                column.unstamped += message is not None
                return log_time

    def _sample(self, column: _Column, signal: Signal, message: object | None) -> None:
        values = column.values.setdefault(signal.name, array("d"))
        if message is None:
            values.append(float("nan"))
            return
        try:
            values.append(sample(signal, message))
        except FieldError as error:
            self._refuse(column, signal, _no_field(signal, error))
            return
        least = nearest(signal, message)
        if least is not None:
            self.nearest[signal.name] = min(least, self.nearest.get(signal.name, least))

    # The results

    def samples(self) -> dict[str, Samples]:
        """Of each wanted signal, in order of time; of one with an error there are none."""
        return {signal.name: self._samples(signal) for signal in self.wanted}

    def _samples(self, signal: Signal) -> Samples:
        column = self.topics.get(signal.path.topic)
        values = column.values.get(signal.name) if column else None
        if column is None or values is None:
            return Samples(np.zeros(0, np.int64), np.zeros(0))
        times = np.array(column.times, np.int64)
        order = np.argsort(times, kind="stable")
        return Samples(times[order], np.array(values, np.float64)[order])

    def ticks(self) -> Times:
        """Times of the clock's topic, where the clock ticks by message."""
        column = self.topics.get(self.clock.topic or "")
        return np.sort(np.array(column.times if column else [], np.int64))

    def span(self) -> Gap:
        """First and last message of the bound topics; of all, where those have none."""
        bound = [column.times for column in self.topics.values() if column.times]
        all_ = bound or [column.logs for column in self.topics.values() if column.logs]
        return min(map(min, all_)), max(map(max, all_))

    def on_clock(self, gap: Gap) -> Gap:
        """A span of log times, on the declared clock: between the messages around it."""
        columns = [column for column in self.topics.values() if column.times]
        if self.clock.time is TimeSource.LOG_TIME or not columns:
            return gap
        logs = np.concatenate([np.array(column.logs, np.int64) for column in columns])
        times = np.concatenate([np.array(column.times, np.int64) for column in columns])
        before, after = times[logs < gap[0]], times[logs > gap[1]]
        start = int(before.max()) if len(before) else int(times.min())
        end = int(after.min()) if len(after) else int(times.max())
        return min(start, end), max(start, end)

    def findings(self) -> list[Diagnostic]:
        """What there is to say about single topics."""
        found = [wrong for signal in self.wanted if (wrong := self._wrong(signal)) is not None]
        if self.clock.topic and not self.ticks().size:
            found.append(_no_topic(self.clock.topic, self.topics, self._clock_place()))
        read = {signal.path.topic: signal for signal in self.wanted}
        for topic, signal in read.items():
            if topic in self.topics:
                found += _oddities(self.topics[topic], signal, self._shift())
        return found

    def _shift(self) -> int:
        """By how many nanoseconds header stamps are away from log times, in the middle."""
        stamped = [c for c in self.topics.values() if c.times and not c.unstamped]
        if self.clock.time is not TimeSource.HEADER_STAMP or not stamped:
            return 0
        shifts = [np.array(c.logs, np.int64) - np.array(c.times, np.int64) for c in stamped]
        return int(np.median(np.abs(np.concatenate(shifts))))

    def _wrong(self, signal: Signal) -> Diagnostic | None:
        column = self.topics.get(signal.path.topic)
        if column is None or not column.logs:
            return _no_topic(signal.path.topic, self.topics, signal.span)
        return column.wrong.get(signal.name)

    def _clock_place(self) -> Span | None:
        assert self.clock.topic is not None
        start = self._source.text.find(f'"{self.clock.topic}"')
        return self._source.span(start, start + len(self.clock.topic) + 2) if start >= 0 else None


def _decoder(channel: Channel, schema: Schema | None) -> Decode | str:
    """What turns a payload into an object with the message's fields, or why nothing does."""
    match channel.message_encoding, schema.encoding if schema else None:
        case _, None:
            return "its messages have no definition"
        case "cdr", "ros2msg":
            from mcap_ros2.decoder import DecoderFactory

            with redirect_stdout(StringIO()), redirect_stderr(StringIO()):  # its parser prints
                decode: Decode | None = DecoderFactory().decoder_for("cdr", schema)
            assert decode is not None
            return lambda payload: decode(_plain(payload))
        case "ros1", "ros1msg":
            from mcap_ros1.decoder import DecoderFactory as Ros1Factory

            assert schema is not None
            known: Decode | None = Ros1Factory().decoder_for("ros1", _fields_only(schema))
            assert known is not None
            return known
        case encoding, definition:
            return f"its messages are encoded as `{encoding}`, defined in `{definition}`"


def _fields_only(schema: Schema) -> Schema:
    """The definition of a ROS 1 message with nothing in it but types and names of fields.

    The decoder makes Python code of the definition and runs it: constants, comments and names of
    any other kind would run too.

    Raises:
        _BrokenError: something else is in it.
    """
    lines = []
    for line in schema.data.decode().splitlines():
        bare = " ".join(line.split("#")[0].split())
        if _SEPARATOR.fullmatch(bare):
            lines.append("=" * 80)
        elif _FIELD.fullmatch(bare) or _NEXT_TYPE.fullmatch(bare):
            lines.append(bare)
        elif bare and not _CONSTANT.match(bare):
            raise _BrokenError(f"`{bare}` is no field")
    if not _ROS1_TYPE.fullmatch(schema.name):
        raise _BrokenError(f"`{schema.name}` is no type")
    return Schema(schema.id, "\n".join(lines).encode(), schema.encoding, schema.name)


def _plain(payload: bytes) -> bytes:
    """The payload, if it is plain CDR: its first two bytes tell the representation."""
    if payload[:2] not in (b"\0\0", b"\0\1"):
        raise _BrokenError("not plain CDR")
    return payload


def _stamp(message: object | None) -> int | None:
    """`header.stamp` in nanoseconds; None for a message without one."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    names = fields(stamp)
    for seconds, nanoseconds in (("sec", "nanosec"), ("secs", "nsecs")):
        if seconds in names and nanoseconds in names:
            return int(getattr(stamp, seconds)) * _SECOND + int(getattr(stamp, nanoseconds))
    return None


def _short(type_: str) -> str:
    """`sensor_msgs/LaserScan` for ROS 2's `sensor_msgs/msg/LaserScan`."""
    return type_.replace("/msg/", "/")


def _health(column: _Column) -> Topic:
    times = np.array(column.times if column.bound else column.logs, np.int64)
    late = int((times < np.maximum.accumulate(times)).sum()) if len(times) else 0
    times.sort()
    steps = np.diff(times)
    return Topic(
        column.name,
        column.type,
        column.encoding,
        len(column.logs),
        int(times[0]) if len(times) else None,
        int(times[-1]) if len(times) else None,
        int(steps.max(initial=0)),
        late,
        int((steps == 0).sum()),
    )


def _recording(
    place: Span,
    digest: str,
    size: int,
    columns: _Columns,
    damages: list[tuple[_Damage, Gap | None]],
) -> Recording:
    start, end = columns.span()
    gaps = tuple(sorted({columns.on_clock(gap) for _, gap in damages if gap is not None}))
    origin = min(columns.first, *(gap[0] for _, gap in damages if gap is not None), _LATEST)
    told = [_damaged(damage, gap, origin, place) for damage, gap in damages]
    return Recording(
        place.source.name,
        digest,
        size,
        min(start, *(gap[0] for gap in gaps)) if gaps else start,
        max(end, *(gap[1] for gap in gaps)) if gaps else end,
        columns.samples(),
        columns.ticks(),
        gaps,
        {name: _health(column) for name, column in sorted(columns.topics.items())},
        columns.nearest,
        (*columns.findings(), *_few(told, place)),
        not damages,
    )


# What there is to say


def _is_a_directory(place: Span) -> Diagnostic:
    return Diagnostic(Code.IS_A_DIRECTORY, "it is a directory", place, "name the MCAP files in it")


def _empty(place: Span) -> Diagnostic:
    return Diagnostic(
        Code.EMPTY_LOG,
        "the log holds no message",
        place,
        "was the recorder stopped at once, or did it subscribe to no topic?",
    )


def _not_a_log(start: bytes, place: Span) -> Diagnostic:
    kind, mend = "it is not an MCAP file", "name a recording in the MCAP format"
    for magic, what in ((b"#ROSBAG V", "a ROS 1 bag"), (b"SQLite format 3", "an SQLite database")):
        if start.startswith(magic):
            kind = f"it is {what}, not an MCAP file"
            mend = "convert it: `mcap convert IN OUT.mcap`"
    return Diagnostic(Code.NOT_A_LOG, kind, place, mend)


def _truncated(walk: _Walk, place: Span) -> Diagnostic:
    reach = "no message in it is whole"
    if walk.first is not None and walk.latest is not None:
        reach = f"whole messages go {_seconds(walk.latest - walk.first)} far"
    return Diagnostic(
        Code.TRUNCATED_LOG,
        f"the log breaks off after byte {walk.cut}: {reach}",
        place,
        "keep what is whole with `mcap recover IN -o OUT`, and audit that",
    )


def _nothing_whole(walk: _Walk, place: Span) -> Diagnostic:
    return Diagnostic(
        Code.DAMAGED_CHUNK,
        f"no message of the log can be read: {walk.damages[0].what}",
        place,
        "copy the log again from where it was recorded",
    )


def _too_long(recording: Recording, declarations: Declarations, place: Span) -> Diagnostic | None:
    period = declarations.clock.period
    length = recording.end_ns - recording.start_ns
    if period is None or length // period < _MOST_TICKS:
        return None
    return Diagnostic(
        Code.UNREADABLE_LOG,
        f"the log lasts {_seconds(length)}, which is {length // period} ticks: a message has a "
        f"wrong time ({declarations.clock.time})",
        place,
        "use another `time` under `[clock]`, or a longer `tick`",
    )


def _damaged(damage: _Damage, gap: Gap | None, origin: int, place: Span) -> Diagnostic:
    lost = "no message is known to be lost"
    if gap is not None:
        start, end = (_seconds(time - origin) for time in gap)
        lost = f"what was recorded from {start} to {end} counts as unknown"
    return Diagnostic(
        damage.code,
        f"the log is damaged near byte {damage.at}: {damage.what}; {lost}",
        place,
        "copy the log again from where it was recorded; nothing counts as shown by a damaged log",
        Severity.WARNING,
    )


def _few(told: list[Diagnostic], place: Span) -> list[Diagnostic]:
    """Not more than a page of them."""
    if len(told) <= _MOST_TOLD:
        return told
    more = f"the log is damaged in {len(told) - _MOST_TOLD} more places"
    return [
        *told[:_MOST_TOLD],
        Diagnostic(Code.DAMAGED_CHUNK, more, place, told[0].help, Severity.WARNING),
    ]


def _no_topic(topic: str, topics: Mapping[str, _Column], span: Span | None) -> Diagnostic:
    if topic in topics:
        return Diagnostic(
            Code.NO_TOPIC,
            f"the log holds no message of `{topic}`",
            span,
            "the topic was recorded, but nothing was published on it",
        )
    near = suggestion(topic, topics)
    listed = ", ".join(sorted(topics)[:8]) + (", ..." if len(topics) > 8 else "")
    return Diagnostic(
        Code.NO_TOPIC,
        f"the topic `{topic}` is not in the log",
        span,
        f"did you mean `{near}`?" if near else f"it holds {listed}",
    )


def _no_field(signal: Signal, error: FieldError) -> Diagnostic:
    return Diagnostic(Code.NO_FIELD, f"in `{signal.path.topic}` {error}", signal.span, error.mend)


def _wrong_type(signal: Signal, found: str) -> Diagnostic:
    return Diagnostic(
        Code.WRONG_TYPE,
        f"`{signal.path.topic}` is of type `{_short(found)}` in the log, "
        f"not `{_short(signal.type or '')}`",
        signal.span,
        f'write `type = "{_short(found)}"`, and check that `path` still fits',
    )


def _unknown_encoding(signal: Signal, why: str) -> Diagnostic:
    return Diagnostic(
        Code.UNKNOWN_ENCODING,
        f"`{signal.path.topic}` cannot be read: {why}",
        signal.span,
        "fretc reads ROS 2 messages (cdr with ros2msg) and ROS 1 messages (ros1 with ros1msg)",
    )


def _oddities(column: _Column, signal: Signal, shift: int) -> list[Diagnostic]:
    """Of a topic that could be read; stamps are `shift` nanoseconds away from log times."""
    found = []
    if column.undecoded:
        found.append(
            Diagnostic(
                Code.BAD_MESSAGE,
                f"{column.undecoded} of {len(column.logs)} messages of `{column.name}` cannot be "
                "decoded: their samples are unknown",
                signal.span,
                "the recorder and the publisher may differ in the type's definition",
            )
        )
    late = _health(column).out_of_order
    if late:
        found.append(
            Diagnostic(
                Code.OUT_OF_ORDER,
                f"{late} of {len(column.logs)} messages of `{column.name}` are earlier than one "
                "before them: they are sorted by time",
                signal.span,
                "check the clocks of publisher and recorder",
                Severity.WARNING,
            )
        )
    if column.unstamped:
        found.append(_unstamped(column, signal, shift))
    return found


def _unstamped(column: _Column, signal: Signal, shift: int) -> Diagnostic:
    message = f"the messages of `{column.name}` have no header.stamp: their log_time is used"
    if shift < _SECOND:
        return Diagnostic(Code.NO_FIELD, message, signal.span, severity=Severity.NOTE)
    return Diagnostic(
        Code.NO_FIELD,
        f"{message}, and that is {_seconds(shift)} away from the stamps of the other topics",
        signal.span,
        'two clocks are mixed: use `time = "log_time"` under `[clock]`',
        Severity.WARNING,
    )


def _seconds(length: int) -> str:
    return f"{length / _SECOND:.3f} s"
