"""Questions answered in a process of their own: one that hangs or dies costs no other its answer.

A single operation on large diagrams cannot be interrupted from Python, and may take any memory. The
process is forked, so it has everything; what it finds comes back finding by finding.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.context import ForkProcess

from compiler.files.processes import reply
from fretc.analysis.analysis import Finding, Job
from fretc.analysis.games.budget import guard
from fretish.reading.recursion import deep

MEMORY = 4 * 2**30
"""Bytes of address space that the process may take."""


class Stopped(Exception):  # noqa: N818
    """Ctrl-C; what was found before it has been given."""


def findings(jobs: Sequence[Job], progress: Callable[[str], None]) -> Iterator[Finding]:
    """What the jobs find, and what each of them lacks whose process ended.

    Args:
        jobs: in the order in which they are done.
        progress: is called with each question before it is looked at.

    Raises:
        Stopped: on Ctrl-C, after what each remaining job lacks.
    """
    found: list[Finding] = []
    number = 0
    while number < len(jobs):
        process, answers = _started(jobs[number:], found)
        progress(jobs[number].title)
        try:
            while True:
                try:
                    finding: Finding | Exception | None = answers.recv()
                except EOFError:
                    break
                if isinstance(finding, MemoryError):
                    break
                if isinstance(finding, Exception):
                    raise finding
                if finding is not None:
                    found.append(finding)
                    yield finding
                    continue
                number += 1
                if number < len(jobs):
                    progress(jobs[number].title)
        except KeyboardInterrupt:
            for job in jobs[number:]:
                yield job.lost("stopped by Ctrl-C")
            raise Stopped from None
        finally:
            process.kill()
            process.join()
            answers.close()
        if number < len(jobs):
            finding = jobs[number].lost(_ending(process.exitcode or 0))
            found.append(finding)
            yield finding
            number += 1


def _started(jobs: Sequence[Job], found: Sequence[Finding]) -> tuple[ForkProcess, Connection]:
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(theirs, jobs, tuple(found)), daemon=True)
    process.start()
    theirs.close()
    return process, ours


def _answer(connection: Connection, jobs: Sequence[Job], found: Sequence[Finding]) -> None:
    """Send each finding, None at the end of each job, and a mistake of ours where there is one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to both; the parent decides
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # BuDDy's last words
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    guard()
    with suppress(OSError):
        is_complete, error = reply(_answer_all, connection, jobs, found)
        if not is_complete:
            connection.send(error)


@deep
def _answer_all(connection: Connection, jobs: Sequence[Job], found: Sequence[Finding]) -> None:
    known = list(found)
    for job in jobs:
        for finding in job.ask(known):
            known.append(finding)
            connection.send(finding)
        connection.send(None)


def _ending(status: int) -> str:
    """Why the process ended before its answer."""
    if status in (-signal.SIGPROF, -signal.SIGKILL):
        return "it took longer than it may"
    return f"it took more than {MEMORY // 2**30} GiB of memory, or failed (exit status {status})"
