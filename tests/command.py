"""The command as its users meet it: what one run prints, and what it exits with."""

import re
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from fretc import cli
from fretc.audit import pool
from fretc.verification.engines import sandbox

PROCESS = (sys.executable, "-c", "from fretc.cli import main; main()")
"""The command in a process of its own, where that is what is tested."""


@dataclass(frozen=True)
class Run:
    status: int
    out: str
    err: str


def untimed(text: str) -> str:
    """What an audit prints, without the time that it took."""
    return re.sub(r"  \d+\.\d s\n$", "\n", text)


Fretc = Callable[..., Run]


def runner(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *, fault: bool = False
) -> Fretc:
    """Run the command in this process. No run shows a traceback, nor (but for `fault`) F999."""

    def run(*arguments: str) -> Run:
        monkeypatch.setattr(sys, "argv", ["fretc", *arguments])
        with pytest.raises(SystemExit) as exit_:
            cli.main()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        assert fault or "F999" not in printed.err
        return Run(int(str(exit_.value.code or 0)), printed.out, printed.err)

    return run


def without_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a command audit several logs, and prove what runs code, in this process.

    A new process takes a quarter of a second; to fork this large one, more than a small audit.
    A limit of the time of logs needs a process, and has one.
    """

    def call(session: object, function: Callable[..., Any], *args: Any) -> Any:
        return function(*args)

    shared = pool._shared

    def here(
        function: Callable[[Any], Any],
        things: Sequence[Any],
        places: Sequence[int],
        jobs: int,
        clock: pool._Clock,
    ) -> Iterator[tuple[int, Any]]:
        if clock.patience([0.0]) is not None:
            yield from shared(function, things, places, jobs, clock)
            return
        for place in places:
            yield place, function(things[place])

    monkeypatch.setattr(sandbox.SandboxSession, "call", call)
    monkeypatch.setattr(pool, "_shared", here)


def write(path: str, text: str) -> str:
    """Write a file byte for byte, with the folders it needs; return its path."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_bytes(text.encode())
    return path


_MADE: dict[str, dict[str, bytes]] = {}


def made_once(name: str, make: Callable[[], object]) -> None:
    """Files in the current folder, which is empty: made once by each process, then written again.

    Args:
        name: of what is made, no other one's.
        make: runs commands, which take longer than to write what they wrote.
    """
    if name not in _MADE:
        make()
        _MADE[name] = {str(p): p.read_bytes() for p in Path().rglob("*") if p.is_file()}
        return
    for path, content in _MADE[name].items():
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Path(path).write_bytes(content)
