"""The reader of logs: from files to samples of signals, and the integrity of the files.

Where the index of a log explains every byte of it, only the messages in question are read. Any
other log is read from its first record to its last; what its summary states (where the chunks are,
how many messages there are) is compared with what was found, so that a damaged place is a named
gap and never a silent loss. The files of a rosbag2 folder are one log. Times are nanoseconds.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial, reduce
from operator import add

from fretc.logs import containers, log_diagnostics, watch_records
from fretc.logs.first_messages import FirstMessages
from fretc.logs.mcap.container import BrokenError
from fretc.logs.mcap.damage import Damage
from fretc.logs.mcap.messages import Sink
from fretc.logs.mcap.metadata import Described, of_record, together
from fretc.logs.messages.decoding import decoder, leaves
from fretc.logs.messages.leaves import Leaves, numbers
from fretc.logs.signals.integrity import Checked, Integrity
from fretc.logs.signals.memory import with_memory
from fretc.logs.signals.samples import Gap, Recording, Samples
from fretc.logs.storage import storage_diagnostics
from fretc.logs.storage.bags import NOWHERE
from fretc.logs.storage.folders import METADATA, Folder, folder, is_folder, of_all
from fretc.logs.storage.inputs import OpenLog, opened
from fretc.logs.storage.log_names import name_of
from fretc.logs.storage.parts import FileContents, RenumberingSink, around, widened
from fretc.logs.storage.splits import ACTIVE, run_name, split
from fretc.logs.tables.episodes import episode_of
from fretc.logs.topic_columns import Columns
from fretc.logs.topics import clocks, never_stated, topic
from fretc.logs.vocabulary import MessageTexts, Words
from fretc.logs.watch_records import watched
from fretish.bindings.declarations import Declarations, Signal
from fretish.classes.frozen import dataclass
from fretish.clock import Clock
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget

_MOST_TICKS = 20_000_000


@dataclass(frozen=True, slots=True)
class Overview:
    """The contents of a log, independent of bindings."""

    recording: Recording
    """The recording by log times, without samples."""
    leaves: Mapping[str, Leaves | None]
    """For each topic the fields that a signal can read; None: its messages cannot be read."""
    reasons: Mapping[str, str]
    """The reasons why messages cannot be read."""
    words: Mapping[str, Words] = field(default_factory=dict)
    """For each topic the values of its texts, if they were asked for."""

    @property
    def numbers(self) -> Mapping[str, tuple[str, ...] | None]:
        """The paths of the numbers and truth values of each topic."""
        return {
            topic: None if leaves is None else numbers(leaves)
            for topic, leaves in self.leaves.items()
        }


def read(
    path: str,
    declarations: Declarations,
    wanted: Collection[str],
    integrity: Integrity = Integrity.HASH,
    beside: Sequence[Signal] = (),
) -> Recording | Diagnostic:
    """Read a log.

    Args:
        path: the file, as the user names it.
        declarations: clock and signals.
        wanted: names of declared signals.
        integrity: how thoroughly the log is checked beyond the bound messages. A log that does not
            match its index is checked in full.
        beside: further signals of topics that a wanted one reads. Nothing else in the recording
            depends on them.

    Returns:
        The recording, with findings about single topics and damaged places; or what keeps the
        whole file from being read. Of a signal with an error among the findings there are no
        samples.

    Raises:
        KeyError: a wanted signal is not declared.
    """
    signals = [declarations.signals[name] for name in dict.fromkeys(wanted)]
    reading = partial(_read_log, path, declarations, signals, integrity, beside)
    return with_budget(0, Source(name_of(path), "").span(), reading)


def _read_log(
    path: str,
    declarations: Declarations,
    signals: Sequence[Signal],
    integrity: Integrity,
    beside: Sequence[Signal],
) -> Recording | Diagnostic:
    sources = [source for some in declarations.labels.values() for source in some]
    named = {source.text for source in sources if not source.is_path}
    asked = frozenset(named) | watch_records.KEYS
    log = _opened(path, lambda: Columns(declarations, signals, beside), integrity, asked)
    if isinstance(log, Diagnostic):
        return log
    place, run, columns, examples = log
    recording = _recording(place, run, columns, examples, signals, beside)
    return _too_long(recording, columns.clock, place) or recording


def look(path: str, *, words: bool = False) -> Overview | Diagnostic:
    """Read a log without bindings: its contents and its integrity.

    Args:
        path: the file, as the user names it.
        words: whether the values of texts are wanted: then messages with texts are decoded.

    Returns:
        The overview, by log times; or what keeps the whole file from being read.
    """
    return with_budget(0, Source(name_of(path), "").span(), partial(_look, path, words))


def _look(path: str, words: bool) -> Overview | Diagnostic:
    nothing = Declarations(Source("", ""), Clock(None, None), {}, {})
    vocabulary = MessageTexts() if words else None
    log = _opened(path, lambda: Columns(nothing, ()), Integrity.FULL, vocabulary=vocabulary)
    if isinstance(log, Diagnostic):
        return log
    place, run, columns, examples = log
    streams = columns.streams.items()
    decoders = {topic: decoder(stream) for topic, stream in streams}
    return Overview(
        _recording(place, run, columns, examples, ()),
        {topic: leaves(stream, examples.of(topic)) for topic, stream in streams},
        {topic: why for topic, why in decoders.items() if isinstance(why, str)},
        {topic: vocabulary.of(topic) for topic in columns.streams} if vocabulary else {},
    )


# One file, or several


@dataclass(frozen=True, slots=True)
class _LogContents:
    """The contents of the files of one log."""

    sha256: str
    size: int
    spans: Sequence[Gap]
    """The first and the last whole message of each file."""
    damages: Sequence[tuple[Span, Damage, Gap | None]]
    """The damages, each with its file and the time of the lost messages."""
    notes: Sequence[Diagnostic]
    checked: Checked
    described: Described
    """The wanted values of its metadata."""


_Read = tuple[Span, _LogContents, Columns, FirstMessages]
"""A log, and the sink that received its messages."""


def _opened(
    path: str,
    new: Callable[[], Columns],
    integrity: Integrity,
    asked: Collection[str] = (),
    vocabulary: MessageTexts | None = None,
) -> _Read | Diagnostic:
    """The log at a path: a file, standard input, a URL, or a folder of rosbag2."""
    span = Source(name_of(path), "").span()
    try:
        if is_folder(path):
            run = partial(_folder, folder(path), asked)
            return _tried(run, span, new, integrity, vocabulary)
        if not os.path.lexists(path) and (parts := split(path)) is not None:
            return _tried(partial(_folder, parts, asked), span, new, integrity, vocabulary)
        episode = episode_of(path)
        file = path if episode is None else episode.file
        with opened(file, whole=integrity is not Integrity.INDEX) as log:
            if isinstance(log, Diagnostic):
                return log
            if episode is not None:
                log = replace(log, episode=episode.number)
            found = _tried(partial(_file, path, log, asked), span, new, integrity, vocabulary)
            if not (isinstance(found, Diagnostic) and log.changed() and containers.only_grows(log)):
                return found
            held = log.beginning()
            if held is None:
                return found
            begun = partial(_beginning, path, held, asked)
            return _tried(begun, span, new, integrity, vocabulary)
    except OSError as error:
        return storage_diagnostics.unreadable(error, span)


def _tried(
    use: Callable[[Sink, Integrity, Span], _LogContents | Diagnostic],
    span: Span,
    new: Callable[[], Columns],
    integrity: Integrity,
    vocabulary: MessageTexts | None,
) -> _Read | Diagnostic:
    """Read a log; if it does not match its index, read it again in full."""
    columns = new()
    examples = FirstMessages(columns, vocabulary)
    try:
        run = use(examples, integrity, span)
    except BrokenError:
        assert integrity is not Integrity.FULL
        return _tried(use, span, new, Integrity.FULL, vocabulary)
    columns.settle()
    return run if isinstance(run, Diagnostic) else (span, run, columns, examples)


def _file(
    path: str, log: OpenLog, asked: Collection[str], sink: Sink, integrity: Integrity, place: Span
) -> _LogContents | Diagnostic:
    part = containers.part(log, sink, integrity, place, asked)
    if isinstance(part, Diagnostic):
        return part
    if part.span is None:
        return diagnostic("empty_log", place)
    damages, notes = (
        [(place, *damage) for damage in part.damages],
        (*part.notes, *_alone(path, place)),
    )
    described = together([*_of_folder(path, asked), part.described])
    return _LogContents(
        part.sha256, part.size, (part.span,), damages, notes, part.checked, described
    )


def _of_folder(path: str, asked: Collection[str]) -> Iterator[Described]:
    """The custom data of the run in the metadata of rosbag2 beside a file."""
    parent = os.path.dirname(path) or "."
    try:
        about = folder(parent) if asked and is_folder(parent) else None
    except OSError:
        return
    if isinstance(about, Folder) and os.path.basename(path) in about.files:
        yield of_record(_CUSTOM, about.custom, asked)


_CUSTOM = "custom_data"
"""The name of custom data in the metadata of a folder."""


def _beginning(
    path: str, log: OpenLog, asked: Collection[str], sink: Sink, integrity: Integrity, place: Span
) -> _LogContents | Diagnostic:
    """The first bytes of a file that has grown since it was opened."""
    run = _file(path, log, asked, sink, integrity, place)
    if isinstance(run, Diagnostic):
        return run
    return replace(run, notes=(*run.notes, diagnostic("grown_log", place, size=f"{log.size:,}")))


def _alone(path: str, span: Span) -> Iterator[Diagnostic]:
    """Diagnostics of a file that is only a part of a run."""
    parent, name = os.path.split(path)
    try:
        about = folder(parent or ".") if is_folder(parent or ".") else None
        bags_of_run = split(path) if name.endswith((".bag", ACTIVE)) else None
    except OSError:
        return
    if isinstance(about, Folder) and len(about.files) > 1 and name in about.files:
        whole = f"the folder `{parent or '.'}`"
    elif bags_of_run is not None:
        about, whole = bags_of_run, f"'{run_name(bags_of_run)}'"
    else:
        return
    yield storage_diagnostics.part_of_a_run(about.files.index(name), len(about.files), whole, span)


def _folder(
    about: Folder | Diagnostic,
    asked: Collection[str],
    one: Sink,
    integrity: Integrity,
    span: Span,
) -> _LogContents | Diagnostic:
    """The files of one run, in the order of its metadata."""
    sink = RenumberingSink(one)
    if isinstance(about, Diagnostic):
        return about
    if about.compressed:
        return diagnostic("compressed_run", span, mode=about.compressed)
    paths = [os.path.join(about.path, name) for name in about.files]
    places = [Source(name_of(path), "").span() for path in paths]
    contents: list[FileContents | Diagnostic] = []
    for path, file in zip(paths, places, strict=True):
        sink.next_file()
        with opened(path) as log:
            contents.append(
                log
                if isinstance(log, Diagnostic)
                else containers.part(log, sink, integrity, file, asked)
            )
    parts = [part for part in contents if isinstance(part, FileContents)]
    spans = [part.span for part in parts if part.span is not None]
    if not spans:
        wrong = [part for part in contents if isinstance(part, Diagnostic)]
        return wrong[0] if wrong else diagnostic("empty_log", span)
    damages = list(_losses(about, places, contents))
    if about.messages not in (None, sink.counted) and not damages:
        lost = (min(a for a, _ in spans), max(b for _, b in spans))
        what = f"its {METADATA} states {about.messages} messages, but its files hold {sink.counted}"
        damage = Damage(NOWHERE, what, code=Code.COUNT_MISMATCH)
        damages.append((span, damage, lost if sink.counted < (about.messages or 0) else None))
    hashes = {
        name: part.sha256
        for name, part in zip(about.files, contents, strict=True)
        if isinstance(part, FileContents)
    }
    notes = {note.message: note for part in parts for note in part.notes}
    size = sum(part.size for part in parts)
    checked = reduce(add, (part.checked for part in parts))
    custom = of_record(_CUSTOM, about.custom, asked)
    described = together([custom, *(part.described for part in parts)])
    return _LogContents(
        of_all(hashes), size, spans, damages, tuple(notes.values()), checked, described
    )


def _losses(
    about: Folder, places: Sequence[Span], contents: Sequence[FileContents | Diagnostic]
) -> Iterator[tuple[Span, Damage, Gap | None]]:
    """The damages of all files, in their order; an unreadable file is one damage."""
    parts = [part if isinstance(part, FileContents) else None for part in contents]
    for i, (place, part) in enumerate(zip(places, contents, strict=True)):
        before, after = around(parts, i)
        if isinstance(part, FileContents):
            for damage, gap in widened(part, before, after):
                yield place, damage, gap
        else:
            what = f"a file of the run cannot be read: {part.message}"
            yield place, Damage(NOWHERE, what, code=Code.LOST_PART), about.lost(i, before, after)


def _too_long(recording: Recording, clock: Clock, span: Span) -> Diagnostic | None:
    length = recording.end_ns - recording.start_ns
    if clock.period is None or length // clock.period < _MOST_TICKS:
        return None
    return log_diagnostics.too_long(length, length // clock.period, clock, span)


def _recording(
    place: Span,
    run: _LogContents,
    columns: Columns,
    examples: FirstMessages,
    wanted: Sequence[Signal],
    beside: Sequence[Signal] = (),
) -> Recording:
    lost = [gap for _, _, gap in run.damages if gap is not None]
    gaps = tuple(sorted({columns.on_clock(gap) for gap in lost}))
    watch = watched(columns, run.described, place)
    columns.frames.gaps = [*lost, *watch.missed]
    origin = min(start for start, _ in [*run.spans, *lost])
    damages = [
        log_diagnostics.damaged(damage, gap, origin, file) for file, damage, gap in run.damages
    ]
    samples, others = (
        {
            signal.name: Samples(*columns.samples(signal), signal.scale, signal.values)
            for signal in signals
        }
        for signals in (wanted, beside)
    )
    start, end = columns.span((min(a for a, _ in run.spans), max(b for _, b in run.spans)))
    missed = [columns.on_clock(span) for span in watch.missed]
    gaps = tuple(sorted({*gaps, *missed}))
    last = max([end, *(gap[1] for gap in gaps), watch.until])
    by_name = {signal.name: signal for signal in (*wanted, *beside)}
    samples, others = (
        {name: with_memory(by_name[name], each, gaps, last) for name, each in some.items()}
        for some in (samples, others)
    )
    return Recording(
        name=place.source.name,
        sha256=run.sha256,
        size=run.size,
        start_ns=min([start, *(gap[0] for gap in gaps)]),
        end_ns=last,
        samples=samples,
        ticks=columns.ticks(),
        gaps=gaps,
        topics={name: topic(column) for name, column in sorted(columns.topics.items())},
        nearest=columns.nearest,
        findings=(
            *columns.findings(),
            *clocks(columns, wanted),
            *never_stated(samples, examples, wanted),
            *log_diagnostics.few(damages, place),
            *run.notes,
            *watch.findings,
            *columns.reports.findings(place),
        ),
        intact=not run.damages and not watch.lost,
        checked=run.checked,
        beside=others,
        described=run.described,
        origin=watch.origin,
        late=columns.late(),
        agents=columns.reports.traces(),
    )
