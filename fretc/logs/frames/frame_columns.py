"""The samples of signals of frames in a recording.

Messages of transforms are kept while the log is read, and used in the order of their log times, as
a live node receives them; static transforms with the same log time come first. Times are
nanoseconds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from fretc.logs.frames.messages import decoder_of, frame_signals, transforms
from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import Decode
from fretc.logs.signals.samples import Gap, Numbers, Times
from fretish.bindings.declarations import Signal
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.transforms import FrameTransform


@dataclass(slots=True)
class _Kept:
    """The messages of one topic, in the order of the file."""

    logs: list[int] = field(default_factory=list)
    payloads: list[bytes] = field(default_factory=list)
    streams: list[int] = field(default_factory=list)
    """The channel of each message."""


@dataclass(slots=True)
class _Series:
    rows: list[int] = field(default_factory=list)
    """The message of each sample, by its place among those of its topic."""
    values: list[float] = field(default_factory=list)


class FrameColumns:
    """A collector of messages of transforms."""

    def __init__(self, signals: Iterable[Signal]) -> None:
        """`signals`: those that are not numbers of poses are ignored."""
        self.signals = [signal for signal in signals if signal.pose is not None]
        self._live = frame_signals(self.signals)
        self._topics = {signal.path.topic for signal in self.signals}
        self._kept = {name: _Kept() for name in (*self._topics, *self._live.static_topics)}
        self._decoders: dict[int, Decode | None] = {}
        self._series: dict[str, _Series] | None = None
        self._frames: set[str] = set()
        self.undecoded: dict[str, int] = {}
        """For each topic, the number of messages that cannot be read."""
        self.gaps: Sequence[Gap] = ()
        """The log times at which messages were lost; set before the samples are asked for."""

    def reads(self, topic: str) -> bool:
        """Whether the topic has transforms that a signal needs, static or not."""
        return topic in self._kept

    def is_static(self, topic: str) -> bool:
        """Whether it reads the topic, and its transforms are static."""
        return topic in self._kept and topic not in self._topics

    def take(
        self, stream: ChannelDefinition, logs: Sequence[int], payloads: Iterable[bytes]
    ) -> None:
        """Add messages of one topic, in their order."""
        kept, id = self._kept[stream.channel.topic], stream.channel.id
        if id not in self._decoders:
            self._decoders[id] = decoder_of(stream)
        kept.logs.extend(logs)
        kept.payloads.extend(payloads)
        kept.streams.extend([id] * len(logs))

    def samples(
        self, signal: Signal, times: Times, unset: NDArray[np.bool_]
    ) -> tuple[Times, Numbers]:
        """Times and values of one signal, in order of time.

        Args:
            signal: one of the signals.
            times: the time of each message of its topic on the declared clock, shape (n,).
            unset: whether this time was never set, which makes a value unknown, shape (n,).
        """
        series = self._all_series()[signal.name]
        rows = np.array(series.rows, np.intp)
        chosen = times[rows]
        values = np.where(unset[rows], np.nan, np.array(series.values, np.float64))
        order = np.argsort(chosen, kind="stable")
        return chosen[order], values[order]

    def findings(self, refused: Collection[str]) -> Iterator[Diagnostic]:
        """Warnings about signals without any value that have no diagnostic yet."""
        for signal in self.signals:
            if signal.name in refused:
                continue
            values = self._all_series()[signal.name].values
            if self._kept[signal.path.topic].logs and np.isnan(values).all():
                yield diagnostic(
                    "no_transform", signal.span, pose=signal.pose, why=self._why(signal)
                )

    def _why(self, signal: Signal) -> str:
        assert signal.pose is not None
        for name in (signal.pose.frame, signal.pose.reference):
            if name not in self._frames:
                some = ", ".join(sorted(self._frames)[:_MOST_NAMED])
                return f"the log has no frame `{name}`, but {some or 'no transform at all'}"
        static = f"{signal.path.topic}_static"
        if not self._kept[static].logs:
            return f"record {static}, too: the log has no message of it"
        return "record all transforms between the two frames"

    def _all_series(self) -> Mapping[str, _Series]:
        if self._series is None:
            self._series = {signal.name: _Series() for signal in self.signals}
            for topic, row, stream, payload, is_after_loss in self._ordered():
                if is_after_loss:
                    self._lose(topic, row)
                self._use(topic, row, transforms(self._decoders[stream], payload))
        return self._series

    def _ordered(self) -> Iterator[tuple[str, int, int, bytes, bool]]:
        """The messages of all topics by log time: topic, place, channel, payload, after a loss."""
        edges = sorted(edge for gap in self.gaps for edge in gap)
        names = [*self._live.static_topics, *self._topics]
        logs = np.concatenate([np.array(self._kept[name].logs, np.int64) for name in names])
        rows = [(name, row) for name in names for row in range(len(self._kept[name].logs))]
        lost_before = np.searchsorted(np.array(edges, np.int64), logs)
        passed = dict.fromkeys(names, 0)
        for place in np.argsort(logs, kind="stable").tolist():
            name, row = rows[place]
            kept, lost = self._kept[name], int(lost_before[place])
            is_after_loss = lost != passed[name] and not self.is_static(name)
            passed[name] = lost
            yield name, row, kept.streams[row], kept.payloads[row], is_after_loss

    def _use(self, topic: str, row: int, read: tuple[FrameTransform, ...] | None) -> None:
        if read is None:
            self.undecoded[topic] = self.undecoded.get(topic, 0) + 1
            self._lose(topic, row)
            return
        self._frames.update(name for each in read for name in (each.parent, each.child))
        self._put(row, self._live.take(topic, read))

    def _lose(self, topic: str, row: int) -> None:
        lost = self._live.lose(topic)
        if not self.is_static(topic):
            self._put(row, lost)

    def _put(self, row: int, samples: Mapping[str, float | None]) -> None:
        assert self._series is not None
        for name, value in samples.items():
            self._series[name].rows.append(row)
            self._series[name].values.append(np.nan if value is None else float(value))


_MOST_NAMED = 8
"""The most frames that a message names."""
