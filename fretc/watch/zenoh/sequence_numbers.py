"""Lost messages, by the numbers that publishers attach to their messages.

Each publisher counts its messages. A number that is missing is a message that was sent and has not
arrived. Times are receive times in nanoseconds.
"""

from __future__ import annotations

from fretc.watch.sources.source import Missed
from fretc.watch.zenoh.keys import Attachment
from fretish.classes.frozen import dataclass

MOST_PUBLISHERS = 10_000
"""The most publishers whose numbers are kept; the oldest are forgotten."""
_MOST_MISSED = 2**53
"""The largest count that is reported: numbers are those of others."""


@dataclass(slots=True)
class _Last:
    """The last message of a publisher."""

    number: int
    sent: int
    """The send time; 0: unknown."""
    arrived: int
    is_gone: bool = False
    """Whether the publisher has disappeared since: it may begin to count again."""


class Numbers:
    """The last number of each publisher, by its key and its identifier."""

    def __init__(self) -> None:
        self._last: dict[tuple[str, bytes], _Last] = {}
        self._complete_since: int | None = None

    def begin(self, complete_since: int | None) -> None:
        """Begin with a connection.

        Args:
            complete_since: the time from which a publisher that was never heard before has sent
                everything to this connection; None: it may have sent messages before.
        """
        self._complete_since = complete_since

    def missed(self, key: str, of: Attachment, since: int | None, now: int) -> Missed | None:
        """The messages that were lost before this one, if there are any.

        Args:
            key: the key of the message.
            of: its attachment.
            since: when the publisher appeared, if it did so during the connection.
            now: the time at which the message arrived.
        """
        last = self._last.get((key, of.gid))
        if last is None:
            start = since if since is not None else self._complete_since
            lost = of.number - 1 if start is not None else 0
            return _missed(start or 0, now, lost)
        return _missed(last.arrived + 1, now, of.number - last.number - 1)

    def arrived(self, key: str, of: Attachment, now: int) -> None:
        """Keep the number of a message that has arrived.

        A cached message, older than the last one, changes nothing; a publisher that begins to
        count again sends later ones.
        """
        sent, last = of.sent or 0, self._last.pop((key, of.gid), None)
        while len(self._last) >= MOST_PUBLISHERS:
            del self._last[next(iter(self._last))]
        is_old = last is not None and of.number <= last.number and sent <= last.sent
        if last is None or last.is_gone or not is_old:
            last = _Last(of.number, sent, now)
        self._last[key, of.gid] = last

    def last_of(self, key: str, since: int) -> int | None:
        """The earliest of the last times of the publishers of a key that sent after `since`."""
        times = [each.arrived for (name, _), each in self._last.items() if name == key]
        return min((time for time in times if time >= since), default=None)

    def gone(self, key: str) -> None:
        """Record that all publishers of a key have disappeared."""
        for (name, _), each in self._last.items():
            each.is_gone |= name == key


def _missed(since: int, now: int, count: int) -> Missed | None:
    """From `since` on and before `now`."""
    if count <= 0:
        return None
    until = now - 1
    return Missed(min(since, until), until, min(count, _MOST_MISSED))
