"""Recorded logs: an MCAP file → samples of signals, and how healthy the file is.

A log is read from its first record to its last. What its summary states (where the chunks are,
how many messages there are) is held against what was found, so that a damaged place is a named
gap and never a silent loss. Times are nanoseconds.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Collection, Sequence
from io import BufferedReader
from pathlib import Path

import numpy as np

from fretish.clock import Clock
from fretish.declarations import Declarations, Signal
from fretish.diagnostic import Diagnostic
from fretish.source import Source, Span
from monitors import findings
from monitors.columns import Column, Columns
from monitors.container import MAGIC
from monitors.samples import Recording, Samples, Topic
from monitors.walk import Walk

_MOST_TICKS = 20_000_000


def read(path: str, declarations: Declarations, wanted: Collection[str]) -> Recording | Diagnostic:
    """Read a log.

    All bytes are hashed and all records walked; only the messages in question are decoded.

    Args:
        path: the file, as the user names it.
        declarations: clock and signals.
        wanted: names of declared signals.

    Returns:
        The recording, with findings about single topics and damaged places; or what keeps the
        whole file from being read. Of a signal with an error among the findings there are no
        samples.

    Raises:
        KeyError: a wanted signal is not declared.
    """
    place = Source(path, "").span()
    signals = [declarations.signals[name] for name in dict.fromkeys(wanted)]
    try:
        mode = os.stat(path).st_mode
        if stat.S_ISDIR(mode):
            return findings.is_a_directory(place)
        if not stat.S_ISREG(mode):
            return findings.not_a_file(place)
        with Path(path).open("rb") as stream:
            return _read(stream, place, declarations, signals)
    except FileNotFoundError:
        return findings.no_such_file(place)
    except OSError as error:
        return findings.unreadable(error, place)


def _read(
    stream: BufferedReader, place: Span, declarations: Declarations, wanted: Sequence[Signal]
) -> Recording | Diagnostic:
    digest = hashlib.file_digest(stream, "sha256").hexdigest()
    size = stream.tell()
    stream.seek(0)
    start = stream.read(16)
    if not start:
        return findings.empty(place)
    if not start.startswith(MAGIC):
        return findings.not_a_log(start, place)
    columns = Columns(declarations, wanted)
    walk = Walk(stream, size, columns)
    walk.run()
    columns.settle()
    unusable = _unusable(walk, place)
    if unusable is not None:
        return unusable
    recording = _recording(place, digest, size, columns, walk, wanted)
    return _too_long(recording, declarations.clock, place) or recording


def _unusable(walk: Walk, place: Span) -> Diagnostic | None:
    """What keeps the whole file from being read."""
    damages = walk.damages
    if damages.span is not None:
        return None
    if walk.cut is not None:
        return findings.truncated(walk.cut, place)
    return findings.nothing_whole(damages.kept[0], place) if damages.kept else findings.empty(place)


def _too_long(recording: Recording, clock: Clock, place: Span) -> Diagnostic | None:
    length = recording.end_ns - recording.start_ns
    if clock.period is None or length // clock.period < _MOST_TICKS:
        return None
    return findings.too_long(length, length // clock.period, clock, place)


def _recording(
    place: Span,
    digest: str,
    size: int,
    columns: Columns,
    walk: Walk,
    wanted: Sequence[Signal],
) -> Recording:
    damages = walk.settled()
    lost = [gap for _, gap in damages if gap is not None]
    gaps = tuple(sorted({columns.on_clock(gap) for gap in lost}))
    assert walk.damages.span is not None
    origin = min(start for start, _ in [walk.damages.span, *lost])
    told = [findings.damaged(damage, gap, origin, place) for damage, gap in damages]
    start, end = columns.span()
    return Recording(
        name=place.source.name,
        sha256=digest,
        size=size,
        start_ns=min([start, *(gap[0] for gap in gaps)]),
        end_ns=max([end, *(gap[1] for gap in gaps)]),
        samples={signal.name: Samples(*columns.samples(signal)) for signal in wanted},
        ticks=columns.ticks(),
        gaps=gaps,
        topics={name: _topic(column) for name, column in sorted(columns.topics.items())},
        nearest=columns.nearest,
        findings=(*columns.findings(), *findings.few(told, place)),
        intact=not damages,
    )


def _topic(column: Column) -> Topic:
    stamps = np.sort(column.stamps())
    steps = np.diff(stamps)
    return Topic(
        name=column.name,
        type=column.type,
        encoding=column.encoding,
        count=len(column.logs),
        first_ns=int(stamps[0]) if len(stamps) else None,
        last_ns=int(stamps[-1]) if len(stamps) else None,
        longest_gap_ns=int(steps.max(initial=0)),
        out_of_order=column.late(),
        equal_stamps=int((steps == 0).sum()),
    )
