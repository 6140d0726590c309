"""The messages of one MCAP file: by its index, or record by record.

If the index explains the whole file, only the wanted parts are read. In any other file each record
is read, which finds damaged parts and their times.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from dataclasses import field, replace
from io import BufferedReader

from fretc.logs.mcap.container import BLOCK, HEAD, BrokenError, crc32, summary
from fretc.logs.mcap.damage import Damage
from fretc.logs.mcap.index import Index, indexed
from fretc.logs.mcap.messages import Sink
from fretc.logs.mcap.metadata import Described
from fretc.logs.mcap.projection import Projection
from fretc.logs.mcap.walk import Walk
from fretc.logs.signals.integrity import Checked, Integrity
from fretc.logs.signals.samples import Gap
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Contents:
    """Facts about one file, apart from its messages."""

    damages: tuple[tuple[Damage, Gap | None], ...]
    """Damaged parts, each with the time of its lost messages; None: none are lost."""
    span: Gap | None
    """The earliest and the latest whole message; None: there is none."""
    cut: int | None
    """The offset up to which there are whole records, in a file without an end."""
    checked: Checked
    unprotected: bool = False
    """Whether messages were read without the protection of a CRC."""
    summary_sha256: str = ""
    """The identity of a log that is not hashed (`_identity`)."""
    described: Described = field(default_factory=dict)
    """The wanted values of its metadata records."""


def contents(
    stream: BufferedReader,
    size: int,
    sink: Sink,
    integrity: Integrity,
    wanted: Collection[str] = (),
) -> Contents:
    """Read a file.

    Args:
        stream: a seekable MCAP file.
        size: the size of the file in bytes.
        sink: receives the messages.
        integrity: whether the index may be trusted.
        wanted: the wanted keys of its metadata records: `build.version`.

    Raises:
        BrokenError: the file does not match its index. The sink has received wrong messages: read
            again, with another sink and `Integrity.FULL`.
    """
    if integrity is not Integrity.FULL:
        index = indexed(stream, size, summary(stream, size), wanted)
        if index is not None:
            return _by_index(stream, index, sink, integrity)
    walk = Walk(stream, size, sink, wanted)
    walk.run()
    if walk.damages.span is None:
        certain = tuple((damage, None) for damage in walk.damages.certain)
        return Contents(certain, None, walk.cut, walk.checked)
    return Contents(
        tuple(walk.settled()),
        walk.damages.span,
        walk.cut,
        walk.checked,
        walk.unprotected,
        described=walk.described,
    )


def _by_index(stream: BufferedReader, index: Index, sink: Sink, integrity: Integrity) -> Contents:
    projection = Projection(stream, index, sink)
    projection.run()
    crc = index.data_crc if integrity is Integrity.HASH else 0
    if crc and _crc32(stream, index.data_end) != crc:
        raise BrokenError("the CRC of its data section does not match the data")
    unprotected = projection.checked.without_crc > 0 and not crc
    statistics = index.statistics
    span = statistics.message_start_time, statistics.message_end_time
    if integrity is Integrity.HASH:
        checked, identity = projection.checked, ""
    else:
        checked = replace(projection.checked, hashed=False)
        identity = _identity(stream, index, projection.crcs)
    return Contents((), span, None, checked, unprotected, identity, index.described)


def _identity(stream: BufferedReader, index: Index, crcs: Mapping[int, int]) -> str:
    """SHA-256 of the summary section, and of the CRC that each chunk states.

    A summary states the positions of messages, and not their contents: another log whose values
    have the same lengths has the same summary. The CRCs cover the messages.

    Args:
        stream: the file.
        index: its index.
        crcs: the CRCs of the chunks that were read, by the offset of each chunk.
    """
    digest = hashlib.sha256()
    for chunk in index.chunks:
        stated_crc = crcs.get(chunk.chunk_start_offset)
        if stated_crc is None:
            stream.seek(chunk.chunk_start_offset + HEAD.size + _CHUNK_CRC)
        digest.update(stream.read(4) if stated_crc is None else stated_crc.to_bytes(4, "little"))
    stream.seek(index.data_end)  # the CRC of the data, if one is stated, is what follows first
    while block := stream.read(BLOCK):
        digest.update(block)
    return digest.hexdigest()


_CHUNK_CRC = 24
"""Bytes before the CRC in a chunk: two times and a size of eight bytes each."""


def _crc32(stream: BufferedReader, size: int) -> int:
    """The CRC of the first `size` bytes."""
    stream.seek(0)
    crc = 0
    while size > 0 and (block := stream.read(min(size, BLOCK))):
        crc = crc32(block, crc)
        size -= len(block)
    return crc
