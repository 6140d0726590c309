"""Many small logs, against what their bytes cost at least and against the mcap library.

    python -m benchmarks.small_logs [LOG] [--count 200] [--requirements FOLDER]
                                   [--command | --nights]

The logs are cut out of one: a second each, from evenly spaced beginnings. The *floor* opens, reads
and hashes each file. The library reads each file and gives its messages, none of them decoded.
CPU time of one process, the least of five after one run to warm up; `--command` also runs
`fretc audit` on one and on two processes: CPU time of all of them, and wall time. `--nights` runs
it only on all logs, again when 12 in a thousand have changed, and again when none has.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from benchmarks.figures import Figure
from benchmarks.fleet import plan
from benchmarks.timing import least
from fretc.audit.many_logs import audit_log
from fretc.audit.store.container import FILE

SECOND = 10**9
LIMITS = {"12 in 1 000 have changed": 0.1, "none has changed": 0.05}
"""What a later night may cost, as a part of the first one."""


def cut(log: Path, count: int, folder: Path) -> list[Path]:
    """As many logs of a second each."""
    with log.open("rb") as stream:
        messages = list(make_reader(stream).iter_messages())
    times = [message.log_time for _, _, message in messages]
    begins = range(times[0], times[-1] - SECOND, (times[-1] - times[0] - SECOND) // count)
    logs = [folder / f"run{number:05}.mcap" for number in range(count)]
    for path, begin in zip(logs, begins, strict=False):
        record(path, messages[bisect_left(times, begin) : bisect_left(times, begin + SECOND)])
    return logs


def record(path: Path, messages: Sequence[Any]) -> None:
    """Write some messages as a log of their own."""
    with path.open("wb") as stream:
        writer: Any = Writer(stream, compression=CompressionType.ZSTD)
        writer.start("ros2", "fretc-benchmark")
        schemas: dict[int, int] = {}
        channels: dict[int, int] = {}
        for schema, channel, message in messages:
            if schema.id not in schemas:
                definition = schema.name, schema.encoding, schema.data
                schemas[schema.id] = writer.register_schema(*definition)
            if channel.id not in channels:
                topic = channel.topic, channel.message_encoding, schemas[schema.id]
                channels[channel.id] = writer.register_channel(*topic)
            stamps = message.publish_time, message.sequence
            writer.add_message(channels[channel.id], message.log_time, message.data, *stamps)
        writer.finish()


def floor(logs: Sequence[Path]) -> None:
    for log in logs:
        hashlib.sha256(log.read_bytes()).hexdigest()


def library(logs: Sequence[Path]) -> None:
    for log in logs:
        with log.open("rb") as stream:
            for _ in make_reader(stream).iter_messages():
                pass


def command(requirements: str, logs: Path, jobs: int) -> tuple[float, float]:
    """Seconds of processors, and of the clock."""
    out = str(logs.parent / f"evidence-{jobs}")
    arguments = ["--requirements", requirements, "--jobs", str(jobs), "-o", out]
    before, start = os.times(), time.perf_counter()
    fretc = [str(Path(sys.executable).with_name("fretc")), "audit", str(logs), *arguments]
    done = subprocess.run(fretc, check=False, capture_output=True)
    assert Path(out, FILE).exists(), done.stderr  # 2: some logs lack a topic
    after = os.times()
    used = after.children_user + after.children_system
    return used - before.children_user - before.children_system, time.perf_counter() - start


def rows(logs: Sequence[Path], requirements: str) -> Iterator[tuple[str, float]]:
    """What is measured, and its seconds for all logs."""
    judged = plan(requirements)
    yield "floor: read and hash", least(lambda: floor(logs))
    yield "mcap: messages", least(lambda: library(logs))
    yield "fretc: audit", least(lambda: [audit_log(judged, str(log)) for log in logs])


def nights(requirements: str, paths: Sequence[Path]) -> Iterator[tuple[str, float, float]]:
    """Each night, with its seconds of processors and of the clock."""
    logs, jobs = paths[0].parent, os.cpu_count() or 1
    changed = len(paths) * 12 // 1000
    time.sleep(2.1)  # until the times of the logs identify them
    yield "first night", *command(requirements, logs, jobs)
    for path, other in zip(paths[:changed], paths[changed:], strict=False):
        path.write_bytes(other.read_bytes())
    time.sleep(2.1)
    for name in LIMITS:
        yield name, *command(requirements, logs, jobs)


def print_nights(requirements: str, paths: Sequence[Path]) -> None:
    (_, *first), *later = nights(requirements, paths)
    print(f"  {'first night':26} {first[0]:6.2f} s of CPU, {first[1]:6.2f} s of wall")
    for name, *taken in later:
        cpu, wall = (now / before for now, before in zip(taken, first, strict=True))
        print(f"  {name:26} {taken[0]:6.2f} s of CPU, {taken[1]:6.2f} s of wall: "
              f"{cpu:.3f} and {wall:.3f} of the first, limit {LIMITS[name]}")  # fmt: skip


def figures(log: str = "traces/mission-seed15.mcap", count: int = 1000) -> Iterator[Figure]:
    """Nights of R1 and of the fifteen requirements, each from its own first night."""
    for requirements in ("requirements/r1.fret", "requirements/mission"):
        with tempfile.TemporaryDirectory() as folder:
            logs = Path(folder) / "logs"
            logs.mkdir()
            (_, first, _), *later = nights(requirements, cut(Path(log), count, logs))
        for name, cpu, _ in later:
            what = f"{requirements.rpartition('/')[2]}: {name}"
            yield Figure(what, cpu / first, "x the first night's CPU", LIMITS[name])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log", nargs="?", default="traces/mission-seed15.mcap", type=Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--requirements", default="requirements/r1.fret")
    parser.add_argument("--command", action="store_true")
    parser.add_argument("--nights", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        logs = Path(folder) / "logs"
        logs.mkdir()
        paths = cut(options.log, options.count, logs)
        size = sum(path.stat().st_size for path in paths) / len(paths) / 1e3
        print(f"{len(paths)} logs of {size:.0f} kB, {options.requirements}")
        if options.nights:
            print_nights(options.requirements, paths)
            return
        found = dict(rows(paths, options.requirements))
        base, peer = list(found.values())[:2]
        for name, taken in found.items():
            each = taken / len(paths) * 1e3
            print(f"  {name:22} {each:7.2f} ms a log, {taken / base:6.1f} floors, "
                  f"{taken / peer:5.2f} of the library")  # fmt: skip
        for jobs in (1, 2) if options.command else ():
            used, wall = (
                each / len(paths) * 1e3 for each in command(options.requirements, logs, jobs)
            )
            print(
                f"  fretc audit --jobs {jobs}  {used:7.2f} ms of CPU a log, {wall:.2f} ms of wall"
            )


if __name__ == "__main__":
    main()
