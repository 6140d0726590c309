"""A run in several files: the contents of each, and the losses between them.

Times are nanoseconds, log times.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import field, replace

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.damage import Damage
from fretc.logs.mcap.messages import Messages, Sink
from fretc.logs.mcap.metadata import Described
from fretc.logs.signals.integrity import EVERYTHING, Checked
from fretc.logs.signals.samples import Gap
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class FileContents:
    """The contents of one file, without its messages."""

    sha256: str
    """The SHA-256 of its bytes, or of its summary if it was read by its index alone."""
    size: int
    span: Gap | None
    """The first and the last whole message; None: there is none."""
    damages: tuple[tuple[Damage, Gap | None], ...]
    notes: tuple[Diagnostic, ...] = ()
    """Further diagnostics."""
    checked: Checked = EVERYTHING
    described: Described = field(default_factory=dict)
    """The wanted values of its metadata."""


class RenumberingSink:
    """A sink that passes messages on, and renumbers the streams of several files as one log."""

    def __init__(self, sink: Sink) -> None:
        self.counted = 0
        """The number of messages so far."""
        self._sink = sink
        self._streams: dict[Hashable, ChannelDefinition] = {}
        self._of_file: dict[int, tuple[ChannelDefinition, ChannelDefinition]] = {}

    def next_file(self) -> None:
        """Begin with another file."""
        self._of_file.clear()

    def declare(self, stream: ChannelDefinition) -> None:
        """A stream of the file."""
        self._sink.declare(self._renumbered(stream))

    def add(
        self, stream: ChannelDefinition, log_time: int, publish_time: int, payload: memoryview
    ) -> None:
        """One whole message."""
        self.counted += 1
        self._sink.add(self._renumbered(stream), log_time, publish_time, payload)

    def add_all(self, stream: ChannelDefinition, messages: Messages) -> None:
        """Whole messages of one stream."""
        self.counted += len(messages.starts)
        self._sink.add_all(self._renumbered(stream), messages)

    def wants(self, topic: str) -> bool:
        """Whether the messages themselves are wanted, not only their number."""
        return self._sink.wants(topic)

    def count(self, stream: ChannelDefinition, count: int) -> None:
        """Count messages of a stream that is not wanted."""
        self.counted += count
        self._sink.count(self._renumbered(stream), count)

    def _renumbered(self, stream: ChannelDefinition) -> ChannelDefinition:
        """The stream with its number in the whole run."""
        of_file = self._of_file.get(stream.channel.id)
        if of_file is not None and of_file[0] is stream:
            return of_file[1]
        channel, schema = stream.channel, stream.schema
        definition = (schema.name, schema.encoding, schema.data) if schema is not None else None
        key = (channel.topic, channel.message_encoding, definition)
        if key not in self._streams:
            number = len(self._streams) + 1
            self._streams[key] = ChannelDefinition(
                replace(channel, id=number, schema_id=number if schema is not None else 0),
                replace(schema, id=number) if schema is not None else None,
            )
        renumbered = self._streams[key]
        self._of_file[channel.id] = stream, renumbered
        return renumbered


def around(parts: Sequence[FileContents | None], i: int) -> tuple[int | None, int | None]:
    """The last message before file `i`, and the first one after it; None: there is none."""
    before = [part.span[1] for part in parts[:i] if part is not None and part.span is not None]
    after = [part.span[0] for part in parts[i + 1 :] if part is not None and part.span is not None]
    return max(before, default=None), min(after, default=None)


def widened(
    part: FileContents, before: int | None, after: int | None
) -> Iterator[tuple[Damage, Gap | None]]:
    """The damages of one file, extended by its neighbours in the run.

    A truncated file may have continued until the next one begins. So each loss at an end of its
    file extends to the messages of the neighbouring files.

    Args:
        part: the file.
        before: the last message of the files before it.
        after: the first message of the files after it.
    """
    for damage, gap in part.damages:
        if gap is None or part.span is None:
            yield damage, gap
            continue
        start, end = gap
        if start <= part.span[0] and before is not None:
            start = min(start, before)
        if end >= part.span[1] and after is not None:
            end = max(end, after)
        yield damage, (start, end)
