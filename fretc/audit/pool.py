"""Map a function over items in several processes; a killed process costs no other item its result.

Each process has a pipe of its own, so that it is certain which item it worked on when it died.
"""

from __future__ import annotations

import multiprocessing
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, suppress
from enum import Enum
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar, overload

from compiler.files.processes import reply
from fretc.logs.storage.log_names import name_of
from fretish.bindings.amounts import exact_duration
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.system.processes import FORKS, ignore_interrupts, stops_blocked

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class WorkerDied:
    """The process of an item was killed twice, the second time while it worked alone."""

    status: int
    """The exit status, as in `Process.exitcode`: a negative one is a signal."""

    def __str__(self) -> str:
        """The exit status in words."""
        return f"signal {-self.status}" if self.status < 0 else f"exit status {self.status}"


class TimedOut(Enum):
    """There was no time for an item: its process was stopped, or never began."""

    OWN = "own"
    """The item took longer than the limit for one."""
    ALL = "all"
    """The time limit for all items was reached."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Time limits in seconds."""

    each: float | None = None
    """The limit for one item; None: none."""
    all: float | None = None
    """The limit for all items together, from the start; None: none."""


ENDLESS = Limits()


def time_limit_diagnostic(log: str, how: TimedOut, limits: Limits) -> Diagnostic:
    """F440 or F441: a log that was not audited to its end because of a time limit.

    Args:
        log: its path.
        how: the limit that was reached.
        limits: the limits of the audit.
    """
    if how is TimedOut.OWN and limits.each is not None:
        return diagnostic(
            "log_out_of_time",
            Source(name_of(log), "").span(),
            log=name_of(log),
            limit=exact_duration(limits.each),
        )
    assert limits.all is not None
    return diagnostic("audit_out_of_time", limit=exact_duration(limits.all))


def killed_diagnostic(log: str, how: str) -> Diagnostic:
    """F419.

    Args:
        log: its path.
        how: how the process ended.
    """
    return diagnostic(
        "audit_process_killed", Source(name_of(log), "").span(), log=name_of(log), how=how
    )


@overload
def map_processes(
    function: Callable[[T], R], items: Sequence[T], jobs: int
) -> Generator[tuple[int, R | WorkerDied], None, None]: ...


@overload
def map_processes(
    function: Callable[[T], R], items: Sequence[T], jobs: int, limits: Limits
) -> Generator[tuple[int, R | WorkerDied | TimedOut], None, None]: ...


def map_processes(
    function: Callable[[T], R], items: Sequence[T], jobs: int, limits: Limits = ENDLESS
) -> Generator[tuple[int, R | WorkerDied | TimedOut], None, None]:
    """The result of the function for each item with the item's index, in the order of completion.

    The processes end when the caller stops iterating.

    Args:
        function: a function whose results can be sent between processes.
        items: any number of items; a single one without limits is processed by this process, as are
            all where processes cannot be forked.
        jobs: the number of processes.
        limits: the time limits; an item over a limit gives `TimedOut`. They need forked processes.

    Raises:
        Exception: an exception that the function raises.
    """
    if limits == ENDLESS and (len(items) < 2 or not FORKS):
        yield from ((index, function(thing)) for index, thing in enumerate(items))
        return
    clock = _Clock(limits)
    again: list[int] = []
    with closing(_shared(function, items, range(len(items)), jobs, clock)) as completed:
        for index, result in completed:
            if isinstance(result, WorkerDied):
                again.append(index)
            else:
                yield index, result
    for index in again:
        yield from _shared(function, items, [index], 1, clock)


class _Clock:
    """The time that is left for all items, and for one."""

    def __init__(self, limits: Limits) -> None:
        self._each = limits.each
        self._end = None if limits.all is None else time.monotonic() + limits.all

    @property
    def is_over(self) -> bool:
        """Whether the limit for all items is reached."""
        return self._end is not None and time.monotonic() >= self._end

    def is_late(self, since: float) -> bool:
        """Whether an item that began then is over its limit."""
        return self._each is not None and time.monotonic() - since >= self._each

    def patience(self, begun: Iterable[float]) -> float | None:
        """Seconds until the next limit is reached, for items that began then; None: never."""
        ends = [] if self._each is None else [since + self._each for since in begun]
        ends += [] if self._end is None else [self._end]
        return max(0.0, min(ends) - time.monotonic()) if ends else None


