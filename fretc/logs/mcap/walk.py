"""A pass through an MCAP file, record by record: messages go to a sink, damages are collected.

The positions of chunks in the summary are used to continue after a damaged part. Times are
nanoseconds, log times.
"""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Collection
from io import BufferedReader

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Header, Metadata, Schema
from numpy.typing import NDArray

from fretc.logs.mcap.container import (
    BLOCK,
    ENTRY,
    HEAD,
    INDEX,
    LARGEST,
    MAGIC,
    PADDING,
    BrokenError,
    ChannelDefinition,
    crc32,
    frames,
    no_summary,
    parse,
    summary,
    unpacked,
)
from fretc.logs.mcap.damage import LATEST, Damage, Damages
from fretc.logs.mcap.messages import Messages, Sink
from fretc.logs.mcap.metadata import Described, described, together
from fretc.logs.signals.integrity import Checked
from fretc.logs.signals.samples import Gap, distinct
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code

_MESSAGE = struct.Struct("<HIQQ")
"""The fields with which each message begins: channel, sequence, log time, publish time."""
_OPCODES = frozenset(Opcode)
_PASSED_BY: dict[int, Callable[[ReadDataStream], object]] = {
    Opcode.HEADER: Header.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.METADATA: Metadata.read,
}
"""Kinds of records that may be among the data and are irrelevant for messages."""


@dataclass(frozen=True, slots=True)
class _Chunk:
    """A chunk whose messages were passed on, and whose index may follow."""

    at: int
    span: Gap
    messages: Messages
    has_crc: bool

    def entries(self, channel: int) -> NDArray[np.void]:
        """Time and offset of each message of a channel."""
        some = self.messages.of_channel(channel)
        entries = np.empty(len(some.starts), ENTRY)
        entries["time"], entries["place"] = some.logs, some.starts - HEAD.size
        return entries


