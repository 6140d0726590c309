"""A robot on DDS: plays a recorded mission as if it went on now, by ROS 2's names and types.

    python -m tests.dds_robot LOG FIRST LAST READERS TOPIC...

plays the seconds of the log from FIRST to LAST, as soon as each of the topics has so many readers.
Stamps are moved to the present. It ends when all that can be has been
received, and prints how many messages there were of each topic.
"""

from __future__ import annotations

import json
import struct
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from mcap.exceptions import McapError
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from fretc.logs.messages.ros2_types import definitions
from fretc.watch.sources.dds_domain import DdsWriter, Domain, join
from fretc.watch.sources.dds_types import Offer
from simulation.recording import TOPICS

_STAMP = struct.Struct("<iI")
_SECOND = 10**9


def writers(domain: Domain) -> dict[str, DdsWriter]:
    """As a robot's nodes offer them: with a type hash, without type information."""
    found = {}
    for topic in TOPICS:
        digest, definition = [*definitions(topic.type).items()][-1]
        reliable, keeps = topic.reliability == "reliable", topic.durability == "transient_local"
        offer = Offer(topic.type, digest, reliable, keeps)
        found[topic.name] = domain.writer(topic.name, offer, definition)
    return found


def messages(log: Path, first: float, last: float) -> Iterator[tuple[int, str, bool, bytes]]:
    """Nanoseconds since `first`, topic, whether it begins with a header, payload.

    A log that breaks off ends there.
    """
    begin: int | None = None
    stamped: dict[int, bool] = {}
    channels: dict[int, Channel] = {}
    with log.open("rb") as stream, suppress(McapError):
        for record in StreamReader(stream).records:
            match record:
                case Schema():
                    stamped[record.id] = record.data.startswith(b"std_msgs/Header header\n")
                case Channel():
                    channels[record.id] = record
                case Message():
                    if begin is None:
                        begin = record.log_time + round(first * _SECOND)
                    at, channel = record.log_time - begin, channels[record.channel_id]
                    if 0 <= at <= (last - first) * _SECOND:
                        yield at, channel.topic, stamped[channel.schema_id], record.data


def main(log: str, first: float, last: float, readers: int, *topics: str) -> None:
    """Play it."""
    domain = join()
    assert isinstance(domain, Domain), domain
    out = writers(domain)
    while any(out[topic].readers < readers for topic in topics):
        time.sleep(0.01)
    counts = dict.fromkeys(out, 0)
    start, clock, moved = time.time_ns(), time.monotonic_ns(), None
    for at, topic, stamped, payload in messages(Path(log), first, last):
        time.sleep(max(0, clock + at - time.monotonic_ns()) / _SECOND)
        data = bytearray(payload)
        if stamped:
            sec, nanosec = _STAMP.unpack_from(data, 4)
            if moved is None:
                moved = start + at - (sec * _SECOND + nanosec)
            _STAMP.pack_into(data, 4, *divmod(sec * _SECOND + nanosec + moved, _SECOND))
        out[topic].write(bytes(data))
        counts[topic] += 1
    for topic in topics:
        out[topic].entity.wait_for_acks(10 * _SECOND)
    print(json.dumps(counts), flush=True)
    domain.close()


if __name__ == "__main__":
    log_, first_, last_, readers_, *topics_ = sys.argv[1:]
    main(log_, float(first_), float(last_), int(readers_), *topics_)
