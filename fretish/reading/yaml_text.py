"""Untrusted YAML, within bounds: its nodes are counted before they become values.

An alias stands for all that its anchor holds, so a few lines may stand for more nodes than memory
has room for; and the library recurses over nested nodes, in C without any limit.
"""

from __future__ import annotations

from typing import Any

_MOST_LEVELS = 100
_MOST_NODES = 20_000
"""Whatever the text is."""
_MOST_TIMES = 10
"""Aliases may expand a text to so many times the nodes that stand in it."""


def loaded(text: str) -> Any:
    """The value of a text in YAML.

    Raises:
        ValueError: it is no YAML, or means far more than is written.
    """
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        _count(yaml, text, loader)
        return yaml.load(text, Loader=loader)
    except (yaml.YAMLError, RecursionError, TypeError, AttributeError) as error:
        raise ValueError("it is not YAML") from error  # TypeError: a key that cannot be one


def _count(yaml: Any, text: str, loader: Any) -> None:
    """Compare the number of nodes after expansion of aliases with the number in the text.

    Raises:
        ValueError: there are too many of them, or they are too deep.
    """
    keys = _Keys()
    sizes: dict[str, int] = {}
    open_: list[tuple[str | None, int]] = []
    size = 0
    for length, event in enumerate(yaml.parse(text, Loader=loader), 1):
        keys.read(yaml, event)
        if isinstance(event, yaml.CollectionStartEvent):
            open_.append((event.anchor, size))
            if len(open_) > _MOST_LEVELS:
                raise ValueError(f"more than {_MOST_LEVELS} nested levels")
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = open_.pop()
            if anchor is not None:
                sizes[anchor] = size - before
        elif isinstance(event, yaml.ScalarEvent) and event.anchor is not None:
            sizes[event.anchor] = 1
        size += sizes.get(event.anchor, 1) if isinstance(event, yaml.AliasEvent) else 1
        if size > max(_MOST_NODES, _MOST_TIMES * length):
            raise ValueError("its aliases expand to too many nodes")


class _Keys:
    """The keys of the mappings that are still open; of equal keys YAML's reader takes the last."""

    def __init__(self) -> None:
        self._open: list[set[str] | None] = []
        """The keys of each open mapping; None for a sequence."""
        self._next: list[bool] = []
        """Whether the next node in it is a key."""

    def read(self, yaml: Any, event: Any) -> None:
        """Process one more event.

        Raises:
            ValueError: a key comes twice in one mapping.
        """
        if isinstance(event, yaml.CollectionEndEvent):
            self._open.pop()
            self._next.pop()
        if not isinstance(event, yaml.NodeEvent):
            return
        keys = self._open[-1] if self._open else None
        if keys is not None:
            if self._next[-1] and isinstance(event, yaml.ScalarEvent):
                if event.value in keys:
                    raise ValueError(f"the key `{event.value}` comes twice")
                keys.add(event.value)
            self._next[-1] = not self._next[-1]
        if isinstance(event, yaml.CollectionStartEvent):
            self._open.append(set() if isinstance(event, yaml.MappingStartEvent) else None)
            self._next.append(True)
