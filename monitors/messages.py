"""The messages of a chunk as columns: where each of them is, and what stands before its payload."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_HEAD = np.dtype([("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")])
"""What each message begins with."""

Stamps = NDArray[np.uint64]
"""Nanoseconds, as they stand in the file: any number."""


@dataclass(frozen=True, slots=True)
class Messages:
    """Message i is `data[starts[i] : ends[i]]`, in the order of the file; all of shape (n,)."""

    data: bytes
    starts: NDArray[np.int64]
    ends: NDArray[np.int64]
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
        shape = (len(padded) - _HEAD.itemsize + 1, _HEAD.itemsize)
        window = np.lib.stride_tricks.as_strided(padded, shape, (1, 1), writeable=False)
        heads = np.ascontiguousarray(window[first]).view(_HEAD).reshape(-1)
        return cls(
            data,
            first,
            np.array(ends, np.int64),
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

    @property
    def payloads(self) -> list[bytes]:
        """What follows the head of each message."""
        size, data = _HEAD.itemsize, self.data
        places = zip(self.starts.tolist(), self.ends.tolist(), strict=True)
        return [data[start + size : end] for start, end in places]
