"""Load the source text of a generated monitor, and make the monitor."""

from __future__ import annotations

import sys
from functools import lru_cache
from types import CodeType, ModuleType
from typing import Any, cast

from monitors.kernel import Monitor


def load(name: str, text: str) -> Monitor:
    """Execute the text of a generated monitor, and make an instance of the monitor.

    Args:
        name: the file name, for tracebacks.
        text: the text that `--emit monitor` wrote.

    Raises:
        ValueError: the text defines no `MONITOR`.
    """
    module = executed(text, name)
    monitor = getattr(module, "MONITOR", None)
    if not isinstance(monitor, type):
        raise ValueError(f"{name} is not a generated monitor")
    return cast(Monitor, monitor())


def executed(text: str, name: str) -> Any:
    """The module of a generated text, with the definitions of the text as attributes."""
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
"""The start of the part that is specific to one monitor. Above it is the run time. Below its head
comment it is equal in all monitors, and is therefore compiled only once."""


def _compiled(text: str, name: str) -> tuple[CodeType, ...]:
    """The code objects of a text in order of execution, with the line numbers of the text."""
    above, found, own = text.partition(_OWN)
    if found:
        head, _, shared = above.partition("\nimport ")
        if all(line.startswith("#") for line in head.splitlines()):
            above = "\n" * (head.count("\n") + 1) + f"import {shared}\n"
        lines = "\n" * above.count("\n")
        try:
            return _run_time(above), compile(f"{lines}#{own}", name, "exec")
        except SyntaxError:
            pass  # The line is inside another statement: the text cannot be split there.
    return (compile(text, name, "exec"),)


@lru_cache(maxsize=4)
def _run_time(text: str) -> CodeType:
    return compile(text, "run time", "exec")
