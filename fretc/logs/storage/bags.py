"""Bags: ROS 1's `.bag` and rosbag2's `.db3`, read with rosbags; their messages go to a sink.

Neither format has check sums: a changed byte within a message is not detected, and a note says so.
Reading ends where the reader ends; the number and the times of its messages are compared with
those that the bag states. Times are nanoseconds, log times.
"""

from __future__ import annotations

import bz2
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

from mcap.records import Channel, Schema

from fretc.logs.mcap.container import BrokenError, ChannelDefinition, largest, unpacked_lz4
from fretc.logs.mcap.damage import LATEST, Damage
from fretc.logs.mcap.messages import Sink
from fretc.logs.messages.ros2_types import standard
from fretc.logs.signals.samples import Gap
from fretc.logs.storage import storage_diagnostics
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.source import Span

BAG, DB3 = b"#ROSBAG V", b"SQLite format 3\0"
"""The first bytes of the files."""
_LEAST = 2**20
"""The least limit in bytes of a database value, even in a small database."""
_STEPS = 20_000
"""Steps of SQLite's virtual machine between two checks of the time: tenths of a millisecond."""
NOWHERE = -1
"""The offset of a damage that has none."""


@dataclass(frozen=True, slots=True)
class BagContents:
    """The contents of a bag, without its messages."""

    span: Gap | None
    """The first and the last whole message."""
    damages: tuple[tuple[Damage, Gap | None], ...]
    notes: tuple[Diagnostic, ...]


def read(file: str, same: str, start: bytes, sink: Sink, span: Span) -> BagContents | Diagnostic:
    """Pass all messages of a bag to a sink, in order of time.

    Args:
        file: the path of the bag.
        same: another path of the same open file, which no other file can replace.
        start: the first bytes of the bag, `BAG` or `DB3`.
        sink: receives the messages.
        span: the bag, as named on the command line.

    Returns:
        Its contents; or why the bag cannot be read.
    """
    try:
        import rosbags  # noqa: F401
    except ModuleNotFoundError:
        return missing_extra("a bag cannot be read: that needs", ["rosbags"], "bags", span)
    bag = start.startswith(BAG)
    reader = _bag(same) if bag else _db3(same)
    try:
        with _limited(os.stat(file).st_size):
            reader.open()
    except OSError:
        raise
    except Exception as error:  # the reader trusts each byte, and each may be wrong
        return storage_diagnostics.bad_bag(_reason(error), span, indexed=bag)
    try:
        way = _Way(reader, sink, bag=bag)
        way.run()
        if not bag:
            way.check(file)
    finally:
        reader.close()
    damages = tuple(way.settled())
    if way.span is None:
        return (
            storage_diagnostics.bad_bag(damages[0][0].description, span, indexed=bag)
            if damages
            else BagContents(None, (), ())
        )
    return BagContents(way.span, damages, (storage_diagnostics.unchecked(span, way.assumed),))


def ends(file: str) -> Gap | None:
    """The first and the last message of a ROS 1 bag, by its index; None: it is unreadable."""
    try:
        reader = _bag(file)
        reader.open()
    except Exception:  # the reader trusts each byte, and each may be wrong; or it is not installed
        return None
    try:
        return (reader.start_time, reader.end_time - 1) if reader.message_count else None
    finally:
        reader.close()


def _bag(file: str) -> Any:
    from rosbags.rosbag1 import Reader

    class Bounded(Reader):
        """A ROS 1 bag whose chunks have the same limits as those of MCAP."""

        def read_chunk(self) -> Any:
            chunk = super().read_chunk()
            return chunk._replace(decompressor=partial(_unpacked, chunk.decompressor))

    return Bounded(Path(file))


def _unpacked(official: Callable[[bytes], bytes], packed: bytes) -> bytes:
    """The contents of a chunk of a ROS 1 bag.

    Raises:
        BrokenError: the chunk is larger than it can be.
        Exception: of each codec; the data is invalid.
    """
    from rosbags.rosbag1.reader import decompressors

    most = largest(len(packed))
    if official is decompressors["bz2"]:
        data = bz2.BZ2Decompressor().decompress(packed, most + 1)
    elif official is decompressors["lz4"]:
        data = unpacked_lz4(packed, most + 1)
    else:
        data = official(packed)
    if len(data) > most:
        raise BrokenError(f"a chunk of {len(packed)} bytes holds more than {most}")
    return data


@contextmanager
def _limited(size: int) -> Iterator[None]:
    """A context in which databases give no value larger than their file.

    Between the steps of a query Python checks whether too much time has passed.
    """
    import apsw

    def limit(connection: apsw.Connection) -> None:
        connection.limit(apsw.SQLITE_LIMIT_LENGTH, max(_LEAST, size))
        connection.set_progress_handler(lambda: False, _STEPS)

    apsw.connection_hooks.append(limit)
    try:
        yield
    finally:
        apsw.connection_hooks.remove(limit)


def _db3(file: str) -> Any:
    from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

    return Sqlite3Reader(Path(quote(file)))  # the reader puts the path into a URI without quoting


def _reason(error: Exception) -> str:
    text = str(error).partition("\n")[0].strip()
    return text[:200] or type(error).__name__


