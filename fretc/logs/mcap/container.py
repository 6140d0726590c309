"""An MCAP file as bytes: records in their frames, chunks unpacked with limits, the summary.

Each byte may be wrong: an inconsistency is a `BrokenError`, and nothing is unpacked or read beyond
its own frame.

Source: MCAP specification, https://mcap.dev/spec
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import field
from functools import cache, lru_cache
from io import BufferedReader, BytesIO
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Schema, Statistics

from fretish.classes.frozen import dataclass

try:  # more than ten times as fast as `zlib`
    from zlib_ng.zlib_ng import crc32 as crc32
except ImportError:  # an older environment without this dependency
    from zlib import crc32 as crc32

if TYPE_CHECKING:
    from zstandard import ZstdDecompressor

INDEX = struct.Struct("<HI")
"""The head of a message index: channel, and the bytes of its entries."""
ENTRY = np.dtype([("time", "<u8"), ("place", "<u8")])
"""An entry of a message index: log time, and the offset of the record in the chunk."""
CHUNK = struct.Struct("<QQQII")
"""The head of a chunk: its times, its size, its CRC, the length of the name of its compression."""
_CHUNK_INDEX = struct.Struct("<QQQQI")
"""The head of a chunk index: times, place, length, and the bytes of its message indexes."""
_INDEXES, _SIZES = struct.Struct("<QI"), struct.Struct("<QQ")
"""In the head of a chunk index: bytes of the message indexes, and of the name of the compression;
then the sizes."""
_PLACE = struct.Struct("<HQ")
"""A channel, and the offset at which its message index begins."""
MAGIC = b"\x89MCAP0\r\n"
"""The first and the last bytes of a file."""
HEAD = struct.Struct("<BQ")
"""The head of each record: opcode and length."""
PADDING = 256
"""Bytes by which a record may exceed its contents."""
LARGEST = 2**30
"""Bytes; a larger message or chunk is refused."""
BLOCK = 2**20
"""Bytes of one read if no more are needed."""
_SHORT = 2**14
"""The most bytes of a record that is cached."""
_FOOTER = struct.Struct("<QQI")
"""Start of the summary, start of its offsets, CRC."""
_RATIO = 200
"""The most unpacked bytes for each packed byte of a chunk larger than `_PLENTY`."""
_DENSEST = 50_000
"""The most unpacked bytes for each packed byte that any compression reaches."""
_PLENTY = 2**26
"""Bytes; a chunk of this size may have any ratio: it may repeat the same numbers."""

R = TypeVar("R")


class BrokenError(Exception):
    """A record is broken; the text gives the reason."""


@dataclass(frozen=True, slots=True)
class ChannelDefinition:
    """A channel of the file, with the definition of its messages."""

    channel: Channel
    schema: Schema | None


# Records


def frames(data: bytes) -> Iterator[tuple[int, int, int]]:
    """`(opcode, start, end)` of each record: its content is `data[start:end]`.

    Raises:
        BrokenError: the last record is longer than the data.
    """
    at, size = 0, len(data)
    while at < size:
        if at + HEAD.size > size:
            raise BrokenError("a record is cut off")
        opcode, length = HEAD.unpack_from(data, at)
        start = at + HEAD.size
        at = start + length
        if at > size:
            raise BrokenError("a record is cut off")
        yield opcode, start, at


class _Exact(ReadDataStream):
    """Bytes that cannot be read past their end."""

    def read(self, length: int) -> bytes:
        data = super().read(length)
        if len(data) != length:
            raise EOFError
        return data


def parse(kind: Callable[[ReadDataStream], R], content: bytes) -> R:
    """One record, parsed from its own bytes only.

    Raises:
        BrokenError: the bytes do not form such a record.
    """
    try:
        short = len(content) <= _SHORT and kind in (Schema.read, Channel.read)
        return (_parsed if short else _parse)(kind, content)
    except Exception as error:  # the parser trusts each byte, and each may be wrong
        raise BrokenError("a record cannot be read") from error


def _parse(kind: Callable[[ReadDataStream], R], content: bytes) -> R:
    return kind(_Exact(BytesIO(content)))


_parsed = lru_cache(512)(_parse)
"""A cache: logs of one robot have the same definitions and the same topics."""


# Chunks


def unpacked(chunk: Chunk) -> bytes:
    """The contents of a chunk, after a check of their length and their CRC.

    It takes no more memory than the chunk states, and no more than `LARGEST`.

    Raises:
        BrokenError: length or CRC are wrong.
    """
    size = chunk.uncompressed_size
    if is_absurd(size, len(chunk.data)):
        raise BrokenError(f"a chunk states an impossible size of {size} bytes")
    if chunk.compression not in _CODECS:
        raise BrokenError(f"a chunk is compressed with the unknown codec `{chunk.compression}`")
    try:
        data = _CODECS[chunk.compression](chunk.data, size + 1)
    except Exception as error:  # each codec raises its own exceptions
        raise BrokenError("a chunk does not decompress") from error
    if len(data) != size:
        raise BrokenError("the size of a chunk differs from the size that it states")
    if chunk.uncompressed_crc and crc32(data) != chunk.uncompressed_crc:
        raise BrokenError("the CRC of a chunk does not match its data")
    return data


def is_absurd(size: int, packed: int) -> bool:
    """Whether so many bytes exceed the limit of a chunk, or cannot come from so few packed ones."""
    return size > min(largest(packed), _DENSEST * (packed + 1))


def largest(packed: int) -> int:
    """The most bytes that a chunk of so many packed bytes may hold."""
    return min(LARGEST, max(_PLENTY, _RATIO * packed))


def _stored(data: bytes, _: int) -> bytes:
    return data


def _zstd(data: bytes, most: int) -> bytes:
    with _decompressor().stream_reader(data) as stream:
        return stream.read(most)


def unpacked_lz4(data: bytes | memoryview, most: int) -> bytes:
    """The unpacked bytes, at most so many."""
    import lz4.frame

    return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=most))


def unpack_into(compression: str, packed: memoryview, target: memoryview, *, whole: bool) -> int:
    """Unpack the beginning of a chunk.

    Args:
        compression: `lz4` or `zstd`.
        packed: the chunk's data, or its beginning.
        target: the memory to fill, as far as the data goes.
        whole: whether the data should end with the target.

    Returns:
        How many bytes there are; if `whole`, more than the target has where the data goes on.

    Raises:
        BrokenError: the data is invalid.
    """
    try:
        if compression == "zstd":
            return _zstd_into(packed, target, whole=whole)
        data = unpacked_lz4(packed, len(target) + whole)
    except Exception as error:  # each codec raises its own exceptions
        raise BrokenError("a chunk does not decompress") from error
    size = min(len(data), len(target))
    target[:size] = data[:size]
    return len(data)


@cache
def _decompressor() -> ZstdDecompressor:
    """One decompressor for all chunks: it costs as much as a small chunk."""
    import zstandard

    return zstandard.ZstdDecompressor()


def _zstd_into(packed: memoryview, target: memoryview, *, whole: bool) -> int:
    filled = 0
    with _decompressor().stream_reader(packed) as stream:
        while filled < len(target) and (more := stream.readinto(target[filled:])):
            filled += more
        return filled + len(stream.read(1)) if whole else filled


_CODECS: dict[str, Callable[[bytes, int], bytes]] = {
    "": _stored,
    "zstd": _zstd,
    "lz4": unpacked_lz4,
}
"""Functions that unpack at most so many bytes, by compression."""


# The end of the file


@dataclass(slots=True)
class Summary:
    """The summary at the end of a file; empty if it is damaged."""

    end: int
    """The offset at which the data section ends, if `sound`; it ends earlier if not."""
    sound: bool
    footer: int
    """The offset of the record before the closing magic."""
    after: int
    """The offset after the closing magic; the file should end there too."""
    statistics: Statistics | None = None
    chunks: dict[int, ChunkIndex] = field(default_factory=dict)
    """Chunk indexes by the offset of each chunk."""
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)


def no_summary(size: int) -> Summary:
    """The empty summary of a file that breaks off after `size` bytes."""
    return Summary(size, sound=False, footer=size, after=size)


def summary(stream: BufferedReader, size: int) -> Summary | None:
    """The summary of a file of `size` bytes; None: the file has no end."""
    begin = max(0, size - BLOCK)
    stream.seek(begin)
    tail = stream.read()
    end = tail.rfind(MAGIC)
    for length in range(_FOOTER.size, _FOOTER.size + PADDING):
        at = end - HEAD.size - length
        if at >= 0 and HEAD.unpack_from(tail, at) == (Opcode.FOOTER, length):
            return _summary(stream, begin + at, tail[at + HEAD.size : end])
    return None


def _summary(stream: BufferedReader, at: int, footer: bytes) -> Summary:
    """The summary of a file whose footer begins at byte `at`."""
    start, _, crc = _FOOTER.unpack_from(footer)
    after = at + HEAD.size + len(footer) + len(MAGIC)
    damaged = Summary(at, sound=False, footer=at, after=after)
    if start == 0:
        return Summary(at, sound=True, footer=at, after=after)
    if not len(MAGIC) <= start <= at:
        return damaged
    stream.seek(start)
    data = stream.read(at - start)
    covered = crc32(HEAD.pack(Opcode.FOOTER, len(footer)), crc32(data))
    if crc and crc != crc32(footer[: _FOOTER.size - 4], covered):
        return damaged
    result = Summary(start, sound=True, footer=at, after=after)
    try:
        for opcode, begin, end in frames(data):
            _note(result, opcode, data[begin:end])
    except BrokenError:
        return damaged
    return result


def _note(result: Summary, opcode: int, content: bytes) -> None:
    match opcode:
        case Opcode.STATISTICS:
            result.statistics = parse(Statistics.read, content)
        case Opcode.CHUNK_INDEX:
            chunk = _chunk_index(content)
            result.chunks[chunk.chunk_start_offset] = chunk
        case Opcode.SCHEMA:
            schema = parse(Schema.read, content)
            result.schemas[schema.id] = schema
        case Opcode.CHANNEL:
            channel = parse(Channel.read, content)
            result.channels[channel.id] = channel


def _chunk_index(content: bytes) -> ChunkIndex:
    """A chunk index; the parser of the official library takes ten times as long.

    Raises:
        BrokenError: the record is cut off.
    """
    try:
        start, end, at, length, size = _CHUNK_INDEX.unpack_from(content)
        names = _CHUNK_INDEX.size + size
        places = dict(_PLACE.iter_unpack(content[_CHUNK_INDEX.size : names]))
        index_length, name = _INDEXES.unpack_from(content, names)
        sizes = names + _INDEXES.size + name
        compression = content[names + _INDEXES.size : sizes].decode()
        packed, unpacked = _SIZES.unpack_from(content, sizes)
    except (struct.error, UnicodeDecodeError) as error:
        raise BrokenError("a record cannot be read") from error
    return ChunkIndex(
        chunk_start_offset=at,
        chunk_length=length,
        message_start_time=start,
        message_end_time=end,
        message_index_offsets=places,
        message_index_length=index_length,
        compression=compression,
        compressed_size=packed,
        uncompressed_size=unpacked,
    )
