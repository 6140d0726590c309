"""Values of functions of frozen things, remembered by the very things they are of.

What a log is judged by is the same for each of thousands of logs. `functools.lru_cache` compares
arguments by what they hold, which costs more here than some functions do, recurses over trees, and
takes things for one that stand in different places of a text.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

_MOST = 4096
"""Values of a function; with one more all are forgotten."""

P = ParamSpec("P")
R = TypeVar("R")


def cache_by_identity(function: Callable[P, R]) -> Callable[P, R]:
    """The function, called once for the same arguments; they are frozen and given by position."""
    known: dict[tuple[int, ...], tuple[tuple[object, ...], R]] = {}

    @functools.wraps(function)
    def once(*args: P.args, **kwargs: P.kwargs) -> R:
        assert not kwargs, "arguments are given by position"
        key = tuple(map(id, args))
        found = known.get(key)
        if found is None:
            if len(known) >= _MOST:
                known.clear()
            found = known[key] = args, function(*args, **kwargs)  # what is kept keeps its identity
        return found[1]

    return once