class _Way:
    """One pass through a bag."""

    def __init__(self, reader: Any, sink: Sink, *, bag: bool) -> None:
        self.span: Gap | None = None
        self.assumed: list[str] = []
        """Types whose definition is not in the bag."""
        self._reader, self._sink, self._bag = reader, sink, bag
        self._damages: list[tuple[Damage, bool]] = []
        """Each damage, with True if all later messages are lost; False: messages of any time may be
        lost."""
        self._streams: dict[int, ChannelDefinition] = {}
        self._stated = self._ends()
        self._counts: dict[int, int] = {}

    def _ends(self) -> Gap | None:
        """The first and the last message, as the bag states it."""
        source = self._reader if self._bag else self._reader.metadata
        start, end = source.start_time, source.end_time - 1
        if not isinstance(start, int) or not isinstance(end, int):
            return None
        return (start, end) if 0 <= start <= end < LATEST else None

    def run(self) -> None:
        """Read the whole bag."""
        connections = list(self._reader.connections)
        counts = self._stated_counts(connections)
        try:
            for connection in connections:
                stream = self._stream(connection)
                self._streams[connection.id] = stream
                self._sink.declare(stream)
            messages = self._reader.messages(connections) if connections else ()
            for connection, time, payload in messages:
                self._message(connection.id, time, payload)
        except OSError:
            raise
        except Exception as error:  # the reader trusts each byte, and each may be wrong
            self._damage(f"it cannot be read further: {_reason(error)}", follows=True)
            return
        if counts != self._counts:
            expected, received = sum(counts.values()), sum(self._counts.values())
            description = f"it states {expected} messages, but holds {received}"
            if expected == received:
                description = "the numbers of messages of its topics differ from the stated numbers"
            self._damage(description, code=Code.COUNT_MISMATCH)

    def _stated_counts(self, connections: list[Any]) -> dict[int, int]:
        if not self._bag:
            return {c.id: c.msgcount for c in connections if c.msgcount}
        counts: dict[int, int] = {}
        for chunk in self._reader.chunk_infos:
            for id, count in chunk.connection_counts.items():
                counts[id] = counts.get(id, 0) + count
        return {id: count for id, count in counts.items() if count}

    def _message(self, id: int, time: int, payload: bytes) -> None:
        self._counts[id] = self._counts.get(id, 0) + 1
        if not (isinstance(payload, bytes) and isinstance(time, int) and 0 <= time < LATEST):
            self._damage("a message has an impossible time, or has no contents")
            return
        first, _ = self.span or (time, time)
        self.span = first, time
        self._sink.add(self._streams[id], time, time, memoryview(payload))

    def check(self, file: str) -> None:
        """The checks that only a database allows."""
        for ending in ("-wal", "-journal"):
            companion = Path(file + ending)
            if companion.exists() and companion.stat().st_size:
                self._damage(f"`{companion.name}` beside it holds messages that are not in it yet")
        listed = self._reader.metadata.message_count
        if listed != sum(self._counts.values()) and not self._damages:
            description = f"it holds {listed} messages, some of them of no topic"
            self._damage(description, code=Code.COUNT_MISMATCH)
        try:
            (result,) = self._reader.dbconn.execute("PRAGMA integrity_check(1)").fetchone()
        except Exception as error:  # it trusts each byte, and each may be wrong
            result = _reason(error)
        if result != "ok":
            self._damage(f"the database is damaged: {str(result)[:200]}")

    def _damage(
        self, description: str, *, follows: bool = False, code: Code = Code.DAMAGED_CHUNK
    ) -> None:
        if all(damage.description != description for damage, _ in self._damages):
            self._damages.append((Damage(NOWHERE, description, code=code), follows))

    def settled(self) -> Iterator[tuple[Damage, Gap | None]]:
        """All damages, each with the time of its lost messages."""
        if self.span is None:
            yield from ((damage, None) for damage, _ in self._damages)
            return
        stated = self._stated or self.span
        first, last = min(self.span[0], stated[0]), max(self.span[1], stated[1])
        for damage, follows in self._damages:
            yield damage, ((self.span[1] if follows else first), last)

    # Streams

    def _stream(self, connection: Any) -> ChannelDefinition:
        if not isinstance(connection.topic, str) or not isinstance(connection.msgtype, str):
            raise ValueError("a topic has no name, or no type")
        schema = self._schema(connection)
        encoding = "ros1" if self._bag else str(connection.ext.serialization_format)
        channel = Channel(
            id=connection.id,
            topic=connection.topic,
            message_encoding=encoding,
            metadata={},
            schema_id=connection.id if schema is not None else 0,
        )
        return ChannelDefinition(channel, schema)

    def _schema(self, connection: Any) -> Schema | None:
        name, kind, text = connection.msgtype, connection.msgdef.format, connection.msgdef.data
        encoding = {"MSG": "ros1msg" if self._bag else "ros2msg", "IDL": "ros2idl"}.get(kind.name)
        if encoding is None:
            encoding, own = "ros2msg", standard(name)
            if own is None:
                return None
            text = own
            self.assumed.append(name)
        if self._bag:
            name = name.replace("/msg/", "/")
        return Schema(connection.id, text.encode(), encoding, name)
