"""Logs put together from pieces: what stands in which chunk, and what the index says of it.

The official writer makes one kind of log; these are of many kinds, and all of them are right.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import lz4.frame
import zstandard
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    Schema,
    Statistics,
)

from tests.fretc.logs.conformance import MAGIC, framed
from tests.fretc.logs.logs import definition

PACK = {
    "": lambda data: data,
    "zstd": lambda data: zstandard.ZstdCompressor().compress(data),
    "lz4": lz4.frame.compress,
}

BETWEEN: dict[str, McapRecord] = {
    "attachment": Attachment(1, 2, "notes.txt", "text/plain", bytes(range(256)) * 40),
    "metadata": Metadata("rosbag2", {"ROS_DISTRO": "jazzy"}),
}


def channel(id: int, topic: str, schema: int, encoding: str = "cdr") -> Channel:
    return Channel(id, topic, encoding, {}, schema)


FLOAT, SCAN, IMAGE = 1, 2, 3
SCHEMAS = {
    FLOAT: Schema(FLOAT, b"float64 data\n", "ros2msg", "std_msgs/msg/Float64"),
    SCAN: Schema(
        SCAN,
        definition("sensor_msgs/msg/LaserScan", "cdr"),
        "ros2msg",
        "sensor_msgs/msg/LaserScan",
    ),
    IMAGE: Schema(IMAGE, b"uint8[] data\n", "ros2msg", "demo/msg/Image"),
}
CHANNELS = {
    1: channel(1, "/x", FLOAT),
    2: channel(2, "/x", FLOAT),
    3: channel(3, "/y", FLOAT),
    4: channel(4, "/scan", SCAN),
    5: channel(5, "/image", IMAGE),
    6: channel(6, "/unused", FLOAT),
}


@dataclass(frozen=True)
class Piece:
    """A chunk, or messages that stand in none."""

    messages: Sequence[McapRecord]
    """And other records that stand among them."""
    compression: str = ""
    crc: bool = True
    chunked: bool = True
    shuffled: bool = False
    """Whether the entries of its index are in order of time, and not of place."""
    declares: bool = True
    """Whether the definitions of its topics stand in it."""
    after: Sequence[str] = ()
    """What follows it: keys of `BETWEEN`."""
    also: Sequence[McapRecord] = ()
    """Other definitions that stand at its beginning."""


@dataclass
class Put:
    """The bytes so far, and where what of them is."""

    data: bytearray = field(default_factory=lambda: bytearray(MAGIC))
    chunks: list[ChunkIndex] = field(default_factory=list)
    packed: list[range] = field(default_factory=list)
    """Of each chunk: the bytes of its data."""
    summary: int = 0

    def put(self, *records: McapRecord, padded: bool = False) -> int:
        """Append them; gives where the first one begins."""
        start = len(self.data)
        for record in records:
            self.data += framed(record, padded=padded)
        return start


def built(
    pieces: Sequence[Piece],
    *,
    padded: bool = False,
    data_crc: bool = False,
    summary_crc: bool = True,
    outside: bool = False,
    **stated: Any,
) -> Put:
    """A log of these pieces, with all indexes and statistics.

    Args:
        pieces: in the order of the file.
        padded: whether records are longer than their content.
        data_crc: whether the data has a CRC, over all chunks.
        summary_crc: whether the summary has one.
        outside: whether all definitions also stand before the first chunk.
        stated: what the statistics state instead of what is right.
    """
    put = Put()
    put.put(Header("ros2", "pieces"))
    if outside:
        put.put(*SCHEMAS.values(), *CHANNELS.values())
    for piece in pieces:
        if piece.chunked:
            _chunk(put, piece, padded=padded)
        else:
            put.put(*_declared(piece), *piece.messages)
        put.put(*(BETWEEN[name] for name in piece.after), padded=padded)
    put.put(DataEnd(zlib.crc32(put.data) if data_crc else 0))
    put.summary = len(put.data)
    messages = [message for piece in pieces for message in _messages(piece)]
    put.put(*SCHEMAS.values(), *CHANNELS.values(), *put.chunks, padded=padded)
    put.put(replace(_statistics(messages, len(put.chunks)), **stated), padded=padded)
    footer = framed(Footer(put.summary, 0, 0))[:-4]
    crc = zlib.crc32(put.data[put.summary :] + footer) if summary_crc else 0
    put.data += footer + crc.to_bytes(4, "little") + MAGIC
    return put


def _messages(piece: Piece) -> list[Message]:
    return [record for record in piece.messages if isinstance(record, Message)]


def _declared(piece: Piece) -> list[McapRecord]:
    ids = dict.fromkeys(message.channel_id for message in _messages(piece))
    channels = [CHANNELS[id] for id in ids]
    schemas = dict.fromkeys(channel.schema_id for channel in channels)
    declared = [*(SCHEMAS[id] for id in schemas), *channels] if piece.declares else []
    return [*piece.also, *declared]


def _chunk(put: Put, piece: Piece, *, padded: bool) -> None:
    content = bytearray(b"".join(map(framed, _declared(piece))))
    indexes: dict[int, MessageIndex] = {}
    for message in piece.messages:
        if not isinstance(message, Message):
            content += framed(message)
            continue
        entry = message.log_time, len(content)
        index = indexes.setdefault(message.channel_id, MessageIndex(message.channel_id, []))
        index.records.append(entry)
        content += framed(message)
    times = [message.log_time for message in _messages(piece)] or [0]
    packed = PACK[piece.compression](bytes(content))
    crc = zlib.crc32(content) if piece.crc else 0
    chunk = Chunk(piece.compression, packed, max(times), min(times), crc, len(content))
    at = put.put(chunk)
    end = len(put.data)
    put.packed.append(range(end - len(packed), end))
    offsets = {}
    for id, index in indexes.items():
        if piece.shuffled:
            index.records.sort(key=lambda entry: (entry[0], -entry[1]))
        offsets[id] = put.put(index, padded=padded)
    put.chunks.append(
        ChunkIndex(
            chunk_start_offset=at,
            chunk_length=end - at,
            message_start_time=min(times),
            message_end_time=max(times),
            message_index_offsets=offsets,
            message_index_length=len(put.data) - end,
            compression=piece.compression,
            compressed_size=len(packed),
            uncompressed_size=len(content),
        )
    )


def _statistics(messages: Sequence[Message], chunks: int) -> Statistics:
    times = [message.log_time for message in messages] or [0]
    return Statistics(
        attachment_count=0,
        channel_count=len(CHANNELS),
        channel_message_counts=dict(Counter(message.channel_id for message in messages)),
        chunk_count=chunks,
        message_count=len(messages),
        message_end_time=max(times),
        message_start_time=min(times),
        metadata_count=0,
        schema_count=len(SCHEMAS),
    )
