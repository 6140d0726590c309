"""What a node publishes, and when: the stop at once, and all of it again with each heartbeat.

One message is handled at a time, whatever thread brings it. Nothing here knows a middleware. The
text of this module is copied into emitted nodes: it needs the standard library only.
"""

import json
import time
from collections.abc import Callable, Collection, Sequence
from threading import Lock
from typing import Any, NamedTuple

from monitors.guard import Guard, Status, bounded


class Channels(NamedTuple):
    """Where a node publishes, and what its clock says."""

    stop: Callable[[bool], object]
    verdict: Callable[[str], object]
    """A line of JSON."""
    statuses: Callable[[Sequence[Status]], object]
    now: Callable[[], int]
    """Nanoseconds on the middleware's clock, which may be simulated; 0 before that has begun."""


class Voice:
    """Between what a middleware brings, a guard, and what is published."""

    def __init__(
        self,
        guard: Guard,
        channels: Channels,
        heartbeat: float,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:
        """Nothing is published yet.

        Args:
            guard: it is used by the voice alone.
            channels: they are called one after the other, each from any thread.
            heartbeat: seconds from one `beat` to the next.
            steady: seconds on a clock that nothing sets.

        Raises:
            ValueError: the heartbeat is too short or too long.
        """
        self.heartbeat = bounded("heartbeat", heartbeat, SHORTEST, LONGEST_BEAT)
        self._guard, self._channels, self._steady = guard, channels, steady
        self._stop: bool | None = None
        self._ticks = 0
        self._reported = float("-inf")
        self._failure: Exception | None = None
        self._closed = False
        self._lock = Lock()

    def hear(self, topic: str, message: Any, singles: Collection[str] = ()) -> None:
        """A message of a topic; what fails here ends the node at its next beat, standing."""
        with self._lock:
            try:
                now = self._channels.now()
                if now:  # else the simulated clock has not begun
                    self._guard.arrive(topic, message, now, self._steady(), singles)
            except Exception as error:
                self._failure = error
            self._speak(again=False)

    def beat(self) -> None:
        """To be called once in each heartbeat.

        Raises:
            Exception: what has failed since the last one.
        """
        with self._lock:
            now = self._channels.now()
            if now and self._failure is None:
                self._guard.pass_to(now)
            self._speak(again=True)
            if self._failure is not None:
                raise self._failure
            if self._steady() - self._reported >= REPORT:
                self._report()

    def close(self) -> None:
        """The last that is published is a stop."""
        with self._lock:
            if not self._closed:
                self._channels.stop(True)
                self._closed = True

    def _speak(self, *, again: bool) -> None:
        if self._closed:
            return
        stop = self._failure is not None or self._guard.stop(self._steady())
        if again or stop is not self._stop:
            self._stop = stop
            self._channels.stop(stop)
        if again or self._guard.ticks != self._ticks:
            self._ticks = self._guard.ticks
            for line in self._guard.news():
                self._channels.verdict(json.dumps(line))

    def _report(self) -> None:
        self._reported = self._steady()
        self._channels.statuses(self._guard.statuses(self._reported))


SHORTEST, LONGEST_BEAT = 0.001, 10.0
"""Seconds of a heartbeat."""
REPORT = 0.5
"""Seconds from one report of diagnostics to the next, about."""
