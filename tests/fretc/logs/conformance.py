"""The MCAP conformance suite, rebuilt: each content of a file in each form of the container.

The public suite is 416 files, kept where a clone does not bring them; this makes the same bytes.

Source: https://github.com/foxglove/mcap, `tests/conformance`: `variants/inputs.ts`,
`variants/generateTestVariants.ts`, `scripts/generate-inputs.ts` (MIT).
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
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
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

MAGIC = b"\x89MCAP0\r\n"
Records = tuple[McapRecord, ...]
Features = frozenset[str]

FEATURES: Mapping[str, str] = {
    "ch": "chunks",
    "mx": "message index",
    "st": "statistics",
    "rsh": "schemas repeated in the summary",
    "rch": "channels repeated in the summary",
    "ax": "attachment index",
    "mdx": "metadata index",
    "chx": "chunk index",
    "sum": "summary offsets",
    "pad": "bytes after the content of records",
}

_SCHEMA = Schema(1, b"\x04\x05\x06", "c", "Example")
_CHANNEL = Channel(1, "example", "a", {"foo": "bar"}, 1)
_TIMES = (0, 2, 1, 3, 3, 5, 4, 7, 8, 9)
_DATA = b"\x01\x02\x03"

INPUTS: Mapping[str, Records] = {
    "NoData": (),
    "OneAttachment": (Attachment(1, 2, "myFile", "application/octet-stream", _DATA),),
    "OneMetadata": (Metadata("myMetadata", {"foo": "bar"}),),
    "OneSchemalessMessage": (
        Channel(1, "example", "text", {}, 0),
        Message(1, 2, _DATA, 1, 10),
    ),
    "OneMessage": (_SCHEMA, _CHANNEL, Message(1, 2, _DATA, 1, 10)),
    "TenMessages": (
        _SCHEMA,
        _CHANNEL,
        *(Message(1, time, _DATA, time, i) for i, time in enumerate(_TIMES)),
    ),
}


@dataclass(frozen=True)
class Variant:
    """One file of the suite."""

    input: str
    features: Features

    @property
    def name(self) -> str:
        return "-".join([self.input, *sorted(self.features)])

    @property
    def records(self) -> Records:
        return INPUTS[self.input]

    @property
    def data(self) -> bytes:
        return build(self.records, self.features)


def variants() -> Iterator[Variant]:
    """All files of the suite."""
    every = [
        frozenset(chosen)
        for count in range(len(FEATURES) + 1)
        for chosen in combinations(FEATURES, count)
    ]
    for name, records in INPUTS.items():
        kinds = {type(record) for record in records}
        yield from (Variant(name, chosen) for chosen in every if _sensible(chosen, kinds))


def _sensible(chosen: Features, kinds: set[type]) -> bool:
    """Whether there is anything that each feature could be about."""
    needed: Mapping[str, set[type]] = {
        "ax": {Attachment},
        "mdx": {Metadata},
        "rsh": {Schema},
        "rch": {Channel},
        "ch": {Schema, Channel, Message},
    }
    about_nothing = any(name in chosen and not kinds & needed[name] for name in needed)
    without_chunks = chosen & {"chx", "mx"} and "ch" not in chosen
    nothing_to_point_at = "sum" in chosen and not chosen & {"chx", "rsh", "rch", "mdx", "ax", "st"}
    return not (about_nothing or without_chunks or nothing_to_point_at)


def framed(record: McapRecord, *, padded: bool = False) -> bytes:
    """A record as it stands in a file; these kinds never have padding."""
    builder = RecordBuilder()
    record.write(builder)
    data = bytes(builder.end())  # type: ignore[no-untyped-call]
    if not padded or isinstance(record, Message | Chunk | DataEnd | Footer):
        return data
    content = data[9:] + b"\x01\xff\xff"
    return data[:1] + len(content).to_bytes(8, "little") + content


@dataclass
class _File:
    """The bytes so far, and what the summary will say of them."""

    padded: bool
    data: bytearray = field(default_factory=lambda: bytearray(MAGIC))
    attachments: list[AttachmentIndex] = field(default_factory=list)
    metadata: list[MetadataIndex] = field(default_factory=list)
    chunks: list[ChunkIndex] = field(default_factory=list)

    def put(self, record: McapRecord) -> tuple[int, int]:
        """Append it; where it begins and how long it is."""
        start = len(self.data)
        self.data += framed(record, padded=self.padded)
        return start, len(self.data) - start


def build(records: Sequence[McapRecord], features: Features) -> bytes:
    """A file with these records, and a container with these features."""
    file = _File("pad" in features)
    file.put(Header("", ""))
    in_chunk = [r for r in records if isinstance(r, Schema | Channel | Message)]
    for record in records:
        if record in in_chunk and "ch" in features:
            continue
        start, length = file.put(record)
        if isinstance(record, Attachment):
            times = record.log_time, record.create_time
            size, name, kind = len(record.data), record.name, record.media_type
            file.attachments.append(AttachmentIndex(start, length, *times, size, name, kind))
        if isinstance(record, Metadata):
            file.metadata.append(MetadataIndex(start, length, record.name))
    if "ch" in features:
        _chunk(file, in_chunk, features)
    file.put(DataEnd(zlib.crc32(file.data)))
    _summary(file, records, features)
    return bytes(file.data) + MAGIC


def _chunk(file: _File, records: Sequence[McapRecord], features: Features) -> None:
    content = bytearray()
    entries: dict[int, list[tuple[int, int]]] = {}
    for record in records:
        if isinstance(record, Message):
            entries.setdefault(record.channel_id, []).append((record.log_time, len(content)))
        content += framed(record)
    data, times = bytes(content), [time for some in entries.values() for time, _ in some]
    size, first, last = len(data), min(times), max(times)
    start, length = file.put(Chunk("", data, last, first, zlib.crc32(data), size))
    offsets: dict[int, int] = {}
    if "mx" in features:
        for channel, some in entries.items():
            offsets[channel], _ = file.put(MessageIndex(channel, some))
    indexes = len(file.data) - start - length
    file.chunks.append(ChunkIndex(length, start, "", size, last, indexes, offsets, first, size))


def _summary(file: _File, records: Sequence[McapRecord], features: Features) -> None:
    groups: dict[str, tuple[Opcode, Sequence[McapRecord]]] = {
        "rsh": (Opcode.SCHEMA, [r for r in records if isinstance(r, Schema)]),
        "rch": (Opcode.CHANNEL, [r for r in records if isinstance(r, Channel)]),
        "st": (Opcode.STATISTICS, [_statistics(records, "ch" in features)]),
        "mdx": (Opcode.METADATA_INDEX, file.metadata),
        "ax": (Opcode.ATTACHMENT_INDEX, file.attachments),
        "chx": (Opcode.CHUNK_INDEX, file.chunks),
    }
    start = len(file.data)
    offsets: list[SummaryOffset] = []
    for name, (opcode, group) in groups.items():
        if name in features:
            begin = len(file.data)
            for record in group:
                file.put(record)
            offsets.append(SummaryOffset(opcode, begin, len(file.data) - begin))
    end = len(file.data)
    if "sum" in features:
        for offset in offsets:
            file.put(offset)
    footer = Footer(start if end > start else 0, end if "sum" in features else 0, 0)
    covered = bytes(file.data[start:]) + framed(footer)[:-4]
    footer.summary_crc = zlib.crc32(covered)
    file.put(footer)


def _statistics(records: Sequence[McapRecord], chunked: bool) -> Statistics:
    kinds = Counter(type(record) for record in records)
    messages = [record for record in records if isinstance(record, Message)]
    times = [message.log_time for message in messages] or [0]
    return Statistics(
        attachment_count=kinds[Attachment],
        channel_count=kinds[Channel],
        channel_message_counts=dict(Counter(message.channel_id for message in messages)),
        chunk_count=int(chunked),
        message_count=len(messages),
        message_end_time=max(times),
        message_start_time=min(times),
        metadata_count=kinds[Metadata],
        schema_count=kinds[Schema],
    )
