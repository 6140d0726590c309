"""`--notify`: give a summary of an audit to a command of the user.

The command gets one JSON object on standard input; its `text` suits chat hooks.
"""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Mapping, Sequence
from typing import Any

from compiler.files.processes import isolate_imports
from compiler.files.templating import to_json
from fretc.terminal.output import fail, print_diagnostics, print_status
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

_PATIENCE = 60
"""Time limit for the command, in seconds."""


def words(command: str, option: str = "--notify") -> list[str]:
    """The command split into words, without a shell; exits if it is empty or cannot be split."""
    try:
        parts = shlex.split(command)
    except ValueError as error:
        parts, why = [], str(error).lower()
    else:
        why = "it is empty"
    if not parts:
        fail(diagnostic("no_command_named", option=option, why=why))
    return parts


def notify(command: Sequence[str], summary: Mapping[str, Any]) -> None:
    """Run the command with the summary, and report whether it failed; verdicts are not affected."""
    isolate_imports()
    try:
        done = subprocess.run(
            command,
            input=f"{to_json(summary)}\n".encode(),
            stdout=subprocess.DEVNULL,
            timeout=_PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        print_diagnostics([_failed(command, f"took longer than {_PATIENCE} s")])
    except OSError as error:
        print_diagnostics([_failed(command, f"cannot be started: {error.strerror or error}")])
    else:
        if done.returncode:
            print_diagnostics([_failed(command, f"ended with exit status {done.returncode}")])
        else:
            print_status(visible(f"sent the summary to `{command[0]}`"))


def _failed(command: Sequence[str], how: str) -> Diagnostic:
    return diagnostic("notice_failed", command=command[0], how=how)
