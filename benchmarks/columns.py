"""Columns of a log against what they cost at least, and against other readers.

    python -m benchmarks.columns LOG... [--peers] [--check]

The columns: the least range of `/scan` within its limits, `linear.x` of `/cmd_vel`, and the two
speeds of `/odom`, each with its times. The floor is what nobody can leave out: the needed bytes are
read, the needed beginnings of chunks unpacked, and the least of each scan taken; nothing is parsed.
Where the log has images, their heights are read too, and then the floor reads and unpacks them.
`python -m benchmarks.logs` writes such logs.

Medians of seven rounds, in each of which all are run in turn, as multiples of the floor: CPU time
of all threads, that of the first thread, and the wall clock. The limits are for the wall clock on
two idle cores: a second thread hashes.
Memory is the peak above the interpreter with everything imported, in a process of its own.
`--check` fails where a limit is exceeded.
"""

from __future__ import annotations

import argparse
import importlib
import subprocess
import sys
import tempfile
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from mcap.reader import make_reader
from mcap.records import ChunkIndex
from mcap_ros1.decoder import DecoderFactory as Ros1
from mcap_ros2.decoder import DecoderFactory as Ros2

from benchmarks.figures import RUNS, Figure
from benchmarks.logs import Options, record
from benchmarks.timing import costs
from compiler.project.folder import load
from fretc.audit.many_logs import AuditOutcome, audit_logs
from fretc.audit.plan import Plan, planned
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Recording
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source

HERE = Path(__file__).parent / "job"
"""Three requirements and their bindings."""
TOPICS = ("/scan", "/cmd_vel", "/odom")
IMAGES = "/camera/image_raw"
LONGEST = {IMAGES: 2**21}
"""Bytes of the longest message of a topic, and some more."""
_LONGEST = 8192
LIMITS = {"columns, index": 1.5, "audit, hash": 2.0, "images, index": 2.0}
"""Times the floor, by the wall clock."""


def declarations(more: str = "") -> Declarations:
    text = (HERE / "bindings.toml").read_text("utf-8") + more
    found, wrong = read_bindings(Source("job", text))
    assert found is not None, wrong
    return found


# The floor


def floor(path: str, topics: Collection[str] = TOPICS) -> Callable[[], None]:
    """What nobody can leave out."""
    with Path(path).open("rb") as stream:
        summary = make_reader(stream).get_summary()
        assert summary is not None
        wanted = {
            id: LONGEST.get(channel.topic, _LONGEST)
            for id, channel in summary.channels.items()
            if channel.topic in topics
        }
        parts = [part for chunk in summary.chunk_indexes if (part := _part(stream, chunk, wanted))]
    scans = np.random.default_rng(1).random((_count(summary), 720), np.float32)
    target = memoryview(bytearray(max(size for *_, size in parts)))
    source = memoryview(bytearray(max(length for _, _, length, _ in parts)))

    def once() -> None:
        with Path(path).open("rb") as stream:
            for compression, at, length, size in parts:
                stream.seek(at)
                stream.readinto(source[:length])
                _unpack(compression, source[:length], target[:size])
        scans.min(axis=1)

    return once


def _count(summary: Any) -> int:
    counts = summary.statistics.channel_message_counts
    return sum(counts.get(id, 0) for id, c in summary.channels.items() if c.topic == "/scan")


