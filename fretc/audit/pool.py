"""Work on many things in several processes; one that is killed costs no other thing its result.

Each process has a pipe of its own, so that it is certain which thing it worked on when it died.
"""

from __future__ import annotations

import multiprocessing
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from enum import Enum
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkProcess
from typing import Any, TypeVar, overload

from compiler.files.processes import ignore_interrupts, reply, stops_blocked
from fretc.logs.storage.log_names import name_of
from fretish.bindings.amounts import exact_duration
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class WorkerDied:
    """The process that worked on a thing was killed, twice: the second time it was alone."""

    status: int
    """How it ended, as `Process.exitcode` tells it: negative is a signal."""

    def __str__(self) -> str:
        """In words."""
        return f"signal {-self.status}" if self.status < 0 else f"exit status {self.status}"


class TimedOut(Enum):
    """There was no time for a thing: its process was ended, or never began."""

    OWN = "own"
    """It took longer than a thing may."""
    ALL = "all"
    """The time for all things was over."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Seconds of the clock that work may take."""

    each: float | None = None
    """Of a thing; None: any."""
    all: float | None = None
    """Of all things together, from their beginning."""


ENDLESS = Limits()


def was_late(log: str, how: TimedOut, limits: Limits) -> Diagnostic:
    """F440, F441: a log that was not audited to its end, for want of time.

    Args:
        log: its path.
        how: which time was over.
        limits: those of the audit.
    """
    if how is TimedOut.OWN and limits.each is not None:
        return Diagnostic(
            Code.LOG_OUT_OF_TIME,
            f"the audit of `{name_of(log)}` was ended after {exact_duration(limits.each)}",
            Source(name_of(log), "").span(),
            help="allow more time with `--log-time`, or audit this log alone",
            severity=Severity.WARNING,
        )
    assert limits.all is not None
    return Diagnostic(
        Code.AUDIT_OUT_OF_TIME,
        f"the {exact_duration(limits.all)} of the audit were over: no data",
        help="audit the remaining logs, or allow more time with `--time`",
        severity=Severity.WARNING,
    )


def was_killed(log: str, how: str) -> Diagnostic:
    """F419.

    Args:
        log: its path.
        how: the process ended.
    """
    return Diagnostic(
        Code.PROCESS_KILLED,
        f"the process that audited `{name_of(log)}` was killed, and again when it ran alone: {how}",
        Source(name_of(log), "").span(),
        help="it may have run out of memory: audit this log on a machine with more memory",
    )


@overload
def each(
    function: Callable[[T], R], things: Sequence[T], jobs: int
) -> Generator[tuple[int, R | WorkerDied], None, None]: ...


@overload
def each(
    function: Callable[[T], R], things: Sequence[T], jobs: int, limits: Limits
) -> Generator[tuple[int, R | WorkerDied | TimedOut], None, None]: ...


def each(
    function: Callable[[T], R], things: Sequence[T], jobs: int, limits: Limits = ENDLESS
) -> Generator[tuple[int, R | WorkerDied | TimedOut], None, None]:
    """The function of each thing with the thing's place, in the order in which they are done.

    The processes end when the caller stops iterating.

    Args:
        function: of anything, to what can be sent between processes.
        things: in any number; a single one without limits is worked on by this process.
        jobs: processes.
        limits: of time; a thing that takes longer is late, and so is each one after all the time.

    Raises:
        Exception: what the function raises.
    """
    if len(things) < 2 and limits == ENDLESS:
        yield from ((place, function(thing)) for place, thing in enumerate(things))
        return
    clock = _Clock(limits)
    again: list[int] = []
    with closing(_shared(function, things, range(len(things)), jobs, clock)) as done:
        for place, result in done:
            if isinstance(result, WorkerDied):
                again.append(place)
            else:
                yield place, result
    for place in again:
        yield from _shared(function, things, [place], 1, clock)


