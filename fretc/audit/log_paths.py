"""The logs that paths stand for: files, folders, patterns, standard input, URLs, object stores."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from compiler.files.text_files import unreadable
from fretc.logs.storage.folders import METADATA, Folder, folder, is_folder
from fretc.logs.storage.listings import below, is_store
from fretc.logs.storage.log_names import LOGS, STDIN, is_url, name_of
from fretc.logs.storage.splits import ACTIVE, is_backup, run_name, split
from fretc.logs.tables.episodes import episode_of, runs_of
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source

_LOGS = (*LOGS, ACTIVE, ".bag.orig.active")
"""Suffixes of logs; other files in folders are skipped."""
ANNOTATIONS = ".fretc.mcap"
"""Suffixes of annotation files; they are skipped in folders of logs."""


def logs(paths: Sequence[str]) -> list[str] | Diagnostic:
    """The logs of some paths, each once; those of a folder are in order of names.

    A folder of rosbag2 with several files is one log, and so are these files if all of them are
    named. So are the files of `rosbag record --split`. A Parquet file with several episodes is
    several logs.

    Args:
        paths: as the user names them; a path that is neither a folder nor a pattern is taken for a
            file.
    """
    by_real_path: dict[str, str] = {}
    for path in paths:
        try:
            files = list(_named(path))
        except OSError as error:
            return unreadable(error.filename or path, error)
        for file in files:
            if isinstance(file, Diagnostic):
                return file
            for run in [file] if _elsewhere(file) else runs_of(file):
                by_real_path.setdefault(run if _elsewhere(run) else os.path.realpath(run), run)
    try:
        return _whole(by_real_path)
    except OSError as error:
        return unreadable(error.filename or METADATA, error)


def files_of(logs: Iterable[str]) -> list[str]:
    """All files of the logs."""
    files: list[str] = []
    for log in logs:
        episode = None if _elsewhere(log) else episode_of(log)
        if episode is not None:
            files.append(episode.file)
            continue
        run = None if _elsewhere(log) or os.path.lexists(log) else split(log)
        if not _elsewhere(log) and os.path.isdir(log):
            files += [entry.path for entry in os.scandir(log)]
        elif run is not None:
            files += [os.path.join(run.path, name) for name in run.files]
        else:
            files.append(log)
    return files


def _elsewhere(path: str) -> bool:
    """Whether the path is not that of a local file."""
    return path == STDIN or is_url(path)


def _named(path: str) -> Iterator[str | Diagnostic]:
    """The logs that one path stands for."""
    if is_store(path):
        yield from _stored(path)
    elif not path or _elsewhere(path) or not (glob.has_magic(path) or os.path.isdir(path)):
        yield path
    elif os.path.isdir(path):
        yield from list(_below(Path(path))) or [_empty(path)]
    elif os.path.lexists(path):
        yield path
    else:
        matches = sorted(glob.glob(path, recursive=True))
        if not matches:
            yield _no_match(path)
        for match in matches:
            if os.path.isdir(match):
                yield from _below(Path(match))
            elif os.path.basename(match) != METADATA:
                yield match


def _stored(path: str) -> Iterator[str | Diagnostic]:
    """The logs below a folder of an object store, or those that a pattern matches."""
    addresses = below(path, lambda name: name.endswith(_LOGS) and not name.endswith(ANNOTATIONS))
    if addresses is None or isinstance(addresses, Diagnostic):
        yield path if addresses is None else addresses
    elif not addresses:
        yield _empty(path) if path.endswith("/") else _no_match(path)
    else:
        yield from addresses


def _below(path: Path, visited: dict[str, None] | None = None) -> Iterator[str | Diagnostic]:
    """The logs in a folder; a broken link counts as a log that cannot be read.

    A link may lead to a folder elsewhere, but not to one that contains the named folder: the search
    could cover the whole disk.

    Args:
        path: the folder.
        visited: folders that have been listed, the named one first, because links may form cycles.
    """
    real = os.path.realpath(path)
    if visited is None:
        visited = {}
    elif real in visited or os.path.commonpath([real, next(iter(visited))]) == real:
        return
    visited[real] = None
    entries = sorted(path.iterdir())
    logs = [entry for entry in entries if not entry.name.endswith(ANNOTATIONS)]
    files = [
        entry
        for entry in logs
        if entry.name.endswith(_LOGS) and not entry.is_dir() and not is_backup(str(entry))
    ]
    run = folder(str(path)) if is_folder(str(path)) else None
    if isinstance(run, Diagnostic) and len(files) > 1:
        yield run
        return
    if isinstance(run, Folder) and (len(run.files) > 1 or run.compressed):
        yield str(path)
        files = [file for file in files if file.name not in run.files]
    own = {*files}
    for entry in entries:
        if entry in own:
            yield str(entry)
        elif entry.is_dir():
            yield from _below(entry, visited)


def _whole(by_real_path: dict[str, str]) -> list[str]:
    """The logs, with a rosbag2 folder instead of its files if all of them are named."""
    runs = {
        os.path.dirname(real): os.path.dirname(file) or "." for real, file in by_real_path.items()
    }
    for real, path in runs.items():
        about = folder(path) if is_folder(path) else None
        if not isinstance(about, Folder) or len(about.files) < 2:
            continue
        parts = [os.path.realpath(os.path.join(real, name)) for name in about.files]
        if all(part in by_real_path for part in parts):
            by_real_path = {
                real if key == parts[0] else key: log for key, log in by_real_path.items()
            }
            by_real_path[real] = path
            by_real_path = {key: log for key, log in by_real_path.items() if key not in parts}
    return list(_joined(by_real_path))


def _joined(by_real_path: dict[str, str]) -> Iterator[str]:
    """The logs, with one run instead of its split bags if all of them are named."""
    passed: set[str] = set()
    for real, log in by_real_path.items():
        if real in passed:
            continue
        run = split(log) if log.endswith((".bag", ACTIVE)) and not _elsewhere(log) else None
        parts = run and {os.path.realpath(os.path.join(run.path, name)) for name in run.files}
        if run and parts and parts <= by_real_path.keys():
            passed |= parts
            yield run_name(run)
        else:
            yield log


def _empty(path: str) -> Diagnostic:
    return diagnostic("folder_without_logs", Source(name_of(path), "").span(), path=name_of(path))


def _no_match(path: str) -> Diagnostic:
    return diagnostic("no_matching_file", Source(name_of(path), "").span(), path=name_of(path))
