"""The recording of a watch: an MCAP file with the bytes that arrived, in the order of arrival.

What an audit needs to say the same (where the grid begins, up to when was watched, what was missed)
is written as metadata. The file is readable up to its last second at any time; closed, it is whole.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

from mcap.writer import CompressionType, Writer

from compiler.files.build_id import __version__
from fretc.logs.signals.samples import Gap
from fretc.logs.watch_records import GRID, WATCH, grid_record, watch_record
from fretc.watch.sources.source import Arrival, Channel
from fretish.clock import Clock

_SECOND = 10**9
"""Nanoseconds of receive time after which what has come is written, at the latest."""
_CHUNK = 2**19
"""Bytes of a chunk."""
MOST_GAPS = 10_000
"""Times of missed messages that are written one by one; more are one, from first to last."""


class Recorder:
    """Writes one run."""

    def __init__(self, path: Path, clock: Clock) -> None:
        """Begin a new file.

        Raises:
            OSError: there is one, or it cannot be written.
        """
        self.path = path
        self._clock = clock
        self._file: BinaryIO = path.open("xb")
        self._writer: Any = Writer(self._file, chunk_size=_CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(library=f"fretc {__version__}")
        self._channels: dict[Channel, int] = {}
        self._schemas: dict[tuple[str, str, bytes], int] = {}
        self._flushed = 0
        self._has_grid = False

    def message(self, arrival: Arrival) -> None:
        """One message, as it came.

        Raises:
            OSError: the disk is full, say.
        """
        channel = self._channels.get(arrival.channel)
        if channel is None:
            channel = self._channels[arrival.channel] = self._register(arrival.channel)
        self._writer.add_message(channel, arrival.log_time, arrival.payload, arrival.publish_time)
        if arrival.log_time - self._flushed >= _SECOND:
            self._flushed = arrival.log_time
            self._writer.flush()
            self._file.flush()

    def _register(self, channel: Channel) -> int:
        schema = 0
        if channel.schema_name or channel.schema_encoding:
            key = channel.schema_name, channel.schema_encoding, channel.schema
            if key not in self._schemas:
                self._schemas[key] = self._writer.register_schema(*key)
            schema = self._schemas[key]
        return int(self._writer.register_channel(channel.topic, channel.message_encoding, schema))

    def grid(self, origin: int | None) -> None:
        """Where the grid begins; written once.

        Raises:
            OSError: the disk is full, say.
        """
        if origin is not None and not self._has_grid:
            self._has_grid = True
            self._writer.add_metadata(GRID, grid_record(self._clock, origin))

    def close(self, until: int, missed: tuple[Gap, ...], disordered: int = 0) -> None:
        """End the file.

        Args:
            until: up to when was watched, on the declared clock.
            missed: receive times between which messages were lost.
            disordered: messages that were judged too late because they came behind later ones.

        Raises:
            OSError: the disk is full, say.
        """
        if len(missed) > MOST_GAPS:
            missed = ((missed[0][0], missed[-1][1]),)
        try:
            self._writer.add_metadata(WATCH, watch_record(self._clock, until, missed, disordered))
            self._writer.finish()
        finally:
            self._file.close()

    def abandon(self) -> None:
        """Leave the file as it is: what is in it can be read, and breaks off."""
        self._file.close()

    def discard(self) -> None:
        """Leave no file: nothing has come."""
        self._file.close()
        self.path.unlink(missing_ok=True)
