"""Limits of CPU time and memory for reading a text or a log, by its size.

Files are untrusted, and a small file can cause hours of CPU time or exhaust the memory. A timer of
the process checks the costs while a file is read, and interrupts reading if they exceed the limit
for its size. Single library calls that could exceed it at once have their own limits.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.system.resources import periodically, resident_memory

SECONDS = 3.0
"""CPU seconds allowed for a text of any size."""
_BYTES_A_SECOND = 200_000
"""Bytes of the text for each additional CPU second."""
MEMORY = 300 * 2**20
"""Bytes of memory allowed for a text of any size."""
_MEMORY_A_BYTE = 100
"""Additional bytes of memory allowed for each byte of the text."""
_LOOK = 0.05
"""CPU seconds between two checks."""

R = TypeVar("R")


class ExceededError(BaseException):
    """Reading has exceeded a limit, which the text of the error names.

    It is not an `Exception`, so that no handler of library errors catches it.
    """


@dataclass(slots=True)
class _Budget:
    """Limits in absolute values of the process: CPU seconds and resident bytes."""

    seconds: float
    memory: int


_budgets: list[_Budget] = []
"""The active budget, if there is one."""


@contextmanager
def budget(size: int) -> Iterator[None]:
    """Context that limits a block to the costs of reading `size` bytes.

    A nested budget extends the outer one. Only the main thread can be interrupted; other threads
    have no limit.

    Raises:
        ExceededError: the block exceeds a limit.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    if _budgets:
        extend_budget(size)
        yield
        return
    _budgets.append(_Budget(time.process_time() + SECONDS, resident_memory() + MEMORY))
    extend_budget(size)
    try:
        with periodically(_LOOK, _look):
            yield
    finally:
        _budgets.clear()


class StoppedError(BaseException):
    """A block has been stopped because its result is no longer wanted."""


@contextmanager
def stoppable(stop: Callable[[], bool], seconds: float) -> Iterator[None]:
    """Context that ends a block as soon as its result is no longer wanted.

    All readings in the block share one limit. In other threads than the main one, and where
    `periodically` calls nothing, the block is not stopped.

    Args:
        stop: whether to end the block; called every `_LOOK` CPU seconds.
        seconds: CPU seconds that the block may take.

    Raises:
        StoppedError: `stop` returned true.
        ExceededError: the block exceeds a limit.
    """
    assert not _budgets, "a reading cannot be stopped from within"

    def look() -> None:
        if stop():
            raise StoppedError
        _look()

    _budgets.append(_Budget(time.process_time() + seconds, resident_memory() + MEMORY))
    try:
        with periodically(_LOOK, look):
            yield
    finally:
        _budgets.clear()


def extend_budget(size: int) -> None:
    """Extend the active budget, if there is one, by the costs of `size` bytes."""
    for current in _budgets:
        current.seconds += size / _BYTES_A_SECOND
        current.memory += size * _MEMORY_A_BYTE


def with_budget(size: int, span: Span, reading: Callable[[], R]) -> R | Diagnostic:
    """The result of the call; F930 if it exceeds the budget for `size` bytes.

    Args:
        size: the number of bytes to read.
        span: the span for the diagnostic.
        reading: the function to call.
    """
    inner = bool(_budgets)
    try:
        with budget(size):
            return reading()
    except ExceededError as error:
        if inner:  # the caller that set the budget reports it
            raise
        return exceeded(error, span)
    except MemoryError:
        return exceeded(ExceededError("more memory than there is"), span)


def exceeded(error: ExceededError, span: Span | None = None) -> Diagnostic:
    """F930 for an exceeded limit."""
    return Diagnostic(
        Code.TOO_COSTLY,
        f"reading it takes {error}, far more than input of its size needs",
        span,
        help="the input is malicious or damaged; if it is sound, split it",
    )


def _look() -> None:
    for current in _budgets:
        if time.process_time() > current.seconds:
            raise ExceededError(f"more than {SECONDS:g} CPU seconds")
        if resident_memory() > current.memory:
            raise ExceededError(f"more than {MEMORY // 2**20} MiB of memory")
