"""Calls in a separate process, with limits of time and memory.

An engine in C++ cannot be interrupted from Python, and some need gigabytes. The process is started
anew, not forked, so that it contains only what the function needs.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from multiprocessing.resource_tracker import ensure_running
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

from compiler.files.processes import isolate_imports, reply
from fretish.classes.frozen import dataclass
from fretish.system.processes import ignore_interrupts, stops_blocked, was_killed
from fretish.system.resources import OUT_OF_MEMORY, ProcessLimits, exceeded_time

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class CallLimits:
    """Limits of a call."""

    seconds: int = 60
    """CPU seconds; on the wall clock three times as many and half a minute may pass."""
    memory: int = 4 * 2**30
    """Bytes of address space."""

    def __post_init__(self) -> None:
        assert self.seconds > 0
        assert self.memory > 0

    @property
    def wall(self) -> float:
        """Wall time in seconds, which includes other processes and the start."""
        return 3.0 * self.seconds + 30.0


DEFAULT = CallLimits()
_RARELY = (100_000, 50, 50)
"""Number of new objects after which Python searches for unused cycles. A search keeps all its
objects, and frequent garbage collection would take a third of its time."""


@dataclass(frozen=True, slots=True)
class NoResult:
    """The call has no result, for this reason."""

    reason: str


def confined(
    limits: CallLimits, function: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs
) -> R | NoResult:
    """The result of one call in a separate process, as by `SandboxSession.call`."""
    with SandboxSession(limits) as session:
        return session.call(function, *args, **kwargs)


class SandboxSession:
    """Calls in a separate process, one after the other, each with its own limits.

    One process serves them until it is stopped or crashes; then the next call starts a new one. An
    interruption (Ctrl-C) ends the process.
    """

    def __init__(self, limits: CallLimits) -> None:
        """A session without a process; the first call starts one.

        Args:
            limits: time for each call, and memory for the process.
        """
        self._limits = limits
        self._process: SpawnProcess | None = None
        self._connection: Connection | None = None

    def __enter__(self) -> SandboxSession:
        """The session itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the process."""
        self._end()

    def call(self, function: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> R | NoResult:
        """The result of the function, or why there is none.

        Args:
            function: function of an importable module, not of the main program, which the other
                process does not execute.
            args: arguments that can be sent between processes, as can the result.
            kwargs: keyword arguments, likewise.

        Raises:
            Exception: the exception of the function.
        """
        complete = False
        try:
            connection, process = self._begun()
            with suppress(BrokenPipeError):  # Then the process has ended without a result.
                connection.send((function, args, kwargs))
            answer: R | NoResult = _answer(connection, process, self._limits)
            complete = not isinstance(answer, NoResult)
            return answer
        finally:
            if not complete:
                self._end()

    def _begun(self) -> tuple[Connection, SpawnProcess]:
        if self._process is None or self._connection is None:
            isolate_imports()
            context = multiprocessing.get_context("spawn")
            pair: Any = context.Pipe()  # Windows has a class of its own
            self._connection, theirs = pair
            self._process = context.Process(target=_serve, args=(theirs, self._limits), daemon=True)
            if os.name == "posix":
                ensure_running()  # Otherwise `start` would do this, and unblock the signals.
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
    """Hide the main program from a starting process, which would execute it again."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


def _answer(connection: Connection, process: SpawnProcess, limits: CallLimits) -> Any:
    if not connection.poll(limits.wall):
        return NoResult(f"out of time: no answer within {limits.wall:g} s")
    try:
        complete, result = connection.recv()
    except (EOFError, OSError):
        process.join()
        return NoResult(_ended(process.exitcode or 0, limits))
    if complete:
        return result
    if isinstance(result, MemoryError):
        return NoResult(_out_of_memory(limits))
    raise result


def _ended(status: int, limits: CallLimits) -> str:
    """Why a process ended without a result."""
    if exceeded_time(status) or was_killed(status):
        more = "" if exceeded_time(status) else ", or it was killed"
        return f"out of time: more than {limits.seconds} CPU seconds{more}"
    if status == OUT_OF_MEMORY:
        return _out_of_memory(limits)
    how = f"signal {-status}" if status < 0 else f"exit status {status}"
    return f"the process crashed ({how}); it may have had too little memory"


def _out_of_memory(limits: CallLimits) -> str:
    return f"out of memory: more than {limits.memory / 2**30:g} GiB"


def _serve(connection: Connection, limits: CallLimits) -> None:
    """Answer calls until the connection is closed."""
    ignore_interrupts()
    own = ProcessLimits(limits.memory)
    gc.set_threshold(*_RARELY)
    with suppress(EOFError, OSError):
        while True:
            function, args, kwargs = connection.recv()
            own.allow(limits.seconds)
            connection.send(reply(function, *args, **kwargs))
            del function, args, kwargs
