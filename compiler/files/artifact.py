"""A generated file as text with a relative path; nothing is written yet."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath


@dataclass(frozen=True, slots=True)
class Artifact:
    """One file, relative to the output folder."""

    path: PurePosixPath
    text: str
