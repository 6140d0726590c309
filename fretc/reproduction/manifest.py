"""A manifest: the list of required logs with their SHA-256, in the format of `sha256sum`.

Evidence agrees with a manifest if it has exactly these logs with these hashes.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping

from compiler.files.text_files import file_sha256
from compiler.files.text_files import read as read_text
from fretc.audit.evidence.schema import EvidenceDocument
from fretc.logs.storage.folders import METADATA, Folder, folder, is_folder
from fretc.logs.storage.log_names import is_url, name_of
from fretc.logs.storage.splits import split
from fretc.logs.tables.episodes import episode_of, runs_of
from fretc.reproduction.outcome import Recheck, differs, unknown
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.diagnostics.source import Source

_LINE = re.compile(r"(?P<escape>\\?)(?P<sha256>[0-9a-fA-F]{64}) [ *](?P<path>.+)")
_ESCAPES = {r"\\": "\\", r"\n": "\n", r"\r": "\r"}
"""Escape sequences of `sha256sum` in a line that begins with a backslash."""


@dataclass(frozen=True, slots=True)
class Manifest:
    """The content of a manifest."""

    file: str
    logs: Mapping[str, str]
    """Name, normalized by `_normal` → SHA-256."""


def _normal(path: str) -> str:
    """Normalize a path: `./logs//a.mcap` becomes `logs/a.mcap`."""
    return path if is_url(path) else os.path.normpath(path)


def read(path: str) -> Manifest | tuple[Diagnostic, ...]:
    """Read a manifest; F545 for each invalid line."""
    source = read_text(path, errors="surrogateescape")
    if isinstance(source, Diagnostic):
        return (source,)
    entries = list(_lines(source))
    errors = [entry for entry in entries if isinstance(entry, Diagnostic)]
    logs = [entry for entry in entries if not isinstance(entry, Diagnostic)]
    if not entries:
        errors.append(_wrong(source, 0, 0, f"`{path}` names no log"))
    return tuple(errors) if has_errors(errors) else Manifest(path, dict(logs))


def _lines(source: Source) -> Iterator[tuple[str, str] | Diagnostic]:
    names: set[str] = set()
    start = 0
    for line in source.text.split("\n"):
        end = start + len(line)
        text = line.removesuffix("\r")
        match = _LINE.fullmatch(text)
        if match is None:
            if text.strip() and not text.startswith("#"):
                yield _wrong(source, start, end, "the line is not in the format of `sha256sum`")
        else:
            log = _unescaped(match["path"]) if match["escape"] else match["path"]
            name = _normal(name_of(log))
            if name in names:
                yield _wrong(source, start, end, "the manifest names this log twice")
            names.add(name)
            yield name, match["sha256"].lower()
        start = end + 1


def _unescaped(path: str) -> str:
    return re.sub(r"\\.", lambda match: _ESCAPES.get(match[0], match[0]), path)


def _wrong(source: Source, start: int, end: int, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_MANIFEST,
        what,
        source.span(start, end),
        help="write the manifest with `sha256sum LOG... > FILE`",
    )


# Evidence beside it -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Match:
    """The comparison of one run with the manifest, or of one log without a run."""

    run: str
    differences: tuple[Recheck, ...]
    """The differences; empty if the hashes agree."""


def matches(
    document: EvidenceDocument, manifest: Manifest, places: Mapping[str, str]
) -> tuple[Match, ...]:
    """Compare each run of evidence with the manifest; then list the logs without a run.

    Logs are matched by name. A log whose name matches no run is matched by its hash.

    Args:
        document: the evidence; its hashes are checked elsewhere.
        manifest: the required logs.
        places: run → present path of its log.
    """
    sha_of = {result.run: result.hashes.get("log") for result in document.results}
    parts = {run: _parts(run, places.get(run)) for run in sha_of}
    named = {
        run: {path: manifest.logs[path] for path in parts[run] if path in manifest.logs}
        for run in sha_of
    }
    matched = {path for listed in named.values() for path in listed}
    unmatched = {path: sha for path, sha in manifest.logs.items() if path not in matched}
    for run, listed in named.items():
        same = next((path for path, sha in unmatched.items() if sha == sha_of[run]), None)
        if not listed and same is not None:
            listed[_normal(run)] = unmatched.pop(same)
    runs = [
        Match(run, tuple(_differences(run, sha_of[run], named[run], parts[run], places.get(run))))
        for run in sha_of
    ]
    why = "the manifest names it, but the evidence has no result for it"
    absent = [*unmatched, *_absent_episodes(sha_of, places)]
    return (*runs, *(Match(path, (differs(path, "", why),)) for path in absent))


def _absent_episodes(runs: Collection[str], places: Mapping[str, str]) -> Iterator[str]:
    """The runs of a table with several, of which the evidence has only some."""
    files: dict[str, str] = {}
    for run in runs:
        episode = episode_of(places.get(run, ""))
        if episode is not None:
            files[episode.file] = run.rpartition("#")[0]
    for file, name in files.items():
        numbers = (path.removeprefix(file) for path in runs_of(file))
        yield from (f"{name}{number}" for number in numbers if f"{name}{number}" not in runs)


def _parts(run: str, location: str | None) -> Mapping[str, str | None]:
    """Path of each file of a run in a manifest → its present path."""
    try:
        about = _folder(location) if location is not None and not is_url(location) else None
    except OSError:
        about = None
    if location is not None and isinstance(about, Folder):
        described = is_folder(location)
        names = _normal(run) if described else os.path.dirname(_normal(run))
        files = (*about.files, *([METADATA] if described else []))
        return {
            _normal(os.path.join(names, name_of(n))): os.path.join(about.path, n) for n in files
        }
    episode = episode_of(location or "")
    if episode is not None:
        return {_normal(run.rpartition("#")[0]): episode.file}
    return {_normal(run): location}


def _folder(location: str) -> Folder | Diagnostic | None:
    """The folder of a run with several files, or None."""
    if is_folder(location):
        return folder(location)
    return None if os.path.lexists(location) else split(location)


def _differences(
    run: str,
    claim: str | None,
    listed: Mapping[str, str],
    parts: Mapping[str, str | None],
    location: str | None,
) -> Iterator[Recheck]:
    """The differences between one run and the manifest."""
    if not listed:
        yield differs(run, "", "the manifest does not name it")
        return
    for path, now in parts.items():
        if path not in listed:
            if os.path.basename(path) != METADATA:
                yield differs(run, "", f"the manifest does not name `{path}`")
            continue
        sha = claim if now == location and claim is not None else file_sha256(now) if now else None
        if sha is None:
            yield unknown(
                run, "", "its hash cannot be computed, so it cannot be compared with the manifest"
            )
        elif sha != listed[path]:
            yield differs(run, "", f"the manifest has another hash for `{path}`")
