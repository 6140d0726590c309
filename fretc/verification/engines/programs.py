"""A program of others, run with limits of time and memory; it does not outlive the call."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from compiler.files.processes import isolate_imports

_MOST_OUTPUT = 32 * 2**20
"""Bytes that a program may write to one file."""
_LIMITED = f'ulimit -c 0; ulimit -f {_MOST_OUTPUT // 512}; ulimit -d "$0" && exec "$@"'
"""For `sh`: no core file, no endless output, and memory as data: what a run time reserves and
never writes does not count."""

MEMORY = 4 * 2**30
"""Bytes for each process of a prover."""
STARTED = 30.0
"""Seconds in which a prover prints its version, or reads its text."""


@dataclass(frozen=True, slots=True)
class Completion:
    """The end of a program, and its output."""

    status: int | None
    """Its exit status, negative for a signal; None: it was stopped, for it took too long."""
    text: str
    """Everything that it wrote, on both streams."""


def run(command: Sequence[str], folder: Path, *, seconds: float, memory: int) -> Completion:
    """Run a program to its end, or to the limit; its process group does not outlive the call.

    Args:
        command: the program and its arguments; no shell reads them.
        folder: a temporary folder, where the program runs and its output is kept meanwhile.
        seconds: so long it may take.
        memory: bytes that each of its processes may write to.

    Raises:
        OSError: the program cannot be started.
    """
    isolate_imports()
    file = folder / "output.txt"
    with file.open("wb") as output:
        process = subprocess.Popen(
            ["/bin/sh", "-c", _LIMITED, str(memory // 1024), *command],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            status: int | None = process.wait(seconds)
        except subprocess.TimeoutExpired:
            status = None
        finally:  # also where the user stops us
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    return Completion(status, file.read_text(encoding="utf-8", errors="replace"))
