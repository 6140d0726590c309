"""The chunks of a log in memory, as far as their wanted messages go.

A chunk is unpacked up to its last wanted message, where that saves much; otherwise it is unpacked
whole, and its CRC is checked. Its head must match its index.

Source: MCAP specification, Message Index (op=0x07), Chunk Index (op=0x08).
"""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Collection, Container, Sequence
from io import BufferedReader

import numpy as np
from mcap.opcode import Opcode
from mcap.records import ChunkIndex
from numpy.typing import NDArray

from fretc.logs.mcap.arena import SIZE, ChunkBytes
from fretc.logs.mcap.container import ENTRY, HEAD, INDEX, BrokenError, crc32, is_absurd
from fretc.logs.mcap.payloads import Places
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


def numbers(entries: bytes) -> Entries:
    """The entries of a message index, of shape (2 * messages,)."""
    return np.frombuffer(entries, "<u8")


@dataclass(frozen=True, slots=True)
class ChunkInMemory:
    """The beginning of a chunk in an arena, up to its last wanted message."""

    index: ChunkIndex
    entries: Sequence[tuple[int, bytes, int]]
    """For each wanted channel: its number, its entries, and its last offset."""
    base: int
    """The offset of the chunk in the arena."""
    size: int
    """The number of its bytes in the arena."""
    crc: int
    """The CRC that it states; 0: none."""
    crc_checked: bool
    """Whether it is whole, and its CRC is correct."""
    places: Places
    """The offsets of all its messages, if it has no CRC; shape (messages,)."""


class ChunkReader:
    """One pass through the chunks with messages of some channels."""

    def __init__(
        self, stream: BufferedReader, chunks: Sequence[ChunkIndex], wanted: Collection[int]
    ) -> None:
        """A reader at the first chunk.

        Args:
            stream: the file; nobody else may use it during `fill`.
            chunks: the index, in the order of the file.
            wanted: the numbers of the channels.
        """
        self._stream, self._wanted = stream, wanted
        self._left = iter([c for c in chunks if c.message_index_offsets.keys() & wanted])
        self._packed = bytearray()
        self._longest: Counter[int] = Counter(dict.fromkeys(wanted, _SLACK))

    def fill(self, arena: ChunkBytes) -> list[ChunkInMemory]:
        """The next chunks, one after the other in an empty arena; none are left: an empty list.

        Raises:
            BrokenError: a chunk does not match its index, or its CRC.
            OSError: the file cannot be read.
        """
        filled = []
        for index in self._left:
            chunk = self._chunk(index, arena)
            if chunk is not None:
                filled.append(chunk)
                arena.used = chunk.base + chunk.size
                if arena.used >= SIZE:
                    break
        return filled

    def _chunk(self, index: ChunkIndex, arena: ChunkBytes) -> ChunkInMemory | None:
        entries = self._entries(index, self._wanted)
        if not entries:
            return None
        size = index.uncompressed_size
        last, final = max((last, id) for id, _, last in entries)
        needed, places = last + HEAD.size + self._longest[final], None
        while True:
            whole = needed > size // 2
            needed = size if whole else needed
            base, crc = self._unpack(index, arena, needed, whole=whole)
            if places is None:
                places = _NOWHERE if crc else self._places(index)
            end = self._end(final, arena, base, last, needed)
            if end <= needed and not crc:
                wall = int(min(places[places > last], default=size))
                end = end if end == wall else max(end, wall)
            if end <= needed:
                break
            if end > size:
                raise BrokenError("a message is cut off")
            needed = end
        checked = whole and crc > 0
        if checked and crc32(arena.data.data[base : base + needed]) != crc:
            raise BrokenError("the CRC of a chunk does not match its data")
        return ChunkInMemory(index, entries, base, needed, crc, checked, places)

    def _places(self, chunk: ChunkIndex) -> Places:
        """The offsets of the messages of a chunk by its index, in the order of the file."""
        entries = self._entries(chunk, chunk.message_index_offsets.keys())
        return np.sort(numbers(b"".join([some for _, some, _ in entries]))[1::2].astype(np.int64))

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
                last = max(_PLACE.iter_unpack(some))[0] if few else int(numbers(some)[1::2].max())
                if last >= chunk.uncompressed_size:
                    raise BrokenError("the index of a chunk points outside the chunk")
                entries.append((id, some, last))
        return entries

    def _unpack(
        self, chunk: ChunkIndex, arena: ChunkBytes, size: int, *, whole: bool
    ) -> tuple[int, int]:
        """Unpack the first `size` bytes of a chunk after those in use.

        Returns:
            Where in the arena they begin, and the CRC that the chunk states.
        """
        packed, used = chunk.compressed_size, arena.used
        before = _HEAD.size + len(chunk.compression) + 8
        if not chunk.compression:
            if packed != chunk.uncompressed_size:
                raise BrokenError("the size of a chunk differs from the size that it states")
            return used + before, self._fill(chunk, arena.target(before + size))
        if is_absurd(chunk.uncompressed_size, packed):
            raise BrokenError("a chunk states an impossible size")
        for length in (packed,) if whole else (_share(chunk, size), packed):
            if before + length > len(self._packed):
                self._packed = bytearray(before + length)
            some = memoryview(self._packed)[: before + length]
            crc = self._fill(chunk, some)
            if arena.unpack(chunk.compression, some[before:], size, whole=whole):
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

    def _end(self, id: int, arena: ChunkBytes, base: int, last: int, needed: int) -> int:
        """The end of the last message of a channel in its chunk, as far as it is unpacked."""
        content = last + HEAD.size
        if content > needed:
            return content
        _, length = HEAD.unpack_from(arena.data.data, base + last)
        self._longest[id] = max(self._longest[id], min(length, SIZE))
        return content + int(length)


def _share(chunk: ChunkIndex, size: int) -> int:
    """An estimate of the packed bytes of a chunk that its first `size` bytes need at most."""
    blocks = -(-size // _BLOCK) * _BLOCK
    likely = int(blocks * chunk.compressed_size / chunk.uncompressed_size * 1.3) + 2**14
    return min(likely, chunk.compressed_size)
