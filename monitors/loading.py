"""A generated text → its module; that of a monitor → the monitor, ready to be stepped."""

from __future__ import annotations

import sys
from functools import lru_cache
from types import CodeType, ModuleType
from typing import Any, cast

from monitors.kernel import Monitor


def load(name: str, text: str) -> Monitor:
    """Execute the text of a generated monitor and make one of it.

    Args:
        name: for tracebacks; the file's name.
        text: what `--emit monitor` wrote.

    Raises:
        ValueError: the text defines no `MONITOR`.
    """
    module = executed(text, name)
    monitor = getattr(module, "MONITOR", None)
    if not isinstance(monitor, type):
        raise ValueError(f"{name} is not a generated monitor")
    return cast(Monitor, monitor())


def executed(text: str, name: str) -> Any:
    """The module of a generated text; its attributes are what the text defines."""
    module = ModuleType(f"_fretc_{name}")
    # Dataclasses look up their module by name while the text is being executed.
    sys.modules[module.__name__] = module
    try:
        for code in _compiled(text, name):
            exec(code, module.__dict__)
    finally:
        del sys.modules[module.__name__]
    return module


_OWN = "\n# The requirements ---"
"""Where what is of one monitor begins. Above it is the run time, most of the text: below the
comments of its head it is the same in all monitors, and compiled once."""


def _compiled(text: str, name: str) -> tuple[CodeType, ...]:
    """The code of a text, in the order of its execution; lines keep their numbers."""
    above, found, own = text.partition(_OWN)
    if found:
        head, _, shared = above.partition("\nimport ")
        if all(line.startswith("#") for line in head.splitlines()):
            above = "\n" * (head.count("\n") + 1) + f"import {shared}\n"
        lines = "\n" * above.count("\n")
        try:
            return _run_time(above), compile(f"{lines}#{own}", name, "exec")
        except SyntaxError:
            pass  # the line stands in the midst of something: the text cannot be divided there
    return (compile(text, name, "exec"),)


@lru_cache(maxsize=4)
def _run_time(text: str) -> CodeType:
    return compile(text, "run time", "exec")
