"""Compilers and interpreters of monitors: external programs with limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from fretc.verification.engines.programs import MEMORY, STARTED, run
from fretish.classes.frozen import dataclass

_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class Binary:
    """Output of a compiler."""

    data: bytes
    engine: str
    """Compiler with version and flags."""


class ToolError(Exception):
    """The text cannot be compiled or run; the message gives the reason."""


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