class _Clock:
    """What is left of the time of all things, and of each."""

    def __init__(self, limits: Limits) -> None:
        self._each = limits.each
        self._end = None if limits.all is None else time.monotonic() + limits.all

    @property
    def is_over(self) -> bool:
        """Whether there is no time for any thing."""
        return self._end is not None and time.monotonic() >= self._end

    def is_late(self, since: float) -> bool:
        """Whether a thing that began then takes too long."""
        return self._each is not None and time.monotonic() - since >= self._each

    def patience(self, begun: Iterable[float]) -> float | None:
        """Seconds until one of the things that began then is late, or all are; None: never."""
        ends = [] if self._each is None else [since + self._each for since in begun]
        ends += [] if self._end is None else [self._end]
        return max(0.0, min(ends) - time.monotonic()) if ends else None


def _shared(
    function: Callable[[T], R],
    things: Sequence[T],
    places: Sequence[int],
    jobs: int,
    clock: _Clock,
) -> Generator[tuple[int, R | WorkerDied | TimedOut], None, None]:
    crew = _WorkerPool(function, things, clock)
    waiting = deque(places)
    try:
        while waiting or crew.busy:
            if clock.is_over:
                for place in (*crew.places, *waiting):
                    yield place, TimedOut.ALL
                return
            while waiting and len(crew.busy) < jobs:
                crew.hire(waiting.popleft())
            done = list(crew.done())
            while waiting and len(crew.busy) < jobs and not clock.is_over:
                crew.hire(waiting.popleft())  # they work while this process takes what is done
            yield from done
    finally:
        crew.dismiss()


class _WorkerPool:
    """Processes, each at one thing or idle."""

    def __init__(
        self, function: Callable[[Any], Any], things: Sequence[Any], clock: _Clock
    ) -> None:
        self._function, self._things, self._clock = function, things, clock
        self._idle: list[tuple[Connection, ForkProcess]] = []
        self.busy: dict[Connection, tuple[ForkProcess, int, float]] = {}
        """Each with the place of its thing, and when that began."""

    @property
    def places(self) -> list[int]:
        """Of the things that are worked on."""
        return [place for _, place, _ in self.busy.values()]

    def hire(self, place: int) -> None:
        """Let an idle process, or a new one, work on a thing."""
        connection, process = self._idle.pop() if self._idle else self._born()
        with suppress(OSError):  # it has died meanwhile: `done` will tell
            connection.send(place)
        self.busy[connection] = process, place, time.monotonic()

    def done(self) -> Iterator[tuple[int, Any]]:
        """Wait for results, and for what is late; the processes of results are free again."""
        patience = self._clock.patience(since for _, _, since in self.busy.values())
        for connection in wait(list(self.busy), patience):
            assert isinstance(connection, Connection)
            process, place, _ = self.busy.pop(connection)
            try:
                fine, result = connection.recv()
            except (EOFError, OSError):
                connection.close()
                process.join()
                yield place, WorkerDied(process.exitcode or 0)
                continue
            self._idle.append((connection, process))
            if not fine:
                raise result
            yield place, result
        for connection, (process, place, since) in list(self.busy.items()):
            if self._clock.is_late(since):
                del self.busy[connection]
                _end(connection, process)
                yield place, TimedOut.OWN

    def dismiss(self) -> None:
        """End all processes at once: they only read."""
        working = [(connection, process) for connection, (process, *_) in self.busy.items()]
        for _, process in (*working, *self._idle):
            process.kill()
        for connection, process in (*working, *self._idle):
            _end(connection, process)

    def _born(self) -> tuple[Connection, ForkProcess]:
        # Forked: the function may be what cannot be sent, and what is loaded need not be again.
        context = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe()
        # A pipe ends when all its ends are closed: a child must not keep those of the others.
        inherited = [ours, *self.busy, *(connection for connection, _ in self._idle)]
        arguments = (self._function, self._things, theirs, inherited)
        process = context.Process(target=_serve, args=arguments, daemon=True)
        with stops_blocked():
            process.start()
        theirs.close()
        return ours, process


def _end(connection: Connection, process: ForkProcess) -> None:
    process.kill()
    connection.close()
    process.join()


def _serve(
    function: Callable[[Any], Any],
    things: Sequence[Any],
    connection: Connection,
    inherited: Sequence[Connection],
) -> None:
    """Work on the things whose places are sent, until nobody is there to send one."""
    ignore_interrupts()
    for other in inherited:
        other.close()
    with suppress(EOFError, OSError):
        while True:
            connection.send(reply(function, things[connection.recv()]))
