"""The messages of some topics of a log, by its index: nothing else is unpacked.

A chunk is unpacked up to its last wanted message, where that saves much; otherwise it is unpacked
whole, and its CRC is checked. Each message is compared with its entry in the index, and the records
of a chunk without CRC must follow each other as the index says. A contradiction is a `BrokenError`:
then each record must be read.

Source: MCAP specification, Message Index (op=0x07), Chunk Index (op=0x08).
"""

from __future__ import annotations

import struct
from collections import Counter, defaultdict
from collections.abc import Container
from dataclasses import field
from io import BufferedReader

import numpy as np
from mcap.opcode import Opcode
from mcap.records import ChunkIndex
from numpy.typing import NDArray

from fretc.logs.mcap.arena import SIZE, ChunkBytes
from fretc.logs.mcap.container import (
    ENTRY,
    HEAD,
    INDEX,
    BrokenError,
    ChannelDefinition,
    crc32,
    is_absurd,
)
from fretc.logs.mcap.damage import LATEST
from fretc.logs.mcap.index import Index, is_known
from fretc.logs.mcap.messages import FileTimes, Messages, Sink, record_heads
from fretc.logs.mcap.payloads import Places
from fretc.logs.signals.integrity import Checked
from fretish.classes.frozen import dataclass

_SLACK = 4096
"""The expected bytes of the last message of a chunk, until a longer message comes."""
_FEW = 32
"""The number of comparisons up to which Python is faster than NumPy."""
_BLOCK = 2**17
"""Bytes that a codec unpacks at once."""


_HEAD = struct.Struct("<BQQQQII")
"""The record of a chunk up to the name of its compression: `HEAD` and `CHUNK`."""
_PLACE = struct.Struct("<8xQ")
"""The format of the position in an entry of a message index, after its time."""
_INDEX_RECORD = struct.Struct("<BQHI")
"""The record of a message index up to its entries: `HEAD` and `INDEX`."""

_NOWHERE: Places = np.zeros(0, np.int64)
Entries = NDArray[np.uint64]
"""The entries of a message index: time, position, time, position, ..."""


def _numbers(entries: bytes) -> Entries:
    return np.frombuffer(entries, "<u8")


@dataclass(slots=True)
class _Batch:
    """Messages of one channel in the arena."""

    entries: list[bytes] = field(default_factory=list)
    """The entries of each chunk, as in its message index."""
    limits: list[tuple[int, int, int, int, int]] = field(default_factory=list)
    """For each chunk: the number of messages, its begin and end, and its first and last time."""


