"""The messages of a chunk as columns: where each of them is, and what stands before its payload."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from fretc.logs.mcap.container import Stream
from fretc.logs.mcap.payloads import Bytes, Payloads, Places

_FIELDS = [("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")]
_HEAD = np.dtype(_FIELDS)
"""What each message begins with."""
_RECORD_HEAD = np.dtype([("opcode", "u1"), ("length", "<u8"), *_FIELDS])
"""What the record of each message begins with."""

FileTimes = NDArray[np.uint64]
"""Nanoseconds, as they stand in the file: any number."""


@dataclass(frozen=True, slots=True)
class Messages:
    """Message i is `data[starts[i] : ends[i]]`, in the order of the file; all of shape (n,)."""

    data: Bytes
    """With `SPARE` bytes, or more, behind the last message."""
    starts: Places
    ends: Places
    channels: NDArray[np.uint16]
    logs: FileTimes
    publishes: FileTimes

    HEAD: ClassVar[int] = _HEAD.itemsize
    """Bytes that each message begins with, before its payload."""

    @classmethod
    def of(cls, data: bytes, starts: Sequence[int], ends: Sequence[int]) -> Messages:
        """With the heads of the messages; what is too short for one reads as zeros."""
        first = np.array(starts, np.int64)
        padded = np.frombuffer(data + b"\0" * _HEAD.itemsize, np.uint8)
        return cls.at(padded, first, np.array(ends, np.int64))

    @classmethod
    def at(cls, data: Bytes, starts: Places, ends: Places) -> Messages:
        """With the heads of the messages, which lie within the data."""
        return cls.behind(_gathered(data, starts, _HEAD), data, starts, ends)

    @classmethod
    def behind(cls, heads: NDArray[np.void], data: Bytes, starts: Places, ends: Places) -> Messages:
        """With heads that have been gathered."""
        return cls(data, starts, ends, heads["channel"], heads["log"], heads["publish"])

    def of_channel(self, id: int) -> Messages:
        """Those of one channel."""
        return self.chosen(np.flatnonzero(self.channels == id))

    def chosen(self, chosen: NDArray[np.intp]) -> Messages:
        """Some of them."""
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
        """What follows the head of each message."""
        size = _HEAD.itemsize
        return Payloads(self.data, self.starts + size, self.ends - self.starts - size)


def record_heads(data: Bytes, places: Places) -> NDArray[np.void]:
    """Opcode, length and head of each message whose record begins at a place, gathered at once.

    Behind each place there must be as many bytes.
    """
    return _gathered(data, places, _RECORD_HEAD)


def _gathered(data: Bytes, places: Places, kind: np.dtype[np.void]) -> NDArray[np.void]:
    """As plain bytes: fields would be copied one by one."""
    size = kind.itemsize
    return np.ndarray((len(data) - size + 1,), f"V{size}", data.data, 0, (1,))[places].view(kind)


class Sink(Protocol):
    """Takes the messages in the order of the file."""

    def declare(self, stream: Stream) -> None:
        """A stream of the file, before its messages; it may come more than once."""
        ...

    def add(self, stream: Stream, log_time: int, publish_time: int, payload: memoryview) -> None:
        """One whole message."""
        ...

    def add_all(self, stream: Stream, messages: Messages) -> None:
        """Whole messages of one stream, and none of another stream of its topic between them."""
        ...

    def wants(self, topic: str) -> bool:
        """Whether more than the number of its messages is asked for."""
        ...

    def count(self, stream: Stream, count: int) -> None:
        """So many messages of a stream that is not wanted."""
        ...
