"""Recorded logs: an MCAP file → samples of signals, and how healthy the file is.

A log is read from its first record to its last. What its summary states (where the chunks are,
how many messages there are) is held against what was found, so that a damaged place is a named
gap and never a silent loss. Times are nanoseconds.
"""

from __future__ import annotations

import hashlib
import os
import stat
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from statistics import median

import numpy as np

from fretish.clock import Clock
from fretish.declarations import Declarations, Signal
from fretish.diagnostic import Diagnostic
from fretish.source import Source, Span
from monitors import findings
from monitors.columns import Column, Columns
from monitors.container import MAGIC, Stream
from monitors.decoding import decoder, shape
from monitors.samples import Recording, Samples, Topic
from monitors.stamps import JUMP, Stamps, stamps
from monitors.walk import Walk

_MOST_TICKS = 20_000_000


@dataclass(frozen=True, slots=True)
class Overview:
    """A log as it is, whatever is bound."""

    recording: Recording
    """By log times, without samples."""
    numbers: Mapping[str, tuple[str, ...] | None]
    """Of each topic the fields that a signal can read; None where its messages cannot be read."""


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
    signals = [declarations.signals[name] for name in dict.fromkeys(wanted)]
    columns = Columns(declarations, signals)
    return _opened(path, lambda stream, place: _read(stream, place, columns, signals))


def look(path: str) -> Overview | Diagnostic:
    """Read a log without any bindings: what is in it, and how healthy it is.

    Args:
        path: the file, as the user names it.

    Returns:
        The overview, by log times; or what keeps the whole file from being read.
    """
    nothing = Declarations(Source("", ""), Clock(None, None), {}, {})
    columns = Columns(nothing, ())
    found = _opened(path, lambda stream, place: _read(stream, place, columns, ()))
    if isinstance(found, Diagnostic):
        return found
    return Overview(found, {topic: _numbers(stream) for topic, stream in columns.streams.items()})


def _numbers(stream: Stream) -> tuple[str, ...] | None:
    """The paths of all numbers in its messages; None where its messages cannot be read."""
    if isinstance(decoder(stream), str):
        return None
    known = shape(stream)
    if known is None:
        return ()
    fields = ((where, known.number(where)) for where in known.numbers())
    return tuple(
        f"{'.'.join(where)}{'[:]' if field is not None and field.many else ''}"
        for where, field in fields
    )


def _opened(
    path: str, use: Callable[[BufferedReader, Span], Recording | Diagnostic]
) -> Recording | Diagnostic:
    place = Source(path, "").span()
    try:
        mode = os.stat(path).st_mode
        if stat.S_ISDIR(mode):
            return findings.is_a_directory(place)
        if not stat.S_ISREG(mode):
            return findings.not_a_file(place)
        with Path(path).open("rb") as stream:
            return use(stream, place)
    except FileNotFoundError:
        return findings.no_such_file(place)
    except OSError as error:
        return findings.unreadable(error, place)


def _read(
    stream: BufferedReader, place: Span, columns: Columns, wanted: Sequence[Signal]
) -> Recording | Diagnostic:
    digest = hashlib.file_digest(stream, "sha256").hexdigest()
    size = stream.tell()
    stream.seek(0)
    start = stream.read(16)
    if not start:
        return findings.empty(place)
    if not start.startswith(MAGIC):
        return findings.not_a_log(start, place)
    walk = Walk(stream, size, columns)
    walk.run()
    columns.settle()
    unusable = _unusable(walk, place)
    if unusable is not None:
        return unusable
    recording = _recording(place, digest, size, columns, walk, wanted)
    return _too_long(recording, columns.clock, place) or recording


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
        findings=(*columns.findings(), *_clocks(columns, wanted), *findings.few(told, place)),
        intact=not damages,
    )


def _clocks(columns: Columns, wanted: Sequence[Signal]) -> list[Diagnostic]:
    """What is odd about the clocks of the topics that the signals read."""
    found: list[Diagnostic] = []
    ahead: dict[str, int] = {}
    signals = {
        signal.path.topic: signal for signal in wanted if signal.path.topic in columns.topics
    }
    for topic, signal in signals.items():
        column = columns.topics[topic]
        if zero := sum(column.unset):
            found.append(findings.zero_stamps(signal, zero, len(column.logs)))
        clock = _stamps(column)
        if clock is not None and clock.jumps:
            found.append(findings.clock_jumps(signal, clock.jumps, clock.largest))
        if clock is not None and not column.unstamped:
            ahead[topic] = clock.ahead
    middle = median(ahead.values()) if ahead else 0
    true = min(ahead, key=lambda topic: (abs(ahead[topic] - middle), abs(ahead[topic])), default="")
    for topic, shift in ahead.items():
        if abs(shift - ahead[true]) > JUMP:
            found.append(findings.mixed_clocks(signals[topic], true, shift - ahead[true]))
    return found


def _stamps(column: Column) -> Stamps | None:
    """Of the messages that the declared clock has a time for."""
    known = np.frombuffer(bytes(column.unset), np.uint8) == 0
    logs, times = np.array(column.logs, np.int64), np.array(column.times, np.int64)
    return stamps(logs[known], times[known])


def _topic(column: Column) -> Topic:
    times = np.sort(column.stamps())
    steps = np.diff(times)
    clock = _stamps(column) if column.bound else None  # of another there are only log times
    return Topic(
        name=column.name,
        type=column.type,
        encoding=column.encoding,
        count=len(column.logs),
        first_ns=int(times[0]) if len(times) else None,
        last_ns=int(times[-1]) if len(times) else None,
        longest_gap_ns=int(steps.max(initial=0)),
        out_of_order=column.late(),
        equal_stamps=int((steps == 0).sum()),
        median_period_ns=int(np.median(steps)) if len(steps) else None,
        unstamped=column.unstamped,
        zero_stamps=sum(column.unset),
        clock_jumps=clock.jumps if clock is not None else 0,
    )
