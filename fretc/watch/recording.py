"""The recording of a watch: an MCAP file with the bytes that arrived, in the order of arrival.

The facts that an audit needs for equal verdicts (the start of the grid, the end of the watch,
missed messages) are written as metadata. The file is readable up to its last second at any time;
after it is closed, it is complete.
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
"""The most nanoseconds of receive time before arrived messages are written."""
_CHUNK = 2**19
"""Bytes of a chunk."""
MOST_GAPS = 10_000
"""The most intervals of missed messages that are written one by one; more are merged into one."""


class RunRecorder:
    """A writer of one run."""

    def __init__(self, path: Path, clock: Clock) -> None:
        """Begin a new file.

        Raises:
            OSError: the file exists already, or cannot be written.
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
        """Write one message as it arrived.

        Raises:
            OSError: for example because the disk is full.
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
        """Write the start of the grid, once.

        Raises:
            OSError: for example because the disk is full.
        """
        if origin is not None and not self._has_grid:
            self._has_grid = True
            self._writer.add_metadata(GRID, grid_record(self._clock, origin))

    def close(self, until: int, missed: tuple[Gap, ...], disordered: int = 0) -> None:
        """End the file.

        Args:
            until: the end of the watch, on the declared clock.
            missed: receive times between which messages were lost.
            disordered: the number of messages that came after later ones whose ticks had been
                judged.

        Raises:
            OSError: for example because the disk is full.
        """
        if len(missed) > MOST_GAPS:
            missed = ((min(since for since, _ in missed), max(until for _, until in missed)),)
        try:
            self._writer.add_metadata(WATCH, watch_record(self._clock, until, missed, disordered))
            self._writer.finish()
        finally:
            self._file.close()

    def abandon(self) -> None:
        """Leave the file as it is: readable, but truncated."""
        self._file.close()

    def discard(self) -> None:
        """Delete the file, because no message arrived."""
        self._file.close()
        self.path.unlink(missing_ok=True)
