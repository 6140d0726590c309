"""An MCAP log as a source: the messages written so far and, if it is followed, further ones.

An incomplete record at the end is read when it is complete. A recorder writes at any time, so no
clock shows that earlier messages are complete: a tick is judged when a later message has been
recorded.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Generator, Iterator
from threading import Event as Flag
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Channel as McapChannel
from mcap.records import Chunk, Message, Schema

from compiler.files.text_files import open_regular
from fretc.logs import log_diagnostics
from fretc.logs.mcap.container import HEAD, LARGEST, MAGIC, BrokenError, frames, parse, unpacked
from fretc.logs.storage import storage_diagnostics
from fretc.logs.storage.log_names import name_of
from fretc.watch.sources.source import Arrival, Channel, Event, Idle, Missed, Opened, Problem
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source as Text
from fretish.diagnostics.source import Span
from fretish.system.files import read_at

_WAIT = 0.05
"""Seconds between two checks of a file that has not grown."""
_KNOWN = 256
"""Bytes before the reading position that are compared again."""
_MOST = 2**16
"""The most channels of a log; a log with more is damaged."""


class Log:
    """One file, read from its beginning."""

    def __init__(self, path: str, *, follow: bool) -> None:
        """A source that is not yet open; with `follow` it waits for further messages."""
        self.name = name_of(path)
        self._path = path
        self._follow = follow
        self._closed = Flag()
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._wanted: frozenset[str] = frozenset()
        self._latest = 0
        self._before = b""
        """The last bytes that were read, to detect a file that was overwritten."""

    def close(self) -> None:
        """Stop reading."""
        self._closed.set()

    def arrivals(self, topics: Collection[str]) -> Iterator[Arrival | Event | Idle]:
        """The messages in the order of the file; those of a chunk by their log times."""
        self._wanted = frozenset(topics)
        span = Text(self.name, "").span()
        try:
            with open_regular(self._path) as stream:
                yield Opened(self.name)
                yield from self._read(stream, span)
        except FileNotFoundError:
            yield Problem(diagnostic("no_such_log", span))
        except IsADirectoryError:
            yield Problem(diagnostic("log_is_directory", span))
        except OSError as error:
            yield Problem(storage_diagnostics.unreadable(error, span))

    def _read(self, stream: BinaryIO, span: Span) -> Iterator[Arrival | Event | Idle]:
        start = yield from self._whole(stream, 0, len(MAGIC), span)
        if start is None:
            return
        if start != MAGIC:
            yield Problem(log_diagnostics.not_a_log(start, span))
            return
        at = len(MAGIC)
        while not self._closed.is_set():
            head = yield from self._whole(stream, at, HEAD.size, span)
            if head is None:
                return
            opcode, length = HEAD.unpack(head)
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                return
            if length > LARGEST or opcode == 0:
                yield Problem(_broken(at, "a record has an impossible length", span))
                return
            content = yield from self._whole(stream, at + HEAD.size, length, span)
            if content is None:
                return
            yield from self._record(opcode, content, at, span)
            at += HEAD.size + length

    def _whole(
        self, stream: BinaryIO, at: int, length: int, span: Span
    ) -> Generator[Event | Idle, None, bytes | None]:
        """So many bytes, once they have been written."""
        while True:
            # a stream would give again what it has in its buffer, whatever the file has now
            file, size = stream.fileno(), len(self._before)
            bytes_before = read_at(file, size, at - size)
            file_size = os.fstat(file).st_size
            is_there = file_size >= at + length
            data = read_at(file, length, at) if is_there else b""
            if bytes_before == self._before and len(data) == length:
                self._before = (bytes_before + data[-_KNOWN:])[-_KNOWN:]
                return data
            changed = self._changed(stream, at)
            if changed is None and len(bytes_before) == size and bytes_before != self._before:
                changed = "another log was written over it"
            if changed is not None:
                yield Problem(_broken(at, changed, span))
                return None
            if self._closed.is_set():
                return None
            if not self._follow:
                yield Problem(_broken(at, "it breaks off" if file_size else "it is empty", span))
                yield Missed(self._latest, self._latest, 1)
                return None
            yield Idle(None)
            self._closed.wait(_WAIT)

    def _changed(self, stream: BinaryIO, at: int) -> str | None:
        """Whether the file is not the one that was being read."""
        own = os.fstat(stream.fileno())
        if own.st_size < at:
            return "it has become shorter than what was read of it"
        try:
            now = os.stat(self._path)
        except OSError:
            return "it is gone"
        if (now.st_dev, now.st_ino) != (own.st_dev, own.st_ino):
            return "another file has taken its place"
        return None

    def _record(
        self, opcode: int, content: bytes, at: int, span: Span
    ) -> Iterator[Arrival | Event]:
        try:
            match opcode:
                case Opcode.CHUNK:
                    yield from self._chunk(parse(Chunk.read, content), at, span)
                case _:
                    arrival = self._single(opcode, content)
                    if arrival is not None:
                        yield arrival
        except BrokenError as error:
            yield Problem(_broken(at, str(error), span))
            yield Missed(self._latest, self._latest, 1)

    def _chunk(self, chunk: Chunk, at: int, span: Span) -> Iterator[Arrival | Event]:
        arrivals: list[Arrival] = []
        try:
            data = unpacked(chunk)
            for opcode, start, end in frames(data):
                arrival = self._single(opcode, data[start:end])
                if arrival is not None:
                    arrivals.append(arrival)
        except BrokenError as error:
            yield Problem(_broken(at, str(error), span))
            yield Missed(chunk.message_start_time, chunk.message_end_time, 1)
        yield from sorted(arrivals, key=_log_time)

    def _single(self, opcode: int, content: bytes) -> Arrival | None:
        match opcode:
            case Opcode.SCHEMA:
                schema = parse(Schema.read, content)
                if len(self._schemas) < _MOST:
                    self._schemas[schema.id] = schema
            case Opcode.CHANNEL:
                self._declare(parse(McapChannel.read, content))
            case Opcode.MESSAGE:
                return self._message(content)
        return None

    def _declare(self, channel: McapChannel) -> None:
        if channel.topic not in self._wanted or channel.id in self._channels:
            return
        schema = self._schemas.get(channel.schema_id)
        self._channels[channel.id] = Channel(
            channel.topic,
            channel.message_encoding,
            schema.name if schema else "",
            schema.encoding if schema else "",
            schema.data if schema else b"",
        )

    def _message(self, content: bytes) -> Arrival | None:
        channel = self._channels.get(int.from_bytes(content[:2], "little"))
        if channel is None:
            return None
        message = parse(_message_of(len(content)), content)
        self._latest = max(self._latest, message.log_time)
        return Arrival(channel, bytes(message.data), message.log_time, message.publish_time)


def _message_of(length: int) -> Callable[..., Message]:
    return lambda stream: Message.read(stream, length)


def _log_time(arrival: Arrival) -> int:
    return arrival.log_time


def _broken(at: int, why: str, span: Span) -> Diagnostic:
    return diagnostic("watched_log_breaks", span, at=at, why=why)
