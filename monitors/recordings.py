"""Recorded logs: files → samples of signals, and how healthy the files are.

A log is read from its first record to its last. What its summary states (where the chunks are,
how many messages there are) is held against what was found, so that a damaged place is a named
gap and never a silent loss. The files of a rosbag2 folder are one log. Times are nanoseconds.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fretish.clock import Clock
from fretish.declarations import Declarations, Signal
from fretish.diagnostic import Code, Diagnostic
from fretish.source import Source, Span
from monitors import bags, findings, refusals
from monitors.bags import NOWHERE
from monitors.columns import Column, Columns
from monitors.container import MAGIC
from monitors.damage import Damage
from monitors.decoding import decoder, numbers
from monitors.examples import Examples
from monitors.folders import METADATA, Folder, folder, is_folder, of_all
from monitors.inputs import Input, opened, shown
from monitors.jsontext import held
from monitors.parts import Numbered, Part, around, widened
from monitors.samples import Gap, Recording, Samples, Topic
from monitors.walk import Sink, Walk

_MOST_TICKS = 20_000_000


@dataclass(frozen=True, slots=True)
class Overview:
    """A log as it is, whatever is bound."""

    recording: Recording
    """By log times, without samples."""
    numbers: Mapping[str, tuple[str, ...] | None]
    """Of each topic the fields that a signal can read; None where its messages cannot be read."""
    reasons: Mapping[str, str]
    """Why not."""


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
    return _opened(path, columns, Examples(columns), signals)


def look(path: str) -> Overview | Diagnostic:
    """Read a log without any bindings: what is in it, and how healthy it is.

    Args:
        path: the file, as the user names it.

    Returns:
        The overview, by log times; or what keeps the whole file from being read.
    """
    nothing = Declarations(Source("", ""), Clock(None, None), {}, {})
    columns = Columns(nothing, ())
    examples = Examples(columns)
    found = _opened(path, columns, examples, ())
    if isinstance(found, Diagnostic):
        return found
    streams = columns.streams.items()
    decoders = {topic: decoder(stream) for topic, stream in streams}
    return Overview(
        found,
        {topic: numbers(stream, examples.of(topic)) for topic, stream in streams},
        {topic: why for topic, why in decoders.items() if isinstance(why, str)},
    )


# One file, or several


@dataclass(frozen=True, slots=True)
class _Run:
    """What the files of one log have given."""

    sha256: str
    size: int
    spans: Sequence[Gap]
    """The first and the last whole message of each file."""
    damages: Sequence[tuple[Span, Damage, Gap | None]]
    """Each with its file, and the time that it has cost."""
    notes: Sequence[Diagnostic]


def _opened(
    path: str, columns: Columns, examples: Examples, wanted: Sequence[Signal]
) -> Recording | Diagnostic:
    """The log at a path: a file, standard input, what is at a URL, or a folder of rosbag2."""
    place = Source(shown(path), "").span()
    try:
        if is_folder(path):
            run = _folder(path, Numbered(examples), place)
        else:
            run = _file(path, examples, place)
    except OSError as error:
        return findings.unreadable(error, place)
    if isinstance(run, Diagnostic):
        return run
    columns.settle()
    recording = _recording(place, run, columns, examples, wanted)
    return _too_long(recording, columns.clock, place) or recording


def _file(path: str, sink: Sink, place: Span) -> _Run | Diagnostic:
    with opened(path) as found:
        if isinstance(found, Diagnostic):
            return found
        part = _part(found, sink, place)
    if isinstance(part, Diagnostic):
        return part
    if part.span is None:
        return findings.empty(place)
    damages = [(place, *damage) for damage in part.damages]
    notes = (*part.notes, *_alone(path, place))
    return _Run(part.sha256, part.size, (part.span,), damages, notes)


def _alone(path: str, place: Span) -> Iterator[Diagnostic]:
    """Whether the file is only a part of a run."""
    parent, name = os.path.split(path)
    try:
        about = folder(parent or ".") if is_folder(parent or ".") else None
    except OSError:
        return
    if isinstance(about, Folder) and len(about.files) > 1 and name in about.files:
        yield refusals.part_of_a_run(about.files.index(name), len(about.files), parent, place)


def _part(log: Input, sink: Sink, place: Span) -> Part | Diagnostic:
    """The messages of one file; or what keeps the whole file from being read."""
    start = log.stream.read(16)
    if not start:
        return findings.empty(place)
    if start.startswith((bags.BAG, bags.DB3)):
        if log.file is None:
            return refusals.bag_of_no_file(place)
        found = bags.read(log.file, start, sink, place)
        if isinstance(found, Diagnostic):
            return found
        return Part(log.sha256(), log.size, found.span, found.damages, found.notes)
    if not start.startswith(MAGIC):
        return findings.not_a_log(start, place)
    walk = Walk(log.stream, log.size, sink)
    walk.run()
    damages = walk.damages
    if damages.span is not None:
        return Part(log.sha256(), log.size, damages.span, tuple(walk.settled()))
    if walk.cut is not None:
        return findings.truncated(walk.cut, place)
    if damages.kept:
        return findings.nothing_whole(damages.kept[0], place)
    return Part(log.sha256(), log.size, None, ())


def _folder(path: str, sink: Numbered, place: Span) -> _Run | Diagnostic:
    """The files of one run, in the order that its description gives."""
    about = folder(path)
    if isinstance(about, Diagnostic):
        return about
    if about.compressed:
        return refusals.compressed_folder(about.compressed, place)
    places = [Source(os.path.join(path, name), "").span() for name in about.files]
    found: list[Part | Diagnostic] = []
    for file in places:
        sink.next_file()
        with opened(file.source.name) as log:
            found.append(log if isinstance(log, Diagnostic) else _part(log, sink, file))
    parts = [part for part in found if isinstance(part, Part)]
    spans = [part.span for part in parts if part.span is not None]
    if not spans:
        wrong = [part for part in found if isinstance(part, Diagnostic)]
        return wrong[0] if wrong else findings.empty(place)
    damages = list(_losses(about, places, found))
    if about.messages not in (None, sink.count) and not damages:
        lost = (min(a for a, _ in spans), max(b for _, b in spans))
        what = f"its {METADATA} states {about.messages} messages, and its files hold {sink.count}"
        damage = Damage(NOWHERE, what, code=Code.COUNT_MISMATCH)
        damages.append((place, damage, lost if sink.count < (about.messages or 0) else None))
    hashes = {
        name: part.sha256
        for name, part in zip(about.files, found, strict=True)
        if isinstance(part, Part)
    }
    notes = {note.message: note for part in parts for note in part.notes}
    size = sum(part.size for part in parts)
    return _Run(of_all(hashes), size, spans, damages, tuple(notes.values()))


def _losses(
    about: Folder, places: Sequence[Span], found: Sequence[Part | Diagnostic]
) -> Iterator[tuple[Span, Damage, Gap | None]]:
    """The damages of all files, in their order; a file that gave nothing is one."""
    parts = [part if isinstance(part, Part) else None for part in found]
    for i, (place, part) in enumerate(zip(places, found, strict=True)):
        before, after = around(parts, i)
        if isinstance(part, Part):
            for damage, gap in widened(part, before, after):
                yield place, damage, gap
        else:
            what = f"a file of the run is lost: {part.message}"
            yield place, Damage(NOWHERE, what, code=Code.LOST_PART), about.lost(i, before, after)


def _too_long(recording: Recording, clock: Clock, place: Span) -> Diagnostic | None:
    length = recording.end_ns - recording.start_ns
    if clock.period is None or length // clock.period < _MOST_TICKS:
        return None
    return findings.too_long(length, length // clock.period, clock, place)


def _recording(
    place: Span, run: _Run, columns: Columns, examples: Examples, wanted: Sequence[Signal]
) -> Recording:
    lost = [gap for _, _, gap in run.damages if gap is not None]
    gaps = tuple(sorted({columns.on_clock(gap) for gap in lost}))
    origin = min(start for start, _ in [*run.spans, *lost])
    told = [findings.damaged(damage, gap, origin, file) for file, damage, gap in run.damages]
    samples = {signal.name: Samples(*columns.samples(signal)) for signal in wanted}
    start, end = columns.span()
    return Recording(
        name=place.source.name,
        sha256=run.sha256,
        size=run.size,
        start_ns=min([start, *(gap[0] for gap in gaps)]),
        end_ns=max([end, *(gap[1] for gap in gaps)]),
        samples=samples,
        ticks=columns.ticks(),
        gaps=gaps,
        topics={name: _topic(column) for name, column in sorted(columns.topics.items())},
        nearest=columns.nearest,
        findings=(
            *columns.findings(),
            *_never_stated(samples, examples, wanted),
            *findings.few(told, place),
            *run.notes,
        ),
        intact=not run.damages,
    )


def _never_stated(
    samples: Mapping[str, Samples], examples: Examples, wanted: Sequence[Signal]
) -> list[Diagnostic]:
    """About signals that are unknown in all messages, in JSON that has no such field."""
    found = []
    for signal in wanted:
        values = samples[signal.name].values
        payloads = examples.of(signal.path.topic)
        if not payloads or not len(values) or not np.isnan(values).all():
            continue
        known = held(payloads)
        if ".".join(signal.path.fields) not in {path.removesuffix("[:]") for path in known}:
            found.append(findings.never_stated(signal, known))
    return found


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
