"""Questions answered in a separate process: a timeout or crash costs no other answer.

A single operation on large diagrams cannot be interrupted from Python, and its memory use is
unbounded. The process is forked, so that it has all data; it returns one finding at a time. Where
processes cannot be forked, this process answers, with fewer limits (F932).
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from compiler.files.processes import reply
from fretc.analysis.arena.budget import guard
from fretc.analysis.games.job import Job
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.recursion import with_recursion_limit
from fretish.system.processes import FORKS, ignore_interrupts, stops_blocked, was_killed
from fretish.system.resources import ProcessLimits, address_space, exceeded_time

F = TypeVar("F")
MEMORY = 4 * 2**30
"""Address space, in bytes, that the process may use besides that of its parent."""


class Interrupted(Exception):  # noqa: N818
    """Ctrl-C was pressed; earlier findings have been yielded."""


def findings(jobs: Sequence[Job[F]], progress: Callable[[str], None]) -> Iterator[F]:
    """Findings of the jobs; a job whose process ended gives its finding for a lost answer.

    Args:
        jobs: jobs in order.
        progress: called with the title of each job before it starts.

    Raises:
        Interrupted: on Ctrl-C, after the findings of the remaining jobs.
    """
    for _, finding in answers(jobs, progress):
        if finding is not None:
            yield finding


def answers(
    jobs: Sequence[Job[F]], progress: Callable[[str], None], known: Sequence[F] = ()
) -> Iterator[tuple[int, F | None]]:
    """Index of a job with each of its findings, and with None if it has answered to the end.

    Args:
        jobs: jobs in order.
        progress: called with the title of each job before it starts.
        known: earlier findings, which the jobs may read.

    Raises:
        Interrupted: on Ctrl-C, after the findings of the remaining jobs.
    """
    if not FORKS:
        yield from _answers_here(jobs, progress, known)
        return
    earlier = [*known]
    with _interruption() as is_stopped:
        number = 0
        while number < len(jobs) and not is_stopped():
            process, messages = _started(jobs[number:], earlier)
            is_full = False
            progress(jobs[number].title)
            try:
                while True:
                    finding = _next(process, messages, is_stopped)
                    if is_full := isinstance(finding, MemoryError):
                        break
                    if isinstance(finding, Exception):
                        raise finding
                    yield number, finding
                    if finding is not None:
                        earlier.append(finding)
                        continue
                    number += 1
                    if number < len(jobs):
                        progress(jobs[number].title)
            except EOFError:
                pass
            finally:
                process.kill()
                process.join()
                messages.close()
            if number < len(jobs) and not is_stopped():
                job, status = jobs[number], process.exitcode or 0
                earlier.append(job.out_of_memory(_LIMIT) if is_full else job.lost(_ending(status)))
                yield number, earlier[-1]
                number += 1
        if is_stopped():
            for rest in range(number, len(jobs)):
                yield rest, jobs[rest].lost(_STOPPED)
            raise Interrupted


def missing_limits() -> tuple[Diagnostic, ...]:
    """F932 if the system has fewer limits for questions than Linux."""
    return () if FORKS else (diagnostic("no_forked_process"),)


def _answers_here(
    jobs: Sequence[Job[F]], progress: Callable[[str], None], known: Sequence[F]
) -> Iterator[tuple[int, F | None]]:
    """The same in this process: Ctrl-C interrupts a question, and nothing limits its memory."""
    earlier = [*known]
    for number, job in enumerate(jobs):
        progress(job.title)
        try:
            for finding in with_recursion_limit(job.ask)(earlier):
                earlier.append(finding)
                yield number, finding
            yield number, None
        except MemoryError:
            earlier.append(job.out_of_memory())
            yield number, earlier[-1]
        except KeyboardInterrupt:
            for rest in range(number, len(jobs)):
                yield rest, jobs[rest].lost(_STOPPED)
            raise Interrupted from None


_STOPPED = "stopped by Ctrl-C"


def finished(jobs: Sequence[Job[F]], progress: Callable[[str], None]) -> tuple[list[F], bool]:
    """The findings of the jobs, and whether Ctrl-C has stopped them."""
    known: list[F] = []
    try:
        known.extend(findings(jobs, progress))
    except Interrupted:
        return known, True
    return known, False


@contextmanager
def _interruption() -> Iterator[Callable[[], bool]]:
    """Whether Ctrl-C was pressed; a flag, so that no finding that was sent is lost."""
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: pressed.append(number))
    try:
        yield lambda: bool(pressed)
    finally:
        signal.signal(signal.SIGINT, before)


def _next(process: BaseProcess, answers: Connection, is_stopped: Callable[[], bool]) -> Any:
    """The next message: a finding, an internal error, or None; after Ctrl-C the rest of it.

    Raises:
        EOFError: the process has ended.
    """
    while not is_stopped() and not answers.poll(_PATIENCE):
        pass
    if is_stopped():
        process.kill()
    try:
        sent = answers.recv()
    except OSError as error:  # in the midst of it
        raise EOFError from error
    return sent


_PATIENCE = 0.1
"""Seconds between two checks for Ctrl-C."""


def _started(jobs: Sequence[Job[F]], earlier: Sequence[F]) -> tuple[BaseProcess, Connection]:
    context: Any = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(theirs, jobs, tuple(earlier)), daemon=True)
    with stops_blocked():
        process.start()
    theirs.close()
    return process, ours


def _answer(connection: Connection, jobs: Sequence[Job[F]], earlier: Sequence[F]) -> None:
    """Send each finding, None at the end of each job, and an internal error if there is one."""
    ignore_interrupts()
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # last words of a library
    ProcessLimits(address_space() + MEMORY)
    guard()
    with suppress(OSError):
        is_complete, error = reply(_answer_all, connection, jobs, earlier)
        if not is_complete:
            connection.send(error)


@with_recursion_limit
def _answer_all(connection: Connection, jobs: Sequence[Job[F]], earlier: Sequence[F]) -> None:
    known = list(earlier)
    for job in jobs:
        for finding in job.ask(known):
            known.append(finding)
            connection.send(finding)
        connection.send(None)


_LIMIT = f"{MEMORY // 2**30} GiB"


def _ending(status: int) -> str:
    """Why the process ended before its answer."""
    if exceeded_time(status) or was_killed(status):
        return "it exceeded its time limit"
    return f"it took more memory than {_LIMIT}, or failed (exit status {status})"
