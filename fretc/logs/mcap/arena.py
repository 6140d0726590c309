"""Reusable memory for the unpacked beginnings of chunks.

New memory for each chunk costs more than unpacking it. Codecs work in blocks, so that the beginning
of a chunk costs as much as its blocks: 128 KiB of zstd, 64 KiB of lz4.
"""

from __future__ import annotations

import numpy as np

from fretc.logs.mcap.container import BrokenError, unpack_into
from fretc.logs.mcap.payloads import Bytes

SIZE = 2**22
"""Bytes that are collected before their messages are read."""
_CHUNK = 2**20
"""Initial room for the last chunk; the memory grows for a larger one."""
SPARE = 64
"""Free bytes behind the unpacked ones: more than the head of a message."""


class ChunkBytes:
    """The unpacked bytes of chunks, one after the other."""

    def __init__(self, most: int) -> None:
        """`most`: the bytes of all chunks; a small log needs little memory."""
        self.data: Bytes = np.zeros(min(most, SIZE + _CHUNK) + SPARE, np.uint8)
        self.used = 0

    def clear(self) -> None:
        """Forget the unpacked bytes: later ones overwrite them."""
        self.used = 0

    def target(self, size: int) -> memoryview:
        """So many bytes after those in use."""
        needed = self.used + size + SPARE
        if needed > len(self.data):
            larger = np.zeros(needed, np.uint8)
            larger[: self.used] = self.data[: self.used]
            self.data = larger
        return self.data.data[self.used : self.used + size]

    def unpack(self, compression: str, packed: memoryview, size: int, *, whole: bool) -> bool:
        """Unpack the first `size` bytes of a chunk after those in use; `used` does not change.

        Args:
            compression: `lz4` or `zstd`.
            packed: the chunk's data, or its beginning.
            size: bytes to unpack.
            whole: whether the data holds no more than these bytes.

        Returns:
            False where the data is too short for it.

        Raises:
            BrokenError: the data is no such data, or holds more than it should.
        """
        length = unpack_into(compression, packed, self.target(size), whole=whole)
        if length > size:
            raise BrokenError("the size of a chunk differs from the size that it states")
        return length == size
