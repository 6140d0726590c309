"""Topics whose messages are packed rows of numbers, as ULog and DataFlash have them.

They are passed on as ROS 1 lays fields out: packed, little-endian.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mcap.records import Channel, Schema
from numpy.typing import NDArray

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.messages import Messages, Sink
from fretc.logs.mcap.payloads import SPARE
from fretish.classes.frozen import dataclass

_HEAD = [("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")]


@dataclass(frozen=True, slots=True)
class PackedField:
    """A field of a message."""

    name: str
    type: str
    """In ROS's words: `float32`, `int16[32]`."""
    columns: Sequence[NDArray[np.generic]]
    """Each of its numbers, shape (n,)."""


@dataclass(frozen=True, slots=True)
class PackedTopic:
    """The messages of one topic."""

    stream: ChannelDefinition
    rows: NDArray[np.void]
    """Shape (n,): the head and the fields of each message."""
    times: NDArray[np.int64]
    """Shape (n,): nanoseconds."""

    def pass_to(self, sink: Sink) -> None:
        """Give all messages to a sink."""
        size = self.rows.dtype.itemsize
        data = np.concatenate([self.rows.view(np.uint8).ravel(), np.zeros(SPARE, np.uint8)])
        starts = np.arange(len(self.rows), dtype=np.int64) * size
        sink.declare(self.stream)
        sink.add_all(self.stream, Messages.at(data, starts, starts + size))


def packed_topic(
    number: int, topic: str, type_: str, fields: Sequence[PackedField], times: NDArray[np.int64]
) -> PackedTopic:
    """The messages of a topic.

    Args:
        number: of the topic in its log, from 1.
        topic: its name.
        type_: the name of the type of its messages.
        fields: their fields, in their order.
        times: shape (n,), nanoseconds.
    """
    columns = [column for field in fields for column in field.columns]
    kinds = [(f"f{i}", "u1" if c.dtype == bool else c.dtype.str) for i, c in enumerate(columns)]
    rows = np.zeros(len(times), np.dtype([*_HEAD, *kinds]))
    for (name, _), column in zip(kinds, columns, strict=True):
        rows[name] = column
    rows["channel"], rows["log"], rows["publish"] = number, times, times
    text = "".join(f"{field.type} {field.name}\n" for field in fields)
    channel = Channel(number, topic, "ros1", {}, number)
    schema = Schema(number, text.encode(), "ros1msg", type_)
    return PackedTopic(ChannelDefinition(channel, schema), rows, times)
