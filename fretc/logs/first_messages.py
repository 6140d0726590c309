"""The first messages of JSON topics, which show the fields that such messages have."""

from __future__ import annotations

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.messages import Messages, Sink
from fretc.logs.vocabulary import MessageTexts

_MOST, _MOST_BYTES = 20, 2**20
"""The most messages of a topic, and the most bytes of them."""


class FirstMessages:
    """A sink that passes every message on, and keeps the first ones of topics in JSON.

    If a vocabulary is given, it gets every message too.
    """

    def __init__(self, sink: Sink, vocabulary: MessageTexts | None = None) -> None:
        self._sink = sink
        self._vocabulary = vocabulary
        self._examples: dict[str, list[bytes]] = {}

    def of(self, topic: str) -> tuple[bytes, ...]:
        """The payloads of a topic; none if it is not in JSON."""
        return tuple(self._examples.get(topic, ()))

    def declare(self, stream: ChannelDefinition) -> None:
        """A stream of the file."""
        if stream.channel.message_encoding == "json":
            self._examples.setdefault(stream.channel.topic, [])
        self._sink.declare(stream)

    def add(
        self, stream: ChannelDefinition, log_time: int, publish_time: int, payload: memoryview
    ) -> None:
        """One whole message."""
        examples = self._open(stream)
        if examples is not None and len(payload) <= _MOST_BYTES:
            examples.append(bytes(payload))
        if self._vocabulary is not None:
            self._vocabulary.take(stream, payload)
        self._sink.add(stream, log_time, publish_time, payload)

    def add_all(self, stream: ChannelDefinition, messages: Messages) -> None:
        """Whole messages of one stream."""
        examples = self._open(stream)
        if examples is not None:
            payloads = messages.payloads
            some = (payloads.payload(i) for i in range(min(len(payloads), _MOST - len(examples))))
            examples += [bytes(payload) for payload in some if len(payload) <= _MOST_BYTES]
        if self._vocabulary is not None:
            for i in range(len(messages)):
                self._vocabulary.take(stream, messages.payloads.payload(i))
        self._sink.add_all(stream, messages)

    def wants(self, topic: str) -> bool:
        """Whether the messages themselves are wanted, not only their number."""
        return self._sink.wants(topic)

    def count(self, stream: ChannelDefinition, count: int) -> None:
        """Count messages of a stream that is not wanted."""
        self._sink.count(stream, count)

    def _open(self, stream: ChannelDefinition) -> list[bytes] | None:
        """The list for further messages of a stream; None: it is full or not wanted."""
        examples = self._examples.get(stream.channel.topic)
        full = examples is None or len(examples) >= _MOST or sum(map(len, examples)) >= _MOST_BYTES
        return None if full else examples
