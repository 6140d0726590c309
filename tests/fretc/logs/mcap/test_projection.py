import random
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from mcap.records import Message

from fretc.logs import extraction
from fretc.logs import topic_columns as columns
from fretc.logs.mcap import projection
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import FULL, examples, some
from tests.fretc.logs.logs import MS, NONE, S, Sent, declare, scan, write
from tests.fretc.logs.pieces import BETWEEN, PACK, Piece, built

CLOCKS = ("log_time", "publish_time", "header.stamp")


def bindings(clock: str = "log_time") -> str:
    return f"""
[clock]
time = "{clock}"
tick = "100 ms"

[signal.x]
path = "/x.data"

[signal.y]
path = "/y.data"

[signal.nearest]
path = "/scan.ranges[:]"
reduce = "min"
unit = "m"
valid = "range_min <= x and x <= range_max"
"""


DECLARED = {clock: declare(bindings(clock)) for clock in CLOCKS}
BY_INDEX = (Integrity.INDEX, Integrity.HASH)


def float_of(channel: int, time: int, value: float, published: int | None = None) -> Message:
    data = b"\x00\x01\x00\x00" + struct.pack("<d", value)
    return Message(channel, time, data, time if published is None else published, 0)


def scan_of(time: int, ranges: Sequence[float], stamp: int) -> Message:
    return Message(4, time, scan(ranges, time, stamp=stamp).payload, time, 0)


def image(time: int, size: int, seed: int = 0) -> Message:
    """A large message that nobody asks for; its bytes do not compress."""
    data = random.Random(seed).randbytes(size)
    return Message(5, time, b"\x00\x01\x00\x00" + struct.pack("<I", size) + data, time, 0)


def either(path: Path, integrity: Integrity, clock: str = "log_time") -> Recording | Diagnostic:
    return read(str(path), DECLARED[clock], ["x", "y", "nearest"], integrity)


def whole(path: Path, integrity: Integrity, clock: str = "log_time") -> Recording:
    found = either(path, integrity, clock)
    assert isinstance(found, Recording), found
    return found


def facts(recording: Recording) -> dict[str, Any]:
    """All that a verdict can depend on, bit by bit."""
    return {
        "samples": {
            name: (some.times.tolist(), some.values.tobytes())
            for name, some in recording.samples.items()
        },
        "gaps": recording.gaps,
        "span": (recording.start_ns, recording.end_ns),
        "ticks": recording.ticks.tolist(),
        "nearest": recording.nearest,
        # That no CRC covers what was read depends on what was read, and no verdict on that.
        "findings": [f for f in recording.findings if f.code is not Code.BAG_FORMAT],
        "intact": recording.intact,
        "counts": {name: topic.count for name, topic in recording.topics.items()},
        "topics": {name: recording.topics[name] for name in ("/x", "/y", "/scan")},
    }


# Any log


TIMES = st.integers(0, 40).map(lambda tenth: 1000 * S + tenth * 100 * MS)
NUMBERS = st.sampled_from([0.0, -0.0, 1.5, float("nan"), float("inf"), -7.25])
FLOATS = st.builds(
    float_of, st.sampled_from([1, 2, 3]), TIMES, NUMBERS, st.one_of(st.none(), st.just(0), TIMES)
)
RANGES = st.lists(st.sampled_from([0.05, 0.5, 2.0, 20.0, float("inf")]), max_size=6)
SCANS = st.builds(scan_of, TIMES, RANGES, st.one_of(st.just(0), TIMES))
IMAGES = st.builds(image, TIMES, st.sampled_from([0, 1, 300, 9000, 200_000]))
ODD = st.builds(
    lambda channel, time, data: Message(channel, time, data, time, 0),
    st.sampled_from([1, 3, 4]),
    TIMES,
    st.sampled_from([b"", b"\x00\x01\x00\x00", b"\x00\x00\x00\x00" + bytes(8), bytes(5000)]),
)
MESSAGES = st.lists(st.one_of(FLOATS, SCANS, IMAGES, ODD), min_size=1, max_size=12)


@st.composite
def pieces(draw: st.DrawFn, *, plain: bool = False) -> list[Piece]:
    """In `plain` logs nothing is that is not in an index."""
    found = []
    for messages in draw(st.lists(MESSAGES, min_size=1, max_size=6)):
        compression, crc = draw(st.sampled_from(sorted(PACK))), draw(st.booleans())
        after = draw(st.lists(st.sampled_from(sorted(BETWEEN)), max_size=2))
        shuffled, declares = draw(st.booleans()), draw(st.booleans())
        chunked = plain or draw(st.integers(0, 5)) > 0
        found.append(Piece(messages, compression, crc, chunked, shuffled, declares, tuple(after)))
    if not plain and draw(st.integers(0, 4)) == 0:
        found.insert(
            draw(st.integers(0, len(found))), Piece([], draw(st.sampled_from(["", "lz4"])))
        )
    return found


