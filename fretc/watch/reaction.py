"""`--on-violation`: a command of the user, which receives the facts and never delays the watch."""

from __future__ import annotations

import os
import subprocess
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from threading import Thread
from typing import Any

from compiler.files.processes import isolate_imports
from compiler.files.templating import to_json
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.system.processes import OWN_GROUP, kill_all, was_killed

PATIENCE = 60
"""Seconds that a command may take."""
MOST = 8
"""The most commands that run at once; a further violation starts none and is reported."""
_LAST = 5
"""Seconds that commands may still take when a watch has ended."""


class Reaction:
    """A starter of a command for each violation, each in a thread of its own."""

    def __init__(self, command: Sequence[str]) -> None:
        """`command`: the program and its options, which are not passed to a shell."""
        self._command = tuple(command)
        self._threads: list[Thread] = []
        self._processes: set[subprocess.Popen[bytes]] = set()
        self._is_over = False
        self._problems: deque[Diagnostic] = deque()

    def start(self, facts: Mapping[str, Any]) -> None:
        """Start the command, with facts as JSON on standard input and as `FRETC_NAME` variables."""
        self._threads = [thread for thread in self._threads if thread.is_alive()]
        if len(self._threads) >= MOST:
            self._failed(f"was not started: {MOST} earlier ones still run")
            return
        thread = Thread(target=self._run, args=(dict(facts),), daemon=True)
        self._threads.append(thread)
        thread.start()

    def problems(self) -> Iterator[Diagnostic]:
        """The failures since the last call."""
        while self._problems:
            yield self._problems.popleft()

    def wait(self) -> None:
        """Wait a little for commands that still run, then stop them."""
        for thread in self._threads:
            thread.join(_LAST / len(self._threads))
        self.end()
        for thread in self._threads:
            thread.join(_LAST)

    def end(self) -> None:
        """Kill all running commands, with the processes that they started."""
        self._is_over = True
        for process in [*self._processes]:
            kill_all(process)

    def _run(self, facts: Mapping[str, Any]) -> None:
        isolate_imports()
        named = {
            f"FRETC_{name.upper()}": str(value)
            for name, value in facts.items()
            if value is not None
        }
        try:
            process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                env={**os.environ, **named},
                start_new_session=True,  # Ctrl-C is for the watch
                creationflags=OWN_GROUP,
            )
        except (OSError, ValueError) as error:
            self._failed(f"cannot be started: {getattr(error, 'strerror', None) or error}")
            return
        self._processes.add(process)
        if self._is_over:
            kill_all(process)
        self._follow(process, f"{to_json(facts)}\n".encode())
        self._processes.discard(process)

    def _follow(self, process: subprocess.Popen[bytes], facts: bytes) -> None:
        try:
            process.communicate(facts, PATIENCE)
        except subprocess.TimeoutExpired:
            kill_all(process)
            process.communicate()
            self._failed(f"took longer than {PATIENCE} s, and was stopped")
        else:
            if self._is_over and was_killed(process.returncode):
                self._failed(f"was stopped: it still ran {_LAST} s after the end of the watch")
            elif process.returncode:
                self._failed(f"ended with exit status {process.returncode}")

    def _failed(self, how: str) -> None:
        self._problems.append(diagnostic("reaction_failed", command=self._command[0], how=how))
