"""Work on many things in several processes; one that is killed costs no other thing its result.

Each process has a pipe of its own, so that it is certain which thing it worked on when it died.
"""

from __future__ import annotations

import multiprocessing
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkProcess
from typing import Any, TypeVar

from compiler.files.processes import reply
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source

T = TypeVar("T")
R = TypeVar("R")

_STOPS = (signal.SIGINT, signal.SIGTERM)


@dataclass(frozen=True, slots=True)
class Killed:
    """The process that worked on a thing was killed, twice: the second time it was alone."""

    status: int
    """How it ended, as `Process.exitcode` tells it: negative is a signal."""

    def __str__(self) -> str:
        """In words."""
        return f"signal {-self.status}" if self.status < 0 else f"exit status {self.status}"


def was_killed(log: str, how: str) -> Diagnostic:
    """F419.

    Args:
        log: its path.
        how: the process ended.
    """
    return Diagnostic(
        Code.PROCESS_KILLED,
        f"the process that audited `{log}` was killed, and again when it ran alone: {how}",
        Source(log, "").span(),
        help="was there memory enough? audit this log on a machine that has more",
    )


def each(
    function: Callable[[T], R], things: Sequence[T], jobs: int
) -> Generator[tuple[int, R | Killed], None, None]:
    """The function of each thing with the thing's place, in the order in which they are done.

    Whoever stops to iterate ends the processes, whatever they are at.

    Args:
        function: of anything, to what can be sent between processes.
        things: in any number; a single one is worked on by this process.
        jobs: processes.

    Raises:
        Exception: what the function raises.
    """
    if len(things) < 2:
        yield from ((place, function(thing)) for place, thing in enumerate(things))
        return
    again: list[int] = []
    with closing(_shared(function, things, range(len(things)), jobs)) as done:
        for place, result in done:
            if isinstance(result, Killed):
                again.append(place)
            else:
                yield place, result
    for place in again:
        yield from _shared(function, things, [place], 1)


def _shared(
    function: Callable[[T], R], things: Sequence[T], places: Sequence[int], jobs: int
) -> Generator[tuple[int, R | Killed], None, None]:
    crew = _Crew(function, things)
    waiting = deque(places)
    try:
        for _ in range(min(jobs, len(places))):
            crew.hire(waiting.popleft())
        while crew.busy:
            for place, result in crew.done():
                if waiting:
                    crew.hire(waiting.popleft())
                yield place, result
    finally:
        crew.dismiss()


class _Crew:
    """Processes, each at one thing or idle."""

    def __init__(self, function: Callable[[Any], Any], things: Sequence[Any]) -> None:
        self._function, self._things = function, things
        self._idle: list[tuple[Connection, ForkProcess]] = []
        self.busy: dict[Connection, tuple[ForkProcess, int]] = {}

    def hire(self, place: int) -> None:
        """Let an idle process, or a new one, work on a thing."""
        connection, process = self._idle.pop() if self._idle else self._born()
        with suppress(OSError):  # it has died meanwhile: `done` will tell
            connection.send(place)
        self.busy[connection] = process, place

    def done(self) -> Iterator[tuple[int, Any]]:
        """Wait for results; there is at least one, and their processes are free again."""
        for connection in wait(list(self.busy)):
            assert isinstance(connection, Connection)
            process, place = self.busy.pop(connection)
            try:
                fine, result = connection.recv()
            except (EOFError, OSError):
                connection.close()
                process.join()
                yield place, Killed(process.exitcode or 0)
                continue
            self._idle.append((connection, process))
            if not fine:
                raise result
            yield place, result

    def dismiss(self) -> None:
        """End all processes at once: they only read."""
        working = [(connection, process) for connection, (process, _) in self.busy.items()]
        for _, process in (*working, *self._idle):
            process.kill()
        for connection, process in (*working, *self._idle):
            connection.close()
            process.join()

    def _born(self) -> tuple[Connection, ForkProcess]:
        # Forked: the function may be what cannot be sent, and what is loaded need not be again.
        context = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe()
        # A pipe ends when all its ends are closed: a child must not keep those of the others.
        inherited = [ours, *self.busy, *(connection for connection, _ in self._idle)]
        arguments = (self._function, self._things, theirs, inherited)
        process = context.Process(target=_serve, args=arguments, daemon=True)
        with _undisturbed():
            process.start()
        theirs.close()
        return ours, process


@contextmanager
def _undisturbed() -> Iterator[None]:
    """No signal to stop arrives in here: a child that is being born has no answer to it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(
    function: Callable[[Any], Any],
    things: Sequence[Any],
    connection: Connection,
    inherited: Sequence[Connection],
) -> None:
    """Work on the things whose places are sent, until nobody is there to send one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to all; the first one decides
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)
    for other in inherited:
        other.close()
    with suppress(EOFError, OSError):
        while True:
            connection.send(reply(function, things[connection.recv()]))
