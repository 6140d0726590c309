"""A generated file as text with a relative path; nothing is written yet."""

from __future__ import annotations

from pathlib import PurePosixPath

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Artifact:
    """One file, relative to the output folder."""

    path: PurePosixPath
    text: str
