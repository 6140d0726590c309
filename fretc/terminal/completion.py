"""Completion in a shell: the script that it loads, and the answers to what the script asks.

The script runs `fretc` with `_FRETC_COMPLETE` in its environment. Source: click's documentation,
Shell Completion.
"""

from __future__ import annotations

import os

import click
from click.shell_completion import ShellComplete, get_completion_class, shell_complete

SHELLS = ("bash", "zsh", "fish")
_NAME, _VARIABLE = "fretc", "_FRETC_COMPLETE"


def script(command: click.Command, shell: str) -> str:
    """What the shell is to load; `shell` is one of `SHELLS`."""
    kind = get_completion_class(shell)
    assert kind is not None
    # The source of bash alone would first run `bash`, to warn of an old one.
    return ShellComplete.source(kind(command, {}, _NAME, _VARIABLE))


def answered(command: click.Command) -> bool:
    """Whether it was a shell that asked; what may follow is then printed."""
    question = os.environ.get(_VARIABLE)
    if question is None:
        return False
    shell_complete(command, {}, _NAME, _VARIABLE, question)
    return True