class Walk:
    """One pass through the data section; messages go to the sink, damages are kept here."""

    def __init__(
        self, stream: BufferedReader, size: int, sink: Sink, wanted: Collection[str] = ()
    ) -> None:
        self.damages = Damages()
        self.cut: int | None = None
        """The offset up to which there are whole records, in a file without an end."""
        self._stream, self._size, self._sink = stream, size, sink
        self._wanted = wanted
        self._found: list[Described] = []
        self._summary = no_summary(size)
        self._schemas: dict[int, Schema] = {}
        self._streams: dict[int, ChannelDefinition] = {}
        self._counts: Counter[int] = Counter()
        self._whole: set[int] = set()
        self._with_crc = 0
        self._broken: set[int] = set()
        """Chunks whose messages were read up to a broken record."""
        self._before: _Chunk | None = None
        self._unprotected = False
        """Whether messages were read that only the CRC of the whole data section covers."""
        self._all_covered = False
        """Whether the CRC of the whole data section is correct."""
        self._crc: int | None = 0
        """The CRC of the data up to here; None after a part was skipped."""

    def run(self) -> None:
        """Read the whole file."""
        tail = summary(self._stream, self._size)
        if tail is None:
            self.cut = self._data(truncated=True)
            if self.damages.span is not None:
                self.damages.add(self.cut, "it breaks off", code=Code.TRUNCATED_LOG)
            return
        self._summary = tail
        self._schemas.update(tail.schemas)
        for channel in tail.channels.values():
            self._declare(channel, self._size)
        self._data(truncated=False)
        if not tail.sound:
            self.damages.add(tail.footer, "its summary is damaged", lossless=True)
        if tail.after != self._size:
            self.damages.add(tail.after, "it contains data after its end", lossless=True)

    def settled(self) -> list[tuple[Damage, Gap | None]]:
        """All damages, each with the time of its lost messages; None: none are lost."""
        read = self._whole | self._broken
        return self.damages.settled(self._summary, read, self._counts, self._size)

    @property
    def described(self) -> Described:
        """The wanted values of its metadata records."""
        return together(self._found)

    @property
    def unprotected(self) -> bool:
        """Whether some messages have no CRC: a changed byte in them is not detected."""
        return self._unprotected and not self._all_covered

    @property
    def checked(self) -> Checked:
        """The checks: every record was read, and the number of intact chunks."""
        chunks = len(self._whole)
        return Checked(
            by_index=False,
            chunks=chunks,
            crc_checked=self._with_crc,
            without_crc=chunks - self._with_crc,
        )

    # Records

    def _data(self, truncated: bool) -> int:
        """Read the data section; return its end."""
        at, end = len(MAGIC), self._summary.end
        walls = self._walls()
        self._stream.seek(0)
        self._take(at)
        while at < end:
            wall = walls[bisect_right(walls, at)]
            crc, head = self._crc, self._take(HEAD.size)
            opcode, length = HEAD.unpack(head) if len(head) == HEAD.size else (0, self._size)
            stop: int = at + HEAD.size + length
            if stop > wall:
                if truncated:
                    return at
                self.damages.add(at, "the length of a record is damaged")
                at = self._jump(wall)
                continue
            try:
                if opcode == Opcode.DATA_END:
                    self._data_end(length, stop, crc)
                    return stop
                self._record(opcode, at, length)
                at = stop
            except BrokenError as error:
                self.damages.add(at, str(error))
                at = self._jump(stop if self._fits(stop, wall) else wall)
        if not truncated and self._crc is not None:
            description = "the end of its data is damaged"
            self.damages.add(at, description, lossless=not self._unprotected)
        return at

    def _walls(self) -> list[int]:
        """The offsets at which a record must end: starts of indexed chunks, and the end of data.

        An index entry that points into another chunk does not count.
        """
        walls, reach = [], 0
        for at in sorted(at for at in self._summary.chunks if at < self._summary.end):
            if at >= reach:
                walls.append(at)
            length = self._summary.chunks[at].chunk_length
            self._stream.seek(at)
            head = self._stream.read(HEAD.size)
            if head == HEAD.pack(Opcode.CHUNK, max(0, length - HEAD.size)):
                reach = max(reach, at + length)
        return [*walls, self._summary.end]

    def _take(self, length: int) -> bytes:
        data = self._stream.read(length)
        if self._crc is not None:
            self._crc = crc32(data, self._crc)
        return data

    def _skip(self, length: int) -> None:
        while length > 0:
            size = len(self._take(min(length, BLOCK)))
            length -= size or length

    def _jump(self, to: int) -> int:
        self._stream.seek(to)
        self._crc = None
        return to

    def _fits(self, at: int, wall: int) -> bool:
        """Whether a plausible record begins at that byte."""
        if at == wall:
            return True
        self._stream.seek(at)
        head = self._stream.read(HEAD.size)
        if len(head) < HEAD.size:
            return False
        opcode, length = HEAD.unpack(head)
        return opcode in _OPCODES and at + HEAD.size + length <= wall

    def _record(self, opcode: int, at: int, length: int) -> None:
        if opcode == 0:
            raise BrokenError("a record has the opcode 0")
        if opcode not in _OPCODES:
            self._skip(length)
            self.damages.add_possible(at, f"a record has the unknown opcode {opcode}")
            return
        if length > LARGEST:
            self._skip(length)
            raise BrokenError(f"a record of {length} bytes is too large to be read")
        content = self._take(length)
        match opcode:
            case Opcode.MESSAGE:
                self._unprotected = True
                self._message(at, content, 0, length)
            case Opcode.CHUNK:
                self._chunk(at, parse(Chunk.read, content))
            case Opcode.MESSAGE_INDEX:
                self._index(content)
            case Opcode.SCHEMA:
                self._define(parse(Schema.read, content), at)
            case Opcode.CHANNEL:
                self._declare(parse(Channel.read, content), at)
            case _ if opcode in _PASSED_BY:
                parse(_PASSED_BY[opcode], content)
                if opcode == Opcode.METADATA and (metadata := described(content, self._wanted)):
                    self._found = [together([*self._found, metadata])]
            case _:
                raise BrokenError("the data section contains a record of the summary")

    def _data_end(self, length: int, stop: int, crc: int | None) -> None:
        if self._summary.sound and stop != self._summary.end:
            raise BrokenError("the end of the data stands among the data")
        expected = parse(DataEnd.read, self._take(length)).data_section_crc
        self._all_covered = bool(expected) and crc == expected
        if expected and crc is not None and crc != expected and not self.damages.certain:
            description = "the CRC of its data section does not match the data"
            self.damages.add(stop, description, lossless=not self._unprotected, anywhere=True)

    def _define(self, schema: Schema, at: int) -> None:
        first = self._schemas.setdefault(schema.id, schema)
        if first != schema:
            self.damages.add(at, f"it defines `{schema.name}` twice, differently", anywhere=True)

    def _declare(self, channel: Channel, at: int) -> None:
        first = self._streams.get(channel.id)
        if first is not None and first.channel != channel:
            description = f"it declares the topic `{channel.topic}` twice, differently"
            self.damages.add(at, description, anywhere=True)
            channel = first.channel
        stream = ChannelDefinition(channel, self._schemas.get(channel.schema_id))
        self._streams[channel.id] = stream
        self._sink.declare(stream)

    # Messages

    def _chunk(self, at: int, chunk: Chunk) -> None:
        self._before = None
        span, has_crc = (
            (chunk.message_start_time, chunk.message_end_time),
            bool(chunk.uncompressed_crc),
        )
        try:
            data = unpacked(chunk)
            messages, fault = self._inside(at, data, has_crc=has_crc)
            if not has_crc:
                self._check(messages, span)
        except BrokenError as error:
            self.damages.add(at, str(error), span)
            return
        self._unprotected |= not has_crc
        if fault:
            messages = messages.chosen(np.arange(len(messages) - 1))
        if not self._at_once(messages):
            for start, end in zip(messages.starts.tolist(), messages.ends.tolist(), strict=True):
                self._message(at, data, start, end)
        if fault:
            self._broken.add(at)
            self.damages.add(at, fault, self._rest(at, messages, span))
            return
        self._whole.add(at)
        self._with_crc += has_crc
        self._before = _Chunk(at, span, messages, has_crc)

    def _rest(self, at: int, messages: Messages, span: Gap) -> Gap:
        """The time of the unread messages of a broken chunk: from its last read message on.

        It is the whole time of the chunk if its messages are not in order of time.
        """
        start, end = span
        index = self._summary.chunks.get(at)
        if index is not None:
            start = min(start, index.message_start_time)
            end = max(end, index.message_end_time)
        times = messages.logs
        if len(times) and (times[1:] >= times[:-1]).all():
            start = int(times[-1])
        return min(start, end), end

    def _inside(self, at: int, data: bytes, *, has_crc: bool) -> tuple[Messages, str]:
        """The messages of a chunk, and the fault of the record after the last of them.

        The fault may be the length of the last message, which is then incomplete. The chunk's
        definitions are recorded.
        """
        starts: list[int] = []
        ends: list[int] = []
        message = Opcode.MESSAGE.value
        fault = ""
        try:
            for opcode, start, end in frames(data):
                if opcode == message:
                    if end - start < _MESSAGE.size:
                        raise BrokenError("a message is cut off")
                    starts.append(start)
                    ends.append(end)
                elif opcode == Opcode.SCHEMA:
                    self._define(parse(Schema.read, data[start:end]), at)
                elif opcode == Opcode.CHANNEL:
                    self._declare(parse(Channel.read, data[start:end]), at)
                elif opcode == 0:
                    raise BrokenError("a record has the opcode 0")
                elif not has_crc:
                    raise BrokenError("a chunk contains a record that is not allowed in chunks")
        except BrokenError as error:
            fault = str(error)
        return Messages.of(data, starts, ends), fault

    def _check(self, messages: Messages, span: Gap) -> None:
        """Check messages without a CRC against the `span` that the chunk states."""
        times = messages.logs
        if ((times < span[0]) | (times > span[1])).any():
            raise BrokenError("the time of a message is outside the range that its chunk states")
        if any(id not in self._streams for id in distinct(messages.channels).tolist()):
            raise BrokenError("a message belongs to an undeclared topic")

    def _at_once(self, messages: Messages) -> bool:
        """Pass on all messages of a chunk, topic by topic, unless one of them is unusual."""
        ids = distinct(messages.channels).tolist()
        streams = [self._streams[id] for id in ids if id in self._streams]
        topics = {stream.channel.topic for stream in streams}
        if len(topics) < len(ids) or (messages.logs >= LATEST).any():
            return False
        for id, stream in zip(ids, streams, strict=True):
            some = messages.of_channel(id)
            self._counts[id] += len(some.starts)
            self._sink.add_all(stream, some)
        if ids:
            times = messages.logs.astype(np.int64)
            self.damages.passed(int(times[0]))
            self.damages.passed_all(int(times.min()), int(times.max()), int(times[-1]))
        return True

    def _index(self, content: bytes) -> None:
        """Compare the index of a chunk with its messages; the chunk's CRC decides."""
        if len(content) < INDEX.size:
            raise BrokenError("a record cannot be read")
        channel, length = INDEX.unpack_from(content)
        padding = len(content) - INDEX.size - length
        if length % ENTRY.itemsize or not 0 <= padding < PADDING:
            raise BrokenError("a record cannot be read")
        chunk = self._before
        if chunk is None or not length:
            return
        listed = np.frombuffer(content, ENTRY, length // ENTRY.itemsize, INDEX.size)
        if not np.array_equal(np.sort(listed), np.sort(chunk.entries(channel))):
            description = "the index of a chunk does not match its messages"
            if chunk.has_crc:
                self.damages.add(chunk.at, description, lossless=True)
            else:
                self.damages.add(chunk.at, description, chunk.span)

    def _message(self, at: int, data: bytes, start: int, end: int) -> None:
        if end - start < _MESSAGE.size:
            raise BrokenError("a message is cut off")
        channel, _, log_time, publish_time = _MESSAGE.unpack_from(data, start)
        self._counts[channel] += 1
        stream = self._streams.get(channel)
        if stream is None:
            self.damages.add(at, "a message belongs to an undeclared topic")
        elif log_time >= LATEST:
            self.damages.add(at, "a message has an impossible time")
        else:
            self.damages.passed(log_time)
            payload = memoryview(data)[start + _MESSAGE.size : end]
            self._sink.add(stream, log_time, publish_time, payload)
