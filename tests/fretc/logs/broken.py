"""Broken and odd logs: how each is made of a sound one, and what has to come out of it.

The sound log holds `/x` at 1000.0 s, 1000.1 s, ... 1001.1 s with the values 0.00, 0.01, ... 0.11,
four messages in each of three chunks, with all indexes, statistics and CRCs.

What has to come out is taken from what is promised, not from what is done: every whole message is
read, or a gap with a name says when messages are lost; what may have lost one is not intact.
"""

from __future__ import annotations

import struct
import tempfile
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, DataEnd, Footer, Header, McapRecord, Message, Schema

from fretish.diagnostics.diagnostic import Code
from tests.fretc.logs.conformance import MAGIC, framed
from tests.fretc.logs.logs import NONE, TWELVE, write

HEAD = 9
"""Bytes before the content of a record: its kind and its length."""


@dataclass(frozen=True)
class Log:
    """The bytes of a sound log, and where its records begin."""

    data: bytes
    places: dict[int, list[int]]
    """By kind."""

    def at(self, opcode: Opcode, which: int = 0) -> int:
        return self.places[opcode][which]

    def content(self, opcode: Opcode, which: int = 0) -> int:
        return self.at(opcode, which) + HEAD

    def length(self, at: int) -> int:
        """Bytes of the record that begins there, with its head."""
        return HEAD + int.from_bytes(self.data[at + 1 : at + HEAD], "little")

    def after(self, opcode: Opcode, which: int = 0) -> int:
        at = self.at(opcode, which)
        return at + self.length(at)

    # Ways to break it

    def cut(self, at: int) -> bytes:
        return self.data[:at]

    def poked(self, at: int, new: bytes) -> bytes:
        return self.data[:at] + new + self.data[at + len(new) :]

    def flipped(self, at: int) -> bytes:
        return self.poked(at, bytes([self.data[at] ^ 0x10]))

    def put(self, at: int, new: bytes) -> bytes:
        """More bytes before the end of the data; the summary is where the footer says."""
        start, _, _ = struct.unpack_from("<QQI", self.data, self.content(Opcode.FOOTER))
        footer = framed(Footer(start + len(new), 0, 0))
        return self.data[:at] + new + self.data[at : self.at(Opcode.FOOTER)] + footer + MAGIC

    def resummed(self, at: int, new: bytes) -> bytes:
        """Other bytes in the summary, and a CRC that covers them."""
        data, footer = self.poked(at, new), self.at(Opcode.FOOTER)
        start, _, _ = struct.unpack_from("<QQI", data, footer + HEAD)
        crc = zlib.crc32(data[start : footer + HEAD + 16])
        return data[: footer + HEAD + 16] + crc.to_bytes(4, "little") + MAGIC


def log(data: bytes) -> Log:
    places: dict[int, list[int]] = {}
    found = Log(data, places)
    at = len(MAGIC)
    while at < len(data) - len(MAGIC):
        places.setdefault(data[at], []).append(at)
        at += found.length(at)
    return found


@cache
def sound() -> Log:
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder) / "log.mcap", TWELVE, compression=NONE, per_chunk=4)
        return log(path.read_bytes())


# Logs made record by record

FLOAT = Schema(1, b"float64 data\n", "ros2msg", "std_msgs/msg/Float64")
TOPIC = Channel(1, "/x", "cdr", {}, 1)
VENDOR = struct.pack("<BQ", 0x7F, 7) + b"private" + struct.pack("<BQ", 0x81, 13) + b"vendor record"
LITTLE, BIG = b"\x00\x01\x00\x00", b"\x00\x00\x00\x00"


def message(time: int, value: float) -> McapRecord:
    return raw(time, LITTLE + struct.pack("<d", value))


def raw(time: int, payload: bytes, channel: int = 1) -> McapRecord:
    return Message(channel, time, payload, time, 0)


def log_of(*records: McapRecord, chunked: bool = True) -> bytes:
    """A log of nothing but these, in one chunk; its end states nothing."""
    content = b"".join(map(framed, records))
    if chunked:
        times = [record.log_time for record in records if isinstance(record, Message)] or [0]
        crc, size = zlib.crc32(content), len(content)
        content = framed(Chunk("", content, max(times), min(times), crc, size))
    return ended(MAGIC + framed(Header("ros2", "")) + content)


