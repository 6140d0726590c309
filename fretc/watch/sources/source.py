"""The interface of sources: messages and events, in the order of their arrival.

A message is passed on as bytes with the definition of its type: a recording holds these bytes, and
the watch decodes them as an audit of the recording does. Times are nanoseconds.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Protocol, runtime_checkable

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.stop_supervisor import Status


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic and the encoding of its messages, in the terms of MCAP.

    Equal channels are one channel of a recording. A topic whose type changes has several.
    """

    topic: str
    """The name in the bindings: `/scan`."""
    message_encoding: str
    """`cdr`, `ros1`, `json`, `protobuf`."""
    schema_name: str
    """`sensor_msgs/msg/LaserScan`; empty: there is no schema."""
    schema_encoding: str
    """`ros2msg`, `ros1msg`, `jsonschema`, `protobuf`."""
    schema: bytes
    """The definition, with those of all types that it uses."""


@dataclass(frozen=True, slots=True)
class Arrival:
    """One message."""

    channel: Channel
    payload: bytes
    log_time: int
    """The receive time. It never decreases between arrivals of a middleware."""
    publish_time: int
    """The send time, if the middleware states it; else `log_time`, as in MCAP."""


@dataclass(frozen=True, slots=True)
class Opened:
    """The source is connected."""

    name: str
    """`ws://robot:8765`, `domain 0`, ..."""


@dataclass(frozen=True, slots=True)
class ConnectionLost:
    """The connection is lost, and is tried again; messages since `since` are unknown."""

    since: int
    """The receive time up to which messages are known to be complete."""
    problem: Diagnostic


@dataclass(frozen=True, slots=True)
class Reconnected:
    """The source is connected again: messages sent from `since` to `until` may be lost."""

    since: int
    until: int


@dataclass(frozen=True, slots=True)
class Missed:
    """Messages from `since` to `until` that are known to be lost.

    They arrived, and the watch was too slow; or they did not arrive, and their numbers are missing.
    """

    since: int
    until: int
    count: int


@dataclass(frozen=True, slots=True)
class Problem:
    """A diagnostic for the user, such as a wrong type; the watch continues."""

    diagnostic: Diagnostic


@dataclass(frozen=True, slots=True)
class Idle:
    """Nothing has arrived for a while."""

    now: int | None
    """All messages received before this time were passed on; None: no clock shows that."""


Event = Opened | ConnectionLost | Reconnected | Missed | Problem


class Source(Protocol):
    """A middleware, or a file that grows."""

    @property
    def name(self) -> str:
        """The name of the source, for people."""

    def arrivals(self, topics: Collection[str]) -> Iterator[Arrival | Event | Idle]:
        """All messages of the topics from now on, until `close`, or until the source has ended.

        A source that cannot be opened at all gives a `Problem` with an error, and ends. If it
        breaks off later, it gives `ConnectionLost` and is opened again, ever less often. `Idle`
        comes at least every tenth of a second while nothing else does, so that the caller can look
        at the clock.
        A middleware runs in a thread of its own and puts what it receives in a `Mailbox`.
        """

    def close(self) -> None:
        """Close the source and end the iterator, from any thread, possibly more than once."""


@runtime_checkable
class Diagnosing(Protocol):
    """A middleware that can publish statuses."""

    def diagnose(self, statuses: Sequence[Status]) -> None:
        """Publish statuses on `/diagnostics`, soon; only the latest ones count.

        It never waits. The first call comes before `arrivals`, without statuses, to announce them.
        """
