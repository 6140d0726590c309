"""The messages of a chunk as columns: where each of them is, and what stands before its payload."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from monitors.payloads import Bytes, Payloads, Places

_HEAD = np.dtype([("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")])
"""What each message begins with."""

Stamps = NDArray[np.uint64]
"""Nanoseconds, as they stand in the file: any number."""


@dataclass(frozen=True, slots=True)
class Messages:
    """Message i is `data[starts[i] : ends[i]]`, in the order of the file; all of shape (n,)."""

    data: Bytes
    """With `SPARE` bytes, or more, behind the last message."""
    starts: Places
    ends: Places
    channels: NDArray[np.uint16]
    logs: Stamps
    publishes: Stamps
    strange: bool
    """Whether records of other kinds stand among them."""

    @classmethod
    def of(
        cls, data: bytes, starts: Sequence[int], ends: Sequence[int], *, strange: bool
    ) -> Messages:
        """With the heads of the messages; what is too short for one reads as zeros."""
        first = np.array(starts, np.int64)
        padded = np.frombuffer(data + b"\0" * _HEAD.itemsize, np.uint8)
        return cls.at(padded, first, np.array(ends, np.int64), strange=strange)

    @classmethod
    def at(cls, data: Bytes, starts: Places, ends: Places, *, strange: bool) -> Messages:
        """With the heads of the messages, which lie within the data."""
        places = len(data) - _HEAD.itemsize + 1
        heads = np.ndarray((places,), _HEAD, data.data, 0, (1,))[starts]
        return cls(
            data,
            starts,
            ends,
            heads["channel"],
            heads["log"],
            heads["publish"],
            strange,
        )

    def of_channel(self, id: int) -> Messages:
        """Those of one channel."""
        chosen = self.channels == id
        return Messages(
            self.data,
            self.starts[chosen],
            self.ends[chosen],
            self.channels[chosen],
            self.logs[chosen],
            self.publishes[chosen],
            self.strange,
        )

    def __len__(self) -> int:
        return len(self.starts)

    @property
    def payloads(self) -> Payloads:
        """What follows the head of each message."""
        size = _HEAD.itemsize
        return Payloads(self.data, self.starts + size, self.ends - self.starts - size)
