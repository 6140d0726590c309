"""Load untrusted YAML within limits: its nodes are counted before it is loaded.

An alias repeats all nodes of its anchor, so a few lines can expand to more nodes than fit into
memory. The library also recurses over nested nodes, in C without a limit.
"""

from __future__ import annotations

from typing import Any

_MOST_LEVELS = 100
_MOST_NODES = 20_000
"""Nodes that are allowed for any text."""
_MOST_TIMES = 10
"""The largest ratio of nodes after expansion of aliases to nodes in the text."""


def loaded(text: str) -> Any:
    """The value of a YAML text.

    Raises:
        ValueError: the text is not YAML, or exceeds a limit.
    """
    import yaml

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        _count(yaml, text, loader)
        return yaml.load(text, Loader=loader)
    except (yaml.YAMLError, RecursionError, TypeError, AttributeError) as error:
        raise ValueError("it is not YAML") from error  # TypeError: an unhashable key.


def _count(yaml: Any, text: str, loader: Any) -> None:
    """Compare the number of nodes after expansion of aliases with the number in the text.

    Raises:
        ValueError: there are too many nodes, or they are nested too deep.
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
    """The keys of the open mappings, to find duplicates: YAML's reader would use the last one."""

    def __init__(self) -> None:
        self._open: list[set[str] | None] = []
        """The keys of each open mapping; None for a sequence."""
        self._next: list[bool] = []
        """Whether the next node of each open collection is a key."""

    def read(self, yaml: Any, event: Any) -> None:
        """Process one more event.

        Raises:
            ValueError: a mapping has a duplicate key.
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
