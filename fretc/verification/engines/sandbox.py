"""Calls that may take too long or too much: each in a process of its own, with limits.

An engine in C++ cannot be interrupted from Python, and some of them take gigabytes before they
answer. The process is started anew, not forked: it holds nothing but what the function needs.
"""

from __future__ import annotations

import gc
import multiprocessing
import resource
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from math import ceil
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from multiprocessing.resource_tracker import ensure_running
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

from compiler.files.processes import ignore_interrupts, reply, shield, stops_blocked

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Limits:
    """What a call may take."""

    seconds: int = 60
    """Of a processor; half a minute and three times as many may pass on the wall clock."""
    memory: int = 4 * 2**30
    """Bytes of address space."""

    def __post_init__(self) -> None:
        assert self.seconds > 0
        assert self.memory > 0

    @property
    def wall(self) -> float:
        """Seconds: other processes take their share, and a process takes time to start."""
        return 3.0 * self.seconds + 30.0


DEFAULT = Limits()
_RARELY = (100_000, 50, 50)
"""How many new objects Python looks through for cycles that are no longer used: a search keeps all
that it makes, and would be looked through again and again for a third of its time."""


@dataclass(frozen=True, slots=True)
class Stopped:
    """The call has no result, for this reason."""

    reason: str


def confined(
    limits: Limits, function: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs
) -> R | Stopped:
    """The result of one call in a process of its own: as `Session.call`."""
    with Session(limits) as session:
        return session.call(function, *args, **kwargs)


class Session:
    """Calls in a process of their own, one after the other, each with limits of its own.

    One process serves them, until it is stopped or crashes: then the next call gets a new one.
    An interruption (Ctrl-C) ends the process.
    """

    def __init__(self, limits: Limits) -> None:
        """No process begins before the first call.

        Args:
            limits: of time for each call, and of memory for the process.
        """
        self._limits = limits
        self._process: SpawnProcess | None = None
        self._connection: Connection | None = None

    def __enter__(self) -> Session:
        """The session itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """The process ends."""
        self._end()

    def call(self, function: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R | Stopped:
        """The result of the function, or why there is none.

        Args:
            function: of a module that can be imported, and not of the program: that is not executed
                in another process.
            args: what can be sent between processes, as can the result.
            kwargs: likewise.

        Raises:
            Exception: what the function raises.
        """
        complete = False
        try:
            connection, process = self._begun()
            with suppress(BrokenPipeError):  # then it has ended, and there is no answer
                connection.send((function, args, kwargs))
            answer: R | Stopped = _answer(connection, process, self._limits)
            complete = not isinstance(answer, Stopped)
            return answer
        finally:
            if not complete:
                self._end()

    def _begun(self) -> tuple[Connection, SpawnProcess]:
        if self._process is None or self._connection is None:
            shield()
            context = multiprocessing.get_context("spawn")
            self._connection, theirs = context.Pipe()
            self._process = context.Process(target=_serve, args=(theirs, self._limits), daemon=True)
            ensure_running()  # else `start` would do it, which unblocks the signals
            with _without_main(), stops_blocked():
                self._process.start()
            theirs.close()
        return self._connection, self._process

    def _end(self) -> None:
        if self._process is not None and self._process.pid is not None:
            self._process.kill()
            self._process.join()
        if self._connection is not None:
            self._connection.close()
        self._process = self._connection = None


@contextmanager
def _without_main() -> Iterator[None]:
    """Hide the program from a process that starts: it would execute the whole of it once more."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _answer(connection: Connection, process: SpawnProcess, limits: Limits) -> Any:
    if not connection.poll(limits.wall):
        return Stopped(f"out of time: no answer within {limits.wall:g} s")
    try:
        complete, result = connection.recv()
    except (EOFError, OSError):
        process.join()
        return Stopped(_ended(process.exitcode or 0, limits))
    if complete:
        return result
    if isinstance(result, MemoryError):
        return Stopped(_out_of_memory(limits))
    raise result


def _ended(status: int, limits: Limits) -> str:
    """Why a process ended without a word."""
    if status in (-signal.SIGXCPU, -signal.SIGKILL):
        more = "" if status == -signal.SIGXCPU else ", or it was killed"
        return f"out of time: more than {limits.seconds} CPU seconds{more}"
    how = f"signal {-status}" if status < 0 else f"exit status {status}"
    return f"the process crashed ({how}); it may have had too little memory"


def _out_of_memory(limits: Limits) -> str:
    return f"out of memory: more than {limits.memory / 2**30:g} GiB"


def _serve(connection: Connection, limits: Limits) -> None:
    """Answer calls until no further one comes."""
    ignore_interrupts()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (limits.memory, limits.memory))
    gc.set_threshold(*_RARELY)
    with suppress(EOFError, OSError):
        while True:
            function, args, kwargs = connection.recv()
            _allow(limits.seconds)
            connection.send(reply(function, *args, **kwargs))
            del function, args, kwargs


def _allow(seconds: int) -> None:
    """So many CPU seconds from now on."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    most = resource.getrlimit(resource.RLIMIT_CPU)[1]
    soon = ceil(used.ru_utime + used.ru_stime) + seconds
    resource.setrlimit(resource.RLIMIT_CPU, (soon if most < 0 else min(soon, most), most))
