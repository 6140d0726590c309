"""Small logs with chosen contents, and declarations to read them with."""

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer
from rosbags.typesys import Stores, get_typestore

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.source import Source

MS = 10**6
S = 10**9

NONE, LZ4, ZSTD = CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD


@dataclass(frozen=True)
class Sent:
    """One message to be written."""

    topic: str
    type: str
    payload: bytes
    time: int
    published: int | None = None
    encoding: str = "cdr"


SCHEMALESS = ("",)
"""Types that are none: their messages have no definition."""
ENCODINGS = {"protobuf": "protobuf", "idl": "ros2idl"}


@cache
def store(encoding: str) -> Any:
    return get_typestore(Stores.ROS2_JAZZY if encoding == "cdr" else Stores.ROS1_NOETIC)


def payload(type_: str, encoding: str = "cdr", **fields: Any) -> bytes:
    types = store(encoding)
    name = type_ if "/msg/" in type_ else type_.replace("/", "/msg/")
    message = types.types[name](**fields)
    if encoding == "cdr":
        return bytes(types.serialize_cdr(message, name))
    return bytes(types.serialize_ros1(message, name))


@cache
def definition(type_: str, encoding: str) -> bytes:
    name = type_ if "/msg/" in type_ else type_.replace("/", "/msg/")
    text, _ = store(encoding).generate_msgdef(name, ros_version=2 if encoding == "cdr" else 1)
    return str(text).encode()


def write(
    path: Path,
    sent: Sequence[Sent],
    *,
    compression: CompressionType = ZSTD,
    per_chunk: int | None = None,
    chunked: bool = True,
    crcs: bool = True,
    data_crcs: bool = False,
    statistics: bool = True,
    index: IndexType = IndexType.ALL,
    definitions: dict[str, bytes] | None = None,
    metadata: Sequence[tuple[str, dict[str, str]]] = (),
) -> Path:
    """The messages in the order given; `per_chunk` messages make a chunk."""
    with path.open("wb") as stream:
        writer: Any = Writer(
            stream,
            compression=compression,
            use_chunking=chunked,
            enable_crcs=crcs,
            enable_data_crcs=data_crcs,
            use_statistics=statistics,
            index_types=index,
        )
        writer.start()
        for name, values in metadata:
            writer.add_metadata(name, values)
        channels: dict[tuple[str, str], int] = {}
        for i, message in enumerate(sent):
            key = (message.topic, message.type)
            if key not in channels:
                channels[key] = channel(writer, message, definitions or {})
            writer.add_message(
                channels[key],
                message.time,
                message.payload,
                message.time if message.published is None else message.published,
            )
            if per_chunk and (i + 1) % per_chunk == 0:
                writer.flush()
        writer.finish()
    return path


def channel(writer: Any, message: Sent, definitions: dict[str, bytes]) -> int:
    known = definitions.get(message.type)
    encoding = {"cdr": "ros2msg", "ros1": "ros1msg"}.get(message.encoding, "jsonschema")
    if known is None:
        known = definition(message.type, message.encoding) if encoding != "jsonschema" else b"{}"
    if message.type in SCHEMALESS:
        return int(writer.register_channel(message.topic, message.encoding, 0))
    encoding = ENCODINGS.get(message.encoding, encoding)
    schema = writer.register_schema(message.type, encoding, known)
    encoded = "cdr" if message.encoding == "idl" else message.encoding
    return int(writer.register_channel(message.topic, encoded, schema))


def number(value: float, time: int, topic: str = "/x", encoding: str = "cdr") -> Sent:
    type_ = "std_msgs/msg/Float64" if encoding == "cdr" else "std_msgs/Float64"
    data = b"\x00\x01\x00\x00" if encoding == "cdr" else b""
    return Sent(topic, type_, data + struct.pack("<d", value), time, encoding=encoding)


def said(topic: str, time: int, **fields: object) -> Sent:
    """A message in JSON."""
    return Sent(topic, "J", json.dumps(fields).encode(), time, encoding="json")


def header(stamp: int, encoding: str = "cdr") -> Any:
    types = store(encoding).types
    time = types["builtin_interfaces/msg/Time"](*divmod(stamp, S))
    if encoding == "cdr":
        return types["std_msgs/msg/Header"](time, "lidar")
    return types["std_msgs/msg/Header"](7, time, "lidar")


def scan(
    ranges: Sequence[float],
    time: int,
    *,
    stamp: int | None = None,
    encoding: str = "cdr",
    range_min: float = 0.1,
    range_max: float = 10.0,
    angle_min: float = 0.0,
    increment: float = 0.1,
) -> Sent:
    type_ = "sensor_msgs/msg/LaserScan" if encoding == "cdr" else "sensor_msgs/LaserScan"
    data = payload(
        type_,
        encoding,
        header=header(time if stamp is None else stamp, encoding),
        angle_min=angle_min,
        angle_max=angle_min + increment * len(ranges),
        angle_increment=increment,
        time_increment=0.0,
        scan_time=0.1,
        range_min=range_min,
        range_max=range_max,
        ranges=np.array(ranges, np.float32),
        intensities=np.zeros(0, np.float32),
    )
    return Sent("/scan", type_, data, time, encoding=encoding)


@lru_cache(maxsize=512)
def declare(text: str) -> Declarations:
    """The declarations of a bindings file; it has to be right."""
    declarations, wrong = read_bindings(Source("bindings.toml", text))
    assert declarations is not None, wrong
    assert not has_errors(wrong), wrong
    return declarations


X_TEXT = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.x]
path = "/x.data"
unit = "m"
max_age = "250 ms"

[proposition.low]
expr = "x < 5 cm"
agg = "any"
"""

SCAN = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.nearest]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
reduce = "min"
unit = "m"
valid = "range_min <= x and x <= range_max"

[proposition.close]
expr = "nearest < 5 cm"
"""


def recorded(path: Path, declarations: Declarations) -> Recording:
    """What is read of the log, which can be read."""
    recording = read(str(path), declarations, list(declarations.signals))
    assert isinstance(recording, Recording), recording
    return recording


def values(recording: Recording, signal: str) -> list[float]:
    return [float(value) for value in recording.samples[signal].base]


def times(recording: Recording, signal: str) -> list[int]:
    return [int(time) for time in recording.samples[signal].times]


X = declare(X_TEXT)
TWELVE = [number(i / 100, 1000 * S + i * 100 * MS) for i in range(12)]
"""Times 1000.0 s to 1001.1 s, values 0.00 to 0.11."""


def refused(path: Path, text: str = X_TEXT) -> Diagnostic:
    """Why the log cannot be read at all."""
    diagnostic = read(str(path), declare(text), [])
    assert isinstance(diagnostic, Diagnostic), diagnostic
    return diagnostic


def codes(recording: Recording) -> list[str]:
    return [finding.code.number for finding in recording.findings]


def chunk_starts(path: Path) -> list[int]:
    """The bytes at which the chunks begin, by the official reader."""
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return [index.chunk_start_offset for index in summary.chunk_indexes]


def damaged(path: Path, at: int, value: int | None = None) -> None:
    """One byte is another: the value, or all its bits turned over."""
    data = bytearray(path.read_bytes())
    data[at] = data[at] ^ 0xFF if value is None else value
    path.write_bytes(data)
