"""The messages of a chunk as columns: their positions, and the fields before their payloads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.payloads import Bytes, Payloads, Places
from fretish.classes.frozen import dataclass

_FIELDS = [("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")]
_HEAD = np.dtype(_FIELDS)
"""The fields with which each message begins."""
_RECORD_HEAD = np.dtype([("opcode", "u1"), ("length", "<u8"), *_FIELDS])
"""The fields with which the record of each message begins."""

FileTimes = NDArray[np.uint64]
"""Nanoseconds as stated in the file, unchecked."""


@dataclass(frozen=True, slots=True)
class Messages:
    """Message i is `data[starts[i] : ends[i]]`, in the order of the file; all of shape (n,)."""

    data: Bytes
    """The memory, with at least `SPARE` bytes after the last message."""
    starts: Places
    ends: Places
    channels: NDArray[np.uint16]
    logs: FileTimes
    publishes: FileTimes

    HEAD: ClassVar[int] = _HEAD.itemsize
    """Bytes at the beginning of each message, before its payload."""

    @classmethod
    def of(cls, data: bytes, starts: Sequence[int], ends: Sequence[int]) -> Messages:
        """The messages with their heads; a message that is too short for one reads as zeros."""
        first = np.array(starts, np.int64)
        padded = np.frombuffer(data + b"\0" * _HEAD.itemsize, np.uint8)
        return cls.at(padded, first, np.array(ends, np.int64))

    @classmethod
    def at(cls, data: Bytes, starts: Places, ends: Places) -> Messages:
        """The messages with their heads; all lie within the data."""
        return cls.behind(_gathered(data, starts, _HEAD), data, starts, ends)

    @classmethod
    def behind(cls, heads: NDArray[np.void], data: Bytes, starts: Places, ends: Places) -> Messages:
        """The messages with heads that have been gathered before."""
        return cls(data, starts, ends, heads["channel"], heads["log"], heads["publish"])

    def of_channel(self, id: int) -> Messages:
        """The messages of one channel."""
        return self.chosen(np.flatnonzero(self.channels == id))

    def chosen(self, chosen: NDArray[np.intp]) -> Messages:
        """Some of the messages."""
        return Messages(
            self.data,
            self.starts[chosen],
            self.ends[chosen],
            self.channels[chosen],
            self.logs[chosen],
            self.publishes[chosen],
        )

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def payloads(self) -> Payloads:
        """The payloads, after the head of each message."""
        size = _HEAD.itemsize
        return Payloads(self.data, self.starts + size, self.ends - self.starts - size)


def record_heads(data: Bytes, places: Places) -> NDArray[np.void]:
    """Opcode, length and head of each message whose record begins at an offset, gathered at once.

    After each offset there must be as many bytes.
    """
    return _gathered(data, places, _RECORD_HEAD)


def _gathered(data: Bytes, places: Places, kind: np.dtype[np.void]) -> NDArray[np.void]:
    """The heads as plain bytes, because fields would be copied one by one."""
    size = kind.itemsize
    return np.ndarray((len(data) - size + 1,), f"V{size}", data.data, 0, (1,))[places].view(kind)


class Sink(Protocol):
    """A receiver of messages in the order of the file."""

    def declare(self, stream: ChannelDefinition) -> None:
        """Receive a stream of the file, before its messages, possibly more than once."""
        ...

    def add(
        self, stream: ChannelDefinition, log_time: int, publish_time: int, payload: memoryview
    ) -> None:
        """Receive one whole message."""
        ...

    def add_all(self, stream: ChannelDefinition, messages: Messages) -> None:
        """Receive whole messages of one stream; no other stream of its topic comes between them."""
        ...

    def wants(self, topic: str) -> bool:
        """Whether the messages of a stream are wanted, not only their number."""
        ...

    def count(self, stream: ChannelDefinition, count: int) -> None:
        """Count messages of a stream that is not wanted."""
        ...
