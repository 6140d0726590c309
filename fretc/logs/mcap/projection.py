"""The messages of some topics of a log, by its index: nothing else is unpacked.

Each message is compared with its entry in the index, and the records of a chunk without CRC must
follow each other as the index says. A contradiction is a `BrokenError`: then each record must be
read.

Source: MCAP specification, Message Index (op=0x07), Chunk Index (op=0x08).
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from contextlib import closing
from dataclasses import field
from io import BufferedReader

import numpy as np
from mcap.opcode import Opcode

from fretc.logs.mcap.arena import SIZE, ChunkBytes
from fretc.logs.mcap.chunks import ChunkInMemory, ChunkReader, Entries, numbers
from fretc.logs.mcap.container import ENTRY, HEAD, BrokenError, ChannelDefinition
from fretc.logs.mcap.damage import LATEST
from fretc.logs.mcap.index import Index, is_known
from fretc.logs.mcap.messages import FileTimes, Messages, Sink, record_heads
from fretc.logs.mcap.payloads import Bytes
from fretc.logs.mcap.read_ahead import in_turn
from fretc.logs.signals.integrity import Checked
from fretish.classes.frozen import dataclass
from fretish.system.resources import HAS_THREADS

_MUCH = 2 * SIZE
"""Unpacked bytes of a log from which on a second thread is worth its start."""


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
        chunks = ChunkReader(self._stream, self._index.chunks, self._wanted)
        with closing(in_turn(chunks.fill, self._arenas())) as filled:
            for arena, some in filled:
                for chunk in some:
                    self._check(chunk, arena.data)
                self._hand_on(some, arena.data)
        counts = self._index.statistics.channel_message_counts
        for id, stream in self._index.streams.items():
            if id not in self._wanted:
                self._sink.count(stream, counts.get(id, 0))
            elif self._counts[id] != counts.get(id, 0):
                raise BrokenError(
                    "the number of messages of a topic differs from the stated number"
                )

    def _arenas(self) -> list[ChunkBytes]:
        """Two arenas to fill in turn; one for a small log, or where two could get large."""
        sizes = [chunk.uncompressed_size for chunk in self._index.chunks]
        two = HAS_THREADS and sum(sizes) >= _MUCH and max(sizes) <= SIZE
        return [ChunkBytes(sum(sizes)) for _ in range(1 + two)]

    # One chunk

    def _check(self, chunk: ChunkInMemory, data: Bytes) -> None:
        """Compare the records of a chunk with the index, as far as no CRC covers them."""
        self.crcs[chunk.index.chunk_start_offset] = chunk.crc
        self._crc_checked += chunk.crc_checked
        self._without_crc += not chunk.crc
        if chunk.crc:
            new = {id: some for id, some, _ in chunk.entries if id not in self._met}
            self._met.update(new)
            firsts = (int(numbers(some)[1::2].min()) for some in new.values())
            self._declared(data.data, chunk.base, chunk.size, max(firsts, default=0))
        else:
            self._tiled(chunk, data)

    def _declared(self, data: memoryview, base: int, size: int, until: int) -> None:
        """Compare declarations of a chunk with the summary: at its beginning, and up to `until`.

        A log that was merged from others may give two topics the same number.
        """
        at, end = base, base + size
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

    def _tiled(self, chunk: ChunkInMemory, data: Bytes) -> None:
        """Compare the unpacked records of a chunk without a CRC with its index.

        Each message begins at the end of the one before, except for definitions between them.
        """
        base, needed, places = chunk.base, chunk.size, chunk.places
        size = chunk.index.uncompressed_size
        there = places[places + HEAD.size <= needed]
        lengths = np.ndarray((len(data) - 8,), "<u8", data.data, 1, (1,))[there + base]
        if (data[there + base] != Opcode.MESSAGE).any() or (lengths > size).any():
            raise BrokenError("the index of a chunk points to a record that is not a message")
        ends = np.append(0, there + HEAD.size + lengths.astype(np.int64))
        walls = np.append(places, size)[: len(ends)]
        for row in np.flatnonzero((ends != walls) & (walls <= needed)).tolist():
            self._between(data.data, base + int(ends[row]), base + int(walls[row]))

    def _between(self, data: memoryview, at: int, wall: int) -> None:
        """Check that only definitions are between two messages in the arena."""
        while at != wall:
            opcode, length = HEAD.unpack_from(data, at) if at + HEAD.size <= wall else (0, 0)
            start, at = at + HEAD.size, at + HEAD.size + length
            if at > wall:
                raise BrokenError("the records of a chunk are not where its index points")
            self._as_declared(opcode, bytes(data[start:at]))

    # Many chunks

    def _hand_on(self, chunks: Sequence[ChunkInMemory], data: Bytes) -> None:
        """Pass the messages in an arena to the sink, topic by topic."""
        batches = _batches(chunks)
        topics: defaultdict[str, list[int]] = defaultdict(list)
        for id in batches:
            topics[self._index.streams[id].channel.topic].append(id)
        for ids in topics.values():
            parts = [(self._index.streams[id], self._messages(id, batches[id], data)) for id in ids]
            for stream, messages in parts if len(parts) == 1 else _by_turns(parts):
                self._sink.add_all(stream, messages)

    def _messages(self, id: int, batch: _Batch, data: Bytes) -> Messages:
        """The messages of one channel, in the order of the file."""
        entries = numbers(b"".join(batch.entries))
        counts, *of_chunks = np.array(batch.limits, np.uint64).T
        bases, limits = (np.repeat(of_chunk, counts.astype(np.int64)) for of_chunk in of_chunks[:2])
        times, places = entries[::2], (entries[1::2] + bases).astype(np.int64)
        if not _in_time(times, counts, *of_chunks[2:]):
            raise BrokenError("the index of a chunk does not match its messages")
        if (places[1:] < places[:-1]).any():  # some writers sort the index by time
            order = np.argsort(places)
            places, times, limits = places[order], times[order], limits[order]
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


def _batches(chunks: Sequence[ChunkInMemory]) -> dict[int, _Batch]:
    """The messages of each channel."""
    batches: defaultdict[int, _Batch] = defaultdict(_Batch)
    for chunk in chunks:
        span = chunk.index.message_start_time, chunk.index.message_end_time
        for id, entries, _ in chunk.entries:
            count = len(entries) // ENTRY.itemsize
            batches[id].entries.append(entries)
            batches[id].limits.append((count, chunk.base, chunk.base + chunk.size, *span))
    return batches


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