def _part(
    stream: Any, chunk: ChunkIndex, wanted: Mapping[int, int]
) -> tuple[str, int, int, int] | None:
    """Compression, place and length of what must be read of a chunk, and how much it unpacks to."""
    last = -1
    for id in wanted.keys() & chunk.message_index_offsets.keys():
        stream.seek(chunk.message_index_offsets[id] + 11)
        entries = stream.read(int.from_bytes(stream.read(4), "little"))
        last = max(last, int(np.frombuffer(entries, "<u8")[1::2].max()) + wanted[id])
    if last < 0:
        return None
    size = min(chunk.uncompressed_size, last)
    blocks = -(-size // 2**17) * 2**17
    length = chunk.compressed_size
    if size < chunk.uncompressed_size:
        share = int(blocks * chunk.compressed_size / chunk.uncompressed_size * 1.3) + 2**14
        length = min(length, share if chunk.compression else size)
    at = chunk.chunk_start_offset + 49 + len(chunk.compression)
    return chunk.compression, at, length, size


_ZSTD = zstandard.ZstdDecompressor()


def _unpack(compression: str, packed: memoryview, target: memoryview) -> None:
    if compression == "zstd":
        with _ZSTD.stream_reader(packed) as stream:
            done = 0
            while done < len(target) and (more := stream.readinto(target[done:])):
                done += more
    elif compression == "lz4":
        import lz4.frame

        lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=len(target))


# Readers


def ours(path: str, found: Declarations, integrity: Integrity) -> Recording:
    recording = read(path, found, tuple(found.signals), integrity)
    assert isinstance(recording, Recording), recording.message
    return recording


def official(path: str) -> list[list[float]]:
    """With the official library and its decoders."""
    columns: list[list[float]] = [[], [], [], []]
    with Path(path).open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[Ros2(), Ros1()])
        for _, channel, _, message in reader.iter_decoded_messages(topics=TOPICS):
            _take(columns, channel.topic, message)
    return columns


def rosbags(path: str) -> list[list[float]]:
    """With rosbags, the fastest reader with a permissive licence that needs no code of ours."""
    from rosbags.rosbag2.storage_mcap import McapReader
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    columns: list[list[float]] = [[], [], [], []]
    reader = McapReader(Path(path))
    reader.open()
    store = get_typestore(Stores.ROS2_JAZZY)
    for one in reader.connections:
        store.register({k: v for k, v in get_types_from_msg(one.msgdef.data, one.msgtype).items()
                        if k not in store.fielddefs})  # fmt: skip
    chosen = [one for one in reader.connections if one.topic in TOPICS]
    for connection, _, data in reader.messages(chosen):
        _take(columns, connection.topic, store.deserialize_cdr(data, connection.msgtype))
    reader.close()
    return columns


def _take(columns: list[list[float]], topic: str, message: Any) -> None:
    if topic == "/scan":
        ranges = np.array(message.ranges, np.float32)
        valid = (ranges >= message.range_min) & (ranges <= message.range_max)
        columns[0].append(float(ranges[valid].min()))
    elif topic == "/cmd_vel":
        columns[1].append(message.linear.x)
    else:
        columns[2].append(message.twist.twist.linear.x)
        columns[3].append(message.twist.twist.angular.z)


def same(recording: Recording, columns: list[list[float]]) -> bool:
    """Whether both have read the same."""
    mine = [recording.samples[name].base for name in ("min_range", "v", "vx", "wz")]
    return all(np.array_equal(a, np.array(b)) for a, b in zip(mine, columns, strict=True))


# The audit, and memory


def plan(integrity: Integrity) -> Plan:
    made = planned(load([str(HERE / "r.fret")], str(HERE / "bindings.toml")), integrity=integrity)
    assert isinstance(made, Plan), made
    return made


def audited(path: str, judged: Plan) -> AuditOutcome:
    audit = audit_logs(judged, [path])
    assert isinstance(audit, AuditOutcome), audit.message
    assert audit.read == 1
    return audit


