"""How thoroughly a log is checked, and the checks that were made."""

from __future__ import annotations

from enum import StrEnum

from fretish.classes.frozen import dataclass


class Integrity(StrEnum):
    """The checks beyond reading the bound messages."""

    INDEX = "index"
    """No further check: the log is identified by the SHA-256 of its summary."""
    HASH = "hash"
    """The SHA-256 of all bytes is computed."""
    FULL = "full"
    """The SHA-256 of all bytes is computed, and every record, CRC and count is checked."""


@dataclass(frozen=True, slots=True)
class Checked:
    """The checked parts of a log."""

    by_index: bool
    """Whether only the bound messages were read; otherwise every record was."""
    hashed: bool = True
    """Whether the SHA-256 is that of the whole log, not of its summary."""
    chunks: int = 0
    crc_checked: int = 0
    """Chunks whose stated CRC matches."""
    without_crc: int = 0
    """Unpacked chunks that state no CRC."""
    skipped: int = 0
    """Chunks without a bound message, which were not unpacked."""

    def __add__(self, other: Checked) -> Checked:
        """The sum over two files of one log."""
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
"""Every record was read, and there was no chunk."""
