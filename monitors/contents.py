"""What a log holds of the topics in question: by its index, or record by record.

By its index only what is wanted is read. A log whose index leaves any doubt, or says anything else
than is found, is read again, record by record: that names what is damaged, and when.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from io import BufferedReader

from monitors.columns import Columns
from monitors.container import BrokenError, summary
from monitors.damage import Damage
from monitors.index import Index, indexed
from monitors.integrity import Checked, Integrity
from monitors.projection import Projection
from monitors.samples import Gap
from monitors.walk import Walk

Crc = Callable[[int], int]
"""The CRC of the file up to that byte."""


@dataclass(frozen=True, slots=True)
class Contents:
    """All that was read of one log."""

    columns: Columns
    damages: tuple[tuple[Damage, Gap | None], ...]
    """Damaged places, with the time that each has cost; None where it cost nothing."""
    span: Gap | None
    """The earliest and the latest whole message; None where there is none."""
    cut: int | None
    """Up to which byte there are whole records, in a file without an end."""
    checked: Checked


def contents(
    stream: BufferedReader,
    size: int,
    integrity: Integrity,
    new: Callable[[], Columns],
    crc: Crc | None = None,
) -> Contents:
    """Read a log.

    Args:
        stream: an MCAP file, which can be sought in.
        size: its bytes.
        integrity: whether its index may be trusted.
        new: makes what takes the messages.
        crc: of the file; None where not all of it is read.
    """
    index = None
    if integrity is not Integrity.FULL:
        index = indexed(stream, size, summary(stream, size))
    if index is not None:
        found = _by_index(stream, index, new(), crc)
        if found is not None:
            return found
    columns = new()
    walk = Walk(stream, size, columns)
    walk.run()
    columns.settle()
    kept = walk.damages.kept
    damages = walk.settled() if walk.damages.span else [(damage, None) for damage in kept]
    return Contents(columns, tuple(damages), walk.damages.span, walk.cut, walk.checked)


def _by_index(
    stream: BufferedReader, index: Index, columns: Columns, crc: Crc | None
) -> Contents | None:
    """What the index leads to; None where the file is not as it says."""
    projection = Projection(stream, index, columns, columns.binds)
    try:
        projection.run()
    except BrokenError:
        return None
    if crc is not None and index.data_crc and crc(index.data_end) != index.data_crc:
        return None
    columns.settle()
    for id, count in index.statistics.channel_message_counts.items():
        columns.count(index.streams[id].channel.topic, count)
    statistics = index.statistics
    span = statistics.message_start_time, statistics.message_end_time
    return Contents(columns, (), span, None, projection.checked)
