"""Columns of times and numbers from messages: for each topic the data that the signals read.

Times are nanoseconds. Only the messages of bound topics are decoded.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Sequence
from dataclasses import field, replace

import numpy as np
from numpy.typing import NDArray

from fretc.logs import log_diagnostics
from fretc.logs.agents.reports import AgentReports
from fretc.logs.extraction import Extract, Extraction
from fretc.logs.frames.frame_columns import FrameColumns
from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.damage import LATEST
from fretc.logs.mcap.messages import FileTimes, Messages
from fretc.logs.mcap.payloads import Payloads
from fretc.logs.signals.enum_values import UnmappedSamples
from fretc.logs.signals.samples import Gap, Late, NumberList, Times, Values
from fretc.logs.signals.topic_clocks import JUMP, forward_fill, late, unset
from fretish.bindings.declarations import Declarations, Signal, short_type
from fretish.classes.frozen import dataclass
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Span

_MOST, _MOST_BYTES = 4096, 2**22
"""The most messages, and the most bytes of them, that are decoded at once."""
_ENOUGH, _ENOUGH_BYTES = 1024, 2**18
"""So many messages, or so many bytes of them, are decoded at once; fewer wait for others of their
stream."""


@dataclass(slots=True)
class Pending:
    """Messages of one stream that wait to be decoded."""

    stream: ChannelDefinition
    logs: list[int] = field(default_factory=list)
    publishes: list[int] = field(default_factory=list)
    payloads: list[bytes] = field(default_factory=list)
    size: int = 0

    def add(self, logs: Sequence[int], publishes: Sequence[int], payloads: Sequence[bytes]) -> None:
        """Add messages."""
        self.logs.extend(logs)
        self.publishes.extend(publishes)
        self.payloads.extend(payloads)
        self.size += sum(map(len, payloads))

    @property
    def full(self) -> bool:
        """Whether they should be decoded before another one is added."""
        return len(self.logs) >= _MOST or self.size >= _MOST_BYTES


@dataclass(slots=True)
class TopicColumn:
    """The data of one topic; `logs` are the log times, `times` those of the declared clock.

    Until all messages have come, `times` are the times in the messages.
    """

    name: str
    type: str
    encoding: str
    bound: bool
    """Whether the topic is bound; of other topics only log times are read."""
    signals: list[Signal]
    """The wanted and readable signals of the topic."""
    logs: array[int] = field(default_factory=lambda: array("q"))
    times: array[int] = field(default_factory=lambda: array("q"))
    values: dict[str, NumberList] = field(default_factory=dict)
    diagnostics: dict[str, Diagnostic] = field(default_factory=dict)
    """For each signal without samples, the reason."""
    foreign: dict[str, UnmappedSamples] = field(default_factory=dict)
    """For each enumeration signal, the samples that are not among its values."""
    types: dict[str, None] = field(default_factory=dict)
    """The types of its messages, in the order of the file."""
    pending: Pending | None = None
    undecoded: int = 0
    unstamped: int = 0
    timeless: bytearray = field(default_factory=bytearray)
    """For each message 1 if the declared clock gives it no time."""
    unset: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    """For each message whether its time was never set: it is zero, and its samples are unknown."""
    placed: bool = False
    """Whether the declared clock gives any of its messages a time."""
    stated: int = 0
    """The number of messages that the log states and that were not read."""

    @property
    def count(self) -> int:
        """The number of messages."""
        return len(self.logs) + self.stated

    def refuse(self, signal: Signal, diagnostic: Diagnostic) -> None:
        """Drop the samples of a signal, for the given reason."""
        if signal in self.signals:
            self.signals.remove(signal)
        self.diagnostics[signal.name] = diagnostic
        self.values.pop(signal.name, None)
        self.foreign.pop(signal.name, None)

    def raw(self) -> tuple[Times, Times]:
        """Log times, and the times in the messages; in the order of the file."""
        logs = np.array(self.logs, np.int64)
        return logs, np.array(self.times, np.int64) if self.bound else logs

    def place(self, *, from_zero: bool) -> None:
        """Find the times that were never set; each such message gets the time of the one before."""
        logs, times = self.raw()
        timeless = np.frombuffer(bytes(self.timeless), np.bool_) if self.bound else logs < 0
        self.unset = ~timeless & unset(logs, times, from_zero=from_zero)
        lost = timeless | self.unset
        self.placed = not lost.all()
        self.times = array("q", (forward_fill(times, lost) if self.placed else logs).tobytes())

    def stamps(self) -> Times:
        """The times in the order of the file; log times if no signal reads the topic."""
        return np.array(self.times, np.int64)

    def numbers(self, signal: Signal) -> Values:
        """The numbers of a signal; unknown in messages whose time was never set."""
        numbers = self.values[signal.name].values().copy()
        numbers[self.unset] = np.nan
        return numbers

    def late(self) -> int:
        """The number of messages that are out of order."""
        stamps = self.stamps()
        return int((stamps < np.maximum.accumulate(stamps)).sum())


class Columns:
    """A sink that keeps the times and numbers of the signals."""

    def __init__(
        self, declarations: Declarations, wanted: Sequence[Signal], beside: Sequence[Signal] = ()
    ) -> None:
        """An empty sink.

        Args:
            declarations: the declared clock and topics.
            wanted: the signals to read.
            beside: further signals of topics that a wanted one reads; they get no diagnostics.
        """
        self.topics: dict[str, TopicColumn] = {}
        """Every topic of the log."""
        self.streams: dict[str, ChannelDefinition] = {}
        """The first stream of each topic."""
        self.nearest: dict[str, float] = {}
        self.clock = declarations.clock
        self.reports = AgentReports(declarations.agent_trace, declarations.clock)
        self._source = declarations.source
        self._wanted = wanted
        topics = {signal.path.topic for signal in wanted}
        self._read_signals = (*wanted, *(one for one in beside if one.path.topic in topics))
        self.frames = FrameColumns(self._read_signals)
        self._bound = {signal.path.topic for signal in declarations.signals.values()}
        self._bound |= {self.clock.topic} if self.clock.topic else set()
        self._extractions: dict[int, Extraction] = {}

    # Messages

    def declare(self, stream: ChannelDefinition) -> None:
        """A topic of the log, with or without messages."""
        topic, type_ = stream.channel.topic, stream.schema.name if stream.schema else ""
        self.streams.setdefault(topic, stream)
        if topic not in self.topics:
            self.topics[topic] = TopicColumn(
                topic,
                type_,
                stream.channel.message_encoding,
                topic in self._bound,
                [s for s in self._read_signals if s.path.topic == topic and s.pose is None],
            )
        column = self.topics[topic]
        poses = [signal for signal in self.frames.signals if signal.path.topic == topic]
        for signal in (*column.signals, *poses):
            declared = signal.type and short_type(signal.type)
            if stream.schema and declared and declared != short_type(type_):
                column.refuse(signal, log_diagnostics.wrong_type(signal, type_))

    def add(
        self, stream: ChannelDefinition, log_time: int, publish_time: int, payload: memoryview
    ) -> None:
        """Add one message; messages of bound topics wait for others of their stream."""
        column = self.topics[stream.channel.topic]
        if column.name == self.reports.topic:
            self.reports.take(stream, log_time, publish_time, bytes(payload))
        if self.frames.is_static(column.name):
            self.frames.take(stream, [log_time], [bytes(payload)])
        if not column.bound:
            column.logs.append(log_time)
            return
        payloads = [bytes(payload) if self._keeps(column) else b""]
        self._wait(column, stream, [log_time], [publish_time], payloads)

    def add_all(self, stream: ChannelDefinition, messages: Messages) -> None:
        """Add messages of one topic, in their order."""
        column = self.topics[stream.channel.topic]
        logs = messages.logs.astype(np.int64)
        if column.name == self.reports.topic:
            times = zip(logs.tolist(), messages.publishes.tolist(), strict=True)
            for payload, (log, publish) in zip(messages.payloads.copies(), times, strict=True):
                self.reports.take(stream, log, publish, payload)
        if self.frames.is_static(column.name):
            self.frames.take(stream, logs.tolist(), messages.payloads.copies())
        if not column.bound:
            column.logs.frombytes(logs.tobytes())
            return
        if len(messages) >= _ENOUGH or messages.payloads.sizes.sum() >= _ENOUGH_BYTES:
            self._settle(column)
            self._read(column, stream, logs, messages.publishes, messages.payloads)
            return
        payloads = messages.payloads.copies() if self._keeps(column) else [b""] * len(logs)
        self._wait(column, stream, logs.tolist(), messages.publishes.tolist(), payloads)

    def wants(self, topic: str) -> bool:
        """Whether the topic is bound, or has the reports of agents or static transforms."""
        return topic in self._bound or topic == self.reports.topic or self.frames.reads(topic)

    def count(self, stream: ChannelDefinition, count: int) -> None:
        """Count messages of a topic that is not bound."""
        self.topics[stream.channel.topic].stated += count

    def _decodes(self, column: TopicColumn) -> bool:
        """Whether messages of the topic must be decoded."""
        return bool(column.signals) or self.clock.time is TimeSource.HEADER_STAMP

    def _keeps(self, column: TopicColumn) -> bool:
        """Whether the payloads of messages of the topic are needed."""
        return self._decodes(column) or self.frames.reads(column.name)

    def _wait(
        self,
        column: TopicColumn,
        stream: ChannelDefinition,
        logs: Sequence[int],
        publishes: Sequence[int],
        payloads: Sequence[bytes],
    ) -> None:
        """Keep messages until there are many of their stream, or another stream follows."""
        pending = column.pending
        if pending is None or pending.stream != stream:
            self._settle(column)
            pending = column.pending = Pending(stream)
        pending.add(logs, publishes, payloads)
        if pending.full:
            self._settle(column)

    def settle(self) -> None:
        """Decode the waiting messages, because no others follow."""
        for column in self.topics.values():
            self._settle(column)
        from_zero = self._begins_at_zero()
        for column in self.topics.values():
            column.place(from_zero=from_zero)

    def _begins_at_zero(self) -> bool:
        """Whether the declared clock begins at zero, by the bound topics, or else by all."""
        columns = self.topics.values()
        of_all = [c for c in columns if c.bound and c.logs] or list(columns)
        times = (column.raw()[1] for column in of_all)
        return any(((some > 0) & (some <= JUMP)).any() for some in times)

    def _settle(self, column: TopicColumn) -> None:
        pending, column.pending = column.pending, None
        if pending is not None:
            logs, publishes = np.array(pending.logs, np.int64), np.array(pending.publishes, "u8")
            payloads = Payloads.of(pending.payloads)
            self._read(column, pending.stream, logs, publishes, payloads)

    def _read(
        self,
        column: TopicColumn,
        stream: ChannelDefinition,
        logs: Times,
        publishes: FileTimes,
        payloads: Payloads,
    ) -> None:
        """Decode messages of one stream and store their data."""
        column.types[short_type(stream.schema.name) if stream.schema else ""] = None
        extract = self._extract(column, stream, payloads)
        times, dated = self._times(column, extract, logs, publishes)
        usable = times < LATEST
        column.undecoded += int((~usable).sum())
        if self.frames.reads(column.name) and not self.frames.is_static(column.name):
            kept = [one for one, use in zip(payloads.copies(), usable, strict=True) if use]
            self.frames.take(stream, logs[usable].tolist(), kept)
        before = len(column.times)
        column.logs.frombytes(logs[usable].tobytes())
        column.times.frombytes(times[usable].tobytes())
        column.timeless.extend((~dated[usable]).tobytes())
        for signal in column.signals:
            column.values.setdefault(signal.name, NumberList()).add(
                extract.values[signal.name][usable]
            )
            foreign = extract.foreign_of(signal.name, usable)
            if foreign is not None:
                later = replace(foreign, first=before + foreign.first)
                earlier = column.foreign.get(signal.name)
                column.foreign[signal.name] = earlier.followed(later) if earlier else later

    def _extract(
        self, column: TopicColumn, stream: ChannelDefinition, payloads: Payloads
    ) -> Extract:
        """The data of the signals; a signal with a diagnostic gets no samples."""
        if not self._decodes(column):
            return Extract.empty(len(payloads), ())
        id = stream.channel.id
        if id not in self._extractions:
            self._extractions[id] = Extraction(stream, column.signals)
        extraction = self._extractions[id]
        extract = extraction.extract(payloads)
        for signal in tuple(column.signals):
            if signal.name in extraction.diagnostics:
                column.refuse(signal, extraction.diagnostics[signal.name])
        if extraction.reads:
            column.undecoded += int((~extract.decoded).sum())
        for name, least in extract.nearest.items():
            self.nearest[name] = min(least, self.nearest.get(name, least))
        return extract

    def _times(
        self, column: TopicColumn, extract: Extract, logs: Times, publishes: FileTimes
    ) -> tuple[Times, NDArray[np.bool_]]:
        """The times of the messages on the declared clock, and a mask of those with one."""
        every = np.ones(len(logs), bool)
        match self.clock.time:
            case TimeSource.LOG_TIME:
                return logs, every
            case TimeSource.PUBLISH_TIME:
                return publishes.clip(max=LATEST).astype(np.int64), every
            case TimeSource.HEADER_STAMP:
                stamped = extract.decoded & extract.stamped
                column.unstamped += int((extract.decoded & ~stamped).sum())
                return np.where(stamped, extract.stamps, logs), extract.decoded

    # The results

    def samples(self, signal: Signal) -> tuple[Times, Values]:
        """Times and values of one signal, in order of time; empty if it has a diagnostic."""
        column = self.topics.get(signal.path.topic)
        if column is not None and signal.pose is not None and signal.name not in column.diagnostics:
            return self.frames.samples(signal, column.stamps(), column.unset)
        if column is None or signal.name not in column.values:
            return np.zeros(0, np.int64), np.zeros(0)
        times, numbers = column.stamps(), column.numbers(signal)
        if (times[1:] >= times[:-1]).all():
            return times, numbers
        order = np.argsort(times, kind="stable")
        return times[order], numbers[order]

    def ticks(self) -> Times:
        """The times of the clock's topic, if the clock ticks by message."""
        column = self.topics.get(self.clock.topic or "")
        return np.sort(np.array(column.times if column else [], np.int64))

    def late(self) -> dict[str, Late]:
        """The late messages of each bound topic; empty if no lateness is declared."""
        lateness = self.clock.effective_lateness
        if lateness is None or self.clock.time is TimeSource.LOG_TIME:
            return {}
        late_messages = {
            column.name: late(np.array(column.logs, np.int64), column.stamps(), lateness)
            for column in self.topics.values()
            if column.bound
        }
        return {name: each for name, each in late_messages.items() if each is not None}

    def span(self, log: Gap) -> Gap:
        """First and last message of the bound topics, or else of all; without any, `log`.

        A topic counts if the declared clock gives any of its messages a time. Topics that are not
        bound count by log time only, because an index has no other time for them.
        """
        columns = [column for column in self.topics.values() if column.placed]
        times = [c.stamps() for c in columns if c.bound]
        if not times and self.clock.time is TimeSource.LOG_TIME:
            times = [c.stamps() for c in columns]
        if not times:
            return log
        return min(int(some.min()) for some in times), max(int(some.max()) for some in times)

    def on_clock(self, gap: Gap) -> Gap:
        """A span of log times on the declared clock, by the messages around it."""
        columns = [column for column in self.topics.values() if column.bound and column.placed]
        if self.clock.time is TimeSource.LOG_TIME or not columns:
            zeros = any(column.unset.any() for column in self.topics.values())
            return gap if gap[0] or not zeros else (min(self.span(gap)[0], gap[1]), gap[1])
        logs = np.concatenate([np.array(column.logs, np.int64) for column in columns])
        times = np.concatenate([np.array(column.times, np.int64) for column in columns])
        before, after = times[logs < gap[0]], times[logs > gap[1]]
        start = int(before.max()) if len(before) else int(times.min())
        end = int(after.min()) if len(after) else int(times.max())
        return min(start, end), max(start, end)

    # Diagnostics

    def findings(self) -> list[Diagnostic]:
        """Diagnostics of single topics: missing ones first, then unusual ones."""
        diagnostics = [
            diagnostic
            for signal in self._wanted
            if (diagnostic := self._problem(signal)) is not None
        ]
        if self.clock.topic and not self.ticks().size:
            diagnostics.append(self._absent(self.clock.topic, self._clock_place(self.clock.topic)))
        refused = {name for column in self.topics.values() for name in column.diagnostics}
        for topic, signal in {signal.path.topic: signal for signal in self._wanted}.items():
            if topic in self.topics:
                diagnostics += self._oddities(self.topics[topic], signal)
        return [*diagnostics, *self._foreign_values(), *self.frames.findings(refused)]

    def _foreign_values(self) -> Iterator[Diagnostic]:
        """Warnings about samples of enumeration signals that are not among their values."""
        for signal in self._wanted:
            column = self.topics.get(signal.path.topic)
            foreign = column.foreign.get(signal.name) if column else None
            if column is not None and foreign is not None:
                after = column.times[foreign.first] - self.span((0, 0))[0]
                yield log_diagnostics.foreign_value(signal, foreign, column.count, after)

    def _problem(self, signal: Signal) -> Diagnostic | None:
        column = self.topics.get(signal.path.topic)
        if column is None or not column.logs:
            return self._absent(signal.path.topic, signal.span)
        return column.diagnostics.get(signal.name)

    def _absent(self, topic: str, span: Span | None) -> Diagnostic:
        if topic in self.topics:
            return log_diagnostics.no_message(topic, span)
        return log_diagnostics.no_topic(topic, self.topics, span)

    def readers(self) -> dict[str, Span | None]:
        """The wanted bound topics, each with the place of its binding."""
        places = {self.clock.topic: self._clock_place(self.clock.topic)} if self.clock.topic else {}
        places |= {signal.path.topic: signal.span for signal in self._wanted}
        return {topic: place for topic, place in places.items() if topic in self.topics}

    def _clock_place(self, topic: str) -> Span | None:
        start = self._source.text.find(f'"{topic}"')
        return self._source.span(start, start + len(topic) + 2) if start >= 0 else None

    def _oddities(self, column: TopicColumn, signal: Signal) -> list[Diagnostic]:
        diagnostics, count = [], len(column.logs)
        if len(column.types) > 1 and signal.type is None:
            diagnostics.append(log_diagnostics.several_types(signal, list(column.types)))
        undecoded = column.undecoded + self.frames.undecoded.get(column.name, 0)
        if undecoded:
            diagnostics.append(log_diagnostics.bad_messages(signal, undecoded, count))
        if late := column.late():
            diagnostics.append(log_diagnostics.out_of_order(signal, late, count))
        if column.unstamped:
            diagnostics.append(log_diagnostics.unstamped(signal, self._shift()))
        return diagnostics

    def _shift(self) -> int:
        """The median of header stamps minus log times, in nanoseconds."""
        stamped = [c for c in self.topics.values() if c.bound and c.placed and not c.unstamped]
        if self.clock.time is not TimeSource.HEADER_STAMP or not stamped:
            return 0
        shifts = [np.array(c.logs, np.int64) - np.array(c.times, np.int64) for c in stamped]
        return int(np.median(np.abs(np.concatenate(shifts))))
