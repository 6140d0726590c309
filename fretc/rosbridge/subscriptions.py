"""What a client has subscribed to, and which messages it gets next.

Several subscriptions of a client to a topic are one with the lowest throttle rate, the smallest
fragments and the longest queue. Times are seconds on any clock that does not go back.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import field
from typing import Any

from fretish.classes.frozen import dataclass

MOST_WAITING = 1000
"""Messages that wait for a slow client without `queue_length`; the oldest are dropped."""


@dataclass(frozen=True, slots=True)
class Subscription:
    """The options of one `subscribe`."""

    throttle: float = 0.0
    """Seconds between two messages."""
    queue: int = 0
    """Messages to keep; 0: those within the throttled time are dropped."""
    fragment: int | None = None
    """The most characters of a message; a longer one is sent in fragments."""
    compression: str = "none"


@dataclass(slots=True)
class TopicQueue:
    """A client's subscriptions to one topic, and the messages that wait."""

    subscriptions: dict[str, Subscription] = field(default_factory=dict)
    waiting: deque[tuple[int, Any]] = field(default_factory=deque)
    """Messages with their numbers in the order of all topics."""
    sent: float = float("-inf")

    @property
    def merged(self) -> Subscription:
        """All subscriptions as one."""
        each = self.subscriptions.values()
        fragments = [one.fragment for one in each if one.fragment is not None]
        cbor = any(one.compression == "cbor" for one in each)
        return Subscription(
            min(one.throttle for one in each),
            max(one.queue for one in each),
            min(fragments, default=None),
            "cbor" if cbor else "none",
        )

    def put(self, number: int, message: Any, now: float) -> None:
        """Take a message to send."""
        merged = self.merged
        if not merged.queue and now < self.sent + merged.throttle:
            return
        most = merged.queue or (1 if merged.throttle else MOST_WAITING)
        while len(self.waiting) >= most:
            self.waiting.popleft()
        self.waiting.append((number, message))

    def due(self) -> float:
        """When the next message may be sent; infinity if none waits."""
        return self.sent + self.merged.throttle if self.waiting else float("inf")

    def take(self, now: float) -> Any:
        """The next message, which is sent now."""
        self.sent = now
        return self.waiting.popleft()[1]


def fragments(text: str, size: int, id: str) -> Iterator[dict[str, Any]]:
    """The operations `fragment` of a long text."""
    total = -(-len(text) // size)
    for number in range(total):
        part = text[number * size : (number + 1) * size]
        yield {"op": "fragment", "id": id, "data": part, "num": number, "total": total}