def _shared(
    function: Callable[[T], R],
    items: Sequence[T],
    indices: Sequence[int],
    jobs: int,
    clock: _Clock,
) -> Generator[tuple[int, R | WorkerDied | TimedOut], None, None]:
    pool = _WorkerPool(function, items, clock)
    waiting = deque(indices)
    try:
        while waiting or pool.busy:
            if clock.is_over:
                for index in (*pool.indices, *waiting):
                    yield index, TimedOut.ALL
                return
            while waiting and len(pool.busy) < jobs:
                pool.submit(waiting.popleft())
            completed = list(pool.completed())
            while waiting and len(pool.busy) < jobs and not clock.is_over:
                pool.submit(waiting.popleft())  # workers continue while this process takes results
            yield from completed
    finally:
        pool.terminate()


class _WorkerPool:
    """Processes that work on one item each, or are idle."""

    def __init__(self, function: Callable[[Any], Any], items: Sequence[Any], clock: _Clock) -> None:
        self._function, self._things, self._clock = function, items, clock
        self._idle: list[tuple[Connection, BaseProcess]] = []
        self.busy: dict[Connection, tuple[BaseProcess, int, float]] = {}
        """Each connection with its process, the index of its item, and its start time."""

    @property
    def indices(self) -> list[int]:
        """The indices of the items in progress."""
        return [index for _, index, _ in self.busy.values()]

    def submit(self, index: int) -> None:
        """Let an idle process, or a new one, work on an item."""
        connection, process = self._idle.pop() if self._idle else self._spawn()
        with suppress(OSError):  # the process has died, which `done` reports
            connection.send(index)
        self.busy[connection] = process, index, time.monotonic()

    def completed(self) -> Iterator[tuple[int, Any]]:
        """Wait for results or for time limits; the processes of results become idle."""
        patience = self._clock.patience(since for _, _, since in self.busy.values())
        for connection in wait(list(self.busy), patience):
            assert isinstance(connection, Connection)
            process, index, _ = self.busy.pop(connection)
            try:
                fine, result = connection.recv()
            except (EOFError, OSError):
                connection.close()
                process.join()
                yield index, WorkerDied(process.exitcode or 0)
                continue
            self._idle.append((connection, process))
            if not fine:
                raise result
            yield index, result
        for connection, (process, index, since) in list(self.busy.items()):
            if self._clock.is_late(since):
                del self.busy[connection]
                _end(connection, process)
                yield index, TimedOut.OWN

    def terminate(self) -> None:
        """Terminate all processes at once: they only read."""
        working = [(connection, process) for connection, (process, *_) in self.busy.items()]
        for _, process in (*working, *self._idle):
            process.kill()
        for connection, process in (*working, *self._idle):
            _end(connection, process)

    def _spawn(self) -> tuple[Connection, BaseProcess]:
        # Forked, because some functions cannot be pickled, and loaded modules are inherited.
        context: Any = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe()
        # A pipe ends when all its ends are closed: a child must close those of other children.
        inherited = [ours, *self.busy, *(connection for connection, _ in self._idle)]
        arguments = (self._function, self._things, theirs, inherited)
        process = context.Process(target=_serve, args=arguments, daemon=True)
        with stops_blocked():
            process.start()
        theirs.close()
        return ours, process


def _end(connection: Connection, process: BaseProcess) -> None:
    process.kill()
    connection.close()
    process.join()


def _serve(
    function: Callable[[Any], Any],
    items: Sequence[Any],
    connection: Connection,
    inherited: Sequence[Connection],
) -> None:
    """Work on the items whose indices are sent, until the connection is closed."""
    ignore_interrupts()
    for other in inherited:
        other.close()
    with suppress(EOFError, OSError):
        while True:
            connection.send(reply(function, items[connection.recv()]))