def ended(data: bytes) -> bytes:
    """A data section, with an end and without a summary."""
    return data + framed(DataEnd(0)) + framed(Footer(0, 0, 0)) + MAGIC


def _without(log: Log, opcode: Opcode) -> bytes:
    """The data section without the records of a kind."""
    places = sorted(at for places in log.places.values() for at in places)
    kept = (at for at in places if at < log.at(DATA_END) and log.data[at] != opcode)
    return MAGIC + b"".join(log.data[at : at + log.length(at)] for at in kept)


# What comes out

CHUNK, INDEX, DATA_END, FOOTER = Opcode.CHUNK, Opcode.MESSAGE_INDEX, Opcode.DATA_END, Opcode.FOOTER
SIZE, CRC = 16, 24
"""Of a chunk's content: where its unpacked size and its CRC are."""
EVERY = range(12)
Make = Callable[[Log], bytes]


@dataclass(frozen=True)
class Refused:
    """A log of which nothing can be read."""

    name: str
    make: Make
    code: Code


@dataclass(frozen=True)
class Broken:
    """The sound log, broken; times are tenths of a second after 1000 s."""

    name: str
    make: Make
    whole: Sequence[int]
    """Whose messages are read."""
    codes: tuple[str, ...] = ()
    gaps: tuple[tuple[int, int], ...] = ()
    intact: bool = False
    """Whether the log can show that a requirement is satisfied."""


@dataclass(frozen=True)
class Odd:
    """A small log with something rare in it; times are nanoseconds."""

    name: str
    data: bytes
    samples: Sequence[tuple[int, float]]
    codes: tuple[str, ...] = ()
    gaps: tuple[tuple[int, int], ...] = ()
    intact: bool = True


REFUSED = [
    Refused("zero length", lambda s: b"", Code.EMPTY_LOG),
    Refused("magic only", lambda s: s.cut(8), Code.TRUNCATED_LOG),
    Refused("header cut", lambda s: s.cut(12), Code.TRUNCATED_LOG),
    Refused("bad start magic", lambda s: s.poked(0, b"\x88"), Code.NOT_A_LOG),
    Refused("no messages", lambda s: log_of(FLOAT, TOPIC), Code.EMPTY_LOG),
    Refused("channel missing", lambda s: log_of(raw(1, b"", channel=9)), Code.DAMAGED_CHUNK),
]


def _first_chunk_left(name: str, make: Make) -> Broken:
    return Broken(name, make, range(4), ("F403",), ((3, 3),))


def _all_left(name: str, make: Make) -> Broken:
    return Broken(name, make, EVERY, ("F403",), ((11, 11),))


