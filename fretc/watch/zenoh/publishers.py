"""The publishers of a Zenoh connection, by their liveliness tokens. Times are receive times."""

from __future__ import annotations

from collections import Counter

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
    """All publishers, by the keys of their tokens; each step takes the same time for any number."""

    def __init__(self) -> None:
        """There are none yet."""
        self._all: dict[str, Publisher] = {}
        self._gone: dict[str, None] = {}
        """The tokens that have disappeared and are kept, the oldest first."""
        self._unreported: dict[str, None] = {}
        """Those of them that do not count as gone yet."""
        self._there: Counter[str] = Counter()
        """For each topic and each key, the number of publishers that are there."""
        self._since: dict[str, int | None] = {}
        """For each key, when its first publisher appeared; None: before the watch."""

    def appear(self, name: str, publisher: Publisher) -> Publisher | None:
        """Add a publisher; returns what it was before it disappeared, if it has been here."""
        before = self._all.get(name)
        if before is not None and before.gone is None:
            return None
        if before is None and len(self._all) >= MOST_TOKENS:
            if not self._gone:
                return None
            self._forget(next(iter(self._gone)))
        self._all[name] = publisher
        self._gone.pop(name, None)
        if before is None or before.is_reported:
            self._there.update((publisher.topic, publisher.token.key))
        self._unreported.pop(name, None)
        self._begin(publisher)
        return before

    def _begin(self, publisher: Publisher) -> None:
        key, since = publisher.token.key, publisher.since
        if publisher.is_early:
            self._since[key] = None
        elif key not in self._since and len(self._since) < MOST_TOKENS:
            self._since[key] = since

    def _forget(self, name: str) -> None:
        """Make room for another publisher."""
        publisher = self._all.pop(name)
        del self._gone[name]
        if self._unreported.pop(name, name) is None:
            self._leave(publisher)

    def _leave(self, publisher: Publisher) -> None:
        publisher.is_reported = True
        for each in (publisher.topic, publisher.token.key):
            self._there[each] -= 1
            if not self._there[each]:
                del self._there[each]

    def disappear(self, name: str, now: int) -> None:
        """Record that a token has disappeared."""
        publisher = self._all.get(name)
        if publisher is not None and publisher.gone is None:
            publisher.gone = now
            self._gone[name] = self._unreported[name] = None

    def ended(self, until: int) -> list[Publisher]:
        """Those that disappeared until this time, each once."""
        names = [name for name in self._unreported if (self._all[name].gone or 0) <= until]
        for name in names:
            del self._unreported[name]
            self._leave(self._all[name])
        return [self._all[name] for name in names]

    def count(self, of: str) -> int:
        """The number of publishers of a topic, or with a key, that are there."""
        return self._there[of]

    def nodes(self, topic: str) -> list[str]:
        """The names of the nodes that publish a topic, sorted; this looks at all publishers."""
        there = (each for each in self._all.values() if not each.is_reported)
        return sorted({each.token.node for each in there if each.topic == topic})

    def nodes_of(self, key: str) -> list[str]:
        """The names of the nodes that publish with a key, sorted; as above."""
        there = (each for each in self._all.values() if not each.is_reported)
        return sorted({each.token.node for each in there if each.token.key == key})

    def since(self, key: str) -> int | None:
        """When the first publisher with this key appeared; None: before the watch, or never."""
        return self._since.get(key)
