"""Payloads of many messages in one block of memory, with access to one position in all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fretish.classes.frozen import dataclass

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]

SPARE = 8
"""Bytes after the last payload, so that a number at any position lies within the memory."""


@dataclass(frozen=True, slots=True)
class Payloads:
    """Payload i is `data[starts[i] : starts[i] + sizes[i]]`; both of shape (n,)."""

    data: Bytes
    """The memory, with at least `SPARE` bytes after the last payload."""
    starts: Places
    sizes: Places

    @classmethod
    def of(cls, payloads: Sequence[bytes | memoryview]) -> Payloads:
        """The payloads, one after the other."""
        sizes = np.fromiter(map(len, payloads), np.int64, len(payloads))
        starts = np.cumsum(sizes) - sizes
        return cls(np.frombuffer(b"".join([*payloads, b"\0" * SPARE]), np.uint8), starts, sizes)

    def __len__(self) -> int:
        return len(self.starts)

    def payload(self, i: int) -> memoryview:
        """One payload."""
        start = int(self.starts[i])
        return self.data[start : start + int(self.sizes[i])].data

    def copies(self) -> list[bytes]:
        """A copy of each payload, which stays valid when the memory is reused."""
        data = self.data.data
        places = zip(self.starts.tolist(), (self.starts + self.sizes).tolist(), strict=True)
        return [bytes(data[start:end]) for start, end in places]

    def gathered(self, rows: Places, at: int, dtype: str, count: int | None) -> NDArray[np.generic]:
        """The numbers `at` bytes from the start of each row.

        Args:
            rows: shape (k,); each of their payloads must reach the position.
            at: bytes from the start of a payload, at any alignment.
            dtype: the NumPy name of a number type.
            count: the length of an array; None for a single number.

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
