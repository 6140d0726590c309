"""Work on many things in several processes; results come in the order of the things."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import Any, Generic, TypeVar

T = TypeVar("T")
R = TypeVar("R")


class _Work(Generic[T, R]):
    """What the processes inherit: what is generated at run time cannot be sent to them."""

    function: Callable[[Any], Any] | None = None


def each(function: Callable[[T], R], things: Sequence[T], jobs: int) -> Iterator[R]:
    """The function of each thing, in their order.

    Args:
        function: of what can be sent between processes, to what can be.
        things: in any number.
        jobs: processes; with one, or for one thing, this one does the work.

    Raises:
        BrokenProcessPool: a process was killed.
    """
    jobs = min(jobs, len(things))
    if jobs < 2:
        yield from map(function, things)
        return
    _Work.function = function
    context = multiprocessing.get_context("fork")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin)
    try:
        yield from pool.map(_done, things)
    finally:
        pool.shutdown(cancel_futures=True)
        _Work.function = None


def _begin() -> None:
    """Ctrl-C goes to all processes of a terminal; the first one decides."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _done(thing: Any) -> Any:
    assert _Work.function is not None
    return _Work.function(thing)
