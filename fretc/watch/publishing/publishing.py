"""Publication of messages as they arrive, and of states with each change and periodically.

Publishing never waits, and its errors do not affect the watch.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Protocol

from fretc.watch.publishing.statuses import statuses
from fretc.watch.sources.source import Arrival, Diagnosing, Event, Idle
from fretc.watch.watch import Watch
from monitors.stop_supervisor import State, Status

PERIOD = 0.5
"""Seconds between two publications of all states if nothing changes."""


_WHO = "fretc watch"
"""The prefix of the name of a status, as ROS nodes have it."""


class Publisher(Protocol):
    """A publisher of verdicts."""

    def pass_on(self, arrival: Arrival) -> None:
        """Publish a message of the robot."""

    def publish(self, states: Sequence[State], known: Sequence[Status], now: int) -> None:
        """Publish the state of all requirements at a receive time in nanoseconds (0: none)."""

    def close(self) -> None:
        """Close the publisher; it may be called more than once."""


class Diagnostics:
    """`diagnostic_msgs/DiagnosticArray` on `/diagnostics`, through the middleware."""

    def __init__(self, middleware: Diagnosing) -> None:
        """A publisher; it must be created before the middleware is opened."""
        self._middleware = middleware
        middleware.diagnose(())

    def pass_on(self, arrival: Arrival) -> None:
        """Do nothing: the message is from the same middleware."""

    def publish(self, states: Sequence[State], known: Sequence[Status], now: int) -> None:
        """Publish the states; only the latest ones count."""
        self._middleware.diagnose([each._replace(name=f"{_WHO}: {each.name}") for each in known])

    def close(self) -> None:
        """Do nothing: the middleware ends with the watch."""


class Publishing:
    """All publishers of a watch."""

    def __init__(self, publishers: Sequence[Publisher]) -> None:
        """Nothing is published yet."""
        self._publishers = publishers
        self._last, self._states = float("-inf"), tuple[State, ...]()

    def take(self, item: Arrival | Event | Idle, watch: Watch) -> None:
        """Publish an event of a source that the watch has processed."""
        if not self._publishers:
            return
        if isinstance(item, Arrival):
            for publisher in self._publishers:
                publisher.pass_on(item)
        states = watch.session.states()
        if states != self._states or time.monotonic() - self._last >= PERIOD:
            self._publish(states, watch)

    def end(self, watch: Watch) -> None:
        """Publish the final states, and close all publishers."""
        if self._publishers:
            self._publish(watch.session.states(ahead=False), watch)
        for publisher in self._publishers:
            publisher.close()

    def _publish(self, states: tuple[State, ...], watch: Watch) -> None:
        earlier = [run.verdicts for run in watch.runs]
        violated = {id for run in earlier for id, verdict in run.items() if verdict == "violated"}
        current = statuses(watch.session, states, violated)
        for publisher in self._publishers:
            publisher.publish(states, current, watch.session.received)
        self._last, self._states = time.monotonic(), states