@pytest.mark.slow
@settings(examples(10), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    pieces(),
    st.sampled_from(CLOCKS),
    st.fixed_dictionaries(
        {name: st.booleans() for name in ("padded", "data_crc", "summary_crc", "outside")}
    ),
)
def test_by_its_index_a_sound_log_is_read_as_record_by_record(
    tmp_path: Path, pieces: list[Piece], clock: str, options: dict[str, bool]
) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(bytes(built(pieces, **options).data))
    full = facts(whole(path, Integrity.FULL, clock))
    for integrity in BY_INDEX:
        found = whole(path, integrity, clock)
        assert facts(found) == full
        if found.checked.by_index:
            assert all(piece.chunked and piece.messages for piece in pieces)


UNSET = [image(1000 * S, 0), float_of(1, 1000 * S + 10**8, 0.0, 0)]
"""The bound topic has no publish time, another one has."""


@pytest.mark.slow
@settings(
    max_examples=2000 if FULL else 8, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@example([Piece(UNSET, crc=False, declares=False)], "publish_time", 1, 1, 1)
@given(
    pieces(),
    st.sampled_from(CLOCKS),
    st.integers(1, 4),
    st.sampled_from([1, 3, 1024]),
    st.sampled_from([1, 2**22]),
)
def test_how_many_messages_are_read_at_once_makes_no_difference(
    tmp_path: Path, pieces: list[Piece], clock: str, most: int, enough: int, size: int
) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(bytes(built(pieces).data))
    expected = facts(whole(path, Integrity.FULL, clock))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(columns, "_MOST", most)
        patch.setattr(columns, "_ENOUGH", enough)
        patch.setattr(projection, "SIZE", size)
        patch.setattr(extraction, "_FEW", 0)
        for integrity in Integrity:
            assert facts(whole(path, integrity, clock)) == expected


def test_the_logs_of_these_tests_are_read_by_their_index(tmp_path: Path) -> None:
    path = tmp_path / "log.mcap"
    messages = [float_of(1, 1000 * S, 0.5), float_of(2, 1000 * S, 0.25), image(1001 * S, 9000)]
    for compression in PACK:
        for options in ({}, {"padded": True}, {"data_crc": True}, {"summary_crc": False}):
            several = [Piece(messages, compression, after=["attachment", "metadata"])] * 3
            path.write_bytes(bytes(built(several, **options).data))
            found = whole(path, Integrity.HASH)
            assert found.checked.by_index
            assert len(found.samples["x"].values) == 6


def test_a_message_outside_of_the_time_that_its_chunk_states_is_seen(tmp_path: Path) -> None:
    times = ((1000, 1001), (1003, 1006), (1008, 1009))
    pieces = [Piece([float_of(1, time * S, 0.5) for time in some]) for some in times]
    log, span = bytes(built(pieces, summary_crc=False).data), struct.pack("<QQ", 1003 * S, 1006 * S)
    assert log.count(span) == 2  # in the chunk, and in its index
    path = tmp_path / "log.mcap"
    path.write_bytes(log)
    assert whole(path, Integrity.HASH).checked.by_index
    for first, last in ((1003 * S, 1006 * S - 1), (1003 * S + 1, 1006 * S)):
        path.write_bytes(log.replace(span, struct.pack("<QQ", first, last)))
        assert not whole(path, Integrity.HASH).checked.by_index


# Which chunks are unpacked, and how far


X, Y = float_of(1, 1000 * S, 0.5), float_of(3, 1000 * S, 1.5)
BIG = image(1000 * S, 400_000)


@pytest.mark.parametrize("compression", sorted(PACK))
@pytest.mark.parametrize(
    ("messages", "checked", "unchecked", "skipped"),
    [
        ([X, Y], 1, 0, 0),
        ([X, BIG], 0, 1, 0),
        ([X, BIG, Y], 1, 0, 0),
        ([BIG, X], 1, 0, 0),
        ([BIG], 0, 0, 1),
        ([X, image(1000 * S, 1)], 1, 0, 0),
    ],
)
def test_a_chunk_is_unpacked_up_to_the_last_message_that_is_wanted(
    tmp_path: Path,
    compression: str,
    messages: list[Message],
    checked: int,
    unchecked: int,
    skipped: int,
) -> None:
    path = tmp_path / "log.mcap"
    # One more chunk, so that something is to be read in each log.
    path.write_bytes(bytes(built([Piece([X]), Piece(messages, compression)]).data))
    found = whole(path, Integrity.HASH)
    assert found.checked.by_index
    assert found.checked.crc_checked == checked + 1
    assert found.checked.crc_unchecked == unchecked
    assert found.checked.skipped == skipped
    assert facts(found) == facts(whole(path, Integrity.FULL))


@pytest.mark.slow
@pytest.mark.parametrize("compression", sorted(PACK))
def test_a_message_that_is_longer_than_any_before_is_read_whole(
    tmp_path: Path, compression: str
) -> None:
    near = [1.0] * 40_000
    ranges = [[2.0], [3.0], [*near, 0.5], [4.0], [*near, 0.25], [5.0]]
    pieces = [
        Piece([scan_of((1000 + i) * S, some, 0), image((1000 + i) * S, 900_000)], compression)
        for i, some in enumerate(ranges)
    ]
    path = tmp_path / "log.mcap"
    path.write_bytes(bytes(built(pieces).data))
    found = whole(path, Integrity.HASH)
    assert found.checked.crc_unchecked == 6
    assert found.samples["nearest"].values.tolist() == [2.0, 3.0, 0.5, 4.0, 0.25, 5.0]


@pytest.mark.slow
@pytest.mark.parametrize("compression", some(sorted(PACK), 3, 2))
def test_more_than_fits_into_memory_at_once_is_read_in_order(
    tmp_path: Path, compression: str
) -> None:
    generator = random.Random(7)
    pieces, expected = [], []
    for i in range(60):
        messages = [float_of(generator.choice([1, 2]), (1000 + i) * S + k, k) for k in range(50)]
        expected += [m.data[4:] for m in messages]
        messages.insert(generator.randrange(50), image((1000 + i) * S, 150_000, i))
        pieces.append(Piece(messages, compression, shuffled=True))
    path = tmp_path / "log.mcap"
    path.write_bytes(bytes(built(pieces).data))
    found = whole(path, Integrity.HASH)
    assert found.checked.by_index
    assert found.samples["x"].values.tobytes() == b"".join(expected)


# One byte is another


def flipped(data: bytes, at: int, by: int) -> bytes:
    return data[:at] + bytes([data[at] ^ by]) + data[at + 1 :]


MUTATED = [
    Piece([float_of(1, 1000 * S, 1.0), scan_of(1001 * S, [1.0, 2.0], 1001 * S)]),
    Piece([float_of(3, 1002 * S, 3.0), image(1002 * S, 3000)], after=["metadata"]),
    Piece([image(1003 * S, 20), float_of(2, 1003 * S, 4.0), float_of(1, 1002 * S, 5.0)]),
]


@pytest.mark.slow
@pytest.mark.parametrize(("compression", "clock"), [("", "log_time"), ("zstd", "header.stamp")])
@pytest.mark.parametrize("crc", [True, False])
def test_no_changed_byte_that_a_crc_covers_changes_what_is_read_unseen(
    tmp_path: Path, compression: str, clock: str, crc: bool
) -> None:
    put = built([replace(piece, compression=compression, crc=crc) for piece in MUTATED])
    data, path = bytes(put.data), tmp_path / "log.mcap"
    path.write_bytes(data)
    sound = facts(whole(path, Integrity.HASH, clock))
    assert sound["intact"]
    # The second chunk is unpacked up to its image only, whatever CRC it has.
    unprotected = {*put.packed[1]} if crc else {at for some in put.packed for at in some}
    generator, seen = random.Random(3), 0
    for at in generator.sample(sorted({*range(len(data))} - unprotected), 400 if FULL else 30):
        path.write_bytes(flipped(data, at, generator.randrange(1, 256)))
        found = either(path, Integrity.HASH, clock)
        if isinstance(found, Diagnostic) or not found.intact:
            seen += 1
            continue
        assert facts(found)["samples"] == sound["samples"], at
        assert (found.start_ns, found.end_ns, found.gaps) == (*sound["span"], ()), at
    assert seen


def test_a_changed_length_in_a_chunk_without_crc_is_seen_by_the_index(tmp_path: Path) -> None:
    """Protobuf and JSON may be read in part, and CDR with more behind it: no decoder complains."""
    data = b'{"v": 1} ' + bytes(8).replace(b"\0", b" ")
    sent = [Sent("/j", "J", data, i * S, encoding="json") for i in range(1, 9)]
    bound = declare(bindings() + '[signal.v]\npath = "/j.v"\n')
    for last in range(8):
        path = write(tmp_path / "log.mcap", sent, per_chunk=4, compression=NONE, crcs=False)
        log = bytearray(path.read_bytes())
        at = log.index(struct.pack("<HIQ", 1, 0, sent[last].time)) - 8
        log[at] -= 1
        path.write_bytes(log)
        found = read(str(path), bound, ["v"])
        assert isinstance(found, Recording)
        assert any(finding.code.number == "F404" for finding in found.findings), last
        assert not found.intact
