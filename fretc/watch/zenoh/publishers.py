"""The publishers of a Zenoh connection, by their liveliness tokens. Times are receive times."""

from __future__ import annotations

from fretc.watch.zenoh.keys import Token
from fretish.classes.frozen import dataclass

MOST_TOKENS = 10_000
"""The most publishers that are followed at a time."""


@dataclass(slots=True)
class Publisher:
    """A publisher that has, or had, a token."""

    topic: str
    token: Token
    since: int
    """When it appeared."""
    is_early: bool
    """Whether it was there before the watch."""
    gone: int | None = None
    """When it disappeared."""
    is_reported: bool = False
    """Whether it counts as gone: the connection has outlived it."""


class Publishers:
    """All publishers, by the keys of their tokens."""

    def __init__(self) -> None:
        self._all: dict[str, Publisher] = {}

    def appear(self, name: str, publisher: Publisher) -> Publisher | None:
        """Add a publisher; returns what it was before it disappeared, if it has been here."""
        before = self._all.get(name)
        if before is not None and before.gone is None:
            return None
        if before is None and len(self._all) >= MOST_TOKENS:
            gone = next((key for key, each in self._all.items() if each.gone is not None), None)
            if gone is None:
                return None
            del self._all[gone]
        self._all[name] = publisher
        return before

    def disappear(self, name: str, now: int) -> None:
        """Record that a token has disappeared."""
        publisher = self._all.get(name)
        if publisher is not None and publisher.gone is None:
            publisher.gone = now

    def ended(self, until: int) -> list[Publisher]:
        """Those that disappeared until this time, each once."""
        ended = [
            each
            for each in self._all.values()
            if each.gone is not None and each.gone <= until and not each.is_reported
        ]
        for each in ended:
            each.is_reported = True
        return ended

    def of_topic(self, topic: str) -> list[Publisher]:
        """Those of a topic that are there."""
        return [each for each in self._all.values() if each.topic == topic and not each.is_reported]

    def has_key(self, key: str) -> bool:
        """Whether a publisher with this key is there."""
        return any(each.token.key == key and not each.is_reported for each in self._all.values())

    def since(self, key: str) -> int | None:
        """When the first publisher with this key appeared; None: before the watch, or never."""
        those = [each for each in self._all.values() if each.token.key == key]
        if any(each.is_early for each in those):
            return None
        return min((each.since for each in those), default=None)