class Projection:
    """One pass through a log; the messages of the wanted topics go to the sink."""

    def __init__(self, stream: BufferedReader, index: Index, sink: Sink) -> None:
        self._stream, self._index, self._sink = stream, index, sink
        streams = index.streams
        self._wanted = {id for id, each in streams.items() if sink.wants(each.channel.topic)}
        self._arena = ChunkBytes(sum(chunk.uncompressed_size for chunk in index.chunks))
        self._packed = bytearray()
        self._longest: Counter[int] = Counter(dict.fromkeys(self._wanted, _SLACK))
        self._batches: defaultdict[int, _Batch] = defaultdict(_Batch)
        self._counts: Counter[int] = Counter()
        self._crc_checked = self._without_crc = 0
        self.crcs: dict[int, int] = {}
        """The CRC that each unpacked chunk states, by the offset of the chunk; 0: none."""
        some = [each.schema for each in streams.values() if each.schema is not None]
        self._schemas = {schema.id: schema for schema in some}
        self._channels = {id: each.channel for id, each in streams.items()}
        self._verified: set[tuple[int, bytes]] = set()
        """Records in chunks that agree with the summary."""
        self._met: set[int] = set()
        """Channels with a message so far."""

    @property
    def checked(self) -> Checked:
        """The checks so far."""
        chunks = len(self._index.chunks)
        return Checked(
            by_index=True,
            chunks=chunks,
            crc_checked=self._crc_checked,
            without_crc=self._without_crc,
            skipped=chunks - len(self.crcs),
        )

    def run(self) -> None:
        """Read all messages.

        Raises:
            BrokenError: the file does not match its index.
        """
        for stream in self._index.streams.values():
            self._sink.declare(stream)
        for chunk in self._index.chunks:
            if not self._wanted.isdisjoint(chunk.message_index_offsets):
                self._chunk(chunk)
                if self._arena.used >= SIZE:
                    self._hand_on()
        self._hand_on()
        counts = self._index.statistics.channel_message_counts
        for id, stream in self._index.streams.items():
            if id not in self._wanted:
                self._sink.count(stream, counts.get(id, 0))
            elif self._counts[id] != counts.get(id, 0):
                raise BrokenError(
                    "the number of messages of a topic differs from the stated number"
                )

    # One chunk

    def _chunk(self, chunk: ChunkIndex) -> None:
        entries = self._entries(chunk, self._wanted)
        if not entries:
            return
        size = chunk.uncompressed_size
        last, final = max((last, id) for id, _, last in entries)
        needed, places = last + HEAD.size + self._longest[final], None
        while True:
            whole = needed > size // 2
            needed = size if whole else needed
            base, crc = self._unpack(chunk, needed, whole=whole)
            if places is None:
                places = _NOWHERE if crc else self._places(chunk)
            end = self._end(final, base, last, needed)
            if end <= needed and not crc:
                wall = int(min(places[places > last], default=size))
                end = end if end == wall else max(end, wall)
            if end <= needed:
                break
            if end > size:
                raise BrokenError("a message is cut off")
            needed = end
        if whole and crc:
            if crc32(self._arena.data.data[base : base + needed]) != crc:
                raise BrokenError("the CRC of a chunk does not match its data")
            self._crc_checked += 1
        self._without_crc += not crc
        self.crcs[chunk.chunk_start_offset] = crc
        if crc:
            new = {id: some for id, some, _ in entries if id not in self._met}
            self._met.update(new)
            firsts = (int(_numbers(some)[1::2].min()) for some in new.values())
            self._declared(base, needed, max(firsts, default=0))
        else:
            self._tiled(base, needed, size, places)
        span = chunk.message_start_time, chunk.message_end_time
        for id, some, _ in entries:
            batch = self._batches[id]
            batch.entries.append(some)
            batch.limits.append((len(some) // ENTRY.itemsize, base, base + needed, *span))
        self._arena.used = base + needed

    def _declared(self, base: int, needed: int, until: int) -> None:
        """Compare declarations of a chunk with the summary: at its beginning, and up to `until`.

        A log that was merged from others may give two topics the same number.
        """
        data, at, end = self._arena.data.data, base, base + needed
        while at + HEAD.size <= end:
            opcode, length = HEAD.unpack_from(data, at)
            start, at = at + HEAD.size, at + HEAD.size + length
            if opcode == Opcode.MESSAGE:
                if at > base + until:
                    return
            elif at > end:
                return
            else:
                self._as_declared(opcode, bytes(data[start:at]))

    def _as_declared(self, opcode: int, content: bytes) -> None:
        """Compare a declaration with the summary."""
        if (opcode, content) not in self._verified:
            if not is_known(opcode, content, self._schemas, self._channels):
                raise BrokenError("a chunk declares a topic or type that is not in the summary")
            self._verified.add((opcode, content))

    def _places(self, chunk: ChunkIndex) -> Places:
        """The offsets of the messages of a chunk by its index, in the order of the file."""
        entries = self._entries(chunk, chunk.message_index_offsets.keys())
        return np.sort(_numbers(b"".join([some for _, some, _ in entries]))[1::2].astype(np.int64))

    def _tiled(self, base: int, needed: int, size: int, places: Places) -> None:
        """Compare the unpacked records of a chunk without a CRC with its index.

        Each message begins at the end of the one before, except for definitions between them.

        Args:
            base: the offset of the chunk in the arena.
            needed: the number of its bytes in the arena.
            size: the size of the chunk.
            places: the offsets of its messages.
        """
        there = places[places + HEAD.size <= needed]
        data = self._arena.data
        lengths = np.ndarray((len(data) - 8,), "<u8", data.data, 1, (1,))[there + base]
        if (data[there + base] != Opcode.MESSAGE).any() or (lengths > size).any():
            raise BrokenError("the index of a chunk points to a record that is not a message")
        ends = np.append(0, there + HEAD.size + lengths.astype(np.int64))
        walls = np.append(places, size)[: len(ends)]
        for row in np.flatnonzero((ends != walls) & (walls <= needed)).tolist():
            self._between(base + int(ends[row]), base + int(walls[row]))

    def _between(self, at: int, wall: int) -> None:
        """Check that only definitions are between two messages in the arena."""
        data = self._arena.data.data
        while at != wall:
            opcode, length = HEAD.unpack_from(data, at) if at + HEAD.size <= wall else (0, 0)
            start, at = at + HEAD.size, at + HEAD.size + length
            if at > wall:
                raise BrokenError("the records of a chunk are not where its index points")
            self._as_declared(opcode, bytes(data[start:at]))

    def _entries(self, chunk: ChunkIndex, ids: Container[int]) -> list[tuple[int, bytes, int]]:
        """For each channel in the chunk: its number, its entries, and its last offset."""
        begin = chunk.chunk_start_offset + chunk.chunk_length
        self._stream.seek(begin)
        data = self._stream.read(chunk.message_index_length)
        entries = []
        for id, offset in chunk.message_index_offsets.items():
            if id not in ids:
                continue
            at = offset - begin
            start = at + _INDEX_RECORD.size
            if start > len(data):
                raise BrokenError("a record is cut off")
            opcode, length, channel, size = _INDEX_RECORD.unpack_from(data, at)
            if (opcode, channel, size % ENTRY.itemsize) != (Opcode.MESSAGE_INDEX, id, 0):
                raise BrokenError("the index of a chunk is missing")
            if INDEX.size + size > length or start + size > len(data):
                raise BrokenError("a record is cut off")
            if size:
                some = data[start : start + size]
                few = size < _FEW * ENTRY.itemsize
                last = max(_PLACE.iter_unpack(some))[0] if few else int(_numbers(some)[1::2].max())
                if last >= chunk.uncompressed_size:
                    raise BrokenError("the index of a chunk points outside the chunk")
                entries.append((id, some, last))
        return entries

    def _unpack(self, chunk: ChunkIndex, size: int, *, whole: bool) -> tuple[int, int]:
        """Unpack the first `size` bytes of a chunk after those in use.

        Returns:
            Where in the arena they begin, and the CRC that the chunk states.
        """
        packed, used = chunk.compressed_size, self._arena.used
        before = _HEAD.size + len(chunk.compression) + 8
        if not chunk.compression:
            if packed != chunk.uncompressed_size:
                raise BrokenError("the size of a chunk differs from the size that it states")
            return used + before, self._fill(chunk, self._arena.target(before + size))
        if is_absurd(chunk.uncompressed_size, packed):
            raise BrokenError("a chunk states an impossible size")
        for length in (packed,) if whole else (_share(chunk, size), packed):
            if before + length > len(self._packed):
                self._packed = bytearray(before + length)
            some = memoryview(self._packed)[: before + length]
            crc = self._fill(chunk, some)
            if self._arena.unpack(chunk.compression, some[before:], size, whole=whole):
                return used, crc
        raise BrokenError("the size of a chunk differs from the size that it states")

    def _fill(self, chunk: ChunkIndex, target: memoryview) -> int:
        """Read the beginning of a chunk, with its head, in one step; return the CRC that it states.

        The other fields of its head must match its index.
        """
        self._stream.seek(chunk.chunk_start_offset)
        if self._stream.readinto(target) != len(target):
            raise BrokenError("a chunk is cut off")
        *stated, crc, name = _HEAD.unpack_from(target)
        compression = chunk.compression.encode()
        tail = compression + chunk.compressed_size.to_bytes(8, "little")
        before = _HEAD.size + len(tail)
        if (
            (*stated, name)
            != (
                Opcode.CHUNK,
                chunk.chunk_length - HEAD.size,
                chunk.message_start_time,
                chunk.message_end_time,
                chunk.uncompressed_size,
                len(compression),
            )
            or target[_HEAD.size : before] != tail
            or chunk.chunk_length < before + chunk.compressed_size
        ):
            raise BrokenError("a chunk does not match its index")
        return int(crc)

    def _end(self, id: int, base: int, last: int, needed: int) -> int:
        """The end of the last message of a channel in its chunk, as far as it is unpacked."""
        content = last + HEAD.size
        if content > needed:
            return content
        _, length = HEAD.unpack_from(self._arena.data.data, base + last)
        self._longest[id] = max(self._longest[id], min(length, SIZE))
        return content + int(length)

    # Many chunks

    def _hand_on(self) -> None:
        """Pass the messages in the arena to the sink, topic by topic."""
        topics: defaultdict[str, list[int]] = defaultdict(list)
        for id in self._batches:
            topics[self._index.streams[id].channel.topic].append(id)
        for ids in topics.values():
            parts = [(self._index.streams[id], self._messages(id)) for id in ids]
            for stream, messages in parts if len(parts) == 1 else _by_turns(parts):
                self._sink.add_all(stream, messages)
        self._batches.clear()
        self._arena.clear()

    def _messages(self, id: int) -> Messages:
        """The messages of one channel, in the order of the file."""
        batch = self._batches[id]
        entries = _numbers(b"".join(batch.entries))
        counts, *of_chunks = np.array(batch.limits, np.uint64).T
        bases, limits = (np.repeat(of_chunk, counts.astype(np.int64)) for of_chunk in of_chunks[:2])
        times, places = entries[::2], (entries[1::2] + bases).astype(np.int64)
        if not _in_time(times, counts, *of_chunks[2:]):
            raise BrokenError("the index of a chunk does not match its messages")
        if (places[1:] < places[:-1]).any():  # some writers sort the index by time
            order = np.argsort(places)
            places, times, limits = places[order], times[order], limits[order]
        data = self._arena.data
        heads = record_heads(data, places)
        lengths, contents = heads["length"].astype(np.uint64), places + HEAD.size
        if (
            (heads["opcode"] != Opcode.MESSAGE).any()
            or (places[1:] == places[:-1]).any()
            or lengths.max() > len(data)
            or (contents.astype(np.uint64) + lengths > limits).any()
            or lengths.min() < Messages.HEAD
        ):
            raise BrokenError("the index of a chunk points to a record that is not a message")
        messages = Messages.behind(heads, data, contents, contents + lengths.astype(np.int64))
        if (messages.channels != id).any() or (messages.logs != times).any():
            raise BrokenError("the index of a chunk does not match its messages")
        self._counts[id] += len(messages)
        return messages


def _in_time(times: FileTimes, counts: Entries, first: Entries, last: Entries) -> bool:
    """Whether the messages of each chunk are within the times that it states, and before `LATEST`.

    Args:
        times: the times of all messages, chunk by chunk.
        counts: the number of messages of each chunk, at least 1.
        first: the first time that each chunk states.
        last: the last time that each chunk states.
    """
    begins = (np.cumsum(counts) - counts).astype(np.intp)
    latest = np.maximum.reduceat(times, begins)
    return bool(
        (np.minimum.reduceat(times, begins) >= first).all()
        and (latest <= last).all()
        and (latest < LATEST).all()
    )


def _share(chunk: ChunkIndex, size: int) -> int:
    """An estimate of the packed bytes of a chunk that its first `size` bytes need at most."""
    blocks = -(-size // _BLOCK) * _BLOCK
    likely = int(blocks * chunk.compressed_size / chunk.uncompressed_size * 1.3) + 2**14
    return min(likely, chunk.compressed_size)


def _by_turns(
    parts: list[tuple[ChannelDefinition, Messages]],
) -> list[tuple[ChannelDefinition, Messages]]:
    """Messages of several channels of one topic: consecutive ones together, in the file's order."""
    owners = np.concatenate([np.full(len(some), i) for i, (_, some) in enumerate(parts)])
    inner = np.concatenate([np.arange(len(some)) for _, some in parts])
    order = np.argsort(np.concatenate([some.starts for _, some in parts]))
    owners, inner = owners[order], inner[order]
    cuts = np.flatnonzero(np.diff(owners)) + 1
    return [
        (parts[int(owner[0])][0], parts[int(owner[0])][1].chosen(rows))
        for owner, rows in zip(np.split(owners, cuts), np.split(inner, cuts), strict=True)
    ]
