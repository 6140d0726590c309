"""Runs of a LeRobot dataset: since version 3 of its format a Parquet file holds many of them.

`file.parquet#7` names the run with `episode_index` 7. A file whose name ends so is a file.

Source: https://huggingface.co/docs/lerobot/lerobot-dataset-v3.
"""

from __future__ import annotations

import os
import re

from fretc.logs.storage.log_names import ARROW_TABLES
from fretc.logs.tables.arrow_rows import episode_numbers
from fretish.classes.frozen import dataclass

_NAME = re.compile(r"(.+)#([0-9]{1,9})", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Episode:
    """One run of a table."""

    file: str
    number: int
    """Its `episode_index`."""


def episode_of(path: str) -> Episode | None:
    """The run that a path names; None: the path is that of a file."""
    match = _NAME.fullmatch(path)
    if match is None or not match[1].endswith(ARROW_TABLES) or os.path.lexists(path):
        return None
    return Episode(match[1], int(match[2]))


def runs_of(file: str) -> list[str]:
    """The paths of the runs of a local file: itself, or one for each of several episodes.

    A file that cannot be read is one run, and its reader says why.
    """
    if not file.endswith(ARROW_TABLES) or not os.path.isfile(file):
        return [file]
    with open(file, "rb") as stream:
        try:
            numbers = episode_numbers(stream, os.path.getsize(file))
        except Exception:  # the reader trusts each byte, and each may be wrong
            return [file]
    return [f"{file}#{number}" for number in numbers] if len(numbers) > 1 else [file]
