"""An external program with limits of time and memory; it is killed when the call ends."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

from compiler.files.processes import isolate_imports
from fretish.classes.frozen import dataclass
from fretish.system.processes import OWN_GROUP, kill_all

_MOST_OUTPUT = 32 * 2**20
"""Maximum number of bytes that a program may write to one file."""
_LIMITED = f'ulimit -c 0; ulimit -f {_MOST_OUTPUT // 512}; ulimit -d "$0" && exec "$@"'
"""For `sh`: no core file, limited output, and memory counted as data, so that reserved but unused
memory does not count."""

MEMORY = 4 * 2**30
"""Bytes for each process of a prover."""
STARTED = 30.0
"""Seconds in which a prover must print its version, or read its text."""


@dataclass(frozen=True, slots=True)
class Completion:
    """Exit status and output of a program."""

    status: int | None
    """Exit status, negative for a signal; None: it exceeded its time limit."""
    text: str
    """Output on both streams."""


def run(command: Sequence[str], folder: Path, *, seconds: float, memory: int) -> Completion:
    """Run a program to its end or its time limit, and end its process group.

    Args:
        command: the program and its arguments, without a shell.
        folder: temporary folder, in which the program runs and its output is kept.
        seconds: time limit.
        memory: bytes that each of its processes may write to.

    Raises:
        OSError: the program cannot be started.
    """
    isolate_imports()
    file = folder / "output.txt"
    with file.open("wb") as output:
        process = subprocess.Popen(
            _limited(command, memory),
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            creationflags=OWN_GROUP,
        )
        try:
            status: int | None = process.wait(seconds)
        except subprocess.TimeoutExpired:
            status = None
        finally:  # Also if the user stops fretc.
            kill_all(process)
            process.wait()
    return Completion(status, file.read_text(encoding="utf-8", errors="replace"))


def _limited(command: Sequence[str], memory: int) -> Sequence[str]:
    """The command with its limits; Windows, which has no `sh`, limits only its time."""
    if os.name != "posix":
        return command
    return ["/bin/sh", "-c", _LIMITED, str(memory // 1024), *command]
