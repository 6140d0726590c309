"""`fretc watch` as a process, and the audit of what it has recorded."""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path
from threading import Thread
from typing import Any

from tests.command import PROCESS

ROOT = Path(__file__).parents[3]


class Watched:
    """`fretc watch --format jsonl`, and the lines that it has printed."""

    def __init__(self, environment: Mapping[str, str], folder: Path, *words: str) -> None:
        self.process: subprocess.Popen[str] = subprocess.Popen(
            [*PROCESS, "watch", *words, "--format", "jsonl"],
            cwd=folder,
            env={**environment, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self.lines: list[dict[str, Any]] = []
        self._thread = Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        self.lines.extend(json.loads(line) for line in self.process.stdout)

    def verdict(self, requirement: str) -> str | None:
        """The last that was said."""
        found = [line for line in self.lines if line.get("requirement") == requirement]
        return found[-1]["verdict"] if found else None

    def verdicts(self) -> dict[str, str]:
        """Those of the only run, which has ended."""
        (ended,) = [line for line in self.lines if line["type"] == "run"]
        found: dict[str, str] = ended["verdicts"]
        return found

    def codes(self) -> set[str]:
        return {line["code"] for line in self.lines if "code" in line}

    def says(self, text: str) -> bool:
        """Whether a message has the text in it."""
        return any(text in str(line.get("message")) for line in tuple(self.lines))

    def end(self) -> int:
        """Ctrl-C."""
        self.process.send_signal(signal.SIGINT)
        status = self.process.wait(30)
        self._thread.join(5)
        return status

    def close(self) -> None:
        """Leave nothing behind."""
        self.process.kill()
        self.process.wait()
        self._thread.join(5)
        assert self.process.stdout is not None
        self.process.stdout.close()
