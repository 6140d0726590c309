"""A queue of limited size between the thread of a middleware and the watch.

Messages that do not fit are dropped and counted: the watch gets `Missed` at the position of the
missing messages. Times are nanoseconds.
"""

from __future__ import annotations

import time
from collections import deque
from threading import Condition

from fretc.watch.sources.source import Arrival, Channel, Event, Idle, Missed

MOST = 20_000
"""The most messages in the queue."""
MOST_BYTES = 2**28
"""The most bytes of their payloads together."""
WAIT = 0.05
"""Seconds after which a reader gets `Idle`."""


class Mailbox:
    """A queue from any threads to one reader, in the order of arrival."""

    def __init__(self, most: int = MOST, most_bytes: int = MOST_BYTES) -> None:
        self._most, self._most_bytes = most, most_bytes
        self._waiting: deque[Arrival | Event] = deque()
        self._bytes = 0
        self._missed: Missed | None = None
        self._closed = False
        self._change = Condition()
        self._offset = time.time_ns() - time.monotonic_ns()

    @property
    def now(self) -> int:
        """The receive time: the wall clock at the start, continued by a monotonic clock."""
        return self._offset + time.monotonic_ns()

    def put(self, channel: Channel, payload: bytes, publish_time: int | None = None) -> int:
        """Add a message, sent at `publish_time` if known; its receive time is now."""
        with self._change:
            now = self.now
            if len(self._waiting) >= self._most or self._bytes + len(payload) > self._most_bytes:
                before = self._missed or Missed(now, now, 0)
                self._missed = Missed(before.since, now, before.count + 1)
                return now
            self._tell_missed()
            sent = now if publish_time is None else publish_time
            self._waiting.append(Arrival(channel, payload, now, sent))
            self._bytes += len(payload)
            self._change.notify()
            return now

    def tell(self, event: Event) -> None:
        """Add an event after all messages before it; an event always fits."""
        with self._change:
            self._tell_missed()
            self._waiting.append(event)
            self._change.notify()

    def take(self) -> Arrival | Event | Idle | None:
        """The next message or event; `Idle` if there is none for a while; None: it is closed."""
        with self._change:
            if not self._waiting and not self._closed:
                self._change.wait(WAIT)
            if not self._waiting:
                self._tell_missed()
            if not self._waiting:
                return None if self._closed else Idle(self.now)
            first = self._waiting.popleft()
            if isinstance(first, Arrival):
                self._bytes -= len(first.payload)
            return first

    def close(self) -> None:
        """Close the queue; remaining messages can still be taken."""
        with self._change:
            self._closed = True
            self._change.notify()

    def _tell_missed(self) -> None:
        if self._missed is not None:
            self._waiting.append(self._missed)
            self._missed = None
