"""Memory for a program that reads the same project again and again, such as an editor's server.

A reading within `Memory.active` takes the results of functions with `@remembered` from the reading
before it, if their arguments are the same objects. Without an active memory nothing is kept.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


class Memory:
    """Results of functions, for those arguments that the last reading used."""

    def __init__(self) -> None:
        self._before: dict[Hashable, tuple[object, Any]] = {}
        self._now: dict[Hashable, tuple[object, Any]] = {}

    @contextmanager
    def active(self) -> Iterator[None]:
        """Context of one reading; results that a complete reading has not used are dropped."""
        token = _active.set(self)
        try:
            yield
        except BaseException:
            self._now = {**self._before, **self._now}
            raise
        finally:
            _active.reset(token)
            self._before, self._now = self._now, {}

    def recall(self, key: Hashable, kept: object, compute: Callable[[], R]) -> R:
        """The result for a key, computed if it is new.

        Args:
            key: identifies function and arguments.
            kept: objects that must live as long as the key, which may contain their `id`.
            compute: computes the result.
        """
        entry = self._now.get(key) or self._before.get(key)
        if entry is None:
            entry = kept, compute()
        self._now[key] = entry
        result: R = entry[1]
        return result


_active: ContextVar[Memory | None] = ContextVar("_active", default=None)


def remembered(function: Callable[P, R]) -> Callable[P, R]:
    """The function with the active memory. Its arguments are immutable and positional."""

    @functools.wraps(function)
    def recalled(*args: P.args, **kwargs: P.kwargs) -> R:
        memory = _active.get()
        if memory is None:
            return function(*args, **kwargs)
        assert not kwargs, "arguments are given by position"
        key = (function, *map(id, args))
        return memory.recall(key, args, lambda: function(*args, **kwargs))

    return recalled


def remembered_by_value(function: Callable[P, R]) -> Callable[P, R]:
    """The function with the active memory. Its arguments are hashable and positional.

    Arguments that are equal have the same result: it holds nothing that equality ignores, such as
    the place of a sentence in its file.
    """

    @functools.wraps(function)
    def recalled(*args: P.args, **kwargs: P.kwargs) -> R:
        memory = _active.get()
        if memory is None:
            return function(*args, **kwargs)
        assert not kwargs, "arguments are given by position"
        return memory.recall((function, *args), None, lambda: function(*args, **kwargs))

    return recalled


def same(value: R, *key: Hashable) -> R:
    """The equal value of the reading before, so that what is computed from it is recalled.

    Args:
        value: the value of this reading.
        key: equal values have equal keys, unequal ones do not.
    """
    memory = _active.get()
    return value if memory is None else memory.recall(key, None, lambda: value)
