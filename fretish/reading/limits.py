"""What reading a text or a log may cost: processor time and memory, by its size.

Files are untrusted, and a small one may ask for hours or for all the memory there is. A
clock of the process's own time looks in while something is read, and ends it where it has taken
more than a text or a log of its size ever needs. What one call of a library may take at once is
bounded where it is called; this is for all that is slow or grows step by step.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import TypeVar

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span

SECONDS = 3.0
"""Processor time for a text of any size."""
_BYTES_A_SECOND = 200_000
"""A text may take one more second for each so many bytes."""
MEMORY = 300 * 2**20
"""Bytes of memory that reading a text of any size may add to the process."""
_MEMORY_A_BYTE = 100
"""Reading may add so many more bytes of memory for each byte of the text."""
_LOOK = 0.05
"""CPU seconds between two looks."""

R = TypeVar("R")


class ExceededError(BaseException):
    """Reading has taken more than it may; the text says of what.

    No `Exception`: where a library may raise anything, this is not to be taken for its own.
    """


@dataclass(slots=True)
class _Budget:
    """What is left to be used: absolute, of the process."""

    seconds: float
    memory: int


_budgets: list[_Budget] = []
"""The one that counts now, if there is one."""


@contextmanager
def budget(size: int) -> Iterator[None]:
    """A block that may cost no more than reading a text of so many bytes.

    Within another one its bytes are added to that. Only the main thread can be interrupted: in any
    other nothing is counted.

    Raises:
        ExceededError: it takes more.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    if _budgets:
        extend_budget(size)
        yield
        return
    _budgets.append(_Budget(time.process_time() + SECONDS, _resident() + MEMORY))
    extend_budget(size)
    signal.signal(signal.SIGPROF, _look)  # stays: a signal that comes late finds no budget
    signal.siginterrupt(signal.SIGPROF, False)
    signal.setitimer(signal.ITIMER_PROF, _LOOK, _LOOK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        _budgets.clear()


def extend_budget(size: int) -> None:
    """So many bytes more are read within the present budget, if there is one."""
    for current in _budgets:
        current.seconds += size / _BYTES_A_SECOND
        current.memory += size * _MEMORY_A_BYTE


def with_budget(size: int, place: Span, reading: Callable[[], R]) -> R | Diagnostic:
    """The result of the call; F930 where it costs more than reading so many bytes may.

    Args:
        size: bytes that are read.
        place: what is read, as the user knows it.
        reading: the call.
    """
    inner = bool(_budgets)
    try:
        with budget(size):
            return reading()
    except ExceededError as error:
        if inner:  # the caller that set the budget reports it
            raise
        return exceeded(error, place)
    except MemoryError:
        return exceeded(ExceededError("more memory than there is"), place)


def exceeded(error: ExceededError, place: Span | None = None) -> Diagnostic:
    """F930."""
    return Diagnostic(
        Code.TOO_COSTLY,
        f"reading it takes {error}, far more than input of its size needs",
        place,
        help="the input is malicious or damaged; if it is sound, split it",
    )


def _look(_number: int, _frame: FrameType | None) -> None:
    for current in _budgets:
        if time.process_time() > current.seconds:
            raise ExceededError(f"more than {SECONDS:g} CPU seconds")
        if _resident() > current.memory:
            raise ExceededError(f"more than {MEMORY // 2**20} MiB of memory")


_PAGE = os.sysconf("SC_PAGE_SIZE")


def _resident() -> int:
    """Bytes of memory that the process has now."""
    return int(Path("/proc/self/statm").read_bytes().split()[1]) * _PAGE
