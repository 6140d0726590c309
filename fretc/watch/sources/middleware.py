"""The common part of middlewares: reconnection with growing pauses.

It runs in a thread of its own. Messages sent while it is not connected are lost, and their number
is unknown.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from threading import Event as Flag
from threading import Thread

from fretc.watch.sources.mailbox import Mailbox
from fretc.watch.sources.source import (
    Arrival,
    Channel,
    ConnectionLost,
    Event,
    Idle,
    Opened,
    Problem,
    Reconnected,
)
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_FIRST_PAUSE, _LONGEST_PAUSE = 0.5, 8.0
"""Seconds before the next connection; each pause is twice the one before."""
_LAST = 2.0
"""Seconds that the end of a watch waits for the thread."""


class Middleware(ABC):
    """A source that can be lost and reconnected."""

    def __init__(self, name: str) -> None:
        """A source that is not yet open."""
        self.name = name
        self._mailbox = Mailbox()
        self._closed = Flag()
        self._alive: int | None = None
        """The receive time before which all sent messages have arrived; None: it was never
        connected."""
        self._is_lost = False

    def close(self) -> None:
        """Close the source."""
        self._closed.set()
        self._mailbox.close()

    def arrivals(self, topics: Collection[str]) -> Iterator[Arrival | Event | Idle]:
        """The messages and events from the thread."""
        thread = Thread(target=self._run, args=(sorted(topics),), daemon=True)
        thread.start()
        try:
            while (item := self._mailbox.take()) is not None:
                yield item
        finally:
            self.close()
            thread.join(_LAST)

    @abstractmethod
    def _listen(self, topics: list[str]) -> bool:
        """Receive messages until the connection is lost; whether the connection was useful."""

    def _run(self, topics: list[str]) -> None:
        pause = _FIRST_PAUSE
        try:
            while not self._closed.is_set():
                useful = self._listen(topics)
                if self._alive is None or self._closed.is_set():
                    break
                pause = _FIRST_PAUSE if useful else min(2 * pause, _LONGEST_PAUSE)
                self._closed.wait(pause)
        finally:
            self._mailbox.close()

    # Events of the thread

    def _opened(self, name: str) -> None:
        """Record a connection: everything that is sent from now on arrives."""
        now = self._mailbox.now
        if self._alive is None:
            self._mailbox.tell(Opened(name))
        else:
            self._mailbox.tell(Reconnected(self._alive, now))
        self._alive, self._is_lost = now, False

    def _is_alive(self, now: int) -> None:
        """Record that everything sent before this receive time has arrived."""
        if self._alive is not None and not self._is_lost:
            self._alive = max(self._alive, now)

    def _put(self, channel: Channel, payload: bytes, publish_time: int | None = None) -> int:
        """Pass on a message; returns its receive time."""
        received = self._mailbox.put(channel, payload, publish_time)
        self._is_alive(received + 1)
        return received

    def _warn(self, problem: Diagnostic) -> None:
        self._mailbox.tell(Problem(problem))

    def _lost(self, problem: Diagnostic) -> None:
        """Report a lost connection, once; without any connection before, as an error at the end."""
        if self._is_lost or self._closed.is_set():
            return
        self._is_lost = True
        if self._alive is None:
            self._warn(problem)
        else:
            self._mailbox.tell(ConnectionLost(self._alive, problem))


def several_publishers(topic: str, count: int, names: Collection[str] = ()) -> Diagnostic:
    """F956, with the names of the nodes, if the middleware reports them."""
    who = f": {', '.join(names)}" if names else ""
    return diagnostic("several_publishers", count=count, topic=topic, who=who)
