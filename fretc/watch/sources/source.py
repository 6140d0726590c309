"""What every source of messages gives: arrivals and events, in the order of their arrival.

A message is handed on as it came, as bytes with the definition of its type: a recording holds these
very bytes, and the watch decodes them as an audit of the recording does. Times are nanoseconds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from fretish.diagnostics.diagnostic import Diagnostic
from monitors.guard import Status


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic and how its messages are written, in the words of MCAP.

    Equal channels are one channel of a recording. A topic whose type changes has several.
    """

    topic: str
    """As the bindings call it: `/scan`."""
    message_encoding: str
    """`cdr`, `ros1`, `json`, `protobuf`."""
    schema_name: str
    """`sensor_msgs/msg/LaserScan`; nothing where there is no schema."""
    schema_encoding: str
    """`ros2msg`, `ros1msg`, `jsonschema`, `protobuf`."""
    schema: bytes
    """The definition, with those of all types that it names."""


@dataclass(frozen=True, slots=True)
class Arrival:
    """One message."""

    channel: Channel
    payload: bytes
    log_time: int
    """When it was received. From one arrival of a middleware to the next it never decreases."""
    publish_time: int
    """When it was sent, where the middleware tells; else `log_time`, as MCAP has it."""


@dataclass(frozen=True, slots=True)
class Opened:
    """The source is there."""

    name: str
    """`ws://robot:8765`, `domain 0`, ..."""


@dataclass(frozen=True, slots=True)
class Interrupted:
    """The source is gone, and is sought again; nothing that was sent since `since` is known."""

    since: int
    """The receive time of the last that is known to be complete."""
    problem: Diagnostic


@dataclass(frozen=True, slots=True)
class Reconnected:
    """The source is there again: messages sent from `since` to `until` may be lost."""

    since: int
    until: int


@dataclass(frozen=True, slots=True)
class Missed:
    """Messages that arrived from `since` to `until` and were dropped: the watch was too slow."""

    since: int
    until: int
    count: int


@dataclass(frozen=True, slots=True)
class Problem:
    """What a user should know, and the watch goes on: another type than bound, say."""

    diagnostic: Diagnostic


@dataclass(frozen=True, slots=True)
class Idle:
    """Nothing has arrived for a while."""

    now: int | None
    """All that was received before this time was handed on; None: no clock tells that."""


Event = Opened | Interrupted | Reconnected | Missed | Problem


class Source(Protocol):
    """A middleware, or a file that grows."""

    @property
    def name(self) -> str:
        """What people call it."""

    def arrivals(self, topics: Collection[str]) -> Iterator[Arrival | Event | Idle]:
        """All messages of the topics from now on, until `close`, or until the source has ended.

        A source that cannot be had at all gives a `Problem` with an error, and ends; what breaks
        off later is `Interrupted`, and sought again, ever less often. `Idle` comes at least every
        tenth of a second while nothing else does, so that the caller can look at the clock.
        A middleware runs in a thread of its own and puts what it receives in a `Mailbox`.
        """

    def close(self) -> None:
        """Let it go; the iterator ends. It may be called from any thread, and more than once."""


@runtime_checkable
class Diagnosing(Protocol):
    """A middleware through which statuses can be published."""

    def diagnose(self, statuses: Sequence[Status]) -> None:
        """Publish them on `/diagnostics`, soon; of those that wait the latest count.

        It never waits. The first call comes before `arrivals`, with nothing: there will be some.
        """
