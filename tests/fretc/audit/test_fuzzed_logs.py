"""Logs cut anywhere, and with any byte changed: a log of which anything is lost satisfies nothing.

A few cuts and changed bytes of each kind of log; `--hypothesis-profile=full`: 200.
"""

import tracemalloc
from dataclasses import dataclass
from functools import cache
from io import BytesIO
from operator import itemgetter
from pathlib import Path
from typing import Any

import mcap_ros1.decoder
import mcap_ros2.decoder
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType, IndexType

from compiler.project import folder as project
from compiler.targets.python.monitor import text
from fretc.audit.one_log import MonitoredRequirement, audit
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.loading import load
from tests.effort import FULL, some
from tests.fretc.logs.logs import LZ4, MS, NONE, ZSTD, S, Sent, number, payload, scan, write

MANY = settings(max_examples=200 if FULL else 2)
BINDINGS = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.x]
path = "/x.data"
unit = "m"
max_age = "150 ms"

[signal.nearest]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
reduce = "min"
unit = "m"
valid = "range_min <= x and x <= range_max"
max_age = "150 ms"

[proposition.near]
expr = "nearest < 1 m"

[proposition.slow]
expr = "x < 20 cm"
"""
REQUIREMENTS = """+++
id = "R1"
+++
whenever near the sw shall within 200 milliseconds satisfy slow

