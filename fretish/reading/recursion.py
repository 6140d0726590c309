"""Raise Python's recursion limit for passes over deep trees."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from typing import ParamSpec, TypeVar

MOST = 2500
"""The largest number of levels of operators in a sentence: over 1 000 nested parentheses."""
_FRAMES = 30_000

P = ParamSpec("P")
R = TypeVar("R")


def with_recursion_limit(function: Callable[P, R]) -> Callable[P, R]:
    """Let the function recurse over trees of `MOST` levels; restore the limit afterwards."""

    @functools.wraps(function)
    def with_room(*args: P.args, **kwargs: P.kwargs) -> R:
        limit = sys.getrecursionlimit()
        if limit >= _FRAMES:
            return function(*args, **kwargs)
        sys.setrecursionlimit(_FRAMES)
        try:
            return function(*args, **kwargs)
        finally:
            sys.setrecursionlimit(limit)

    return with_room
