"""Child processes: how they start, their pipes, and their end."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Thread
from typing import IO

FORKS = sys.platform == "linux" and hasattr(os, "fork")
"""Whether a process can be forked, with all its data. macOS has `fork`, but its system libraries
do not survive it."""
OWN_GROUP: int = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
"""`creationflags` of `Popen`: Windows ignores `start_new_session`, and needs this so that Ctrl-C
reaches only this process."""
_KILLED = {-9, 1} if sys.platform == "win32" else {-9}
"""Exit statuses of a process that was killed; on Windows it has the status 1."""
_STOPS = (signal.SIGINT, signal.SIGTERM)
_BLOCK = 2**16
"""Bytes that are copied at once."""


def was_killed(status: int) -> bool:
    """Whether an exit status is that of a process that was killed."""
    return status in _KILLED


def kill_all(process: subprocess.Popen[bytes]) -> None:
    """Kill a process that has its own group or session, and the processes that it has started.

    On Windows, a process whose parent has already ended is not found.
    """
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, 9)
        return
    with suppress(OSError):
        subprocess.run(
            ["taskkill", "/F", "/T", "/PID", str(process.pid)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=False,
        )
    process.kill()


def pause_all(process: subprocess.Popen[bytes]) -> None:
    """Pause a process that has its own group or session, and those that it has started.

    Raises:
        OSError: Windows cannot do this.
    """
    if sys.platform == "win32":
        raise OSError(None, "Windows cannot pause a process")
    os.killpg(process.pid, signal.SIGSTOP)


def resume_all(process: subprocess.Popen[bytes]) -> None:
    """Let the processes go on that `pause_all` has paused."""
    if sys.platform != "win32":
        os.killpg(process.pid, signal.SIGCONT)


@contextmanager
def stops_blocked() -> Iterator[None]:
    """Block stop signals for a child that starts in this context, until it ignores them.

    Without this, a child prints a traceback for a Ctrl-C that comes while it imports; on Windows it
    does. `ignore_interrupts` ends the block in the child.
    """
    if sys.platform == "win32" or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore_interrupts() -> None:
    """Ignore Ctrl-C in a child: the parent receives it, too, and ends the child by SIGTERM."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if sys.platform != "win32" and hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)


def selectable(pipe: IO[bytes]) -> tuple[IO[bytes] | socket.socket, Callable[[int], bytes]]:
    """What a selector can wait for, and a function that reads what has come.

    Windows waits for sockets only: there a thread copies the pipe into one.
    """
    if sys.platform != "win32":
        return pipe, lambda length: os.read(pipe.fileno(), length)
    return through_socket(pipe)


def through_socket(pipe: IO[bytes]) -> tuple[socket.socket, Callable[[int], bytes]]:
    """A socket into which a thread copies a pipe, and its `recv`."""
    ours, theirs = socket.socketpair()
    Thread(target=_copy, args=(pipe.fileno(), theirs), daemon=True).start()
    return ours, ours.recv


def _copy(descriptor: int, to: socket.socket) -> None:
    with suppress(OSError), to:
        while block := os.read(descriptor, _BLOCK):
            to.sendall(block)
