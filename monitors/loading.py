"""A generated text → its module; that of a monitor → the monitor, ready to be stepped."""

from __future__ import annotations

import sys
from types import ModuleType
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
        raise ValueError(f"{name} is no generated monitor")
    return cast(Monitor, monitor())


def executed(text: str, name: str) -> Any:
    """The module of a generated text; its attributes are what the text defines."""
    module = ModuleType(f"_fretc_{name}")
    # Dataclasses look up their module by name while the text is being executed.
    sys.modules[module.__name__] = module
    try:
        exec(compile(text, name, "exec"), module.__dict__)
    finally:
        del sys.modules[module.__name__]
    return module
