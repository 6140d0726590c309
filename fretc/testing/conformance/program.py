"""The program under test: one line of inputs and one line of outputs for each tick.

First each side writes a header with the names of its columns. Time and length of each output line
are limited; the program is ended with the run.
"""

from __future__ import annotations

import selectors
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from shlex import join
from types import TracebackType
from typing import IO, Self

from fretc.testing.exports.tables import Cell, cell_text, csv_text
from fretish.diagnostics.diagnostic import Diagnostic, DiagnosticError
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible
from fretish.system.processes import OWN_GROUP, kill_all, selectable
from monitors.kernel.tables import InputError
from monitors.kernel.variable_tables import read_variables
from monitors.kernel.variables import Variable

LONGEST_LINE = 1 << 16
"""Maximum length of an output line in bytes."""
_LAST_WORDS = 2048
"""Number of bytes of standard error that are kept."""
_FAREWELL = 1.0
"""Seconds in which it must end after its input has ended."""


class ProgramError(DiagnosticError):
    """The program violates the protocol."""


class ProgramRun:
    """A run of the program."""

    def __init__(
        self,
        command: Sequence[str],
        inputs: Sequence[str],
        outputs: Mapping[str, Variable],
        seconds: float,
    ) -> None:
        """A run that has not started.

        Args:
            command: the program and its arguments, without a shell.
            inputs: its input columns.
            outputs: the columns that it must print.
            seconds: time limit for each line.
        """
        self._command, self._inputs, self._seconds = command, inputs, seconds
        self._rows = read_variables(self._lines(), outputs, f"output of `{command[0]}`")
        self._buffer = bytearray()
        self._errors = bytearray()
        self._tick = -1

    def __enter__(self) -> Self:
        """Start it.

        Raises:
            ProgramError: it cannot be started (F940).
        """
        try:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                bufsize=0,
                start_new_session=True,  # Ctrl-C reaches only fretc, which ends the children.
                creationflags=OWN_GROUP,
            )
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or error
            raise ProgramError(_not_started(self._command, str(why))) from error
        self._selector = selectors.DefaultSelector()
        for pipe in (self._process.stdout, self._process.stderr):
            stream, read = selectable(_stream(pipe))
            self._selector.register(stream, selectors.EVENT_READ, (pipe, read))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """End the program and its child processes."""
        process = self._process
        with suppress(OSError):
            _stream(process.stdin).close()
        with suppress(subprocess.TimeoutExpired):
            if error is None:
                process.wait(_FAREWELL)
        kill_all(process)
        process.wait()
        self._selector.close()
        for stream in (process.stdout, process.stderr):
            _stream(stream).close()

    def step(self, values: Sequence[Cell]) -> tuple[Cell, ...]:
        """The outputs of the next tick, in the order of `outputs`.

        Raises:
            ProgramError: a line is wrong (F941), late (F942) or missing (F943).
        """
        if self._tick >= 0 and (self._buffer or self._reads(0)):
            raise ProgramError(self._wrong("it came before the inputs of its tick"))
        self._tick += 1
        header = [self._inputs] if self._tick == 0 else []
        for names in header:
            self._send(csv_text(names, ()))
        self._send(csv_text([cell_text(value) for value in values], ()))
        try:
            return next(self._rows)
        except InputError as error:
            raise ProgramError(self._wrong(str(error))) from error

    def _send(self, line: str) -> None:
        try:
            _stream(self._process.stdin).write(line.encode())
        except OSError:
            raise ProgramError(self._ended()) from None

    def _lines(self) -> Iterator[str]:
        """Lines of its output, each as soon as it is complete."""
        while True:
            due = time.monotonic() + self._seconds
            while b"\n" not in self._buffer:
                if len(self._buffer) > LONGEST_LINE:
                    why = f"it is longer than {LONGEST_LINE} bytes"
                    raise ProgramError(self._wrong(why))
                if not self._reads(due - time.monotonic()):
                    raise ProgramError(self._late())
            line, _, rest = self._buffer.partition(b"\n")
            self._buffer = rest
            yield line.decode(errors="backslashreplace") + "\n"

    def _reads(self, seconds: float) -> bool:
        """Whether more of its output came in time.

        Raises:
            ProgramError: it has ended too early.
        """
        due = time.monotonic() + seconds
        while ready := self._selector.select(max(0.0, due - time.monotonic())):
            for key, _ in ready:
                pipe, read = key.data
                chunk = read(LONGEST_LINE)
                if not chunk:
                    self._selector.unregister(key.fileobj)
                    if pipe is self._process.stdout:
                        raise ProgramError(self._ended())
                elif pipe is self._process.stdout:
                    self._buffer += chunk
                    return True
                else:
                    self._errors = (self._errors + chunk)[-_LAST_WORDS:]
        return False

    # Messages

    def _wrong(self, why: str) -> Diagnostic:
        """F941."""
        return diagnostic("program_line", tick=self._tick, why=visible(why))

    def _late(self) -> Diagnostic:
        """F942."""
        return diagnostic("program_silent", tick=max(self._tick, 0), seconds=f"{self._seconds:g}")

    def _ended(self) -> Diagnostic:
        """F943."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_FAREWELL)
        while True:  # The last lines of its standard error.
            ready = [key.data for key, _ in self._selector.select(0)]
            found = b"".join(r(_LAST_WORDS) for p, r in ready if p is self._process.stderr)
            if not found:
                break
            self._errors = (self._errors + found)[-_LAST_WORDS:]
        status = self._process.returncode
        how = "closed its output" if status is None else _ending(status)
        said = self._errors.decode(errors="backslashreplace").strip().splitlines()
        last = f"; its last output: {said[-1]}" if said else ""
        return diagnostic("program_ended", tick=max(self._tick, 0), how=visible(f"{how}{last}"))


def _stream(pipe: IO[bytes] | None) -> IO[bytes]:
    assert pipe is not None, "all three are pipes"
    return pipe


def _ending(status: int) -> str:
    if status < 0:
        return f"ended by signal {-status}"
    return f"ended with exit status {status}"


def _not_started(command: Sequence[str], why: str) -> Diagnostic:
    """F940."""
    return diagnostic("program_not_started", command=visible(join(command)), why=visible(why))
