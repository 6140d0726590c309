"""The messages of one MCAP file: by its index, or record by record.

Where the index explains the whole file, only the wanted parts are read. In any other file each
record is read: that shows damaged places and their times.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
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


@dataclass(frozen=True, slots=True)
class Contents:
    """Facts about one file, apart from its messages."""

    damages: tuple[tuple[Damage, Gap | None], ...]
    """Damaged places, with the time that each has cost; None where it cost nothing."""
    span: Gap | None
    """The earliest and the latest whole message; None where there is none."""
    cut: int | None
    """Up to which byte there are whole records, in a file without an end."""
    checked: Checked
    unprotected: bool = False
    """Whether messages were read that no CRC covers."""
    summary_sha256: str = ""
    """Identifies a log that is not hashed (`_identity`)."""
    described: Described = field(default_factory=dict)
    """What its metadata records say, as far as it is asked for."""


def contents(
    stream: BufferedReader,
    size: int,
    sink: Sink,
    integrity: Integrity,
    wanted: Collection[str] = (),
) -> Contents:
    """Read a file.

    Args:
        stream: an MCAP file, which can be sought in.
        size: its bytes.
        sink: takes the messages.
        integrity: whether the index may be trusted.
        wanted: what is asked for of its metadata records: `build.version`.

    Raises:
        BrokenError: the file is not as its index says. The sink has got what it should not have:
            read again, with another one and `Integrity.FULL`.
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
    """SHA-256 of all that follows the data, and of the CRC that each chunk states.

    A summary says where messages are, and not what they hold: with values of the same length it is
    the same for another log. What the CRCs say covers the messages.

    Args:
        stream: the file.
        index: its index.
        crcs: of the chunks that were read, by the byte at which each begins.
    """
    digest = hashlib.sha256()
    for chunk in index.chunks:
        known = crcs.get(chunk.chunk_start_offset)
        if known is None:
            stream.seek(chunk.chunk_start_offset + HEAD.size + _CHUNK_CRC)
        digest.update(stream.read(4) if known is None else known.to_bytes(4, "little"))
    stream.seek(index.data_end)  # the CRC of the data, if one is stated, is what follows first
    while block := stream.read(BLOCK):
        digest.update(block)
    return digest.hexdigest()


_CHUNK_CRC = 24
"""Bytes before it in a chunk: two times and a size of eight bytes each."""


def _crc32(stream: BufferedReader, size: int) -> int:
    """The CRC of the first `size` bytes."""
    stream.seek(0)
    crc = 0
    while size > 0 and (block := stream.read(min(size, BLOCK))):
        crc = crc32(block, crc)
        size -= len(block)
    return crc
