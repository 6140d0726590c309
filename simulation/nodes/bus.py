"""What connects the parts: topics, on which messages take time and get lost, and timers.

The parts share nothing but the messages. Times are nanoseconds.
"""

import heapq
import math
from collections import defaultdict
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from simulation.world.scenario import Transport

Handler = Callable[[Any, int], None]
"""Takes a message and the time at which it arrives."""

_SECOND = 10**9
_NEXT = 105_000_000
"""Nanoseconds by which a message is held back to come after the next one of a 10 Hz topic."""


class Bus:
    """Delivers messages at their time; the recorder hears what everybody hears."""

    def __init__(
        self,
        record: Callable[[str, Any, int], None],
        transports: Mapping[str, Transport],
        seed: int,
        faults_from: int = 0,
    ) -> None:
        """`faults_from`: no message that is sent before this time is late or lost."""
        self._record, self._transports = record, transports
        self._random = np.random.default_rng([seed, 3])
        self._faults_from = faults_from
        self._handlers: dict[str, list[Handler]] = defaultdict(list)
        self._queue: list[tuple[int, int, Callable[[int], None]]] = []
        self._count = 0

    @property
    def next(self) -> float:
        """When something happens next; inf where nothing is to happen."""
        return self._queue[0][0] if self._queue else math.inf

    def subscribe(self, topic: str, handler: Handler) -> None:
        """Hear every message of the topic from now on; who subscribed first hears first."""
        self._handlers[topic].append(handler)

    def publish(self, topic: str, message: Any, time: int) -> None:
        """Send a message at a time that is not past; it may arrive later, or never."""
        way = self._transports.get(topic)
        if way is not None and time >= self._faults_from:
            lost, swapped = self._random.random(2)
            if lost < way.loss:
                return
            time += round(way.delay * _SECOND) + (_NEXT if swapped < way.swap else 0)
        self.at(time, lambda now: self._deliver(topic, message, now))

    def at(self, time: int, action: Callable[[int], None]) -> None:
        """Do something then; of two things at one time the one that was asked for first."""
        heapq.heappush(self._queue, (time, self._count, action))
        self._count += 1

    def every(self, period: int, first: int, action: Callable[[int], None]) -> None:
        """Do something again and again."""

        def again(now: int) -> None:
            action(now)
            self.at(now + period, again)

        self.at(first, again)

    def run(self) -> None:
        """Do what is next."""
        time, _, action = heapq.heappop(self._queue)
        action(time)

    def _deliver(self, topic: str, message: Any, now: int) -> None:
        self._record(topic, message, now)
        for handler in self._handlers[topic]:
            handler(message, now)
