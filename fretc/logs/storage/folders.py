"""A run in several files: the `metadata.yaml` of a rosbag2 folder.

Times are nanoseconds, log times.

Source: rosbag2, https://github.com/ros2/rosbag2/blob/rolling/rosbag2_storage/include/rosbag2_storage/bag_metadata.hpp.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path, PurePosixPath
from typing import Any

from fretc.logs.signals.samples import Gap
from fretc.logs.storage.log_names import name_of
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.limits import with_budget
from fretish.reading.yaml_text import loaded

METADATA = "metadata.yaml"
_LARGEST = 2**24
"""The most bytes of a `metadata.yaml`."""
_LATEST = 2**62


@dataclass(frozen=True, slots=True)
class Folder:
    """One run, as its `metadata.yaml` describes it."""

    path: str
    files: tuple[str, ...]
    """The names of its files within the folder, in order of time."""
    messages: int | None
    span: Gap | None
    """The first and the last message of the run."""
    spans: Mapping[str, Gap]
    """The spans of single files, if they are stated."""
    compressed: str
    """`file` or `message`: the unit of compression; empty: not compressed."""
    custom: Mapping[str, str] = field(default_factory=dict)
    """The `custom_data` of the recorder."""

    def lost(self, i: int, before: int | None, after: int | None) -> Gap | None:
        """The time that file `i` has covered, as far as it is known.

        Args:
            i: a file that cannot be read.
            before: the last message of the files before it.
            after: the first message of the files after it.
        """
        own = [self.spans[self.files[i]]] if self.files[i] in self.spans else []
        run = [self.span] if self.span is not None else []
        starts = [before] if before is not None else [a for a, _ in (*own, *run)]
        ends = [after] if after is not None else [b for _, b in (*own, *run)]
        times = [time for time in (*starts, *ends, before, after) if time is not None]
        return (min(times), max(times)) if times else None


def is_folder(path: str) -> bool:
    """Whether the path is a folder with a `metadata.yaml` of rosbag2."""
    return os.path.isdir(path) and (Path(path) / METADATA).is_file()


def of_all(hashes: Mapping[str, str]) -> str:
    """One SHA-256 of several files: that of the output of `sha256sum`."""
    lines = "".join(f"{sha256}  {name}\n" for name, sha256 in hashes.items())
    return hashlib.sha256(lines.encode("utf-8", "surrogateescape")).hexdigest()


def folder(path: str) -> Folder | Diagnostic:
    """The run that the `metadata.yaml` of a folder describes.

    Raises:
        OSError: the file cannot be read.
    """
    file = Path(path) / METADATA
    span = Source(name_of(str(file)), "").span()
    with file.open("rb") as stream:
        data = stream.read(_LARGEST)
    return with_budget(
        len(data), span, lambda: _described(path, data) or diagnostic("bad_run_metadata", span)
    )


def _described(path: str, data: bytes) -> Folder | None:
    """The run; None: the file is not as rosbag2 writes it."""
    try:
        about = loaded(data.decode())["rosbag2_bagfile_information"]
        files = tuple(_name(name) for name in about["relative_file_paths"])
        if len(set(files)) < len(files):
            return None
        return Folder(
            path,
            files,
            _natural(about.get("message_count")),
            _span(about),
            _spans(about.get("files")),
            _compressed(about),
            _custom(about.get("custom_data")),
        )
    except (ValueError, TypeError, KeyError, AttributeError):
        return None


def _name(listed: Any) -> str:
    """The name of a listed file, without the stated folder."""
    name = PurePosixPath(listed).name
    if not name or name == ".." or b"\0" in os.fsencode(name):
        raise ValueError("a file has no name")
    return name


def _compressed(about: Mapping[str, Any]) -> str:
    mode = about.get("compression_mode") or ""
    if not isinstance(mode, str):  # never as a text: that of a list of aliases has no end
        raise ValueError("the compression mode is not a text")
    return "" if mode.lower() == "none" else mode.lower()


def _custom(data: Any) -> dict[str, str]:
    """The texts in `custom_data`; texts made of lists are skipped, because aliases have no end."""
    items = data.items() if isinstance(data, dict) else ()
    return {k: v for k, v in items if isinstance(k, str) and isinstance(v, str)}


def _spans(listed: Any) -> dict[str, Gap]:
    spans: dict[str, Gap] = {}
    for about in listed if isinstance(listed, list) else ():
        if isinstance(about, dict) and isinstance(about.get("path"), str):
            span = _span(about)
            if span is not None:
                spans[PurePosixPath(about["path"]).name] = span
    return spans


def _span(about: Mapping[str, Any]) -> Gap | None:
    """The first and the last message; None: there is none, or the times are invalid."""
    start = _natural(_inner(about.get("starting_time"), "nanoseconds_since_epoch"))
    length = _natural(_inner(about.get("duration"), "nanoseconds"))
    if start is None or length is None or not about.get("message_count"):
        return None
    return (start, start + length) if start + length < _LATEST else None


def _inner(about: Any, name: str) -> Any:
    return about.get(name) if isinstance(about, dict) else None


def _natural(value: Any) -> int | None:
    return value if isinstance(value, int) and value >= 0 else None
