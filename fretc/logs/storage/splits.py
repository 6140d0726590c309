"""Related ROS 1 bags: the files of one run, and a bag with its backup.

`rosbag record --split` writes `run_0.bag`, `run_1.bag`, and so on; the last one is called
`run_2.bag.active` until the recorder has closed it. Such a run has the name `run_*.bag`. Times are
nanoseconds, log times.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from fretc.logs.signals.samples import Gap
from fretc.logs.storage.bags import ends
from fretc.logs.storage.folders import Folder

ACTIVE = ".bag.active"
"""The suffix of a bag that its recorder has not closed."""
_FILE = re.compile(r"(?P<run>.+)_(?P<number>\d+)\.bag(\.active)?", re.DOTALL)
_RUN = re.compile(r"(?P<run>.+)_\*\.bag", re.DOTALL)
_SOON = 10**9
"""The most time between two files of a run; files farther apart are separate runs."""
_BACKUP = re.compile(r".+\.orig\.bag|.+\.bag\.orig\.active", re.DOTALL)
_HEADER = 4096
"""Bytes to which the header of a bag is padded."""


def split(path: str) -> Folder | None:
    """The run that a bag belongs to; None: the bag is a whole run.

    Files of one name are one run if their numbers are consecutive, none occurs twice (`run_1.bag`
    and `run_01.bag`), and each begins where the one before it ends: the names alone could be those
    of numbered runs.

    Args:
        path: the path of one of the files, or a name from `run_name`.

    Raises:
        OSError: a file cannot be read.
    """
    parent, name = os.path.split(path)
    match = _RUN.fullmatch(name) or _FILE.fullmatch(name)
    if match is None or (_RUN.fullmatch(name) and os.path.lexists(path)):
        return None
    matches = (_FILE.fullmatch(file) for file in os.listdir(parent or "."))
    own = [file for file in matches if file and file["run"] == match["run"]]
    numbers = sorted((int(file["number"]), file[0]) for file in own)
    files = [file for _, file in numbers]
    follow = all(b == a + 1 for (a, _), (b, _) in pairwise(numbers))
    if len(files) < 2 or not follow or not _in_time(parent, files):
        return None
    return Folder(parent or ".", tuple(files), None, None, {}, "")


def run_name(run: Folder) -> str:
    """The name of the run: `runs/run_*.bag`."""
    match = _FILE.fullmatch(run.files[0])
    assert match is not None
    name = f"{match['run']}_*.bag"
    return name if run.path == "." else os.path.join(run.path, name)


def _in_time(parent: str, files: Sequence[str]) -> bool:
    """Whether each file begins where the one before it ends; the last one may be unreadable."""
    spans: list[Gap | None] = [ends(os.path.join(parent, file)) for file in files]
    if spans[-1] is None and files[-1].endswith(ACTIVE):
        spans.pop()
    closed = [span for span in spans if span is not None]
    soon = all(abs(b[0] - a[1]) <= _SOON for a, b in pairwise(closed))
    return soon and bool(closed) and len(closed) == len(spans)


def is_backup(path: str) -> bool:
    """Whether the file is a backup by `rosbag reindex`, beside the new bag."""
    root, name = os.path.split(path)
    if not _BACKUP.fullmatch(name):
        return False
    fixed = (name.replace(".orig.bag", ".bag"), name.replace(".bag.orig.active", ".bag"))
    originals = {*fixed, f"{fixed[1]}.active"} - {name}
    return any(os.path.exists(os.path.join(root, original)) for original in originals)


def unclosed_backup(path: str) -> str | None:
    """The name of a bag's backup by `rosbag reindex`, if its recorder had not closed the bag.

    Then the last, unfinished chunk is not in the bag.

    Raises:
        OSError: it cannot be read.
    """
    file = Path(path.removesuffix(".active"))
    for backup in (file.with_suffix(".orig.bag"), file.with_name(f"{file.name}.orig.active")):
        if backup.is_file():
            with backup.open("rb") as stream:
                _, marker, rest = stream.read(_HEADER).partition(b"index_pos=")
            place = int.from_bytes(rest[:8], "little") if marker else 0
            if not 0 < place < backup.stat().st_size:
                return backup.name
    return None
