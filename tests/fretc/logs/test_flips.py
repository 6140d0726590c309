"""Logs with one changed byte, each byte in turn: what is not seen is named as what cannot be."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from mcap.opcode import Opcode

from fretc.logs.mcap.container import MAGIC, frames
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Diagnostic
from tests.effort import some
from tests.fretc.logs.logs import LZ4, MS, NONE, S, Sent, codes, declare, number, write

TEXT = """
[clock]
time = "CLOCK"
tick = "100 ms"

[signal.x]
path = "/x.data"

[signal.v]
path = "/json.v"
"""
CHUNK_HEAD = struct.Struct("<QQQII")
LOGGED, PUBLISHED, PAYLOAD = 6, 14, 22
"""The bytes of a message at which its times begin, and its payload."""
SENT = [
    message
    for i in range(2)
    for message in (
        number(1.0 + i, 1000 * S + i * 300 * MS),
        Sent(
            "/json",
            "J",
            b'{"v": %d, "w": 12}' % i,
            1000 * S + (i * 300 + 100) * MS,
            encoding="json",
        ),
        number(9.0, 1000 * S + (i * 300 + 200) * MS, topic="/free"),
    )
]


@dataclass(frozen=True)
class Kind:
    """A log, by how it is written."""

    name: str
    options: dict[str, Any]
    has_crc: bool = False

    def __str__(self) -> str:
        return self.name


KINDS = [
    Kind("as rosbag2 writes it", {"per_chunk": 3, "compression": NONE, "crcs": False}),
    Kind("lz4 without CRC", {"per_chunk": 6, "compression": LZ4, "crcs": False}),
    Kind("with CRC", {"per_chunk": 3, "compression": NONE}, has_crc=True),
    Kind("without chunks", {"chunked": False, "crcs": False}),
]


def unseen(data: bytes) -> Iterator[range]:
    """The bytes that nothing but a CRC checks: of messages their times and payloads.

    The log time of a message in a chunk stands in the index too.
    """
    end = data.rindex(MAGIC)
    for opcode, start, stop in frames(data[len(MAGIC) : end]):
        at = len(MAGIC) + start
        if opcode == Opcode.MESSAGE:
            yield range(at + LOGGED, len(MAGIC) + stop)
        elif opcode == Opcode.CHUNK:
            *_, name = CHUNK_HEAD.unpack_from(data, at)
            inner = at + CHUNK_HEAD.size + name + 8
            if name:  # of packed bytes no place is known: all of them are payload
                yield range(inner, at + stop - start)
                continue
            for kind, first, last in frames(data[inner : at + stop - start]):
                if kind == Opcode.MESSAGE:
                    yield range(inner + first + PUBLISHED, inner + last)


BOTH = (Integrity.HASH, Integrity.FULL)


def columns(recording: Recording) -> Any:
    return (
        {name: (s.times.tolist(), s.values.tobytes()) for name, s in recording.samples.items()},
        recording.ticks.tolist(),
        recording.start_ns,
        recording.end_ns,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "kind", "integrity", "clock"),
    [
        (first, *way)
        for first, way in enumerate(
            [
                *((kind, integrity, "log_time") for kind in KINDS for integrity in BOTH),
                (KINDS[0], Integrity.INDEX, "log_time"),
                (KINDS[0], Integrity.HASH, "publish_time"),
            ]
        )
    ],
    ids=str,
)
def test_a_changed_byte_is_told_or_changes_nothing_or_cannot_be_seen_and_that_is_told(
    tmp_path: Path, first: int, kind: Kind, integrity: Integrity, clock: str
) -> None:
    declared = declare(TEXT.replace("CLOCK", clock))
    path = write(tmp_path / "log.mcap", SENT, **kind.options)
    data = path.read_bytes()
    sound = read(str(path), declared, ["x", "v"], integrity)
    assert isinstance(sound, Recording)
    assert codes(sound) == ([] if kind.has_crc else ["F415"])
    free = set() if kind.has_crc else {at for places in unseen(data) for at in places}
    silent = []
    for at in some(range(len(data)), 30, 3 * first):
        changed = bytearray(data)
        changed[at] ^= 1 << at % 8
        path.write_bytes(changed)
        found = read(str(path), declared, ["x", "v"], integrity)
        if isinstance(found, Diagnostic) or set(codes(found)) - {"F415"}:
            continue
        if columns(found) != columns(sound) and not (at in free and "F415" in codes(found)):
            silent.append(at)
    assert silent == []
