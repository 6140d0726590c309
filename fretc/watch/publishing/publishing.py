"""When something is published: what arrives at once, what is known with each change, and steadily.

No publisher is waited for, and what fails there does not touch the watch.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Protocol

from fretc.watch.publishing.statuses import statuses
from fretc.watch.sources.source import Arrival, Diagnosing, Event, Idle
from fretc.watch.watch import Watch
from monitors.guard import State, Status

PERIOD = 0.5
"""Seconds from one time that all is published to the next, where nothing changes."""


_WHO = "fretc watch"
"""Before each name of a status, as nodes of ROS have theirs there."""


class Publisher(Protocol):
    """Where verdicts go."""

    def pass_on(self, arrival: Arrival) -> None:
        """A message of the robot."""

    def publish(self, states: Sequence[State], known: Sequence[Status], now: int) -> None:
        """What is known of all requirements at a receive time, in nanoseconds; 0: nothing came."""

    def close(self) -> None:
        """Nothing more comes; it may be called more than once."""


class Diagnostics:
    """`diagnostic_msgs/DiagnosticArray` on `/diagnostics`, through the middleware."""

    def __init__(self, middleware: Diagnosing) -> None:
        """To be made before the middleware is opened."""
        self._middleware = middleware
        middleware.diagnose(())

    def pass_on(self, arrival: Arrival) -> None:
        """Nothing: it came from there."""

    def publish(self, states: Sequence[State], known: Sequence[Status], now: int) -> None:
        """The latest is what counts."""
        self._middleware.diagnose([each._replace(name=f"{_WHO}: {each.name}") for each in known])

    def close(self) -> None:
        """Nothing: the middleware ends with the watch."""


class Publishing:
    """All places where the verdicts of a watch go."""

    def __init__(self, publishers: Sequence[Publisher]) -> None:
        """Nothing is published yet."""
        self._publishers = publishers
        self._last, self._states = float("-inf"), tuple[State, ...]()

    def take(self, item: Arrival | Event | Idle, watch: Watch) -> None:
        """What a source has given, which the watch has taken."""
        if not self._publishers:
            return
        if isinstance(item, Arrival):
            for each in self._publishers:
                each.pass_on(item)
        states = watch.session.states()
        if states != self._states or time.monotonic() - self._last >= PERIOD:
            self._publish(states, watch)

    def end(self, watch: Watch) -> None:
        """The last word, and nothing more."""
        if self._publishers:
            self._publish(watch.session.states(ahead=False), watch)
        for each in self._publishers:
            each.close()

    def _publish(self, states: tuple[State, ...], watch: Watch) -> None:
        earlier = [run.verdicts for run in watch.runs]
        violated = {id for run in earlier for id, verdict in run.items() if verdict == "violated"}
        known = statuses(watch.session, states, violated)
        for each in self._publishers:
            each.publish(states, known, watch.session.received)
        self._last, self._states = time.monotonic(), states
