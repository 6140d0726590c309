"""Child processes: their import path, their signals, and their replies."""

from __future__ import annotations

import os
import pickle
import signal
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_STOPS = (signal.SIGINT, signal.SIGTERM)


def isolate_imports() -> None:
    """Keep Python child processes from importing modules of the current folder.

    Python puts the current folder first for `-c` and `-m`, by which children are started: a
    `multiprocessing.py` beside a supplier's logs would be executed. An environment variable is used
    because every program in between passes it on, unlike options such as `-P`.
    """
    os.environ["PYTHONSAFEPATH"] = "1"


@contextmanager
def stops_blocked() -> Iterator[None]:
    """Block stop signals for a child that starts in this context, until it ignores them.

    Without this, a child prints a traceback for a Ctrl-C that comes while it imports.
    `ignore_interrupts` ends the block in the child.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore_interrupts() -> None:
    """Ignore Ctrl-C in a child: the parent receives it, too, and ends the child by SIGTERM."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)


def reply(function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> tuple[bool, Any]:
    """The result of a function, or its error, for the process that started this one.

    Returns:
        True and the result; or False and the exception, with a note of its traceback.
    """
    try:
        return True, function(*args, **kwargs)
    except MemoryError:
        return False, MemoryError()  # there may be no memory for more
    except Exception as error:
        error.add_note(traceback.format_exc())
        return False, _sendable(error)


def _sendable(error: Exception) -> Exception:
    """The error, or a RuntimeError with its text if the error cannot be pickled."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
