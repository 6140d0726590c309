"""Processes that we start: where they look for their libraries, and what they reply."""

from __future__ import annotations

import os
import pickle
import signal
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_STOPS = (signal.SIGINT, signal.SIGTERM)


def shield() -> None:
    """Python processes that begin from now on import nothing from where they happen to run.

    Python would put the current folder first for `-c` and `-m`, which is how children are started:
    a `multiprocessing.py` beside a supplier's logs would be executed. Options such as `-P` are
    handed on by multiprocessing, the environment by every program in between.
    """
    os.environ["PYTHONSAFEPATH"] = "1"


@contextmanager
def stops_blocked() -> Iterator[None]:
    """Block the signals that stop a process, for a child that starts in here until it ignores them.

    It would print a traceback for a Ctrl-C that comes while it imports. `ignore_interrupts` ends
    this in the child.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore_interrupts() -> None:
    """Ignore Ctrl-C in a child: it goes to all, and the parent decides. SIGTERM ends the child."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)


def reply(function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> tuple[bool, Any]:
    """What a process sends to the one that started it: the result of a function, or its error.

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
    """The error, or one with the same text where it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
