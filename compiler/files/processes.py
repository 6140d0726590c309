"""Child processes: their import path and their replies."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any


def isolate_imports() -> None:
    """Keep Python child processes from importing modules of the current folder.

    Python puts the current folder first for `-c` and `-m`, by which children are started: a
    `multiprocessing.py` beside a supplier's logs would be executed. An environment variable is used
    because every program in between passes it on, unlike options such as `-P`.
    """
    os.environ["PYTHONSAFEPATH"] = "1"


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
        import traceback  # a short command never needs it

        error.add_note(traceback.format_exc())
        return False, _sendable(error)


def _sendable(error: Exception) -> Exception:
    """The error, or a RuntimeError with its text if the error cannot be pickled."""
    import pickle

    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
