"""Times and samples of arriving messages, read as by an audit of the recording.

The decoders of audits read one message at a time. A message that cannot be decoded, or whose time
was never set, is unknown and gets the time of the one before it of its topic; before the first
message with a time, it waits for that. Times are nanoseconds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace
from math import isnan

from mcap.records import Channel as McapChannel
from mcap.records import Schema

from fretc.logs import log_diagnostics
from fretc.logs.extraction import Extract, Extraction
from fretc.logs.frames.live_frames import LiveFrames
from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.damage import LATEST
from fretc.logs.mcap.payloads import Payloads
from fretc.logs.messages.python_messages import Value
from fretc.logs.signals.enum_values import UNKNOWN
from fretc.watch.single_messages import SingleMessages
from fretc.watch.sources.source import Arrival, Channel
from fretish.bindings.declarations import Declarations, Signal, short_type
from fretish.classes.frozen import dataclass
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Diagnostic

MOST_HELD = 1000
"""The most messages of a topic without any time that wait for one; further ones replace the
oldest."""
_NOTHING: Value = (UNKNOWN, None, "")


@dataclass(frozen=True, slots=True)
class Timed:
    """One message on the declared clock."""

    topic: str
    time: int
    arrival: int
    values: Mapping[str, Value]
    """A sample of each signal that reads the topic."""


@dataclass(slots=True)
class _Topic:
    signals: list[Signal]
    """The signals that the messages of the topic have."""
    latest: int | None = None
    """The time of the last message that has one."""
    held: list[int] = field(default_factory=list)
    """The arrivals of messages before the first one with a time."""
    types: dict[str, None] = field(default_factory=dict)
    unknown: Mapping[str, Value] = field(default_factory=dict)
    """An unknown sample of each signal."""


class Decoder:
    """A decoder of the messages of all bound topics."""

    def __init__(self, declarations: Declarations) -> None:
        self._time = declarations.clock.time
        signals = declarations.signals.values()
        names = {signal.path.topic for signal in signals}
        names |= {declarations.clock.topic} if declarations.clock.topic else set()
        self._topics = {
            name: _Topic(
                [each for each in signals if each.path.topic == name and each.pose is None],
                unknown={
                    each.name: _NOTHING
                    for each in signals
                    if each.path.topic == name and each.pose is None
                },
            )
            for name in names
        }
        self._frames = LiveFrames(signals)
        self._extractions: dict[Channel, Extraction] = {}
        self._single: dict[Channel, SingleMessages] = {}
        self.undecoded: dict[str, int] = {}
        """For each topic, the number of messages that could not be decoded."""

    @property
    def topics(self) -> frozenset[str]:
        """The topics that are read."""
        return frozenset(self._topics) | self._frames.topics

    @property
    def static_topics(self) -> frozenset[str]:
        """The topics of static transforms."""
        return self._frames.topics - self._topics.keys()

    def lose(self) -> None:
        """Record that messages were lost: transforms are known again from later ones on."""
        self._frames.lose()

    def read(self, arrival: Arrival) -> tuple[list[Timed], list[Diagnostic]]:
        """The message, with those that waited for its time, and diagnostics of its channel."""
        messages, problems = self._read(arrival)
        if not self._frames.reads(arrival.channel.topic):
            return messages, problems
        channel = arrival.channel
        samples = self._frames.read(stream_of(channel), channel, arrival.payload)
        problems += self._frames.take_problems()
        if not messages:
            return [], problems
        *held, last = messages
        return [*held, replace(last, values={**last.values, **samples})], problems

    def _read(self, arrival: Arrival) -> tuple[list[Timed], list[Diagnostic]]:
        topic = self._topics.get(arrival.channel.topic)
        if topic is None:
            return [], []
        reader = self._single.get(arrival.channel)
        single = None if reader is None else reader.read(arrival.payload)
        if single is not None:
            time = self._placed(arrival, single.stamp)
            values = {**topic.unknown, **single.values} if time else topic.unknown
            return self._timed(arrival, topic, time, values), []
        return self._read_by_extraction(arrival, topic)

    def _read_by_extraction(
        self, arrival: Arrival, topic: _Topic
    ) -> tuple[list[Timed], list[Diagnostic]]:
        """A message that is the first one of its layout, or otherwise unusual."""
        problems: list[Diagnostic] = []
        if arrival.channel not in self._extractions:
            problems = self._open(arrival.channel, topic)
        extraction = self._extractions[arrival.channel]
        extract = extraction.extract(Payloads.of([arrival.payload]))
        problems += self._refusals(arrival.channel, topic)
        is_decoded = bool(extract.decoded[0])
        time: int | None = None
        if is_decoded or self._time is not TimeSource.HEADER_STAMP:
            time = self._placed(arrival, int(extract.stamps[0]) if extract.stamped[0] else None)
        signals = topic.signals if time != 0 else ()
        values = {**topic.unknown, **{each.name: _value(extract, each.name) for each in signals}}
        name = arrival.channel.topic
        if not is_decoded and extraction.reads:
            self.undecoded[name] = self.undecoded.get(name, 0) + 1
        return self._timed(arrival, topic, time, values), problems

    def _timed(
        self, arrival: Arrival, topic: _Topic, time: int | None, values: Mapping[str, Value]
    ) -> list[Timed]:
        """The message on the declared clock, with those that waited for its time."""
        name = arrival.channel.topic
        if time is not None and time >= LATEST:
            return []
        if not time and topic.latest is None:
            topic.held = [*topic.held, arrival.log_time][-MOST_HELD:]
            return []
        topic.latest = time or topic.latest
        assert topic.latest is not None, "what has no time waits for one"
        message = Timed(name, topic.latest, arrival.log_time, values)
        if not topic.held:
            return [message]
        held, topic.held = topic.held, []
        return [*(Timed(name, topic.latest, each, topic.unknown) for each in held), message]

    def _open(self, channel: Channel, topic: _Topic) -> list[Diagnostic]:
        """Open a channel at its first message: its type may differ from the one in the bindings."""
        problems = []
        type_ = short_type(channel.schema_name)
        topic.types[type_] = None
        for signal in tuple(topic.signals):
            declared = signal.type and short_type(signal.type)
            if channel.schema_name and declared and declared != type_:
                topic.signals.remove(signal)
                problems.append(log_diagnostics.wrong_type(signal, channel.schema_name))
        if len(topic.types) > 1 and topic.signals and topic.signals[0].type is None:
            problems.append(log_diagnostics.several_types(topic.signals[0], list(topic.types)))
        extraction = Extraction(stream_of(channel), topic.signals, few=0)
        self._extractions[channel] = extraction
        self._single[channel] = SingleMessages(extraction)
        return problems

    def _refusals(self, channel: Channel, topic: _Topic) -> list[Diagnostic]:
        """Diagnostics for signals that the channel does not have."""
        refused = self._extractions[channel].diagnostics
        missing = [signal for signal in topic.signals if signal.name in refused]
        for signal in missing:
            topic.signals.remove(signal)
        return [refused[signal.name] for signal in missing]

    def _placed(self, arrival: Arrival, stamp: int | None) -> int:
        """The time of a decoded message on the declared clock; 0: it was never set."""
        match self._time:
            case TimeSource.LOG_TIME:
                return arrival.log_time
            case TimeSource.PUBLISH_TIME:
                return min(arrival.publish_time, LATEST)
            case TimeSource.HEADER_STAMP:
                return arrival.log_time if stamp is None else stamp


def _value(extract: Extract, name: str) -> Value:
    if extract.is_foreign(name, 0):
        return UNKNOWN, None, extract.texts[name][1]
    values = extract.values[name]
    value = values[0]
    return (value, values.dtype, "") if not isnan(value) else _NOTHING


def stream_of(channel: Channel, id: int = 1) -> ChannelDefinition:
    """A channel as a stream for the decoders of logs."""
    schema = None
    if channel.schema_name or channel.schema_encoding:
        schema = Schema(
            id=id,
            name=channel.schema_name,
            encoding=channel.schema_encoding,
            data=channel.schema,
        )
    return ChannelDefinition(
        McapChannel(
            id=id,
            topic=channel.topic,
            message_encoding=channel.message_encoding,
            metadata={},
            schema_id=id if schema else 0,
        ),
        schema,
    )
