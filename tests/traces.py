"""The recorded mission of the repository, and a part of it for tests that only need some log."""

from functools import cache
from io import BytesIO
from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import Writer

MISSION = Path(__file__).parents[1] / "traces/mission-seed15.mcap"
READ = ("/scan", "/odom")
"""What R1 reads."""
FIRST, LAST = 4 * 10**9, 7 * 10**9
"""Nanoseconds from the start: somebody comes too close, and the robot stands in time."""


@cache
def part() -> bytes:
    """A log of three seconds, which satisfies R1."""
    out = BytesIO()
    with MISSION.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        start = summary.statistics.message_start_time
        writer = Writer(out, chunk_size=2**14)
        writer.start(profile=reader.get_header().profile)
        ids: dict[str, int] = {}
        for schema, channel, message in reader.iter_messages(READ):
            if schema is None or not FIRST <= message.log_time - start < LAST:
                continue
            if channel.topic not in ids:
                id = writer.register_schema(schema.name, schema.encoding, schema.data)
                encoding = channel.message_encoding
                ids[channel.topic] = writer.register_channel(channel.topic, encoding, id)
            times = message.log_time, message.publish_time
            writer.add_message(ids[channel.topic], times[0], message.data, times[1])
        writer.finish()  # type: ignore[no-untyped-call]
    return out.getvalue()
