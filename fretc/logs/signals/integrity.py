"""How much of a log is looked at, and what was looked at in the end."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Integrity(StrEnum):
    """What is done beyond reading the messages that the bindings name."""

    INDEX = "index"
    """Nothing: the log is known by the SHA-256 of its summary."""
    HASH = "hash"
    """All bytes are hashed."""
    FULL = "full"
    """All bytes are hashed, and every record, CRC and count is checked."""


@dataclass(frozen=True, slots=True)
class Checked:
    """The parts of a log that were read and checked."""

    by_index: bool
    """Whether only the messages in question were read; else every record was."""
    hashed: bool = True
    """Whether the SHA-256 is that of the whole log, and not that of its summary."""
    chunks: int = 0
    crc_checked: int = 0
    """Chunks that have the CRC that they state."""
    without_crc: int = 0
    """Of the chunks that were unpacked, those that state no CRC."""
    skipped: int = 0
    """Chunks without a message in question: they were not unpacked."""

    def __add__(self, other: Checked) -> Checked:
        """Of two files of one log."""
        return Checked(
            self.by_index or other.by_index,
            self.hashed and other.hashed,
            self.chunks + other.chunks,
            self.crc_checked + other.crc_checked,
            self.without_crc + other.without_crc,
            self.skipped + other.skipped,
        )

    @property
    def crc_unchecked(self) -> int:
        """Chunks with a CRC of which only the beginning was unpacked."""
        return self.chunks - self.crc_checked - self.without_crc - self.skipped


EVERYTHING = Checked(by_index=False)
"""Every record was read; there was no chunk."""