+++
id = "R2"
+++
whenever slow the sw shall immediately satisfy (near | !near)
"""
NAN = float("nan")
MOST = 64 * 2**20
"""Bytes of memory; the logs have some 10 kB. A changed size may say that a chunk of 1 kB unpacks to
50 000 times as much, and a changed time may make many ticks."""


@dataclass(frozen=True)
class Kind:
    """One way to record the run."""

    encoding: str
    compression: CompressionType
    chunked: bool = True
    crcs: bool = True
    summary: bool = True

    def __str__(self) -> str:
        words = [self.encoding, self.compression.name.lower()]
        words += ["chunked" if self.chunked else "unchunked", "CRC" if self.crcs else "no CRC"]
        return ", ".join(words if self.summary else [*words, "no summary"])


KINDS = [
    Kind("cdr", ZSTD),
    Kind("cdr", LZ4),
    Kind("cdr", NONE),
    Kind("cdr", NONE, chunked=False),
    Kind("cdr", ZSTD, crcs=False),
    Kind("cdr", LZ4, crcs=False),
    Kind("cdr", NONE, crcs=False),
    Kind("cdr", NONE, chunked=False, crcs=False),
    Kind("cdr", ZSTD, summary=False),
    Kind("cdr", NONE, crcs=False, summary=False),
    Kind("ros1", ZSTD),
    Kind("ros1", NONE, chunked=False, crcs=False),
]


def run(encoding: str) -> list[Sent]:
    """Four seconds in which a robot comes near to something three times, and slows down."""
    sent: list[Sent] = []
    note = "std_msgs/msg/String" if encoding == "cdr" else "std_msgs/String"
    text = payload(note, encoding, data="all is well " * 40)
    for tick in range(40):
        time, phase = 1000 * S + tick * 100 * MS, tick % 13
        distance = 1.35 - 0.1 * phase
        sent.append(scan([distance + 0.01 * i for i in range(24)], time, encoding=encoding))
        sent.append(number(0.05 if distance < 1 else 0.5, time + 10 * MS, "/x", encoding))
        if tick % 4 == 3:  # large, not bound, and the last one of its chunk
            sent.append(Sent("/note", note, text, time + 20 * MS, encoding=encoding))
    return sent


@dataclass(frozen=True)
class Known:
    """A sound log, and what is in it."""

    data: bytes
    columns: Any


class Bench:
    """A folder with requirements, in which logs are audited."""

    def __init__(self, folder: Path) -> None:
        self.log = folder / "run.mcap"
        (folder / "r.fret").write_text(REQUIREMENTS, "utf-8")
        (folder / "bindings.toml").write_text(BINDINGS, "utf-8")
        self.project = project.load([str(folder / "r.fret")], str(folder / "bindings.toml"))
        assert not self.project.diagnostics
        monitors = [
            load(f"{requirement.id}_monitor", text(requirement))
            for requirement in self.project.formalized
        ]
        self.watched = [MonitoredRequirement(monitor, {}) for monitor in monitors]
        self.known = cache(self._known)

    @property
    def declarations(self) -> Declarations:
        assert self.project.declarations is not None
        return self.project.declarations

    def _known(self, kind: Kind) -> Known:
        write(
            self.log,
            run(kind.encoding),
            compression=kind.compression,
            chunked=kind.chunked,
            per_chunk=9,
            crcs=kind.crcs,
            data_crcs=kind.crcs,
            statistics=kind.summary,
            index=IndexType.ALL if kind.summary else IndexType.NONE,
        )
        data = self.log.read_bytes()
        verdicts, recording = self.audit(data)
        assert recording is not None
        assert verdicts == ["satisfied", "satisfied"]
        assert columns(recording) == official(data, kind.encoding)
        return Known(data, columns(recording))

    def audit(self, data: bytes) -> tuple[list[str], Recording | None]:
        """The verdicts, and what was read; nothing of a log that cannot be read."""
        self.log.write_bytes(data)
        declared = self.declarations
        recording = read(str(self.log), declared, list(declared.signals))
        if isinstance(recording, Diagnostic):
            return [], None
        return [
            evidence.verdict for evidence in audit(recording, declared, self.watched)
        ], recording

    def check(self, kind: Kind, data: bytes) -> list[str]:
        """What holds for whatever was done to a log of that kind; gives the verdicts."""
        tracemalloc.start()
        verdicts, recording = self.audit(data)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        ticks = 0 if recording is None else (recording.end_ns - recording.start_ns) // (100 * MS)
        assert peak < MOST + 64 * ticks
        if recording is not None and "satisfied" in verdicts:
            read, expected = columns(recording), self.known(kind).columns
            if kind.crcs:
                assert read == expected
            elif read != expected:  # nobody can see a changed number there
                agree(read, official(data, kind.encoding) or expected)
        return verdicts


def columns(recording: Recording) -> Any:
    """Times and values of all signals; NaN is equal to itself."""
    samples = recording.samples.items()
    return {
        name: [*zip(s.times.tolist(), map(repr, s.values.tolist()), strict=True)]
        for name, s in samples
    }


def agree(read: Any, expected: Any) -> None:
    """No message is lost or made up, and each number is as expected, or unknown."""
    for name, column in read.items():
        if column:
            assert [time for time, _ in column] == [time for time, _ in expected[name]]
            pairs = zip(column, expected[name], strict=True)
            assert all(ours[1] in ("nan", theirs[1]) for ours, theirs in pairs)


def official(data: bytes, encoding: str) -> Any:
    """What the official reader and decoders find in a log; None where it cannot be read."""
    decode = mcap_ros2.decoder if encoding == "cdr" else mcap_ros1.decoder
    factory = decode.DecoderFactory()
    by_topic: dict[str, list[tuple[int, str]]] = {"x": [], "nearest": []}
    try:
        messages = list(NonSeekingReader(BytesIO(data), validate_crcs=True).iter_messages())
    except Exception:  # each codec has its own
        return None
    for schema, channel, message in messages:
        name = {"/x": "x", "/scan": "nearest"}.get(channel.topic)
        if name is None:
            continue
        try:
            decoded = factory.decoder_for(channel.message_encoding, schema)(message.data)
        except Exception:  # whatever it is: the message says nothing
            decoded = None
        by_topic[name].append((message.log_time, repr(sample(decoded))))
    return {name: sorted(samples, key=itemgetter(0)) for name, samples in by_topic.items()}


def sample(decoded: Any) -> float:
    """What a signal reads in a message; NaN is unknown."""
    if decoded is None or hasattr(decoded, "data"):
        return float(decoded.data) if decoded else NAN
    least, most = decoded.range_min, decoded.range_max
    return float(min((r for r in decoded.ranges if least <= r <= most), default=NAN))


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return Bench(tmp_path_factory.mktemp("fuzz"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", some(KINDS, 2), ids=str)
@MANY
@given(draw=st.data())
def test_a_log_that_is_cut_satisfies_nothing(bench: Bench, kind: Kind, draw: Any) -> None:
    data = bench.known(kind).data
    cut = draw.draw(st.integers(0, len(data) - 1), "cut at")
    assert "satisfied" not in bench.check(kind, data[:cut])


@pytest.mark.slow
@pytest.mark.parametrize("kind", some(KINDS, 2, 1), ids=str)
@MANY
@given(draw=st.data())
def test_a_log_with_a_changed_byte_satisfies_nothing_that_is_not_in_it(
    bench: Bench, kind: Kind, draw: Any
) -> None:
    data = bench.known(kind).data
    at = draw.draw(st.integers(0, len(data) - 1), "byte")
    change = draw.draw(st.integers(1, 255), "changed by")
    bench.check(kind, data[:at] + bytes([data[at] ^ change]) + data[at + 1 :])
