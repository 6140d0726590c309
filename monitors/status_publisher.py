"""Publish the status of a node: changes of the stop flag at once, everything at each heartbeat.

Messages from several threads are processed one at a time. The module is independent of any
middleware. Its text is copied into emitted nodes: it needs the standard library only.
"""

import json
import time
from collections.abc import Callable, Collection, Sequence
from threading import Lock
from typing import Any, NamedTuple

from monitors.stop_supervisor import Status, StopSupervisor, bounded


class Channels(NamedTuple):
    """The publishers and the clock of a node."""

    stop: "Callable[[bool], object]"
    verdict: "Callable[[str], object]"
    """Publishes a line of JSON."""
    statuses: "Callable[[Sequence[Status]], object]"
    now: "Callable[[], int]"
    """Nanoseconds on the middleware's clock, which may be simulated; 0 before it has started."""


class StatusPublisher:
    """Passes messages to a supervisor, and publishes the results."""

    def __init__(
        self,
        supervisor: StopSupervisor,
        channels: Channels,
        heartbeat: float,
        steady: "Callable[[], float]" = time.monotonic,
    ) -> None:
        """Start before anything is published.

        Args:
            supervisor: the supervisor; nothing else may use it.
            channels: the publishers; they are never called concurrently, but from any thread.
            heartbeat: seconds between two calls of `on_heartbeat`.
            steady: a monotonic clock in seconds.

        Raises:
            ValueError: the heartbeat is out of range.
        """
        self.heartbeat = bounded("heartbeat", heartbeat, SHORTEST, LONGEST_BEAT)
        self._supervisor, self._channels, self._steady = supervisor, channels, steady
        self._stop: bool | None = None
        self._ticks = 0
        self._reported = float("-inf")
        self._failure: Exception | None = None
        self._closed = False
        self._lock = Lock()

    def on_message(self, topic: str, message: Any, singles: "Collection[str]" = ()) -> None:
        """Process a message; an exception stops the robot, and `on_heartbeat` raises it again."""
        self._process(
            lambda now: self._supervisor.arrive(topic, message, now, self._steady(), singles)
        )

    def on_refusal(self, topic: str, reason: str) -> None:
        """Trust a topic no longer, until its next message; exceptions are those of a message."""
        self._process(lambda now: self._supervisor.refuse(topic, reason, now))

    def _process(self, step: "Callable[[int], None]") -> None:
        with self._lock:
            try:
                now = self._channels.now()
                if now:  # 0: the simulated clock has not started
                    step(now)
            except Exception as error:
                self._failure = error
            self._publish(again=False)

    def on_heartbeat(self) -> None:
        """Publish everything; to be called once per heartbeat.

        Raises:
            Exception: an exception of `on_message` since the last call.
        """
        with self._lock:
            now = self._channels.now()
            if now and self._failure is None:
                self._supervisor.pass_to(now)
            self._publish(again=True)
            if self._failure is not None:
                raise self._failure
            if self._steady() - self._reported >= REPORT:
                self._report()

    def close(self) -> None:
        """Publish a stop as the last message."""
        with self._lock:
            if not self._closed:
                self._channels.stop(True)
                self._closed = True

    def _publish(self, *, again: bool) -> None:
        if self._closed:
            return
        stop = self._failure is not None or self._supervisor.stop(self._steady())
        if again or stop is not self._stop:
            self._stop = stop
            self._channels.stop(stop)
        if again or self._supervisor.ticks != self._ticks:
            self._ticks = self._supervisor.ticks
            for line in self._supervisor.news():
                self._channels.verdict(json.dumps(line))

    def _report(self) -> None:
        self._reported = self._steady()
        self._channels.statuses(self._supervisor.statuses(self._reported))


SHORTEST, LONGEST_BEAT = 0.001, 10.0
"""The range of a heartbeat in seconds."""
REPORT = 0.5
"""The approximate number of seconds between two reports of diagnostics."""
