"""The samples of signals of frames from arriving messages, equal to those of a recording."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping

import numpy as np

from fretc.logs.frames.messages import decoder_of, frame_signals, transforms
from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import Decode
from fretc.logs.messages.python_messages import Value
from fretc.logs.signals.enum_values import UNKNOWN
from fretish.bindings.declarations import Signal, short_type
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_DOUBLE = np.dtype(np.float64)


class LiveFrames:
    """The signals of frames of a watch."""

    def __init__(self, signals: Collection[Signal]) -> None:
        """`signals`: those that are not numbers of poses are ignored."""
        self._signals = [signal for signal in signals if signal.pose is not None]
        self._live = frame_signals(self._signals)
        self._lost = False
        self._decoders: dict[Hashable, Decode | None] = {}
        self._problems: list[Diagnostic] = []

    @property
    def topics(self) -> frozenset[str]:
        """The topics of transforms, with those of static ones."""
        moving = {signal.path.topic for signal in self._signals}
        return frozenset((*moving, *self._live.static_topics))

    def reads(self, topic: str) -> bool:
        """Whether the topic has transforms that a signal needs."""
        return self._live.reads(topic)

    def read(
        self, stream: ChannelDefinition, channel: Hashable, payload: bytes
    ) -> Mapping[str, Value]:
        """The new samples after a message."""
        if channel not in self._decoders:
            self._decoders[channel] = self._open(stream)
        topic = stream.channel.topic
        if self._lost and topic not in self._live.static_topics:
            self._lost = False
            self._live.forget()
        contents = transforms(self._decoders[channel], payload)
        samples = self._live.lose(topic) if contents is None else self._live.take(topic, contents)
        return {name: _sample(value) for name, value in samples.items()}

    def lose(self) -> None:
        """Record that messages were lost before the next one."""
        self._lost = True

    def take_problems(self) -> list[Diagnostic]:
        """Diagnostics of the channels since the last call."""
        problems, self._problems = self._problems, []
        return problems

    def _open(self, stream: ChannelDefinition) -> Decode | None:
        """The decoder of a channel; None if its messages have another type, or cannot be read."""
        name = stream.schema.name if stream.schema else ""
        for signal in self._signals:
            declared = signal.type and short_type(signal.type)
            if name and declared != short_type(name):
                self._problems.append(
                    diagnostic(
                        "wrong_type",
                        signal.span,
                        topic=stream.channel.topic,
                        type=short_type(name),
                        declared=declared,
                    )
                )
                return None
        return decoder_of(stream)


def _sample(value: float | None) -> Value:
    return (UNKNOWN, None, "") if value is None else (float(value), _DOUBLE, "")
