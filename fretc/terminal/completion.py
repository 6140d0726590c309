"""Shell completion: the script that a shell loads, and the answers to its queries.

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
    """The completion script; `shell` is one of `SHELLS`."""
    kind = get_completion_class(shell)
    assert kind is not None
    # `source` of bash alone would run `bash` to warn about old versions.
    return ShellComplete.source(kind(command, {}, _NAME, _VARIABLE))


def answer_query(command: click.Command) -> bool:
    """Whether this run is a completion query; if so, the completions are printed."""
    question = os.environ.get(_VARIABLE)
    if question is None:
        return False
    shell_complete(command, {}, _NAME, _VARIABLE, question)
    return True