CUT = [
    _first_chunk_left("cut in a chunk", lambda s: s.cut(s.at(CHUNK, 1) + 150)),
    _first_chunk_left("cut in the head of a chunk", lambda s: s.cut(s.at(CHUNK, 1) + 20)),
    Broken("cut after a chunk", lambda s: s.cut(s.after(CHUNK, 1)), range(8), ("F403",), ((7, 7),)),
    Broken("cut in an index", lambda s: s.cut(s.at(INDEX, 1) + 15), range(8), ("F403",), ((7, 7),)),
    _all_left("cut before the end of the data", lambda s: s.cut(s.at(DATA_END))),
    _all_left("cut in the summary", lambda s: s.cut((s.at(DATA_END) + s.at(FOOTER)) // 2)),
    _all_left("cut in the footer", lambda s: s.cut(s.at(FOOTER) + 14)),
    _all_left("no end magic", lambda s: s.data[:-8]),
]


def _without_the_middle(name: str, make: Make) -> Broken:
    return Broken(name, make, (*range(4), *range(8, 12)), ("F404",), ((4, 7),))


def _length(length: int) -> Broken:
    bytes_ = struct.pack("<Q", length)
    return _without_the_middle(f"length {length:#x}", lambda s: s.poked(s.at(CHUNK, 1) + 1, bytes_))


DAMAGED = [
    _without_the_middle("chunk CRC", lambda s: s.flipped(s.content(CHUNK, 1) + CRC)),
    _without_the_middle("bit in a chunk", lambda s: s.flipped(s.content(CHUNK, 1) + 150)),
    _without_the_middle(
        "unpacked size", lambda s: s.poked(s.content(CHUNK, 1) + SIZE, struct.pack("<Q", 2**50))
    ),
    _length(2**60),
    _length(2**63),
    _length(2**64 - 1),
    Broken(
        "zeros from a chunk on",
        lambda s: s.cut(s.at(CHUNK, 1) + 100) + bytes(4096),
        range(4),
        ("F404", "F403"),
        ((4, 7),),
    ),
    Broken("garbage after the end", lambda s: s.data + bytes(37), EVERY, ("F404",)),
    Broken("summary CRC", lambda s: s.flipped(s.content(FOOTER) + 16), EVERY, ("F404",)),
    Broken("kind zero", lambda s: s.put(s.at(DATA_END), bytes(9)), EVERY, ("F404",), ((11, 11),)),
    Broken(
        "chunk index beyond the file",
        lambda s: s.resummed(s.content(Opcode.CHUNK_INDEX) + 16, struct.pack("<Q", 10**6)),
        EVERY,
        ("F404",),
        ((0, 3),),
    ),
    Broken(
        "kinds of a vendor, nothing counted",  # one of them may have been a chunk
        lambda s: ended(s.cut(s.at(DATA_END)) + VENDOR),
        EVERY,
        ("F404", "F404"),
        ((11, 11),),
    ),
]

SOUND = [
    Broken("sound", lambda s: s.data, EVERY, intact=True),
    Broken(
        "no chunk CRC",
        lambda s: s.poked(s.content(CHUNK, 1) + CRC, bytes(4)),
        EVERY,
        codes=("F415",),
        intact=True,
    ),
    Broken("no summary", lambda s: ended(s.cut(s.at(DATA_END))), EVERY, intact=True),
    Broken("no message index", lambda s: ended(_without(s, INDEX)), EVERY, intact=True),
    Broken(
        "kinds of a vendor, counted", lambda s: s.put(s.at(DATA_END), VENDOR), EVERY, intact=True
    ),
]

NAN = float("nan")
ODD = [
    Odd("unchunked", log_of(FLOAT, TOPIC, message(1, 0.5), message(2, 1.5), chunked=False),
        [(1, 0.5), (2, 1.5)], ("F415",)),
    Odd("out of order", log_of(FLOAT, TOPIC, *(message(t, t / 2) for t in (5, 3, 9, 1))),
        [(1, 0.5), (3, 1.5), (5, 2.5), (9, 4.5)], ("F411",)),
    Odd("equal times", log_of(FLOAT, TOPIC, *(message(5, v) for v in (2.0, 3.0, 1.0))),
        [(5, 2.0), (5, 3.0), (5, 1.0)]),
    Odd("time 0 and the largest", log_of(FLOAT, TOPIC, message(0, 0.5), message(2**64 - 1, 1.5)),
        [(0, NAN)], ("F416", "F404"), ((0, 0),), intact=False),
    Odd("a log that begins at time 0", log_of(FLOAT, TOPIC, message(0, 0.5), message(9, 1.5)),
        [(0, 0.5), (9, 1.5)]),
    Odd("empty payload", log_of(FLOAT, TOPIC, message(1, 0.5), raw(2, b"")),
        [(1, 0.5), (2, NAN)], ("F412",)),
    Odd("short payload", log_of(FLOAT, TOPIC, message(1, 0.5), raw(2, LITTLE)),
        [(1, 0.5), (2, NAN)], ("F412",)),
    Odd("big-endian CDR", log_of(FLOAT, TOPIC, raw(1, BIG + struct.pack(">d", 0.5))), [(1, 0.5)]),
    Odd("schemaless", log_of(Channel(1, "/x", "cdr", {}, 0), message(1, 0.5)), [], ("F408",)),
    Odd("channel missing for one of two",
        log_of(FLOAT, TOPIC, message(1, 0.5), raw(2, b"", channel=9), message(3, 1.5)),
        [(1, 0.5), (3, 1.5)], ("F404",), ((1, 3),), intact=False),
]  # fmt: skip
