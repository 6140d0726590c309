"""Processes that we start: where they look for their libraries, and what they reply."""

from __future__ import annotations

import os
import pickle
import traceback
from collections.abc import Callable
from typing import Any


def shield() -> None:
    """Python processes that begin from now on import nothing from where they happen to run.

    Python would put the present folder first for `-c` and `-m`, which is how children are started:
    a `multiprocessing.py` beside a supplier's logs would be executed. Options such as `-P` are
    handed on by multiprocessing, the environment by every program in between.
    """
    os.environ["PYTHONSAFEPATH"] = "1"


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
