"""The positions of the messages of a log by its own index, if that explains every byte of the file.

The index is used only if the file is consistent: adjoining parts of known kinds, and as many chunks
and messages as stated. In any other log each record must be read (`fretc.logs.mcap.walk`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from io import BufferedReader

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, DataEnd, Schema, Statistics

from fretc.logs.mcap.container import (
    HEAD,
    LARGEST,
    MAGIC,
    BrokenError,
    ChannelDefinition,
    Summary,
    parse,
)
from fretc.logs.mcap.metadata import LARGEST as LARGEST_METADATA
from fretc.logs.mcap.metadata import Described, described, together
from fretish.classes.frozen import dataclass

_PASSED_BY = frozenset({Opcode.HEADER, Opcode.ATTACHMENT, Opcode.METADATA})


@dataclass(frozen=True, slots=True)
class Index:
    """A log whose summary states the position of everything."""

    chunks: tuple[ChunkIndex, ...]
    """In the order of the file."""
    streams: dict[int, ChannelDefinition]
    """Streams by channel number."""
    statistics: Statistics
    data_end: int
    """The offset up to which the CRC of the data goes."""
    data_crc: int
    """The stated CRC of the data; 0: none."""
    summary: int
    """The offset of the summary."""
    described: Described
    """The wanted values of its metadata records."""


def indexed(
    stream: BufferedReader, size: int, summary: Summary | None, wanted: Collection[str] = ()
) -> Index | None:
    """The index of a file of `size` bytes; None: the file is unusual in some way.

    Args:
        stream: the file.
        size: the size of the file in bytes.
        summary: the summary of the file.
        wanted: the wanted keys of its metadata records.
    """
    if summary is None or not summary.sound or summary.after != size or summary.statistics is None:
        return None
    statistics, chunks = (
        summary.statistics,
        tuple(summary.chunks[at] for at in sorted(summary.chunks)),
    )
    if not chunks:
        return None
    streams = {
        id: ChannelDefinition(channel, summary.schemas.get(channel.schema_id))
        for id, channel in summary.channels.items()
    }
    counts = statistics.channel_message_counts
    if (
        statistics.chunk_count != len(chunks)
        or not 0 < statistics.message_count == sum(counts.values())
        or not streams.keys() >= {id for id, count in counts.items() if count}
        or any(each.schema is None and each.channel.schema_id for each in streams.values())
        or not all(map(_is_usual, chunks))
        or statistics.message_start_time != min(chunk.message_start_time for chunk in chunks)
        or statistics.message_end_time != max(chunk.message_end_time for chunk in chunks)
    ):
        return None
    metadata: list[Described] = []
    try:
        end = _between(stream, summary, chunks, wanted, metadata)
    except BrokenError:
        return None
    if end is None:
        return None
    return Index(chunks, streams, statistics, *end, summary.end, together(metadata))


def _is_usual(chunk: ChunkIndex) -> bool:
    """Whether the chunk can be read by its index, which states the positions of its messages."""
    first, last = chunk.chunk_start_offset, chunk.chunk_start_offset + chunk.chunk_length
    return (
        bool(chunk.message_index_offsets)
        and chunk.uncompressed_size <= LARGEST
        and chunk.compression in ("", "lz4", "zstd")
        and first + chunk.compressed_size < last
        and last <= min(chunk.message_index_offsets.values())
        and max(chunk.message_index_offsets.values()) < last + chunk.message_index_length
    )


def _between(
    stream: BufferedReader,
    summary: Summary,
    chunks: tuple[ChunkIndex, ...],
    wanted: Collection[str],
    found: list[Described],
) -> tuple[int, int] | None:
    """The end of the data, and its CRC; None: something unusual is between the chunks.

    The wanted values of metadata records are added to `found`.
    """
    at, end = len(MAGIC), None
    for chunk in (*chunks, None):
        wall = summary.end if chunk is None else chunk.chunk_start_offset
        if at > wall or end is not None:
            return None
        for place, opcode, content in _records(stream, at, wall, metadata=bool(wanted)):
            if end is not None:
                return None
            if opcode == Opcode.METADATA:
                found.append(described(content, wanted))
            if opcode == Opcode.DATA_END:
                end = place, parse(DataEnd.read, content).data_section_crc
            elif opcode not in _PASSED_BY and not is_known(
                opcode, content, summary.schemas, summary.channels
            ):
                return None
        if chunk is not None:
            at = wall + chunk.chunk_length + chunk.message_index_length
    return end


def _records(
    stream: BufferedReader, at: int, wall: int, *, metadata: bool
) -> Iterator[tuple[int, int, bytes]]:
    """Offset, kind and content of each record; no content of large ones and unwanted metadata.

    Raises:
        BrokenError: the last record exceeds the given end.
    """
    while at < wall:
        stream.seek(at)
        head = stream.read(HEAD.size)
        opcode, length = HEAD.unpack(head) if len(head) == HEAD.size else (0, wall)
        if at + HEAD.size + length > wall:
            raise BrokenError("a record is cut off")
        asked = metadata and opcode == Opcode.METADATA and length <= LARGEST_METADATA
        passed_by = opcode in _PASSED_BY and not asked
        yield at, opcode, b"" if passed_by else stream.read(length)
        at += HEAD.size + length


def is_known(
    opcode: int, content: bytes, schemas: Mapping[int, Schema], channels: Mapping[int, Channel]
) -> bool:
    """Whether a record declares a topic or its messages in the same way as the summary.

    Raises:
        BrokenError: the record cannot be read.
    """
    if opcode == Opcode.SCHEMA:
        schema = parse(Schema.read, content)
        return bool(schemas.get(schema.id) == schema)
    if opcode == Opcode.CHANNEL:
        channel = parse(Channel.read, content)
        return bool(channels.get(channel.id) == channel)
    return False
