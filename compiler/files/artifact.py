"""A file to be written: pure text with a place, until the command writes it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath


@dataclass(frozen=True, slots=True)
class Artifact:
    """One file, relative to the output folder."""

    path: PurePosixPath
    text: str
