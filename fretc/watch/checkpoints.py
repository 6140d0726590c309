"""The latest time of all messages at earlier arrivals, in limited memory. Times are nanoseconds."""

from __future__ import annotations

from bisect import bisect_right

_APART = 100 * 10**6
"""Nanoseconds of receive time between two checkpoints."""
_MOST = 2000
"""The most checkpoints; then every second one of the older half is dropped."""


class Checkpoints:
    """For some arrivals, the latest time on the declared clock of all messages until then."""

    def __init__(self) -> None:
        """No message has arrived yet."""
        self._arrivals: list[int] = []
        self._times: list[int] = []

    def add(self, arrival: int, time: int) -> None:
        """Record that after a message with this arrival, this is the latest time of all."""
        if self._arrivals and arrival - self._arrivals[-1] < _APART:
            return
        self._arrivals.append(arrival)
        self._times.append(time)
        if len(self._arrivals) > _MOST:
            half = _MOST // 2
            del self._arrivals[1:half:2], self._times[1:half:2]

    @property
    def first(self) -> int | None:
        """The first time; None: no message has arrived."""
        return self._times[0] if self._times else None

    def latest(self, arrival: int) -> int | None:
        """A time that was the latest one at this arrival or before it.

        It is never later than the true one, and no earlier than that of any message which arrived a
        tenth of a second before the last one until then. None: no message had arrived.
        """
        place = bisect_right(self._arrivals, arrival)
        return self._times[place - 1] if place else None
