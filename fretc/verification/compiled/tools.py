"""Compilers and interpreters of monitors: external programs with limits."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO

from fretc.verification.engines.programs import MEMORY, STARTED, run
from fretish.classes.frozen import dataclass
from fretish.system.resources import exceeded_time

_SECONDS = 60.0
_ENDING = 10.0
"""Seconds in which a process must end after it has closed its output."""


@dataclass(frozen=True, slots=True)
class Binary:
    """Output of a compiler."""

    data: bytes
    engine: str
    """Compiler with version and flags."""


class ToolError(Exception):
    """The text cannot be compiled or run; the message gives the reason."""


@contextmanager
def conversation(
    name: str,
    command: Sequence[str],
    folder: Path,
    environment: Mapping[str, str],
    errors: IO[bytes],
) -> Iterator[subprocess.Popen[bytes]]:
    """A program with pipes to its input and output, until the end of the context.

    Args:
        name: the program, in messages.
        command: the program and its arguments.
        folder: its working directory.
        environment: its environment variables.
        errors: the file that receives its error output.

    Raises:
        ToolError: the program cannot be started.
    """
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
        )
    except OSError as error:
        raise ToolError(f"{name} cannot be started: {error}") from None
    with process:
        try:
            yield process
        finally:
            process.kill()


def no_answer(
    name: str, process: subprocess.Popen[bytes], errors: Path, marks: Sequence[str]
) -> ToolError:
    """The reason why a program has not answered.

    Args:
        name: the program, in messages.
        process: the program.
        errors: the file with its error output.
        marks: words, one of which is in each line that states a reason.
    """
    with suppress(subprocess.TimeoutExpired):
        if exceeded_time(process.wait(_ENDING)):
            return ToolError(f"out of time: {name} took as many CPU seconds")
    text = errors.read_text(encoding="utf-8", errors="replace")
    lines = (line for line in text.splitlines() if any(mark in line for mark in marks))
    return ToolError(f"{name} does not run it: {next(lines, 'it gives no reason')}")


def compiled(
    program: str,
    flags: Sequence[str],
    texts: Mapping[str, str],
    steps: Sequence[Sequence[str]],
    result: str,
) -> Binary:
    """A compiled binary.

    Args:
        program: path of the compiler.
        flags: flags of all steps.
        texts: texts by file name.
        steps: further arguments of each call of the compiler.
        result: file that the last step writes.

    Raises:
        ToolError: the compiler rejects the text, or cannot be run.
    """
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        known = compile_in(folder, program, flags, texts, steps)
        try:
            data = (folder / result).read_bytes()
        except OSError:
            raise ToolError(f"{known} compiles it, but writes no `{result}`") from None
        return Binary(data, f"{known} {' '.join(flags)}")


def compile_in(
    folder: Path,
    program: str,
    flags: Sequence[str],
    texts: Mapping[str, str],
    steps: Sequence[Sequence[str]],
) -> str:
    """Compile texts in a folder; return the compiler with its version.

    Args:
        folder: folder for the texts and what is made of them.
        program: path of the compiler.
        flags: flags of all steps.
        texts: texts by file name.
        steps: further arguments of each call of the compiler.

    Raises:
        ToolError: the compiler rejects the text, or cannot be run.
    """
    for file, text in texts.items():
        (folder / file).write_text(text, encoding="utf-8")
    known = version(program)
    for step in steps:
        try:
            end = run([program, *flags, *step], folder, seconds=_SECONDS, memory=MEMORY)
        except OSError as error:
            raise ToolError(f"the compiler cannot be run: {error}") from None
        if end.status != 0:
            lines = (line for line in end.text.splitlines() if "error" in line)
            raise ToolError(f"{known} does not compile it: {next(lines, 'it gives no reason')}")
    return known


def version(program: str) -> str:
    """The first line of a program's version output.

    Raises:
        ToolError: it cannot be run.
    """
    with TemporaryDirectory(prefix="fretc-") as folder:
        try:
            end = run([program, "--version"], Path(folder), seconds=STARTED, memory=MEMORY)
        except OSError as error:
            raise ToolError(f"`{program}` cannot be run: {error}") from None
    first, *_ = end.text.splitlines() or [""]
    return first or "a program that prints no version"
