"""`--on-violation`: a command of the user, which gets the facts and never holds up the watch."""

from __future__ import annotations

import os
import subprocess
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from threading import Thread
from typing import Any

from compiler.files.processes import shield
from compiler.files.templating import to_json
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity

PATIENCE = 60
"""Seconds that a command may take."""
MOST = 8
"""Commands that run at once; a violation beyond them starts none, and that is said."""
_LAST = 5
"""Seconds that the end of a watch waits for commands that still run."""


class Reaction:
    """Starts a command for each violation, each in a thread of its own."""

    def __init__(self, command: Sequence[str]) -> None:
        """Of the command and its options, which no shell sees."""
        self._command = tuple(command)
        self._threads: list[Thread] = []
        self._problems: deque[Diagnostic] = deque()

    def start(self, facts: Mapping[str, Any]) -> None:
        """Start it with facts: as JSON on standard input, and each as `FRETC_NAME` beside."""
        self._threads = [thread for thread in self._threads if thread.is_alive()]
        if len(self._threads) >= MOST:
            self._failed(f"was not started: {MOST} of it still run")
            return
        thread = Thread(target=self._run, args=(dict(facts),), daemon=True)
        self._threads.append(thread)
        thread.start()

    def problems(self) -> Iterator[Diagnostic]:
        """What has failed since this was asked last."""
        while self._problems:
            yield self._problems.popleft()

    def wait(self) -> None:
        """Give commands that still run a little time."""
        for thread in self._threads:
            thread.join(_LAST / len(self._threads))

    def _run(self, facts: Mapping[str, Any]) -> None:
        shield()
        named = {
            f"FRETC_{name.upper()}": str(value)
            for name, value in facts.items()
            if value is not None
        }
        try:
            done = subprocess.run(
                self._command,
                input=f"{to_json(facts)}\n".encode(),
                stdout=subprocess.DEVNULL,
                env={**os.environ, **named},
                timeout=PATIENCE,
                check=False,
            )
        except subprocess.TimeoutExpired:
            self._failed(f"took longer than {PATIENCE} s")
        except (OSError, ValueError) as error:
            self._failed(f"cannot be started: {getattr(error, 'strerror', None) or error}")
        else:
            if done.returncode:
                self._failed(f"ended with exit status {done.returncode}")

    def _failed(self, how: str) -> None:
        self._problems.append(
            Diagnostic(
                Code.REACTION_FAILED,
                f"`{self._command[0]}` {how}",
                help="try it by hand; the watch does not depend on it",
                severity=Severity.WARNING,
            )
        )
