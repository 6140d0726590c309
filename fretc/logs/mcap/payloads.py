"""Payloads of many messages in one piece of memory, and the same place of all of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]

SPARE = 8
"""Bytes that follow the last payload, so that a number at any place lies within the memory."""


@dataclass(frozen=True, slots=True)
class Payloads:
    """Payload i is `data[starts[i] : starts[i] + sizes[i]]`; both of shape (n,)."""

    data: Bytes
    """With `SPARE` bytes, or more, behind the last payload."""
    starts: Places
    sizes: Places

    @classmethod
    def of(cls, payloads: Sequence[bytes | memoryview]) -> Payloads:
        """The payloads, one behind the other."""
        sizes = np.fromiter(map(len, payloads), np.int64, len(payloads))
        starts = np.cumsum(sizes) - sizes
        return cls(np.frombuffer(b"".join([*payloads, b"\0" * SPARE]), np.uint8), starts, sizes)

    def __len__(self) -> int:
        return len(self.starts)

    def payload(self, i: int) -> memoryview:
        """One of them."""
        start = int(self.starts[i])
        return self.data[start : start + int(self.sizes[i])].data

    def copies(self) -> list[bytes]:
        """Each of them, also when the memory is used for something else."""
        data = self.data.data
        places = zip(self.starts.tolist(), (self.starts + self.sizes).tolist(), strict=True)
        return [bytes(data[start:end]) for start, end in places]

    def gathered(self, rows: Places, at: int, dtype: str, count: int | None) -> NDArray[np.generic]:
        """The numbers `at` bytes from the start of each row.

        Args:
            rows: shape (k,); in each of their payloads the place exists.
            at: bytes from the start of a payload, at any alignment.
            dtype: NumPy's name of a number.
            count: of an array; None for a number alone.

        Returns:
            Shape (k,), or (k, count).
        """
        kind = np.dtype(dtype.replace("?", "u1"))
        width = kind.itemsize * (1 if count is None else count)
        places = len(self.data) - max(width, 1) + 1
        # A number at every byte: gathering from it copies whole numbers, not their single bytes.
        shape, strides = (
            ((places,), (1,)) if count is None else ((places, count), (1, kind.itemsize))
        )
        numbers = np.ndarray(shape, kind, self.data.data, 0, strides)[self.starts[rows] + at]
        return numbers != 0 if dtype == "?" else numbers