def memory(path: str, what: str) -> float:
    """MB above the interpreter, in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.columns", path, "--peak", what]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def peak(path: str, what: str) -> float:
    """MB by which this process grows for a log, from when everything is imported."""
    found, judged = declarations(), plan(Integrity.HASH)
    use: Callable[[str], object] = {
        "columns": lambda log: ours(log, found, Integrity.INDEX),
        "audit": lambda log: audited(log, judged),
    }[what]
    for name in ("lz4.frame", "concurrent.futures", "hashlib", "json"):
        importlib.import_module(name)
    before = _most()
    use(path)
    return _most() - before


def _most() -> float:
    """MB of memory that this process has had at most; that of its parent does not count."""
    (line,) = (
        line
        for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        if "VmHWM" in line
    )
    return int(line.split()[1]) / 1024


# What is printed


def measured(path: str, *, peers: bool) -> list[str]:
    """Print the figures of one log; gives the rows that exceed their limit."""
    found, pictured = declarations(), declarations(PICTURED)
    runs: dict[str, Callable[[], object]] = {"floor": floor(path)}
    for integrity in Integrity:
        runs[f"columns, {integrity}"] = partial(ours, path, found, integrity)
    for integrity in Integrity:
        runs[f"audit, {integrity}"] = partial(audited, path, plan(integrity))
    if IMAGES in ours(path, found, Integrity.INDEX).topics:
        runs["floor of images"] = floor(path, (*TOPICS, IMAGES))
        for integrity in (Integrity.INDEX, Integrity.HASH):
            runs[f"images, {integrity}"] = partial(ours, path, pictured, integrity)
    taken = costs(runs)
    if peers:
        recording = ours(path, found, Integrity.INDEX)
        for reader in (official, rosbags):
            assert same(recording, reader(path)), reader
            taken |= costs({reader.__name__: partial(reader, path)}, 1)
    print(f"{path}: {Path(path).stat().st_size / 1e6:.0f} MB")
    print(f"  {'':<17} {'CPU':>10} {'x floor':>8} {'first thread':>13} {'wall clock':>11}  limit")
    too_slow = []
    for name, cost in taken.items():
        least = taken["floor of images" if "images" in name else "floor"]
        share, limit = cost.wall / least.wall, LIMITS.get(name)
        print(
            f"  {name:<17} {cost.cpu:8.4f} s {cost.cpu / least.cpu:8.1f} "
            f"{cost.main / least.cpu:13.1f} {share:11.1f}  {limit or ''}"
        )
        if limit is not None and share > limit:
            too_slow.append(f"{path}: {name}")
    for what in ("columns", "audit"):
        print(f"  memory of {what:<16} {memory(path, what):8.1f} MB")
    return too_slow


def figures() -> Iterator[Figure]:
    """A log of ten minutes without a camera, and one of half a minute with one."""
    found, pictured, judged = declarations(), declarations(PICTURED), plan(Integrity.HASH)
    with tempfile.TemporaryDirectory() as folder:
        plain, camera = (str(Path(folder, name)) for name in ("plain.mcap", "camera.mcap"))
        record(Path(plain), Options())
        record(Path(camera), Options(seconds=30, camera=True))
        rows: Mapping[str, tuple[str, Collection[str], Callable[[], object]]] = {
            "columns, index": (plain, TOPICS, partial(ours, plain, found, Integrity.INDEX)),
            "audit, hash": (plain, TOPICS, partial(audited, plain, judged)),
            "images, index": (
                camera, (*TOPICS, IMAGES), partial(ours, camera, pictured, Integrity.INDEX),
            ),
        }  # fmt: skip
        for name, (path, topics, run) in rows.items():
            taken = costs({"floor": floor(path, topics), "run": run}, RUNS)
            value = taken["run"].wall / taken["floor"].wall
            yield Figure(f"log: {name}", value, "x reading and inflating", LIMITS[name])


PICTURED = f"""
[signal.height]
path = "{IMAGES}.height"
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="+")
    parser.add_argument("--peers", action="store_true", help="ROS 2 only")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--peak", choices=("columns", "audit"), help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.peak:
        print(peak(chosen.logs[0], chosen.peak))
        return
    slow = [row for log in chosen.logs for row in measured(log, peers=chosen.peers)]
    if chosen.check and slow:
        raise SystemExit(f"above its limit: {', '.join(slow)}")


if __name__ == "__main__":
    main()
