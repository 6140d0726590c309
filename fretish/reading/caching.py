"""Cache the results of functions by the identity of their arguments.

Thousands of logs are evaluated with the same trees. `functools.lru_cache` would compare arguments
by value: that is slower than some of the functions, recurses over trees, and treats equal trees
with different spans as the same.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

_MOST = 4096
"""The largest number of cached results of a function; beyond it the cache is cleared."""

P = ParamSpec("P")
R = TypeVar("R")


def cache_by_identity(function: Callable[P, R]) -> Callable[P, R]:
    """The function with a cache. Its arguments are immutable and positional."""
    cache: dict[tuple[int, ...], tuple[tuple[object, ...], R]] = {}

    @functools.wraps(function)
    def once(*args: P.args, **kwargs: P.kwargs) -> R:
        assert not kwargs, "arguments are given by position"
        key = tuple(map(id, args))
        entry = cache.get(key)
        if entry is None:
            if len(cache) >= _MOST:
                cache.clear()
            entry = cache[key] = args, function(*args, **kwargs)  # Keeps the ids valid.
        return entry[1]

    return once
